// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/cloud_origin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/clouds/column_values.hpp"

namespace adit {
namespace {

// m. Up to here float32 rounds by a quarter of a millimetre at most.
constexpr double kNear = 8192.0;
// m. Up to here it rounds by half a millimetre; clouds of one recording may spread so far.
constexpr double kReach = 16384.0;
// m. No coordinates on the Earth are as large; those that are come from damaged numbers.
constexpr double kFarthest = 1e8;
constexpr std::size_t kSampledPoints =
    4096;  // points; their median is within 2 % of all points' ranks

/// Some returns of a cloud, spread over it.
struct Sample {
  std::array<std::vector<double>, 3> axes;  ///< m
};

Sample sample_of(const CloudColumns& columns) {
  const std::size_t every = std::max<std::size_t>(1, columns.points / kSampledPoints);
  const std::size_t count = columns.points / every;
  const double scale = columns.reading.coordinate_scale.value_or(1.0);
  std::array<std::vector<double>, 3> all;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    all[axis].resize(count);
    Column some = *columns.columns[axis];
    some.stride *= every;
    for_each_value(some, count, [&](std::size_t i, auto value) {
      all[axis][i] = scale * static_cast<double>(value);
    });
  }
  Sample sample;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d p(all[0][i], all[1][i], all[2][i]);
    if (p.allFinite() && !p.isZero(0.0)) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        sample.axes[axis].push_back(all[axis][i]);
      }
    }
  }
  return sample;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// m, from float32 `at` to the next larger one.
double float_step(double at) {
  const auto value = static_cast<float>(std::abs(at));
  return static_cast<double>(std::nextafter(value, std::numeric_limits<float>::max())) -
         static_cast<double>(value);
}

bool are_floats(const std::vector<double>& values) {
  return std::ranges::all_of(
      values, [](double value) { return static_cast<double>(static_cast<float>(value)) == value; });
}

}  // namespace

CloudOrigin find_origin(const std::filesystem::path& file, const CloudColumns& columns) {
  CloudOrigin origin{.offset = columns.reading.offset.value_or(Eigen::Vector3d::Zero())};
  const Sample sample = sample_of(columns);
  if (sample.axes[0].empty()) {
    return origin;
  }
  Eigen::Vector3d middle;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    middle[static_cast<Eigen::Index>(axis)] = median(sample.axes[axis]);
  }
  const double farthest = middle.cwiseAbs().maxCoeff();
  if (farthest > kFarthest) {
    return origin;
  }
  // A single axis may have whole numbers all over, such as a wall's.
  const bool finer = !std::ranges::all_of(sample.axes, are_floats);
  if (!finer && farthest > kNear) {
    origin.step = float_step(farthest);
  }
  if (!columns.reading.offset) {
    origin.offset =
        farthest > kNear ? middle.array().round().matrix().eval() : Eigen::Vector3d::Zero().eval();
  } else if (const double away = (middle - origin.offset).cwiseAbs().maxCoeff();
             finer && away > kReach) {
    throw InputError(
        file, {},
        fmt::format("its points lie about {:.1f} km from {}, where the recording's first cloud "
                    "lies, and float32 keeps millimetres within 16 km",
                    1e-3 * away, offset_text(origin.offset)),
        "Make it a recording of its own");
  }
  return origin;
}

std::string offset_text(const Eigen::Vector3d& offset) {
  return fmt::format("({:.0f}, {:.0f}, {:.0f}) m", offset.x(), offset.y(), offset.z());
}

std::string offset_note(const Eigen::Vector3d& offset) {
  return "the coordinates of the recording are large: adit subtracts " + offset_text(offset) +
         " from all clouds, so that they keep their millimetres; ranges are measured from there, "
         "and results are relative to it";
}

std::string coarse_note(double step) {
  return fmt::format(
      "its coordinates are rounded to float32, which has steps of {:g} m at that size; what the "
      "rounding took is lost. Write them in double precision, or subtract an offset before they "
      "are written",
      step);
}

}  // namespace adit
