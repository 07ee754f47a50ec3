// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/loop_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/core.h>

#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/parallel.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

double length_of(const Vector3d& v) {
  return std::sqrt(v.squaredNorm());
}

struct Viewpoint {
  double time = 0.0;  ///< s
  double path = 0.0;  ///< m from the start
  Eigen::Isometry3d T_world_lidar;
  std::vector<Vector3d> seen;  ///< world
};

/// Places a spacing apart, with what they see.
std::vector<Viewpoint> places_of(const PoseAtTime& pose_at, double duration,
                                 const LoopOptions& options) {
  constexpr double kStep = 0.1;  // s
  std::vector<Viewpoint> all;
  double path = 0.0;
  Vector3d last = pose_at(0.0).translation();
  for (int i = 0; kStep * i <= duration; ++i) {
    const Eigen::Isometry3d T_world_lidar = pose_at(kStep * i);
    path += length_of(T_world_lidar.translation() - last);
    last = T_world_lidar.translation();
    if (all.empty() || path - all.back().path >= options.spacing) {
      all.push_back({.time = kStep * i, .path = path, .T_world_lidar = T_world_lidar, .seen = {}});
    }
  }
  const std::size_t every = all.size() / options.most + 1;
  std::vector<Viewpoint> thinned;
  for (std::size_t i = 0; i < all.size(); i += every) {
    thinned.push_back(std::move(all[i]));
  }
  return thinned;
}

void look_around(Viewpoint& place, std::span<const Vector3d> directions, const RayScene& still,
                 double range) {
  const Vector3d eye = place.T_world_lidar.translation();
  for (const Vector3d& direction : directions) {
    const Vector3d towards = place.T_world_lidar.linear() * direction;
    if (const auto hit = still.cast(eye, towards, range)) {
      place.seen.push_back(eye + hit->distance * towards);
    }
  }
}

/// Share of what one place sees that is in sight of the other.
double share_in_sight(const Viewpoint& from, const Viewpoint& other, const RayScene& still,
                      double range) {
  if (from.seen.empty()) {
    return 0.0;
  }
  const Vector3d eye = other.T_world_lidar.translation();
  std::size_t count = 0;
  for (const Vector3d& point : from.seen) {
    const Vector3d way = point - eye;
    const double distance = length_of(way);
    constexpr double kSkin = 0.1;  // m, the surface does not hide itself
    if (distance > 2.0 * kSkin && distance < range) {
      count += still.cast(eye, way / distance, distance - kSkin) ? 0U : 1U;
    }
  }
  return static_cast<double>(count) / static_cast<double>(from.seen.size());
}

/// rad between two attitudes, from the trace.
double angle_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Matrix3d turn = a.linear().transpose() * b.linear();
  const double cosine = std::clamp(0.5 * (turn.trace() - 1.0), -1.0, 1.0);
  return repeatable_atan2(std::sqrt(1.0 - cosine * cosine), cosine);
}

}  // namespace

std::vector<LoopPair> find_loops(const PoseAtTime& T_world_lidar, double duration,
                                 std::span<const Vector3d> directions, const RayScene& still,
                                 const LoopOptions& options, const Checkpoint& checkpoint) {
  std::vector<Viewpoint> places = places_of(T_world_lidar, duration, options);
  in_parallel(
      places.size(), 1,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          look_around(places[i], directions, still, options.range);
        }
      },
      checkpoint);
  std::vector<std::vector<LoopPair>> found(places.size());
  in_parallel(
      places.size(), 1,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
          const Viewpoint& later = places[b];
          for (std::size_t a = 0; a < b; ++a) {
            const Viewpoint& earlier = places[a];
            const double distance =
                length_of(later.T_world_lidar.translation() - earlier.T_world_lidar.translation());
            const double path = later.path - earlier.path;
            if (path < options.apart || path < options.detour * distance ||
                distance > options.reach) {
              continue;
            }
            const double overlap = std::min(share_in_sight(earlier, later, still, options.range),
                                            share_in_sight(later, earlier, still, options.range));
            if (overlap >= options.overlap) {
              found[b].push_back(
                  {.time_a = earlier.time,
                   .time_b = later.time,
                   .distance = distance,
                   .angle = angle_between(earlier.T_world_lidar, later.T_world_lidar),
                   .overlap = overlap});
            }
          }
        }
      },
      checkpoint);
  std::vector<LoopPair> loops;
  for (const std::vector<LoopPair>& part : found) {
    loops.insert(loops.end(), part.begin(), part.end());
  }
  return loops;
}

void write_loops(const std::filesystem::path& file, std::span<const LoopPair> loops, double epoch) {
  OutputFile out(file);
  out.write("time_a_s,time_b_s,distance_m,angle_rad,overlap\n");
  for (const LoopPair& loop : loops) {
    const std::string line =
        fmt::format("{:.3f},{:.3f},{:.4f},{:.5f},{:.4f}\n", epoch + loop.time_a,
                    epoch + loop.time_b, loop.distance, loop.angle, loop.overlap);
    out.write(std::string_view(line));
  }
  out.close();
}

}  // namespace adit
