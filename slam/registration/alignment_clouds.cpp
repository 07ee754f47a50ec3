// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/alignment_clouds.hpp"

#include <algorithm>
#include <bit>
#include <string>

#include "adit/engine/context.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {
namespace {

constexpr uint32_t kSmallestTable = 256;

// Magnusson 2009, section 6.2.1, and the floor that keeps the Gaussian of one place invertible.
constexpr engine::FinishSettings kGaussians = {
    .min_points = 6, .least_ratio = 0.01, .least_sigma = 0.01};
constexpr engine::FinishSettings kPlanes = {.min_points = 1};

}  // namespace

RegistrationMethod method_of(const RegistrationConfig& config) {
  return config.method == "ndt" ? RegistrationMethod::ndt : RegistrationMethod::vgicp;
}

engine::VoxelContent content_for(RegistrationMethod method) {
  const bool gaussians =
      method == RegistrationMethod::ndt || method == RegistrationMethod::ndt_to_ndt;
  return gaussians ? engine::VoxelContent::moments : engine::VoxelContent::surfaces;
}

std::optional<engine::FinishSettings> finish_for(RegistrationMethod method) {
  if (method == RegistrationMethod::vgicp) {
    return std::nullopt;
  }
  return content_for(method) == engine::VoxelContent::moments ? kGaussians : kPlanes;
}

std::string_view to_string(RegistrationMethod method) {
  switch (method) {
    case RegistrationMethod::vgicp:
      return "VGICP";
    case RegistrationMethod::ndt:
      return "NDT";
    case RegistrationMethod::point_to_plane:
      return "point to plane";
    case RegistrationMethod::ndt_to_ndt:
      return "NDT to NDT";
  }
  return "unknown";
}

AlignmentClouds::AlignmentClouds(engine::Context& context, const PreprocessConfig& config)
    : context_(&context),
      front_end_(context, config),
      surfaces_(context, engine::VoxelContent::surfaces),
      moments_(context, engine::VoxelContent::moments),
      counters_(context.make_buffer(sizeof(gpu::VoxelMapCounters), engine::Memory::device,
                                    "voxel map counters")),
      counters_readback_(context.make_buffer(
          sizeof(gpu::VoxelMapCounters), engine::Memory::readback, "voxel map counters back")) {}

SurfaceCloud AlignmentClouds::make_cloud(std::span<const Point> points,
                                         const Eigen::Vector3d& viewpoint) {
  Sweep sweep;
  sweep.source = "of the cloud";
  sweep.points.assign(points.begin(), points.end());
  // float32 is exact enough near the origin of its frame only: the sensor's place becomes it.
  for (Point& point : sweep.points) {
    point.x = static_cast<float>(static_cast<double>(point.x) - viewpoint.x());
    point.y = static_cast<float>(static_cast<double>(point.y) - viewpoint.y());
    point.z = static_cast<float>(static_cast<double>(point.z) - viewpoint.z());
  }
  front_end_.measure_beam_spacing(sweep.points);
  front_end_.upload(sweep);
  const engine::Buffer whole =
      context_->make_buffer(std::max<uint64_t>(points.size(), 1) * sizeof(gpu::uvec4),
                            engine::Memory::device, "surface cloud");
  try {
    engine::Recorder recorder = context_->make_recorder();
    front_end_.record(recorder, whole);
    context_->submit(std::move(recorder)).wait();
  } catch (...) {
    front_end_.invalidate();
    throw;
  }
  const gpu::SweepCounters counters = front_end_.read_counters();
  const uint32_t size = counters.cloud_points;
  SurfaceCloud cloud{.points = context_->make_buffer(std::max(size, 1U) * sizeof(gpu::uvec4),
                                                     engine::Memory::device, "surface cloud"),
                     .size = size,
                     .origin = viewpoint,
                     .viewpoint = viewpoint};
  if (size > 0) {
    engine::Recorder recorder = context_->make_recorder();
    recorder.copy(whole.slice(0, cloud.points.size()), cloud.points);
    context_->submit(std::move(recorder)).wait();
  }
  return cloud;
}

AlignmentTarget AlignmentClouds::make_target(const SurfaceCloud& cloud, RegistrationMethod method,
                                             std::span<const double> voxel_sizes) {
  AlignmentTarget target{.method = method,
                         .levels = {},
                         .voxels = 0,
                         .origin = cloud.origin,
                         .viewpoint = cloud.viewpoint};
  for (const double voxel_size : voxel_sizes) {
    target.levels.push_back(make_level(cloud, method, voxel_size, target.voxels));
  }
  return target;
}

// Built twice: first in a table that has room for a voxel a point, then in one of the right size.
AlignmentTarget::Level AlignmentClouds::make_level(const SurfaceCloud& cloud,
                                                   RegistrationMethod method, double voxel_size,
                                                   uint32_t& voxels) {
  const engine::VoxelMapKernels& kernels =
      content_for(method) == engine::VoxelContent::moments ? moments_ : surfaces_;
  const auto table_of = [&](uint32_t slots) {
    return context_->make_buffer(engine::VoxelMapKernels::table_bytes(slots),
                                 engine::Memory::device, "voxel map");
  };
  const uint32_t room = std::bit_ceil(std::max(2 * cloud.size, kSmallestTable));
  gpu::VoxelMapCounters counters{};
  {
    const engine::Buffer roomy = table_of(room);
    counters =
        build(kernels, cloud, {.table = roomy, .counters = counters_, .voxel_size = voxel_size});
  }
  if (counters.failures + counters.out_of_range > 0) {
    throw engine::Error(fmt::format(
        "{} of {} points do not fit into a map of voxels of {:f} m: it reaches {} voxels "
        "from its origin, {} in height; take larger voxels or a smaller cloud",
        counters.failures + counters.out_of_range, cloud.size, voxel_size, gpu::kVoxelsSideways,
        gpu::kVoxelsUpwards));
  }
  if (counters.crowded > 0) {
    throw engine::Error(
        fmt::format("a voxel of {:f} m holds more than {} points of the cloud; take smaller voxels "
                    "or thin the cloud (preprocess.r_input)",
                    voxel_size, gpu::kMostCellPoints));
  }
  voxels = counters.used_slots;
  const uint32_t slots = std::bit_ceil(std::max(2 * voxels, kSmallestTable));
  AlignmentTarget::Level level{.voxel_size = voxel_size, .table = table_of(slots), .slots = slots};
  const engine::VoxelMapView map{
      .table = level.table, .counters = counters_, .voxel_size = voxel_size};
  build(kernels, cloud, map);
  if (const std::optional<engine::FinishSettings> finish = finish_for(method)) {
    engine::Buffer finished = table_of(slots);
    engine::Recorder recorder = context_->make_recorder();
    kernels.record_finish(recorder, map, *finish, finished);
    context_->submit(std::move(recorder)).wait();
    level.table = std::move(finished);
  }
  return level;
}

gpu::VoxelMapCounters AlignmentClouds::build(const engine::VoxelMapKernels& kernels,
                                             const SurfaceCloud& cloud,
                                             const engine::VoxelMapView& map) {
  engine::Recorder recorder = context_->make_recorder();
  kernels.record_clear(recorder, map);
  kernels.record_add(recorder, map, cloud.points, cloud.size,
                     to_device(Eigen::Isometry3d::Identity()));
  recorder.barrier();
  recorder.copy(map.counters, counters_readback_);
  context_->submit(std::move(recorder)).wait();
  return counters_readback_.as<gpu::VoxelMapCounters>()[0];
}

}  // namespace adit
