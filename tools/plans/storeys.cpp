// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/plans/storeys.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {
namespace {

constexpr double kLevel = 0.9;            // of a normal's z: floors and ramps, no walls
constexpr std::size_t kLeastGround = 20;  // points
constexpr double kLeastPath = 5.0;        // m, on a storey: more than a staircase's landing is long
constexpr double kSteady = 0.3;  // m, what the floor of a storey varies by around a place, 1 sigma
constexpr double kStep = 0.1;    // m, between heights that are tried
constexpr double kSquare = 1.0;  // m, in which a storey's floor has one height

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// How far the path went along the floor to each step, within a session.
std::vector<double> lengths_of(std::span<const FloorStep> steps) {
  std::vector<double> lengths(steps.size());
  for (std::size_t i = 1; i < steps.size(); ++i) {
    if (steps[i].session == steps[i - 1].session) {
      lengths[i] = (steps[i].sensor - steps[i - 1].sensor).head<2>().norm();
    }
  }
  return lengths;
}

/// The height that most of the path keeps to; nothing where there is none left.
std::optional<double> busiest_height(const std::map<int64_t, double>& levels) {
  std::optional<double> busiest;
  double most = 0.0;
  for (const auto& [level, length] : levels) {
    double around = 0.0;
    for (const auto& [other, way] : levels) {
      const double off = kStep * static_cast<double>(other - level) / kSteady;
      around += way * std::exp(-0.5 * off * off);
    }
    if (around > most) {
      most = around;
      busiest = kStep * static_cast<double>(level);
    }
  }
  return busiest;
}

/// Each step belongs to the nearest storey, stairs and landings to that which they lead to.
void add_paths(std::vector<Storey>& storeys, std::span<const FloorStep> steps) {
  const auto off = [](const Storey& storey, const FloorStep& step) {
    return std::abs(storey.floor - step.floor);
  };
  for (const FloorStep& step : steps) {
    const auto nearest = std::ranges::min_element(
        storeys, {}, [&](const Storey& storey) { return off(storey, step); });
    if (nearest != storeys.end() && off(*nearest, step) < kLeastStorey) {
      nearest->path.push_back(step);
    }
  }
  for (Storey& storey : storeys) {
    std::vector<double> floors;
    for (const FloorStep& step : storey.path) {
      if (off(storey, step) <= 0.5 * kLeastStorey) {
        floors.push_back(step.floor);
      }
    }
    storey.floor = median_of(std::move(floors));
  }
}

}  // namespace

FloorStep floor_step(const MapKeyframe& keyframe, const Eigen::Vector3d& sensor,
                     std::span<const PlanPoint> points) {
  std::vector<double> ground;
  for (const PlanPoint& point : points) {
    if (point.normal.z() >= kLevel && point.position.z() < sensor.z() &&
        (point.position - sensor).head<2>().norm() <= kGroundReach) {
      ground.push_back(point.position.z());
    }
  }
  FloorStep step{.session = keyframe.session, .sensor = sensor};
  if (ground.size() >= kLeastGround) {
    step.seen_floor = median_of(std::move(ground));
  }
  return step;
}

std::vector<FloorStep> floors_under(std::vector<FloorStep> steps) {
  std::map<SessionId, std::vector<double>> heights;
  for (const FloorStep& step : steps) {
    if (step.seen_floor) {
      heights[step.session].push_back(step.sensor.z() - *step.seen_floor);
    }
  }
  std::erase_if(steps, [&](const FloorStep& step) { return !heights.contains(step.session); });
  std::map<SessionId, double> carried;
  for (const auto& [session, values] : heights) {
    carried[session] = median_of(values);
  }
  for (FloorStep& step : steps) {
    step.floor = step.sensor.z() - carried.at(step.session);
  }
  return steps;
}

std::vector<Storey> find_storeys(std::span<const FloorStep> steps) {
  const std::vector<double> lengths = lengths_of(steps);
  std::map<int64_t, double> levels;  // m of path at each height, in steps of kStep
  for (std::size_t i = 0; i < steps.size(); ++i) {
    levels[std::llround(steps[i].floor / kStep)] += lengths[i];
  }
  std::vector<Storey> storeys;
  while (const std::optional<double> height = busiest_height(levels)) {
    Storey storey{.floor = *height};
    std::erase_if(levels, [&](const auto& level) {
      const bool is_on =
          std::abs(kStep * static_cast<double>(level.first) - *height) <= 0.5 * kLeastStorey;
      storey.length += is_on ? level.second : 0.0;
      return is_on;
    });
    // What is nearer to a busier height is the landing of a staircase.
    if (storey.length >= kLeastPath && std::ranges::all_of(storeys, [&](const Storey& other) {
          return std::abs(other.floor - *height) >= kLeastStorey;
        })) {
      storeys.push_back(std::move(storey));
    }
  }
  std::ranges::sort(storeys, {}, &Storey::floor);
  add_paths(storeys, steps);
  return storeys;
}

double StoreyFloor::at(const Eigen::Vector2d& place) {
  const std::pair square(static_cast<int64_t>(std::floor(place.y() / kSquare)),
                         static_cast<int64_t>(std::floor(place.x() / kSquare)));
  const auto known = known_.find(square);
  if (known != known_.end()) {
    return known->second;
  }
  const Eigen::Vector2d middle = kSquare * Eigen::Vector2d(static_cast<double>(square.second) + 0.5,
                                                           static_cast<double>(square.first) + 0.5);
  double nearest = std::numeric_limits<double>::infinity();
  double floor = 0.0;
  for (const FloorStep& step : path_) {
    const double distance = (step.sensor.head<2>() - middle).squaredNorm();
    if (distance < nearest) {
      nearest = distance;
      floor = step.floor;
    }
  }
  known_[square] = floor;
  return floor;
}

}  // namespace adit
