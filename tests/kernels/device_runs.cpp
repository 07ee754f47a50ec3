// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/kernels/device_runs.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "slam/registration.hpp"
#include "tests/support/transfer.hpp"

namespace adit::test {
namespace {

using engine::Memory;
using engine::Recorder;

constexpr uint64_t kPoseAt = engine::align_slice(sizeof(gpu::RegistrationStart));

template <class Record>
Times submit(engine::Context& context, Record&& record) {
  Recorder recorder = context.make_recorder();
  record(recorder);
  engine::Submission submission = context.submit(std::move(recorder));
  submission.wait();
  return submission.scope_times();
}

template <class T>
uint64_t bytes_for(uint32_t count) {
  return uint64_t{std::max(count, 1U)} * sizeof(T);
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
  submit(context, [&](Recorder& recorder) { preprocess_.record_reset(recorder, scratch_); });
}

Times PreprocessRun::run() {
  return submit(*context_, [&](Recorder& recorder) {
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

DeviceCloud::DeviceCloud(engine::Context& context, const std::vector<gpu::uvec4>& points)
    : size_(static_cast<uint32_t>(points.size())),
      points_(upload(context, points, "surface cloud")),
      counters_(upload(context, std::vector{gpu::SweepCounters{size_, size_, 0, 0}}, "counters")) {}

VoxelMapRun::VoxelMapRun(engine::Context& context, double voxel_size, uint32_t slots)
    : context_(&context),
      kernels_(context),
      voxel_size_(voxel_size),
      table_(context.make_buffer(engine::VoxelMapKernels::table_bytes(slots), Memory::device,
                                 "voxel map")),
      counters_(context.make_buffer(sizeof(gpu::VoxelMapCounters), Memory::device,
                                    "voxel map counters")) {
  clear();
}

void VoxelMapRun::clear() {
  submit(*context_, [&](Recorder& recorder) { kernels_.record_clear(recorder, view()); });
}

Times VoxelMapRun::add(const DeviceCloud& cloud, const Eigen::Isometry3d& T_map_cloud) {
  return submit(*context_, [&](Recorder& recorder) {
    const engine::Scope scope = recorder.scope("add");
    kernels_.record_add(recorder, view(), cloud.points(), cloud.size(), to_device(T_map_cloud));
  });
}

Times VoxelMapRun::remove(const DeviceCloud& cloud, const Eigen::Isometry3d& T_map_cloud) {
  return submit(*context_, [&](Recorder& recorder) {
    const engine::Scope scope = recorder.scope("remove");
    kernels_.record_remove(recorder, view(), cloud.points(), cloud.size(), to_device(T_map_cloud));
  });
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

VgicpRun::VgicpRun(engine::Context& context, const DeviceCloud& source, const VoxelMapRun& target,
                   const engine::VgicpSettings& settings)
    : context_(&context),
      vgicp_(context),
      source_(&source),
      target_(&target),
      settings_(settings),
      upload_(context.make_buffer(kPoseAt + sizeof(gpu::mat3x4), Memory::upload, "start")),
      state_(context.make_buffer(sizeof(gpu::RegistrationState), Memory::device, "state")),
      scratch_(context.make_buffer(vgicp_.scratch_bytes(), Memory::device, "scratch")) {}

Times VgicpRun::align(const Eigen::Isometry3d& start) {
  return run(start, gpu::kPhaseIterate, settings_.max_iterations);
}

Times VgicpRun::evaluate(const Eigen::Isometry3d& pose) {
  return run(pose, gpu::kPhaseEvaluate, 0);
}

Times VgicpRun::run(const Eigen::Isometry3d& pose, uint32_t phase, uint32_t max_iterations) {
  gpu::RegistrationStart& start = upload_.as<gpu::RegistrationStart>()[0];
  start = vgicp_.start();
  start.phase = phase;
  *reinterpret_cast<gpu::mat3x4*>(upload_.mapped() + kPoseAt) = to_device(pose);
  engine::VgicpSettings settings = settings_;
  settings.max_iterations = max_iterations;
  return submit(*context_, [&](Recorder& recorder) {
    recorder.copy(upload_.slice(kPoseAt, sizeof(gpu::mat3x4)),
                  state_.slice(offsetof(gpu::RegistrationState, pose), sizeof(gpu::mat3x4)));
    const engine::Scope scope = recorder.scope("align");
    vgicp_.record(recorder, settings,
                  {.surface_cloud = source_->points(),
                   .counters = source_->counters(),
                   .target = target_->view(),
                   .start = upload_,
                   .state = state_},
                  scratch_);
  });
}

gpu::RegistrationState VgicpRun::state() const {
  return download<gpu::RegistrationState>(*context_, state_).front();
}

double device_ms(const Times& times, std::string_view scope) {
  const auto found = std::find_if(times.begin(), times.end(),
                                  [&](const engine::ScopeTime& t) { return t.name == scope; });
  return found == times.end() ? 0.0 : found->device_ms;
}

}  // namespace adit::test
