// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// NumPy arrays to what adit works on and back. Whoever calls holds the GIL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <Eigen/Geometry>

#include "adit/slam/core/types.hpp"

namespace adit::python {

namespace py = pybind11;

/// An array as it is; anything else by numpy.asarray(). Throws TypeError unless it has integers or
/// floating-point numbers of any size and byte order, ValueError unless it has this shape; -1
/// stands for any length. `name` is the argument's, for messages.
py::array number_array(const py::object& object, std::string_view name,
                       const std::vector<py::ssize_t>& shape);

/// Points of (n, 3) or (n, 4) numbers: x y z in m and, in the fourth column, intensity. An array of
/// float32 with four columns in the order of rows is copied as it is, any other is converted first.
/// Throws TypeError, ValueError; also for no point at all.
std::vector<Point> points_of(const py::object& object, std::string_view name);

/// (n,) numbers.
std::vector<float> floats_of(const py::object& object, std::string_view name);

/// (n,) whole numbers from 0 to 65535. Throws TypeError, ValueError.
std::vector<uint16_t> rings_of(const py::object& object, std::string_view name);

/// (3,), finite unless that is allowed: what an inertial sensor does not measure is NaN.
Eigen::Vector3d vector_of(const py::object& object, std::string_view name, bool finite = true);
/// (3, 3), finite.
Eigen::Matrix3d matrix_of(const py::object& object, std::string_view name);
/// (4, 4): a rigid transformation.
Eigen::Isometry3d pose_of_array(const py::object& object, std::string_view name);

/// A copy with the shape of the matrix, (n,) of a vector; row-major.
template <class Derived>
py::array_t<double> array_of(const Eigen::MatrixBase<Derived>& matrix) {
  std::vector<py::ssize_t> shape{matrix.rows()};
  if constexpr (Derived::ColsAtCompileTime != 1) {
    shape.push_back(matrix.cols());
  }
  py::array_t<double> array(shape);
  double* to = array.mutable_data();
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      *to++ = matrix(row, column);
    }
  }
  return array;
}
py::array_t<double> array_of(const Eigen::Isometry3d& pose);

/// Views of memory that `owner` keeps alive and that stays where it is: not copied, not writable.
py::array view_of(const std::vector<Point>& points, py::handle owner);  ///< (n, 4) float32
template <class Number>
py::array view_of(const std::vector<Number>& numbers, py::handle owner) {
  py::array array(py::dtype::of<Number>(), {numbers.size()}, {sizeof(Number)}, numbers.data(),
                  owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// An array that takes the points over.
py::array array_of(std::vector<Point>&& points);

}  // namespace adit::python
