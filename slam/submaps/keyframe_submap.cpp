// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/submaps/keyframe_submap.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "adit/engine/context.hpp"

namespace adit {
namespace {

// shaders/include/surface.glsl: two bits of class, 15 bits for each axis of the octahedral map.
constexpr uint32_t kIsotropic = 0;
constexpr uint32_t kPlane = 1;
constexpr uint32_t kGrazing = 3;
constexpr int kClassAt = 30;
constexpr int kFirstAt = 15;
constexpr uint32_t kAxisMask = 0x7fff;
constexpr double kHalfRange = 16383.0;

Eigen::Vector2d folded(const Eigen::Vector2d& o) {
  return {(1.0 - std::abs(o.y())) * (o.x() >= 0.0 ? 1.0 : -1.0),
          (1.0 - std::abs(o.x())) * (o.y() >= 0.0 ? 1.0 : -1.0)};
}

uint32_t pack(const Eigen::Vector3d& direction, uint32_t kind) {
  Eigen::Vector2d o = direction.head<2>() / direction.lpNorm<1>();
  o = direction.z() < 0.0 ? folded(o) : o;
  const auto axis = [](double value) {
    return static_cast<uint32_t>(
        std::clamp(value * kHalfRange + kHalfRange + 0.5, 0.0, 2.0 * kHalfRange));
  };
  return (kind << kClassAt) | (axis(o.x()) << kFirstAt) | axis(o.y());
}

}  // namespace

Eigen::Vector3d surface_direction(uint32_t packed) {
  Eigen::Vector2d o((packed >> kFirstAt) & kAxisMask, packed & kAxisMask);
  o = (o.array() - kHalfRange) / kHalfRange;
  const double z = 1.0 - o.lpNorm<1>();
  o = z < 0.0 ? folded(o) : o;
  return Eigen::Vector3d(o.x(), o.y(), z).normalized();
}

uint32_t turned_surface(const Eigen::Matrix3d& rotation, uint32_t packed) {
  return has_direction(packed) ? pack(rotation * surface_direction(packed), packed >> kClassAt)
                               : packed;
}

bool has_direction(uint32_t packed) {
  return packed >> kClassAt != kIsotropic;
}

bool is_plane(uint32_t packed) {
  return packed >> kClassAt == kPlane || packed >> kClassAt == kGrazing;
}

SubmapBox box_of(const KeyframeSubmap& submap) {
  if (submap.points.empty()) {
    return {};
  }
  SubmapBox box{.lower = submap.points.front().position(),
                .upper = submap.points.front().position()};
  for (const SubmapPoint& point : submap.points) {
    box.lower = box.lower.cwiseMin(point.position());
    box.upper = box.upper.cwiseMax(point.position());
  }
  return box;
}

SurfaceCloud make_surface_cloud(engine::Context& context, const KeyframeSubmap& submap) {
  const auto count = static_cast<std::size_t>(
      std::ranges::count(submap.points, false, &SubmapPoint::seen_through));
  const uint64_t bytes = std::max<uint64_t>(count, 1) * sizeof(gpu::uvec4);
  const engine::Buffer staging =
      context.make_buffer(bytes, engine::Memory::upload, "submap of a keyframe");
  SurfaceCloud cloud{
      .points = context.make_buffer(bytes, engine::Memory::device, "submap of a keyframe"),
      .size = static_cast<uint32_t>(count)};
  const auto bits = [](int32_t place) {
    return std::bit_cast<uint32_t>(static_cast<float>(place / kSubmapSteps));
  };
  auto next = staging.as<gpu::uvec4>().begin();
  for (const SubmapPoint& point : submap.points) {
    if (!point.seen_through) {
      *next++ = {bits(point.place[0]), bits(point.place[1]), bits(point.place[2]), point.surface};
    }
  }
  if (count > 0) {
    engine::Recorder recorder = context.make_recorder();
    recorder.copy(staging, cloud.points);
    context.submit(std::move(recorder)).wait();
  }
  return cloud;
}

}  // namespace adit
