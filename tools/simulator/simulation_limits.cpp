// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/simulation_limits.hpp"

#include <cmath>
#include <string>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr double kLeastLeg = 0.01;    // m
constexpr double kLeastAngle = 0.01;  // rad between the ways to and from a corner

void require_rate(int rate, int least, int most, const char* such_as) {
  if (rate < least || rate > most || 1'000'000'000 % rate != 0) {
    throw UsageError(fmt::format("is {} Hz; must be a divisor of 1e9 from {} to {}, such as {}.",
                                 rate, least, most, such_as));
  }
}

}  // namespace

void require_duration(double seconds) {
  if (!(seconds >= 0.2 && seconds <= 36000.0)) {
    throw UsageError(fmt::format("is {} s; must be 0.2 to 36000.", shortest(seconds)));
  }
}

void require_change(double share) {
  if (!(share >= 0.0 && share <= 1.0)) {
    throw UsageError(fmt::format("is {}; must be a share from 0 to 1.", shortest(share)));
  }
}

void require_later(double seconds) {
  constexpr double kTenYears = 3.2e8;
  if (!(seconds >= 0.0 && seconds <= kTenYears)) {
    throw UsageError(fmt::format("is {} s; must be 0 to 3.2e8, ten years.", shortest(seconds)));
  }
}

void require_speed(double speed) {
  if (!(speed > 0.0 && speed <= 50.0)) {
    throw UsageError(
        fmt::format("is {} m/s; must be more than 0 and at most 50.", shortest(speed)));
  }
}

void require_begin(double distance) {
  if (!(distance >= 0.0 && distance <= 1e5)) {
    throw UsageError(fmt::format("is {} m; must be 0 to 100000.", shortest(distance)));
  }
}

void require_corner_radius(double radius) {
  if (!(radius >= 0.01 && radius <= 1000.0)) {
    throw UsageError(fmt::format("is {} m; must be 0.01 to 1000.", shortest(radius)));
  }
}

void require_size(double size) {
  if (!(size >= 0.05 && size <= 100.0)) {
    throw UsageError(fmt::format("is {} m; must be 0.05 to 100.", shortest(size)));
  }
}

void require_imu_rate(int rate) {
  require_rate(rate, 10, 2000, "100, 200, 400, 1000");
}

void require_gnss_rate(int rate) {
  require_rate(rate, 1, 20, "1, 5, 10");
}

void require_wheel_rate(int rate) {
  require_rate(rate, 5, 500, "10, 20, 50, 100");
}

void require_camera_rate(int rate) {
  require_rate(rate, 1, 50, "1, 2, 5, 10");
}

void require_wheels(const MotionStyle& style) {
  if (style.step > 0.0) {
    throw UsageError(std::string(style.name) +
                     " is on foot, and has no wheels. Choose drive, stop-and-go or moving-start.");
  }
}

void require_way(std::span<const Eigen::Vector3d> corners) {
  const std::size_t n = corners.size();
  if (n < 3) {
    throw UsageError("a closed way has at least three corners.");
  }
  const auto to_next = [&](std::size_t i) {
    return Eigen::Vector2d((corners[(i + 1) % n] - corners[i % n]).head<2>());
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (!corners[i].allFinite()) {
      throw UsageError(fmt::format("corner {} is not a place of finite numbers.", i + 1));
    }
    if (to_next(i).norm() < kLeastLeg) {
      throw UsageError(fmt::format("two corners lie at the same place, {} and {}{}.", i + 1,
                                   (i + 1) % n + 1,
                                   i + 1 == n ? "; the way closes by itself" : ""));
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d back = -to_next(i + n - 1);
    const Eigen::Vector2d ahead = to_next(i);
    const double across = std::abs(back.x() * ahead.y() - back.y() * ahead.x());
    if (across < kLeastAngle * back.dot(ahead)) {
      throw UsageError(fmt::format("the way turns straight back at corner {}.", i + 1));
    }
  }
}

}  // namespace adit
