// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/verify/device_runs.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>

#include "adit/benchmarks/verify/transfer.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit::test {
namespace {

using engine::Memory;
using engine::Recorder;

constexpr float kNotWritten = std::numeric_limits<float>::quiet_NaN();

// In the upload of an alignment: its job, its start, its initial state.
constexpr uint64_t kStartAt = engine::align_slice(sizeof(gpu::RegistrationJob));
constexpr uint64_t kProgressBytes =
    sizeof(gpu::RegistrationHeader) + sizeof(gpu::RegistrationProgress);
constexpr uint64_t kStateAt = kStartAt + engine::align_slice(kProgressBytes);

template <class T>
uint64_t bytes_for(uint32_t count) {
  return uint64_t{std::max(count, 1U)} * sizeof(T);
}

/// All clouds in one buffer.
std::vector<Point> joined(std::span<const reference::CloudToMerge> clouds) {
  std::vector<Point> points;
  for (const reference::CloudToMerge& cloud : clouds) {
    points.insert(points.end(), cloud.points.begin(), cloud.points.end());
  }
  return points;
}

std::vector<gpu::vec4> as_device(const std::vector<Eigen::Vector3f>& places) {
  std::vector<gpu::vec4> result;
  for (const Eigen::Vector3f& place : places) {
    result.push_back({place.x(), place.y(), place.z(), 0.0F});
  }
  return result;
}

}  // namespace

PreprocessRun::PreprocessRun(engine::Context& context, const engine::PreprocessSettings& settings,
                             const std::vector<Point>& raw)
    : context_(&context),
      preprocess_(context),
      settings_(settings),
      count_(static_cast<uint32_t>(raw.size())),
      raw_(upload(context, raw, "raw points")),
      cloud_(context.make_buffer(bytes_for<Point>(count_), Memory::device, "cloud")),
      surface_cloud_(
          context.make_buffer(bytes_for<gpu::uvec4>(count_), Memory::device, "surface cloud")),
      counters_(context.make_buffer(sizeof(gpu::SweepCounters), Memory::device, "counters")),
      scratch_(context.make_buffer(preprocess_.scratch_bytes(count_), Memory::device, "scratch")) {
  run_and_wait(context, [&](Recorder& recorder) { preprocess_.record_reset(recorder, scratch_); });
}

Times PreprocessRun::run() {
  return run_and_wait(*context_, [&](Recorder& recorder) {
    const engine::Scope scope = recorder.scope("preprocess");
    preprocess_.record(recorder, settings_,
                       {.point_count = count_,
                        .capacity = count_,
                        .raw = raw_,
                        .cloud = cloud_,
                        .surface_cloud = surface_cloud_,
                        .counters = counters_},
                       scratch_);
  });
}

gpu::SweepCounters PreprocessRun::counters() const {
  return download<gpu::SweepCounters>(*context_, counters_).front();
}

std::vector<Point> PreprocessRun::cloud() const {
  const uint32_t count = std::min(counters().cloud_points, count_);
  return download<Point>(*context_, cloud_.slice(0, count * sizeof(Point)));
}

std::vector<gpu::uvec4> PreprocessRun::surface_cloud() const {
  const uint32_t count = std::min(counters().cloud_points, count_);
  return download<gpu::uvec4>(*context_, surface_cloud_.slice(0, count * sizeof(gpu::uvec4)));
}

DeskewRun::DeskewRun(engine::Context& context, const engine::DeskewSettings& settings,
                     const std::vector<Point>& raw, const std::vector<float>& times,
                     const SweepMotion& motion)
    : context_(&context),
      deskew_(context),
      settings_(settings),
      count_(static_cast<uint32_t>(raw.size())),
      knots_count_(static_cast<uint32_t>(motion.T_start_lidar.size())),
      raw_(upload(context, raw, "raw points")),
      times_(upload(context, times, "times of points")),
      knots_(upload(context, knots(motion), "knots")),
      moved_(upload(
          context,
          std::vector<Point>(raw.size(), {kNotWritten, kNotWritten, kNotWritten, kNotWritten}),
          "moved")) {}

Times DeskewRun::run() {
  return run_and_wait(*context_, [&](Recorder& recorder) {
    const engine::Scope scope = recorder.scope("deskew");
    deskew_.record(recorder, settings_,
                   {.point_count = count_,
                    .knot_count = knots_count_,
                    .raw = raw_,
                    .times = times_,
                    .knots = knots_,
                    .moved = moved_});
  });
}

std::vector<Point> DeskewRun::moved() const {
  std::vector<Point> result = download<Point>(*context_, moved_);
  result.resize(count_);
  return result;
}

SubmapMergeRun::SubmapMergeRun(engine::Context& context,
                               std::span<const reference::CloudToMerge> clouds, double edge,
                               uint32_t slots)
    : context_(&context),
      kernels_(context),
      edge_(edge),
      points_(upload(context, joined(clouds), "clouds")),
      table_(context.make_buffer(engine::SubmapMerge::table_bytes(slots), Memory::device, "cells")),
      counters_(context.make_buffer(sizeof(gpu::MergeCounters), Memory::device, "counters")) {
  uint32_t begin = 0;
  for (const reference::CloudToMerge& cloud : clouds) {
    const auto count = static_cast<uint32_t>(cloud.points.size());
    clouds_.push_back({.points = points_,
                       .begin = begin,
                       .count = count,
                       .sweep = static_cast<uint32_t>(clouds_.size()),
                       .T_submap_lidar = to_device(cloud.T_submap_lidar)});
    begin += count;
  }
}

engine::MergeView SubmapMergeRun::view() const {
  return {.table = table_, .counters = counters_, .voxel_size = edge_};
}

Times SubmapMergeRun::run() {
  run_and_wait(*context_, [&](Recorder& recorder) { kernels_.record_clear(recorder, view()); });
  return run_and_wait(*context_, [&](Recorder& recorder) {
    const engine::Scope scope = recorder.scope("merge");
    for (engine::MergeCloud cloud : clouds_) {
      cloud.points = points_;
      kernels_.record_add(recorder, view(), cloud);
    }
  });
}

std::vector<gpu::MergeCell> SubmapMergeRun::cells() const {
  return download<gpu::MergeCell>(*context_, table_);
}

gpu::MergeCounters SubmapMergeRun::counters() const {
  return download<gpu::MergeCounters>(*context_, counters_).front();
}

SubmapSurfacesRun::SubmapSurfacesRun(engine::Context& context,
                                     const engine::PreprocessSettings& settings,
                                     const std::vector<gpu::uvec4>& points,
                                     const std::vector<Eigen::Vector3f>& sensors)
    : context_(&context),
      kernels_(context),
      settings_(settings),
      count_(static_cast<uint32_t>(points.size())),
      points_(upload(context, points, "merged points")),
      sensors_(upload(context, as_device(sensors), "sensors")),
      surface_cloud_(
          context.make_buffer(bytes_for<gpu::uvec4>(count_), Memory::device, "surface cloud")),
      scratch_(context.make_buffer(engine::SubmapMerge::surface_scratch_bytes(count_),
                                   Memory::device, "scratch")) {}

Times SubmapSurfacesRun::run() {
  return run_and_wait(*context_, [&](Recorder& recorder) {
    kernels_.record_surfaces(
        recorder, settings_,
        {.count = count_, .points = points_, .sensors = sensors_, .surface_cloud = surface_cloud_},
        scratch_);
  });
}

std::vector<gpu::uvec4> SubmapSurfacesRun::surface_cloud() const {
  return download<gpu::uvec4>(*context_, surface_cloud_.slice(0, count_ * sizeof(gpu::uvec4)));
}

DeviceCloud::DeviceCloud(engine::Context& context, const std::vector<gpu::uvec4>& points)
    : size_(static_cast<uint32_t>(points.size())),
      points_(upload(context, points, "surface cloud")),
      counters_(upload(context, std::vector{gpu::SweepCounters{size_, size_, 0, 0}}, "counters")) {}

VoxelMapRun::VoxelMapRun(engine::Context& context, double voxel_size, uint32_t slots,
                         engine::VoxelContent content)
    : context_(&context),
      kernels_(context, content),
      voxel_size_(voxel_size),
      table_(context.make_buffer(engine::VoxelMapKernels::table_bytes(slots), Memory::device,
                                 "voxel map")),
      counters_(context.make_buffer(sizeof(gpu::VoxelMapCounters), Memory::device,
                                    "voxel map counters")) {
  clear();
}

void VoxelMapRun::clear() {
  run_and_wait(*context_, [&](Recorder& recorder) { kernels_.record_clear(recorder, view()); });
}

Times VoxelMapRun::add(const DeviceCloud& cloud, const Eigen::Isometry3d& T_map_cloud) {
  return run_and_wait(*context_, [&](Recorder& recorder) {
    const engine::Scope scope = recorder.scope("add");
    kernels_.record_add(recorder, view(), cloud.points(), cloud.size(), to_device(T_map_cloud));
  });
}

Times VoxelMapRun::remove(const DeviceCloud& cloud, const Eigen::Isometry3d& T_map_cloud) {
  return run_and_wait(*context_, [&](Recorder& recorder) {
    const engine::Scope scope = recorder.scope("remove");
    kernels_.record_remove(recorder, view(), cloud.points(), cloud.size(), to_device(T_map_cloud));
  });
}

Times VoxelMapRun::finish(const engine::FinishSettings& settings) {
  finished_ = context_->make_buffer(table_.size(), Memory::device, "finished map");
  return run_and_wait(*context_, [&](Recorder& recorder) {
    const engine::Scope scope = recorder.scope("finish");
    kernels_.record_finish(recorder, view(), settings, *finished_);
  });
}

std::vector<gpu::GaussianCell> VoxelMapRun::target_cells() const {
  return download<gpu::GaussianCell>(*context_, target());
}

engine::VoxelMapView VoxelMapRun::view() const {
  return {.table = table_, .counters = counters_, .voxel_size = voxel_size_};
}

std::vector<gpu::GaussianCell> VoxelMapRun::cells() const {
  return download<gpu::GaussianCell>(*context_, table_);
}

gpu::VoxelMapCounters VoxelMapRun::counters() const {
  return download<gpu::VoxelMapCounters>(*context_, counters_).front();
}

AlignmentRun::AlignmentRun(engine::Context& context, const engine::RegistrationKernels& kernels,
                           const DeviceCloud& source, const VoxelMapRun& target,
                           const reference::AlignmentSettings& settings,
                           const AlignmentOptions& options)
    : context_(&context),
      kernels_(&kernels),
      source_(&source),
      target_(&target),
      settings_(settings),
      options_(options),
      upload_(
          context.make_buffer(kStateAt + sizeof(gpu::RegistrationState), Memory::upload, "start")),
      progress_(context.make_buffer(kProgressBytes, Memory::device, "progress")),
      state_(context.make_buffer(sizeof(gpu::RegistrationState), Memory::device, "state")),
      scratch_(context.make_buffer(kernels_->scratch_bytes(1, kernels_->groups(source.size())),
                                   Memory::device, "scratch")) {}

Times AlignmentRun::align(const Eigen::Isometry3d& start) {
  return run(start, settings_.max_iterations, true);
}

Times AlignmentRun::evaluate(const Eigen::Isometry3d& pose) {
  return run(pose, 0, true);
}

Times AlignmentRun::step(const Eigen::Isometry3d& pose, uint32_t steps) {
  return run(pose, steps, false);
}

Times AlignmentRun::run(const Eigen::Isometry3d& pose, uint32_t max_iterations, bool assess) {
  const engine::VoxelMapView target = target_->view();
  // Gaussians are three uvec4 each.
  const uint32_t items =
      kernels_->options().method == gpu::kNdtToNdt ? source_->size() / 3 : source_->size();
  const uint32_t groups = kernels_->groups(items);
  gpu::RegistrationJob& job = upload_.as<gpu::RegistrationJob>()[0];
  job = {};
  job.source_count = items;
  job.table_mask = target.slots() - 1;
  job.groups = groups;
  job.cell = static_cast<float>(target.voxel_size);
  job.inverse_cell = static_cast<float>(1.0 / target.voxel_size);
  job.max_squared = static_cast<float>(settings_.d_max * settings_.d_max);
  job.score_weight = static_cast<float>(options_.score_weight);
  job.score_exponent = static_cast<float>(options_.score_exponent);
  const Eigen::Vector3f viewpoint = options_.viewpoint.cast<float>();
  job.viewpoint = {viewpoint.x(), viewpoint.y(), viewpoint.z()};
  engine::RegistrationKernels::write_start(
      {upload_.mapped() + kStartAt, kProgressBytes}, 1, groups,
      max_iterations > 0 ? gpu::kPhaseIterate : gpu::kPhaseAssess);
  *reinterpret_cast<gpu::RegistrationState*>(upload_.mapped() + kStateAt) =
      initial_state(pose, options_.prior_information);
  const engine::RegistrationSettings settings{.translation_epsilon = settings_.translation_epsilon,
                                              .rotation_epsilon = settings_.rotation_epsilon,
                                              .max_iterations = max_iterations,
                                              .max_constrained = options_.max_constrained,
                                              .robust_width = options_.robust_width};
  const engine::RegistrationArguments arguments{
      .count = 1,
      .group_stride = groups,
      .source = source_->points(),
      .target = target_->target(),
      .jobs = upload_.slice(0, sizeof(gpu::RegistrationJob)),
      .start = upload_.slice(kStartAt, kProgressBytes),
      .progress = progress_,
      .states = state_};
  return run_and_wait(*context_, [&](Recorder& recorder) {
    recorder.copy(upload_.slice(kStateAt, sizeof(gpu::RegistrationState)), state_);
    const engine::Scope scope = recorder.scope("align");
    kernels_->record_steps(recorder, settings, arguments, scratch_);
    if (assess) {
      kernels_->record_assessment(recorder, settings, arguments, scratch_);
    }
  });
}

DeviceOutcome AlignmentRun::state() const {
  const std::vector<std::byte> progress = download<std::byte>(*context_, progress_);
  DeviceOutcome outcome{};
  static_cast<gpu::RegistrationState&>(outcome) =
      download<gpu::RegistrationState>(*context_, state_).front();
  std::memcpy(&outcome.header, progress.data(), sizeof(outcome.header));
  std::memcpy(static_cast<gpu::RegistrationProgress*>(&outcome),
              progress.data() + sizeof(outcome.header), sizeof(gpu::RegistrationProgress));
  return outcome;
}

double device_ms(const Times& times, std::string_view scope) {
  const auto found =
      std::ranges::find(times.scopes, scope, [](const engine::ScopeTime& t) { return t.name; });
  return found == times.scopes.end() ? 0.0 : found->device_ms;
}

}  // namespace adit::test
