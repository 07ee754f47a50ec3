// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What made-up sensors see, when, and how it comes into files.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "adit/slam/core/units.hpp"
#include "adit/tests/support/moving_rig.hpp"

namespace adit::test {

inline constexpr int kSweeps = 8;  // 0.1 s each

inline std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write(const std::filesystem::path& file, const std::string& bytes) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream stream(file, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream.flush()) {
    throw std::runtime_error("cannot write " + file.string());
  }
}

/// m, from the middle of a room of 8 x 6 m to its walls; some rays meet things before these.
inline double room(double azimuth, std::size_t ray) {
  const double x = std::abs(std::cos(azimuth));
  const double y = std::abs(std::sin(azimuth));
  const double wall = std::min(4.0 / std::max(x, 1e-6), 3.0 / std::max(y, 1e-6));
  return ray % 5 == 0 ? 0.7 * wall : wall;
}

inline Nanoseconds at(double seconds) {
  return MovingRig::kBegin + Nanoseconds(static_cast<int64_t>(1e9 * seconds));
}
/// "1623370000.100000000"
inline std::string in_seconds(double seconds) {
  const std::string digits = std::to_string(at(seconds).count());
  return digits.substr(0, 10) + "." + digits.substr(10);
}
/// As KITTI writes it; MovingRig::kBegin is 2021-06-11, 00:06:40.
inline std::string as_date(double seconds) {
  return "2021-06-11 00:06:" + std::to_string(40.0 + seconds);
}

/// What 16 x 36 rays meet, x y z and intensity.
inline std::vector<Point> room_points() {
  std::vector<Point> points;
  for (std::size_t beam = 0; beam < 16; ++beam) {
    const double elevation = kDegree * (2.0 * static_cast<double>(beam) - 15.0);
    for (int column = 0; column < 36; ++column) {
      const double azimuth = 10.0 * kDegree * column;
      const double range = room(azimuth, beam);
      points.push_back({static_cast<float>(range * std::cos(azimuth)),
                        static_cast<float>(range * std::sin(azimuth)),
                        static_cast<float>(range * std::tan(elevation)), 0.5F});
    }
  }
  return points;
}

}  // namespace adit::test
