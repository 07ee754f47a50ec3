// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/seen_intensity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <span>

#include <nlohmann/json.hpp>

#include "adit/tools/clouds/ply_visit.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/viewer/brightness.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr double kFinestCell = 0.2;               // m
constexpr std::size_t kMostCells = 2'000'000;     // some 100 MB, while the map is read
constexpr uint64_t kMostCloudPoints = 8'000'000;  // that are looked at, evenly chosen
constexpr std::size_t kMostBrightnessPoints = 200'000;
constexpr int64_t kHalf = int64_t{1} << 20;  // cells, on either side of the origin
constexpr uint64_t kAxisBits = 21;

using CellAt = std::array<int64_t, 3>;

std::optional<uint64_t> key_of(const CellAt& cell) {
  uint64_t key = 0;
  for (const int64_t one : cell) {
    if (one < -kHalf || one >= kHalf) {
      return std::nullopt;
    }
    key = key << kAxisBits | static_cast<uint64_t>(one + kHalf);
  }
  return key;
}

CellAt cell_of_key(uint64_t key) {
  CellAt cell{};
  for (std::size_t k = 3; k-- > 0; key >>= kAxisBits) {
    cell[k] = static_cast<int64_t>(key & ((uint64_t{1} << kAxisBits) - 1)) - kHalf;
  }
  return cell;
}

/// Of a place that is a number.
CellAt cell_at(const Eigen::Vector3d& p, double edge) {
  const double farthest = static_cast<double>(2 * kHalf);
  CellAt cell{};
  for (int k = 0; k < 3; ++k) {
    const double number = std::clamp(std::floor(p[k] / edge), -farthest, farthest);
    cell[static_cast<std::size_t>(k)] = static_cast<int64_t>(number);
  }
  return cell;
}

/// What takes points of each keyframe to where they were by a trajectory; nothing where it has
/// none of the keyframe's sweeps.
std::vector<std::optional<Eigen::Isometry3d>> back_to(const Trajectory& trajectory,
                                                      const std::vector<MapKeyframe>& keyframes,
                                                      const std::vector<ViewSweep>& sweeps) {
  std::unordered_map<Nanoseconds::rep, const Eigen::Isometry3d*> T_cloud_lidar;
  for (const StampedPose& pose : trajectory.poses) {
    T_cloud_lidar.emplace(pose.stamp.count(), &pose.pose);
  }
  std::vector<std::optional<Eigen::Isometry3d>> back(keyframes.size());
  for (const ViewSweep& sweep : sweeps) {
    const auto then = T_cloud_lidar.find(sweep.stamp.count());
    auto& T_cloud_map = back[static_cast<std::size_t>(sweep.keyframe)];
    if (!T_cloud_map && then != T_cloud_lidar.end()) {
      const auto& keyframe = keyframes[static_cast<std::size_t>(sweep.keyframe)];
      T_cloud_map = *then->second * (keyframe.T_map_keyframe * sweep.T_keyframe_lidar).inverse();
    }
  }
  return back;
}

/// How many points a run's cloud has, by its summary; nothing where it left none.
std::optional<uint64_t> points_by(const fs::path& summary) {
  const auto json = nlohmann::json::parse(read_text_file(summary), nullptr, false);
  const nlohmann::json::json_pointer at("/output/map_points");
  return json.is_object() && json.contains(at) && json[at].is_number_unsigned()
             ? std::optional(json[at].get<uint64_t>())
             : std::nullopt;
}

}  // namespace

SeenIntensity::SeenIntensity() : edge_(kFinestCell) {}

SeenIntensity SeenIntensity::of(const fs::path& folder, const std::vector<MapKeyframe>& keyframes,
                                const std::vector<ViewSweep>& sweeps, std::ostream& progress) {
  SeenIntensity seen;
  const fs::path cloud = folder / "map.ply";
  const fs::path trajectory = folder / "trajectory.tum";
  const fs::path summary = folder / "summary.json";
  if (!fs::exists(cloud) || !fs::exists(trajectory) || !fs::exists(summary)) {
    return seen;
  }
  try {
    if (points_by(summary) != WrittenPly(cloud).points()) {
      return seen;  // it is of an earlier run
    }
    seen.T_cloud_map_ = back_to(read_trajectory(trajectory), keyframes, sweeps);
    seen.read(cloud);
  } catch (const FileError& error) {
    progress << "note: points have no intensity: " << error.what() << "\n";
    seen.T_cloud_map_.clear();
  }
  return seen;
}

void SeenIntensity::read(const fs::path& cloud) {
  const WrittenPly ply(cloud);
  const uint64_t stride = std::max<uint64_t>(1, ply.points() / kMostCloudPoints);
  const uint64_t sampled = std::max<uint64_t>(1, ply.points() / kMostBrightnessPoints);
  std::vector<Point> some;
  uint64_t number = 0;
  ply.visit([&](std::span<const Point> points) {
    for (const Point& point : points) {
      const Eigen::Vector3d p(point.x, point.y, point.z);
      const bool taken = number % stride == 0;
      if (number++ % sampled == 0) {
        some.push_back(point);
      }
      if (!taken || !p.allFinite() || !std::isfinite(point.intensity)) {
        continue;
      }
      if (const auto key = key_of(cell_at(p, edge_))) {
        Cell& cell = cells_[*key];
        cell.sum += point.intensity;
        ++cell.count;
      }
      if (cells_.size() > kMostCells) {
        coarsen();
      }
    }
  });
  brightest_ = usual_brightest(some);
}

/// Eight cells become one.
void SeenIntensity::coarsen() {
  std::unordered_map<Key, Cell> coarse;
  for (const auto& [key, fine] : cells_) {
    CellAt cell = cell_of_key(key);
    std::ranges::for_each(cell, [](int64_t& one) { one >>= 1; });
    Cell& sum = coarse[*key_of(cell)];
    sum.sum += fine.sum;
    sum.count += fine.count;
  }
  cells_ = std::move(coarse);
  edge_ *= 2.0;
}

std::optional<uint8_t> SeenIntensity::at(std::size_t keyframe, const Eigen::Vector3d& p_map) const {
  if (!(brightest_ > 0.0F) || keyframe >= T_cloud_map_.size() || !T_cloud_map_[keyframe] ||
      !p_map.allFinite()) {
    return std::nullopt;
  }
  const CellAt middle = cell_at(*T_cloud_map_[keyframe] * p_map, edge_);
  Cell found;
  const auto add = [&](const CellAt& cell) {
    const auto key = key_of(cell);
    const auto seen = key ? cells_.find(*key) : cells_.end();
    if (seen != cells_.end()) {
      found.sum += seen->second.sum;
      found.count += seen->second.count;
    }
  };
  add(middle);
  if (found.count == 0) {  // else those around it
    for (int i = 0; i < 27; ++i) {
      add({middle[0] + i / 9 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i % 3 - 1});
    }
  }
  if (found.count == 0) {
    return std::nullopt;
  }
  return brightness_of(found.sum / static_cast<float>(found.count), brightest_);
}

}  // namespace adit
