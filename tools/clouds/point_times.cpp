// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/point_times.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>

#include <fmt/core.h>

namespace adit {
namespace {

constexpr double kRelativeBelow = 1.0;      // s after zero
constexpr double kNeededResolution = 1e-4;  // s

/// Index of the earliest and the latest valid point.
struct Extent {
  std::size_t earliest = 0;
  std::size_t latest = 0;
};

template <class T>
std::optional<Extent> find_extent(const std::filesystem::path& file, std::span<const T> times,
                                  std::span<const uint8_t> valid) {
  std::optional<Extent> extent;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (valid[i] == 0) {
      continue;
    }
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(times[i])) {
        throw InputError(file, Place::point(i),
                         "its time is not a finite number, its coordinates are",
                         "Write the point without coordinates (NaN), or the cloud without times");
      }
    }
    if (!extent) {
      extent = Extent{i, i};
    } else if (times[i] < times[extent->earliest]) {
      extent->earliest = i;
    } else if (times[i] > times[extent->latest]) {
      extent->latest = i;
    }
  }
  return extent;
}

template <class T>
std::vector<std::size_t> find_impossible(std::span<const T> times, std::span<const uint8_t> valid,
                                         std::optional<double> unit) {
  // A sweep's points spread evenly over its time, or are a part of it: a hundred times the bulk is
  // far beyond both.
  constexpr double kFarthest = 100.0;
  // The bulk may be of one moment; then the longest sweep counts, by default in the finest unit.
  const double slowest = kLongestSweep / unit.value_or(1e-9);
  constexpr std::size_t kSampled = 4096;  // points whose times make the quantiles
  const std::size_t every = std::max<std::size_t>(1, times.size() / kSampled);
  std::vector<double> some;
  std::size_t points = 0;
  std::size_t finite = 0;
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto time = static_cast<double>(times[i]);
    points += valid[i] != 0 ? 1U : 0U;
    if (valid[i] == 0 || !std::isfinite(time)) {
      continue;
    }
    if (finite++ % every == 0) {
      some.push_back(time);
    }
    least = std::min(least, time);
    greatest = std::max(greatest, time);
  }
  if (!are_few(points - finite, points) || some.empty()) {
    return {};
  }
  const auto quantile = [&](std::size_t twentieths) {
    const auto at = some.begin() + static_cast<std::ptrdiff_t>(twentieths * (some.size() - 1) / 20);
    std::nth_element(some.begin(), at, some.end());
    return *at;
  };
  const double low = quantile(1);
  const double high = quantile(19);
  const double reach = high > low ? kFarthest * (high - low) : slowest;
  if (finite == points && greatest - high <= reach && low - least <= reach) {
    return {};
  }
  std::vector<std::size_t> impossible;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto time = static_cast<double>(times[i]);
    if (valid[i] != 0 && !(time - high <= reach && low - time <= reach)) {
      impossible.push_back(i);
    }
  }
  return are_few(impossible.size(), points) ? impossible : std::vector<std::size_t>{};
}

/// Seconds in one unit of the times, from their spread; where they do not spread, from their size.
double unit_from_spread(double spread, double largest, bool integers) {
  if (spread > 1e6) {
    return 1e-9;
  }
  if (spread > 1e3) {
    return 1e-6;
  }
  if (spread > 1.0) {
    return 1e-3;
  }
  if (spread > 0.0 && !integers) {
    return 1.0;
  }
  // A single time, or integers one apart: an epoch's size tells the unit (1e11 s is the year 5138).
  if (largest > 1e17 || (integers && largest < 1e9)) {
    return 1e-9;
  }
  return largest > 1e14 ? 1e-6 : largest > 1e11 ? 1e-3 : 1.0;
}

/// time * unit in nanoseconds, as exact as the time itself: the whole units do not pass through a
/// product of doubles.
template <class T>
Nanoseconds scaled(T time, double unit) {
  const auto nanoseconds_per_unit = static_cast<int64_t>(std::llround(unit * 1e9));
  if constexpr (std::is_integral_v<T>) {
    return Nanoseconds(time * nanoseconds_per_unit);
  } else {
    const T whole = std::trunc(time);
    const auto fraction = std::llround((time - whole) * static_cast<T>(nanoseconds_per_unit));
    return Nanoseconds(static_cast<int64_t>(whole) * nanoseconds_per_unit + fraction);
  }
}

template <class T>
PointTimes interpret(const std::filesystem::path& file, std::span<const T> times,
                     std::span<const uint8_t> valid, bool single_precision,
                     std::optional<double> known_unit, double longest) {
  PointTimes result;
  result.offsets.resize(times.size());
  const std::optional<Extent> extent = find_extent(file, times, valid);
  if (!extent) {
    return result;
  }
  const T first = times[extent->earliest];
  const T last = times[extent->latest];
  // The difference is taken before the conversion: absolute nanoseconds do not fit into a double.
  const auto difference = [first](T time) {
    if constexpr (std::is_integral_v<T>) {
      return static_cast<double>(static_cast<uint64_t>(time) - static_cast<uint64_t>(first));
    } else {
      return time - first;
    }
  };
  const double largest =
      std::max(std::abs(static_cast<double>(first)), std::abs(static_cast<double>(last)));
  const double unit =
      known_unit ? *known_unit : unit_from_spread(difference(last), largest, std::is_integral_v<T>);
  result.unit = unit;
  const double duration = difference(last) * unit;
  if (!(duration <= longest)) {
    throw InputError(
        file, Place::point(extent->latest),
        fmt::format("its time is {:g} s after that of point ", duration) +
            std::to_string(extent->earliest) + "; a sweep lasts 10 s at most",
        known_unit
            ? "Correct recording.point_time_unit"
            : "The file is damaged or holds more than one sweep; or set recording.point_time_unit, "
              "such as 1e-9");
  }
  if (!(largest * unit < 9.2e9)) {
    throw InputError(file, Place::point(extent->earliest), "its time is beyond 292 years",
                     "The file is damaged, or the field is no time: rename it");
  }
  // Epochs lie in the past: what is a sweep before zero counts back from a stamp at its end.
  const double earliest = static_cast<double>(first) * unit;
  result.absolute = earliest >= kRelativeBelow || earliest < -kLongestSweep;
  constexpr double kFloatStep = 1.2e-7;  // relative distance of neighbouring floats
  if (result.absolute && single_precision && largest * unit * kFloatStep > kNeededResolution) {
    throw InputError(file, Place::point(extent->earliest),
                     "its time is absolute and in float32, which resolves only " +
                         std::to_string(largest * unit * kFloatStep) + " s there",
                     "Write the times as float64, or relative to the start of the sweep");
  }
  result.start = scaled(first, unit);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const bool usable = valid[i] != 0 || (times[i] >= first && times[i] <= last);
    result.offsets[i] = usable ? static_cast<float>(difference(times[i]) * unit) : 0.0F;
  }
  return result;
}

}  // namespace

bool are_few(std::size_t bad, std::size_t points) {
  constexpr std::size_t kLeast = 20;
  return bad == 0 || (points >= kLeast && bad <= points / 10);
}

std::vector<std::size_t> impossible_times(std::span<const double> times,
                                          std::span<const uint8_t> valid,
                                          std::optional<double> unit) {
  return find_impossible(times, valid, unit);
}

std::vector<std::size_t> impossible_times(std::span<const int64_t> times,
                                          std::span<const uint8_t> valid,
                                          std::optional<double> unit) {
  return find_impossible(times, valid, unit);
}

PointTimes interpret_times(const std::filesystem::path& file, std::span<const double> times,
                           std::span<const uint8_t> valid, bool single_precision,
                           std::optional<double> unit, double longest) {
  return interpret(file, times, valid, single_precision, unit, longest);
}

PointTimes interpret_times(const std::filesystem::path& file, std::span<const int64_t> times,
                           std::span<const uint8_t> valid, std::optional<double> unit,
                           double longest) {
  return interpret(file, times, valid, false, unit, longest);
}

}  // namespace adit
