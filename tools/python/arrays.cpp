// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/arrays.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <new>

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

/// Row order, native byte order, aligned. An array that has all three is not copied.
constexpr int kPlain =
    py::array::c_style | py::array::forcecast | py::detail::npy_api::NPY_ARRAY_ALIGNED_;
template <class Number>
using PlainArray = py::array_t<Number, kPlain>;

std::string type_name(const py::object& object) {
  return py::str(py::type::of(object).attr("__name__"));
}

/// Lists and other sequences become arrays.
py::array as_array(const py::object& object, std::string_view name) {
  if (py::isinstance<py::array>(object)) {
    return py::reinterpret_borrow<py::array>(object);
  }
  try {
    return py::module_::import("numpy").attr("asarray")(object);
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_ValueError)) {  // of rows that are not equally long
      throw;
    }
    throw py::value_error(
        fmt::format("{}: the rows of this {} differ in length", name, type_name(object)));
  }
}

/// `kinds` are the accepted values of dtype.kind, `wanted` is their name for messages.
py::array as_numbers(const py::object& object, std::string_view name, std::string_view kinds,
                     std::string_view wanted) {
  py::array array = as_array(object, name);
  // NumPy makes float64 of an empty list, and of a list of other objects an array of objects.
  if (kinds.find(array.dtype().kind()) == std::string_view::npos) {
    throw py::type_error(py::isinstance<py::array>(object)
                             ? fmt::format("{}: {} are expected, not {}", name, wanted,
                                           std::string(py::str(array.dtype())))
                             : fmt::format("{}: an array or list of {} is expected, not {}", name,
                                           wanted, type_name(object)));
  }
  return array;
}

py::array as_numbers(const py::object& object, std::string_view name) {
  return as_numbers(object, name, "fiu", "numbers");
}

template <class Number>
PlainArray<Number> plain(const py::array& array) {
  auto numbers = PlainArray<Number>::ensure(array);
  if (!numbers) {
    throw std::bad_alloc();  // the only failure: any number converts
  }
  return numbers;
}

PlainArray<double> doubles(const py::array& array) {
  return plain<double>(array);
}

bool is_single(const py::array& array) {
  return py::isinstance<py::array_t<float>>(array);  // not by the identity of its dtype
}

void require_finite(const double* numbers, py::ssize_t size, std::string_view name) {
  for (py::ssize_t i = 0; i < size; ++i) {
    if (!std::isfinite(numbers[i])) {
      throw py::value_error(fmt::format("{}: not finite", name));
    }
  }
}

template <class Number>
std::vector<Point> read_points(const PlainArray<Number>& array) {
  const auto numbers = array.template unchecked<2>();
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

py::array number_array(const py::object& object, std::string_view name,
                       const std::vector<py::ssize_t>& shape) {
  py::array array = as_numbers(object, name);
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
  const py::array array = as_numbers(object, name);
  if (array.ndim() != 2 || (array.shape(1) != 3 && array.shape(1) != 4)) {
    throw py::value_error(
        fmt::format("{}: has the shape {}, not (n, 3) or (n, 4)", name, text_of(array)));
  }
  if (array.shape(0) == 0) {
    throw py::value_error(fmt::format("{}: has no point", name));
  }
  if (!is_single(array)) {
    return read_points(doubles(array));
  }
  const auto numbers = plain<float>(array);
  if (numbers.shape(1) != 4) {
    return read_points(numbers);
  }
  std::vector<Point> points(static_cast<std::size_t>(numbers.shape(0)));
  std::memcpy(static_cast<void*>(points.data()), numbers.data(), points.size() * sizeof(Point));
  return points;
}

std::vector<float> floats_of(const py::object& object, std::string_view name) {
  const auto numbers = doubles(number_array(object, name, {-1}));
  std::vector<float> floats(static_cast<std::size_t>(numbers.size()));
  for (std::size_t i = 0; i < floats.size(); ++i) {
    floats[i] = static_cast<float>(numbers.data()[i]);
  }
  return floats;
}

std::vector<uint16_t> rings_of(const py::object& object, std::string_view name) {
  constexpr auto kMost = std::numeric_limits<uint16_t>::max();
  const auto numbers = plain<int64_t>(as_numbers(object, name, "iu", "whole numbers"));
  if (numbers.ndim() != 1) {
    throw py::value_error(fmt::format("{}: has the shape {}, not (n,)", name, text_of(numbers)));
  }
  std::vector<uint16_t> rings;
  rings.reserve(static_cast<std::size_t>(numbers.size()));
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    const int64_t number = numbers.data()[i];
    if (number < 0 || number > kMost) {
      throw py::value_error(fmt::format("{}: {} is not between 0 and {}", name, number, kMost));
    }
    rings.push_back(static_cast<uint16_t>(number));
  }
  return rings;
}

Eigen::Vector3d vector_of(const py::object& object, std::string_view name, bool finite) {
  const auto numbers = doubles(number_array(object, name, {3}));
  if (finite) {
    require_finite(numbers.data(), 3, name);
  }
  return Eigen::Vector3d(numbers.data());
}

Eigen::Matrix3d matrix_of(const py::object& object, std::string_view name) {
  const auto numbers = doubles(number_array(object, name, {3, 3}));
  require_finite(numbers.data(), 9, name);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
}

Eigen::Isometry3d pose_of_array(const py::object& object, std::string_view name) {
  const auto numbers = doubles(number_array(object, name, {4, 4}));
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
