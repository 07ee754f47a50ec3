// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/self_test/self_test_ndt.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/registration.hpp"
#include "adit/engine/kernels/voxel_map.hpp"
#include "adit/engine/self_test/self_test_alignment.hpp"
#include "adit/engine/self_test/self_test_checks.hpp"

namespace adit::engine {
namespace {

constexpr RegistrationSettings kSteps = {
    .translation_epsilon = 1e-4, .rotation_epsilon = 1e-4, .max_iterations = 30};
// The score of NDT for voxels of this size and half outliers (Magnusson 2009): d1, d2.
constexpr float kScoreD1 = -0.704447F;
constexpr float kScoreD2 = 0.756363F;
constexpr FinishSettings kGaussians = {.min_points = 3, .least_ratio = 0.01, .least_sigma = 0.02};

// NDT does not ask for surfaces.
std::vector<gpu::uvec4> without_surfaces(const KnownScene& scene) {
  std::vector<gpu::uvec4> points;
  const auto bits = [](double value) { return std::bit_cast<uint32_t>(static_cast<float>(value)); };
  for (const KnownPoint& point : scene.cloud) {
    const std::array<double, 3>& p = point.centroid;
    points.push_back({bits(p[0]), bits(p[1]), bits(p[2]), 0});
  }
  return points;
}

}  // namespace

std::vector<SelfTestCase> test_ndt(Context& context) {
  const KnownScene scene = make_known_scene();
  const VoxelMapKernels maps(context, VoxelContent::moments);
  const RegistrationKernels ndt(context, {.method = gpu::kNdt});
  const auto make = [&](uint64_t bytes, Memory memory) {
    return context.make_buffer(bytes, memory, "self-test of NDT");
  };
  const auto uploaded = [&](auto values) {
    Buffer buffer = make(values.size() * sizeof(values[0]), Memory::upload);
    std::ranges::copy(std::as_bytes(std::span(values)), buffer.mapped());
    return buffer;
  };
  const auto count = static_cast<uint32_t>(scene.cloud.size());
  const uint32_t groups = ndt.groups(count);
  const Buffer cloud = uploaded(without_surfaces(scene));
  gpu::RegistrationJob scored = known_job(count, groups);
  scored.score_weight = -kScoreD1 * kScoreD2;
  scored.score_exponent = 0.5F * kScoreD2;
  const Buffer job = uploaded(std::array{scored});
  const Buffer first = uploaded(std::array{identity_state()});
  const Buffer start = make(kProgressBytes, Memory::upload);
  RegistrationKernels::write_start({start.mapped(), kProgressBytes}, 1, groups);
  const uint64_t table_bytes = VoxelMapKernels::table_bytes(kSlots);
  const Buffer table = make(table_bytes, Memory::device);
  const Buffer finished = make(table_bytes, Memory::device);
  const Buffer counters = make(sizeof(gpu::VoxelMapCounters), Memory::device);
  const Buffer progress = make(kProgressBytes, Memory::device);
  const Buffer state = make(sizeof(gpu::RegistrationState), Memory::device);
  const Buffer scratch = make(ndt.scratch_bytes(1, groups), Memory::device);
  const Buffer finished_back = make(table_bytes, Memory::readback);
  const Buffer progress_back = make(kProgressBytes, Memory::readback);
  const Buffer state_back = make(sizeof(gpu::RegistrationState), Memory::readback);
  const VoxelMapView map{.table = table, .counters = counters, .voxel_size = kVoxelSize};
  const RegistrationArguments alignment{.count = 1,
                                        .group_stride = groups,
                                        .source = cloud,
                                        .target = finished,
                                        .jobs = job,
                                        .start = start,
                                        .progress = progress,
                                        .states = state};

  Recorder recorder = context.make_recorder();
  recorder.copy(first, state);
  recorder.fill(finished, 0);
  maps.record_clear(recorder, map);
  maps.record_add(recorder, map, cloud, count, known_pose());
  recorder.barrier();
  maps.record_finish(recorder, map, kGaussians, finished);
  ndt.record_steps(recorder, kSteps, alignment, scratch);
  ndt.record_assessment(recorder, kSteps, alignment, scratch);
  recorder.copy(finished, finished_back);
  recorder.copy(progress, progress_back);
  recorder.copy(state, state_back);
  context.submit(std::move(recorder)).wait();

  const auto* header = reinterpret_cast<const gpu::RegistrationHeader*>(progress_back.mapped());
  return {check_finished_map(scene, finished_back.as<gpu::GaussianCell>()),
          check_alignment(scene, "ndt",
                          {state_back.as<gpu::RegistrationState>()[0], *header,
                           *reinterpret_cast<const gpu::RegistrationProgress*>(header + 1)})};
}

}  // namespace adit::engine
