// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/self_test/self_test.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/registration.hpp"
#include "adit/engine/kernels/voxel_map.hpp"
#include "adit/engine/self_test/self_test_alignment.hpp"
#include "adit/engine/self_test/self_test_checks.hpp"
#include "adit/engine/self_test/self_test_deskew.hpp"
#include "adit/engine/self_test/self_test_parts.hpp"
#include "adit/engine/self_test/self_test_sweeps.hpp"
#include "adit/shaders/embedded.hpp"
#include "adit/shaders/shared/engine_probe.h"

namespace adit::engine {
namespace {

constexpr RegistrationSettings kAlignment = {.translation_epsilon = 1e-4,
                                             .rotation_epsilon = 1e-4,
                                             .max_iterations = 30,
                                             .robust_width = 1e3};  // far from everything
constexpr uint32_t kProbeItems = 1000;
constexpr uint32_t kProbeScale = 3;
constexpr uint32_t kProbeOffset = 11;
constexpr uint32_t kTexels = 200;

// Slices one after the other; made twice, first to learn the size.
class Layout {
 public:
  Layout() = default;
  explicit Layout(const Slice& whole) : whole_(whole) {}
  Slice take(uint64_t bytes) {
    const Slice slice{whole_.buffer, end_, bytes};
    end_ += align_slice(bytes);
    return slice;
  }
  uint64_t bytes() const { return end_; }

 private:
  Slice whole_;  // without a buffer while only the size is asked for
  uint64_t end_ = 0;
};

struct Inputs {
  Slice raw, times, knots, start, job, state, probe, texels, order, mask;

  Inputs(Layout& layout, const KnownScene& scene)
      : raw(layout.take(scene.raw.size() * sizeof(gpu::vec4))),
        times(layout.take(scene.raw.size() * sizeof(float))),
        knots(layout.take(known_motion().size() * sizeof(gpu::DeskewKnot))),
        start(layout.take(kProgressBytes)),
        job(layout.take(sizeof(gpu::RegistrationJob))),
        state(layout.take(sizeof(gpu::RegistrationState))),
        probe(layout.take(kProbeItems * sizeof(uint32_t))),
        texels(layout.take(kTexels * sizeof(gpu::uvec4))),
        order(layout.take(kTexels * sizeof(uint32_t))),
        mask(layout.take(kTexels * sizeof(gpu::uvec4))) {}
};

// Zero before the run, so that what a kernel leaves out is not what happened to lie there. Buffers
// of points have room for every raw point: a wrong count writes nowhere else.
struct Outputs {
  Slice counters, moved, cloud, surface_cloud, map, map_counters;
  Slice state, progress, probe, texel_probe;

  Outputs(Layout& layout, const KnownScene& scene)
      : counters(layout.take(sizeof(gpu::SweepCounters))),
        moved(layout.take(scene.raw.size() * sizeof(gpu::vec4))),
        cloud(layout.take(scene.raw.size() * sizeof(gpu::vec4))),
        surface_cloud(layout.take(scene.raw.size() * sizeof(gpu::uvec4))),
        map(layout.take(VoxelMapKernels::table_bytes(kSlots))),
        map_counters(layout.take(sizeof(gpu::VoxelMapCounters))),
        state(layout.take(sizeof(gpu::RegistrationState))),
        progress(layout.take(kProgressBytes)),
        probe(layout.take(sizeof(gpu::ProbeSums) + kProbeItems * sizeof(uint32_t))),
        texel_probe(layout.take(sizeof(gpu::ProbeSums) + kTexels * sizeof(gpu::uvec4))) {}
};

template <class Slices>
uint64_t bytes_of(const KnownScene& scene) {
  Layout layout;
  const Slices slices(layout, scene);
  return layout.bytes();
}

template <class T>
void write(Slice slice, const T& values) {
  std::memcpy(slice.mapped(), values.data(), values.size() * sizeof(values[0]));
}

template <class T>
std::span<const T> read(Slice slice) {
  return {reinterpret_cast<const T*>(slice.mapped()), static_cast<size_t>(slice.bytes / sizeof(T))};
}

std::vector<uint32_t> probe_values() {
  std::vector<uint32_t> values(kProbeItems);
  std::iota(values.begin(), values.end(), 5U);
  return values;
}

std::vector<gpu::uvec4> texel_values(uint32_t factor) {
  std::vector<gpu::uvec4> values;
  for (uint32_t i = 0; i < kTexels; ++i) {
    values.push_back({factor * i, factor * i + 1U, factor * i + 2U, factor * i + 3U});
  }
  return values;
}

std::vector<uint32_t> reversed_order() {
  std::vector<uint32_t> order(kTexels);
  std::iota(order.rbegin(), order.rend(), 0U);
  return order;
}

SelfTestCase check_texel_probe(std::span<const uint32_t> output) {
  const std::vector<gpu::uvec4> texels = texel_values(1001);
  const std::vector<gpu::uvec4> mask = texel_values(77);
  const std::vector<uint32_t> order = reversed_order();
  uint32_t wrong = 0;
  for (size_t i = 0; i < kTexels; ++i) {
    const gpu::uvec4& a = texels[order[i]];
    const gpu::uvec4& b = mask[i];
    const std::array expected = {(a.x ^ b.x) + kProbeOffset, (a.y ^ b.y) + kProbeOffset,
                                 (a.z ^ b.z) + kProbeOffset, (a.w ^ b.w) + kProbeOffset};
    wrong += std::equal(expected.begin(), expected.end(),
                        output.begin() + static_cast<std::ptrdiff_t>(2 + 4 * i))
                 ? 0U
                 : 1U;
  }
  return {"engine_texel_probe", wrong == 0 && output[1] == kTexels,
          "expected " + std::to_string(kTexels) + " texels, found " + std::to_string(output[1]) +
              ", of which " + std::to_string(wrong) + " wrong"};
}

FoundAlignment found_alignment(Slice state, Slice progress) {
  const auto* header = reinterpret_cast<const gpu::RegistrationHeader*>(progress.mapped());
  return {*reinterpret_cast<const gpu::RegistrationState*>(state.mapped()), *header,
          *reinterpret_cast<const gpu::RegistrationProgress*>(header + 1)};
}

SelfTestCase check_probe(std::span<const uint32_t> output) {
  uint32_t sum = 0;
  uint32_t wrong = 0;
  for (uint32_t i = 0; i < kProbeItems; ++i) {
    const uint32_t expected = kProbeScale * (i + 5U) + kProbeOffset;
    sum += expected;
    wrong += output[2 + i] == expected ? 0U : 1U;
  }
  return {"engine_probe", wrong == 0 && output[0] == sum && output[1] == kProbeItems,
          "expected a sum of " + std::to_string(sum) + " over " + std::to_string(kProbeItems) +
              " items, found " + std::to_string(output[0]) + " over " + std::to_string(output[1]) +
              "; " + std::to_string(wrong) + " results wrong"};
}

}  // namespace

bool SelfTestReport::passed() const {
  return std::all_of(cases.begin(), cases.end(),
                     [](const SelfTestCase& test) { return test.passed; });
}

std::vector<SelfTestCase> test_sweeps(Context& context) {
  const KnownScene scene = make_known_scene();
  const Preprocess preprocess(context);
  const Deskew deskew(context);
  const VoxelMapKernels voxel_maps(context);
  // As the odometry specialises them: what is compiled here it finds in the driver's cache.
  const RegistrationKernels vgicp(context, {.robust = gpu::kCauchy});
  const Kernel probe(context, "engine_probe", {{0, kDefaultLocalSize}, {1, kProbeScale}});
  const Kernel texel_probe(context, "engine_texel_probe");

  const auto raw_points = static_cast<uint32_t>(scene.raw.size());
  const auto cloud_points = static_cast<uint32_t>(scene.cloud.size());
  const Buffer upload =
      context.make_buffer(bytes_of<Inputs>(scene), Memory::upload, "self-test upload");
  const Buffer input = context.make_buffer(upload.size(), Memory::device, "self-test input");
  const Buffer work =
      context.make_buffer(bytes_of<Outputs>(scene), Memory::device, "self-test output");
  const Buffer results = context.make_buffer(work.size(), Memory::readback, "self-test results");
  const Buffer emptied = context.make_buffer(VoxelMapKernels::table_bytes(kSlots), Memory::readback,
                                             "self-test emptied map");
  const Buffer preprocess_scratch = context.make_buffer(
      preprocess.scratch_bytes(raw_points), Memory::device, "self-test preprocessing scratch");
  const uint32_t groups = vgicp.groups(cloud_points);
  const Buffer alignment_scratch = context.make_buffer(
      vgicp.scratch_bytes(1, groups), Memory::device, "self-test alignment scratch");

  Layout upload_layout(upload);
  const Inputs staged(upload_layout, scene);
  write(staged.raw, scene.raw);
  write(staged.times, known_times(scene));
  write(staged.knots, known_motion());
  RegistrationKernels::write_start({staged.start.mapped(), kProgressBytes}, 1, groups);
  write(staged.job, std::array{known_job(cloud_points, groups)});
  write(staged.state, std::array{identity_state()});
  write(staged.probe, probe_values());
  write(staged.texels, texel_values(1001));
  write(staged.order, reversed_order());
  write(staged.mask, texel_values(77));

  Layout input_layout(input);
  const Inputs in(input_layout, scene);
  Layout work_layout(work);
  const Outputs out(work_layout, scene);
  const VoxelMapView map{.table = out.map, .counters = out.map_counters, .voxel_size = kVoxelSize};
  const gpu::mat3x4 T_map_cloud = known_pose();
  const RegistrationArguments alignment{.count = 1,
                                        .group_stride = groups,
                                        .source = out.surface_cloud,
                                        .target = out.map,
                                        .jobs = in.job,
                                        .start = in.start,
                                        .progress = out.progress,
                                        .states = out.state};

  Recorder recorder = context.make_recorder();
  recorder.copy(upload, input);
  recorder.fill(work, 0);
  recorder.barrier();
  recorder.copy(in.state, out.state);
  recorder.dispatch(probe, 4, gpu::ProbePush{kProbeItems, kProbeOffset}, {in.probe, out.probe});
  recorder.dispatch(texel_probe, 4, gpu::TexelProbePush{kTexels, kProbeOffset},
                    {in.order, in.texels, in.mask, out.texel_probe});
  deskew.record(recorder, known_motion_settings(scene),
                {.point_count = raw_points,
                 .knot_count = static_cast<uint32_t>(known_motion().size()),
                 .raw = in.raw,
                 .times = in.times,
                 .knots = in.knots,
                 .moved = out.moved});
  preprocess.record_reset(recorder, preprocess_scratch);
  preprocess.record(recorder, scene.settings,
                    {.point_count = raw_points,
                     .capacity = raw_points,
                     .raw = in.raw,
                     .cloud = out.cloud,
                     .surface_cloud = out.surface_cloud,
                     .counters = out.counters},
                    preprocess_scratch);
  recorder.barrier();
  voxel_maps.record_clear(recorder, map);
  voxel_maps.record_add(recorder, map, out.surface_cloud, cloud_points, T_map_cloud);
  vgicp.record_steps(recorder, kAlignment, alignment, alignment_scratch);
  vgicp.record_assessment(recorder, kAlignment, alignment, alignment_scratch);
  recorder.copy(work, results);
  recorder.barrier();
  voxel_maps.record_remove(recorder, map, out.surface_cloud, cloud_points, T_map_cloud);
  recorder.barrier();
  recorder.copy(out.map, emptied);
  context.submit(std::move(recorder)).wait();

  Layout result_layout(results);
  const Outputs found(result_layout, scene);
  const gpu::SweepCounters counters = read<gpu::SweepCounters>(found.counters)[0];
  return {check_probe(read<uint32_t>(found.probe)),
          check_texel_probe(read<uint32_t>(found.texel_probe)),
          check_deskew(scene, read<gpu::vec4>(found.moved)),
          check_insert(scene, counters),
          check_count(scene, counters),
          check_emit(scene, read<gpu::vec4>(found.cloud)),
          check_normals(scene, read<gpu::uvec4>(found.surface_cloud), counters),
          check_voxel_map(scene, {.cells = read<gpu::GaussianCell>(found.map),
                                  .emptied = read<gpu::GaussianCell>(emptied),
                                  .counters = read<gpu::VoxelMapCounters>(found.map_counters)[0],
                                  .voxel_size = kVoxelSize}),
          check_alignment(scene, "vgicp", found_alignment(found.state, found.progress)),
          check_directions(found_alignment(found.state, found.progress))};
}

// FNV-1a, of names and words.
std::string kernels_identity() {
  uint64_t hash = 0xcbf29ce484222325U;
  const auto add = [&](std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) {
      hash = (hash ^ static_cast<uint64_t>(byte)) * 0x100000001b3U;
    }
  };
  for (const std::string_view name : shaders::names()) {
    add(std::as_bytes(std::span(name)));
    add(std::as_bytes(shaders::find(name)));
  }
  return fmt::format("{:016x}", hash);
}

SelfTestReport run_self_test(Context& context) {
  SelfTestReport report;
  for (const SelfTestPart part : kSelfTestParts) {
    for (SelfTestCase& one : part(context)) {
      report.cases.push_back(std::move(one));
    }
  }
  return report;
}

}  // namespace adit::engine
