// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/arrays.hpp"

#include <cmath>
#include <cstring>
#include <memory>

#include <fmt/core.h>

namespace adit::python {
namespace {

std::string text_of(const py::array& array) {
  return py::str(array.attr("shape"));
}

std::string text_of(const std::vector<py::ssize_t>& shape) {
  std::string text;
  for (const py::ssize_t size : shape) {
    text += (text.empty() ? "" : ", ") + (size < 0 ? std::string("n") : std::to_string(size));
  }
  return "(" + text + (shape.size() == 1 ? ",)" : ")");
}

py::array as_floats(const py::object& object, std::string_view name) {
  if (!py::isinstance<py::array>(object)) {
    throw py::type_error(fmt::format("{}: a NumPy array is expected, not {}", name,
                                     std::string(py::str(py::type::of(object).attr("__name__")))));
  }
  const auto array = py::reinterpret_borrow<py::array>(object);
  // Not by the identity of dtypes: that of an array that was unpickled is another object.
  if (!py::isinstance<py::array_t<float>>(array) && !py::isinstance<py::array_t<double>>(array)) {
    throw py::type_error(fmt::format("{}: float32 or float64 is expected, not {}", name,
                                     std::string(py::str(array.dtype()))));
  }
  return array;
}

/// The same numbers as doubles, in the order of rows.
py::array_t<double, py::array::c_style | py::array::forcecast> doubles(const py::array& array) {
  return py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
}

void require_finite(const double* numbers, py::ssize_t size, std::string_view name) {
  for (py::ssize_t i = 0; i < size; ++i) {
    if (!std::isfinite(numbers[i])) {
      throw py::value_error(fmt::format("{}: not finite", name));
    }
  }
}

template <class Number>
std::vector<Point> read_points(const py::array& array) {
  const auto numbers = py::array_t<Number>(array).template unchecked<2>();
  std::vector<Point> points(static_cast<std::size_t>(numbers.shape(0)));
  const bool has_intensity = numbers.shape(1) == 4;
  for (py::ssize_t i = 0; i < numbers.shape(0); ++i) {
    points[static_cast<std::size_t>(i)] = {
        .x = static_cast<float>(numbers(i, 0)),
        .y = static_cast<float>(numbers(i, 1)),
        .z = static_cast<float>(numbers(i, 2)),
        .intensity = has_intensity ? static_cast<float>(numbers(i, 3)) : 0.0F};
  }
  return points;
}

}  // namespace

py::array float_array(const py::object& object, std::string_view name,
                      const std::vector<py::ssize_t>& shape) {
  py::array array = as_floats(object, name);
  bool fits = array.ndim() == static_cast<py::ssize_t>(shape.size());
  for (std::size_t i = 0; fits && i < shape.size(); ++i) {
    fits = shape[i] < 0 || array.shape(static_cast<py::ssize_t>(i)) == shape[i];
  }
  if (!fits) {
    throw py::value_error(
        fmt::format("{}: has the shape {}, not {}", name, text_of(array), text_of(shape)));
  }
  return array;
}

std::vector<Point> points_of(const py::object& object, std::string_view name) {
  const py::array array = as_floats(object, name);
  if (array.ndim() != 2 || (array.shape(1) != 3 && array.shape(1) != 4)) {
    throw py::value_error(
        fmt::format("{}: has the shape {}, not (n, 3) or (n, 4)", name, text_of(array)));
  }
  if (array.shape(0) == 0) {
    throw py::value_error(fmt::format("{}: has no point", name));
  }
  if (!py::isinstance<py::array_t<float>>(array)) {
    return read_points<double>(array);
  }
  if (array.shape(1) == 4 && (array.flags() & py::array::c_style) != 0) {
    std::vector<Point> points(static_cast<std::size_t>(array.shape(0)));
    std::memcpy(points.data(), array.data(), points.size() * sizeof(Point));
    return points;
  }
  return read_points<float>(array);
}

std::vector<float> floats_of(const py::object& object, std::string_view name) {
  const py::array array = float_array(object, name, {-1});
  const auto numbers = doubles(array);
  std::vector<float> floats(static_cast<std::size_t>(numbers.size()));
  for (std::size_t i = 0; i < floats.size(); ++i) {
    floats[i] = static_cast<float>(numbers.data()[i]);
  }
  return floats;
}

Eigen::Vector3d vector_of(const py::object& object, std::string_view name, bool finite) {
  const auto numbers = doubles(
      float_array(py::module_::import("numpy").attr("asarray")(object, "float64"), name, {3}));
  if (finite) {
    require_finite(numbers.data(), 3, name);
  }
  return Eigen::Vector3d(numbers.data());
}

Eigen::Matrix3d matrix_of(const py::object& object, std::string_view name) {
  const auto numbers = doubles(float_array(object, name, {3, 3}));
  require_finite(numbers.data(), 9, name);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
}

Eigen::Isometry3d pose_of_array(const py::object& object, std::string_view name) {
  const auto numbers = doubles(float_array(object, name, {4, 4}));
  require_finite(numbers.data(), 16, name);
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  constexpr double kRoundOff = 1e-4;  // what float32 and text leave
  constexpr double kExact = 1e-12;
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const bool rigid =
      (rotation * rotation.transpose()).isIdentity(kRoundOff) && rotation.determinant() > 0.0 &&
      (matrix.row(3) - Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)).cwiseAbs().maxCoeff() < kRoundOff;
  if (!rigid) {
    throw py::value_error(fmt::format(
        "{}: is no rigid transformation: a rotation and a translation above 0 0 0 1", name));
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = (rotation * rotation.transpose()).isIdentity(kExact)
                      ? rotation
                      : Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

py::array_t<double> array_of(const Eigen::Isometry3d& pose) {
  return array_of(pose.matrix());
}

py::array view_of(const std::vector<Point>& points, py::handle owner) {
  py::array array(py::dtype::of<float>(), {points.size(), std::size_t{4}},
                  {sizeof(Point), sizeof(float)}, points.data(), owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

py::array array_of(std::vector<Point>&& points) {
  auto kept = std::make_unique<std::vector<Point>>(std::move(points));
  const float* data = kept->empty() ? nullptr : &kept->front().x;
  const std::size_t size = kept->size();
  const py::capsule owner(kept.release(),
                          [](void* held) { delete static_cast<std::vector<Point>*>(held); });
  return py::array(py::dtype::of<float>(), {size, std::size_t{4}}, {sizeof(Point), sizeof(float)},
                   data, owner);
}

}  // namespace adit::python
