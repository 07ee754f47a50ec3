// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/range_sensor.hpp"

#include <cmath>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d direction_to(double azimuth, double elevation) {
  const SinCos around = repeatable_sin_cos(azimuth);
  const SinCos up = repeatable_sin_cos(elevation);
  return {up.cos * around.cos, up.cos * around.sin, up.sin};
}

Firing firing_of(const LaserChannel& channel, double rotor, int64_t time) {
  const SinCos around = repeatable_sin_cos(rotor);
  return {.time = time,
          .origin = {channel.radius * around.cos, channel.radius * around.sin, channel.height},
          .direction = direction_to(rotor + channel.azimuth, channel.elevation),
          .ring = channel.ring};
}

void append(const SpinningPattern& pattern, int64_t period, int64_t sweep,
            std::vector<Firing>& firings) {
  const auto rotor_at = [&](double share) { return pattern.start - 2.0 * kPi * share; };
  if (pattern.cycles_per_sweep > 0) {
    for (int64_t i = 0; i < pattern.cycles_per_sweep; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(pattern.cycles_per_sweep);
      for (const LaserChannel& channel : pattern.channels) {
        firings.push_back(firing_of(channel, rotor_at(share),
                                    i * period / pattern.cycles_per_sweep + channel.time));
      }
    }
    return;
  }
  const int64_t begin = sweep * period;
  for (int64_t cycle = (begin + pattern.cycle - 1) / pattern.cycle;
       cycle * pattern.cycle < begin + period; ++cycle) {
    for (const LaserChannel& channel : pattern.channels) {
      const int64_t time = cycle * pattern.cycle + channel.time - begin;
      const double share = static_cast<double>(time) / static_cast<double>(period);
      firings.push_back(firing_of(channel, rotor_at(share), time));
    }
  }
}

/// -1 to 1 and back, once while the phase grows by 1.
double zigzag(double phase) {
  const double u = phase - std::floor(phase);
  return u < 0.5 ? 4.0 * u - 1.0 : 3.0 - 4.0 * u;
}

Vector2d traced(const TracedPattern& pattern, double time, int line) {
  const Vector2d middle = 0.5 * (pattern.low + pattern.high);
  const Vector2d half = 0.5 * (pattern.high - pattern.low);
  if (pattern.curve == TracedPattern::Curve::zigzag) {
    const double share = static_cast<double>(line) / pattern.lines;
    const double turns = pattern.frequencies.x() * time + 0.25 * share;
    const double phase = pattern.frequencies.y() * time + share;
    return {2.0 * kPi * (turns - std::floor(turns)), middle.y() + half.y() * zigzag(phase)};
  }
  const double offset = pattern.line_spacing * (line - 0.5 * (pattern.lines - 1));
  const auto turn = [&](double frequency) {
    const double turns = frequency * time;
    return repeatable_sin_cos(2.0 * kPi * (turns - std::floor(turns)));
  };
  const SinCos first = turn(pattern.frequencies.x());
  const SinCos second = turn(pattern.frequencies.y());
  const double room = 0.5 * pattern.line_spacing * (pattern.lines - 1);
  return {middle.x() + 0.5 * half.x() * (first.cos + second.cos),
          middle.y() + 0.5 * (half.y() - room) * (first.sin + second.sin) + offset};
}

void append(const TracedPattern& pattern, int64_t period, int64_t sweep,
            std::vector<Firing>& firings) {
  const int64_t begin = sweep * period;
  for (int64_t shot = (begin + pattern.interval - 1) / pattern.interval;
       shot * pattern.interval < begin + period; ++shot) {
    const double time = 1e-9 * static_cast<double>(shot * pattern.interval);
    for (int line = 0; line < pattern.lines; ++line) {
      const Vector2d angles = traced(pattern, time, line);
      firings.push_back({.time = shot * pattern.interval - begin,
                         .direction = direction_to(angles.x(), angles.y()),
                         .ring = static_cast<uint16_t>(line)});
    }
  }
}

void append(const CameraPattern& pattern, int64_t /*period*/, int64_t /*sweep*/,
            std::vector<Firing>& firings) {
  for (int row = 0; row < pattern.height; ++row) {
    for (int column = 0; column < pattern.width; ++column) {
      const Vector3d towards(pattern.focal, 0.5 * pattern.width - column - 0.5,
                             0.5 * pattern.height - row - 0.5);
      firings.push_back({.time = 0,
                         .direction = towards / std::sqrt(towards.squaredNorm()),
                         .ring = static_cast<uint16_t>(row)});
    }
  }
}

}  // namespace

std::string_view to_string(CloudLayout layout) {
  switch (layout) {
    case CloudLayout::velodyne:
      return "velodyne";
    case CloudLayout::ouster:
      return "ouster";
    case CloudLayout::hesai:
      return "hesai";
    case CloudLayout::livox:
      return "livox";
    case CloudLayout::camera:
      return "camera";
  }
  return "";
}

CloudLayout cloud_layout_named(std::string_view name) {
  std::vector<std::string> names;
  for (const CloudLayout layout :
       {CloudLayout::velodyne, CloudLayout::ouster, CloudLayout::hesai, CloudLayout::livox}) {
    if (name == to_string(layout)) {
      return layout;
    }
    names.emplace_back(to_string(layout));
  }
  throw UsageError("there is no driver '" + std::string(name) + "'. " +
                   suggestion(std::string(name), names) + ".");
}

std::vector<Firing> firings_of(const RangeSensor& sensor, int64_t index) {
  std::vector<Firing> firings;
  std::visit([&](const auto& pattern) { append(pattern, sensor.period, index, firings); },
             sensor.pattern);
  return firings;
}

}  // namespace adit
