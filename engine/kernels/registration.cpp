// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/kernels/registration.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <vector>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/texels.hpp"

namespace adit::engine {
namespace {

// Eigenvalues of the regularised covariances are (epsilon, 1, 1): Koide et al. and all its
// descendants.
constexpr float kPlaneEpsilon = 1e-3F;
// Points a group takes at least before another one is worth its price, where the shape says none.
constexpr uint32_t kPointsOfAGroup = 512;

std::vector<Specialization> constants(const RegistrationOptions& options, const LaunchShape& shape,
                                      bool texels) {
  return {
      {0, shape.local_size}, {2, texels ? 1U : 0U}, {3, options.method}, {8, shape.least_items}};
}

std::vector<Specialization> constants(const RegistrationOptions& options, const LaunchShape& shape,
                                      bool texels, uint32_t sums) {
  std::vector<Specialization> all = constants(options, shape, texels);
  all.insert(all.end(), {{4, options.neighbours},
                         {5, options.robust},
                         {6, options.drop_back_faces ? 1U : 0U},
                         {7, sums}});
  return all;
}

// Both covariances of a match are at most the identity, so that the inverse of their sum is at
// least half of it, whatever the surfaces are.
float fictitious_information(uint32_t method) {
  return method == gpu::kVgicp ? 0.5F : 0.0F;
}

}  // namespace

RegistrationKernels::RegistrationKernels(Context& context, const RegistrationOptions& options)
    : options_(options),
      shape_(reduction_shape(context.device(), options.many)),
      texels_(reads_texels(context.device())),
      linearize_(context, "registration_linearize",
                 constants(options, shape_, texels_, gpu::kSystemSize)),
      assess_(context, "registration_linearize",
              constants(options, shape_, texels_, gpu::kGeometrySize)),
      localize_(context, "registration_localize", constants(options, shape_, texels_)) {}

uint32_t RegistrationKernels::groups(uint32_t points) const {
  const uint32_t each = shape_.least_items > 1 ? shape_.least_items : kPointsOfAGroup;
  const uint32_t wanted = points / each;
  const uint32_t usual = std::clamp(std::bit_ceil(std::max(wanted, 1U)), 2U, shape_.groups);
  // A point, and each voxel it looks at: the look-up's loops, the sums' and the directions'.
  const uint32_t rounds = 10 + 4 * options_.neighbours;
  return std::max(usual, std::bit_ceil(least_groups(points, rounds, shape_.local_size)));
}

uint64_t RegistrationKernels::progress_bytes(uint32_t count) {
  return sizeof(gpu::RegistrationHeader) + uint64_t{count} * sizeof(gpu::RegistrationProgress);
}

uint64_t RegistrationKernels::scratch_bytes(uint32_t count, uint32_t group_stride) const {
  return align_slice(uint64_t{count} * group_stride * gpu::kSystemStride * sizeof(float));
}

void RegistrationKernels::write_start(std::span<std::byte> bytes, uint32_t count,
                                      uint32_t group_stride, uint32_t phase) {
  const uint32_t steps = phase == gpu::kPhaseIterate ? group_stride : 0;
  const bool with_prior = phase == gpu::kPhaseConstrained;
  const uint32_t constrained = with_prior ? group_stride : 0;
  const gpu::RegistrationHeader header{
      .iterate = {steps, count, 1, with_prior ? 0 : count},
      .assess = {group_stride, count, 1, count},
      .constrained = {constrained, count, 1, with_prior ? count : 0},
      .reassess = {constrained, count, 1, 0}};
  std::memcpy(bytes.data(), &header, sizeof(header));
  const gpu::RegistrationProgress progress{.phase = phase,
                                           .iterations = 0,
                                           .converged = phase == gpu::kPhaseAssess ? 1U : 0U,
                                           .failed = 0,
                                           .ticket = 0,
                                           .factor = 1.0F,
                                           .most_factor = gpu::kLongest,
                                           .last_step = {}};
  for (uint32_t i = 0; i < count; ++i) {
    std::memcpy(bytes.data() + sizeof(header) + i * sizeof(progress), &progress, sizeof(progress));
  }
}

uint32_t RegistrationKernels::passes(Stage stage, const RegistrationSettings& settings) const {
  const bool surfaces = options_.method != gpu::kNdtToNdt;  // Gaussians have no normals to agree
  switch (stage) {
    case Stage::iterate:
      return settings.max_iterations;
    case Stage::geometry:
      return surfaces ? 2 : 1;
    case Stage::constrain:
      return surfaces ? settings.max_constrained : 0;
    case Stage::geometry_again:
      return surfaces && settings.max_constrained > 0 ? 2 : 0;
  }
  return 0;
}

uint64_t RegistrationKernels::remaining_at(Stage stage) {
  constexpr uint64_t kRemaining = offsetof(gpu::RegistrationPass, remaining);
  switch (stage) {
    case Stage::iterate:
      return offsetof(gpu::RegistrationHeader, iterate) + kRemaining;
    case Stage::geometry:
      return offsetof(gpu::RegistrationHeader, assess) + kRemaining;
    case Stage::constrain:
      return offsetof(gpu::RegistrationHeader, constrained) + kRemaining;
    case Stage::geometry_again:
      return offsetof(gpu::RegistrationHeader, reassess) + kRemaining;
  }
  return 0;
}

void RegistrationKernels::record_start(Recorder& recorder, const RegistrationArguments& arguments) {
  recorder.barrier();
  recorder.copy(arguments.start, arguments.progress);
  recorder.barrier();
}

void RegistrationKernels::record(Recorder& recorder, Stage stage, uint32_t first, uint32_t count,
                                 const RegistrationSettings& settings,
                                 const RegistrationArguments& arguments, Slice scratch) const {
  RegistrationSettings limits = settings;
  if (stage != Stage::iterate) {
    limits.max_iterations = settings.max_constrained;
  }
  for (uint32_t i = first; i < first + count; ++i) {
    const auto pass = [&](const Kernel& kernel, uint32_t phase, uint64_t pass_at) {
      record_pass(recorder, kernel, phase, pass_at, limits, arguments, scratch);
    };
    switch (stage) {
      case Stage::iterate:
        pass(linearize_, gpu::kPhaseIterate, offsetof(gpu::RegistrationHeader, iterate));
        break;
      case Stage::geometry:
        pass(i == 0 ? assess_ : localize_, i == 0 ? gpu::kPhaseAssess : gpu::kPhaseLocalize,
             offsetof(gpu::RegistrationHeader, assess));
        break;
      case Stage::constrain:
        pass(assess_, gpu::kPhaseConstrained, offsetof(gpu::RegistrationHeader, constrained));
        break;
      case Stage::geometry_again:
        pass(i == 0 ? assess_ : localize_, i == 0 ? gpu::kPhaseReassess : gpu::kPhaseRelocalize,
             offsetof(gpu::RegistrationHeader, reassess));
        break;
    }
  }
}

void RegistrationKernels::record_steps(Recorder& recorder, const RegistrationSettings& settings,
                                       const RegistrationArguments& arguments,
                                       Slice scratch) const {
  record_start(recorder, arguments);
  record(recorder, Stage::iterate, 0, passes(Stage::iterate, settings), settings, arguments,
         scratch);
}

void RegistrationKernels::record_assessment(Recorder& recorder,
                                            const RegistrationSettings& settings,
                                            const RegistrationArguments& arguments,
                                            Slice scratch) const {
  for (const Stage stage : {Stage::geometry, Stage::constrain, Stage::geometry_again}) {
    record(recorder, stage, 0, passes(stage, settings), settings, arguments, scratch);
  }
}

void RegistrationKernels::record_pass(Recorder& recorder, const Kernel& kernel, uint32_t phase,
                                      uint64_t pass_at, const RegistrationSettings& settings,
                                      const RegistrationArguments& arguments, Slice scratch) const {
  const gpu::RegistrationPush push{
      .epsilon = kPlaneEpsilon,
      .fictitious = fictitious_information(options_.method),
      .robust_width = static_cast<float>(settings.robust_width),
      .translation_epsilon = static_cast<float>(settings.translation_epsilon),
      .rotation_epsilon = static_cast<float>(settings.rotation_epsilon),
      .max_iterations = settings.max_iterations,
      .group_stride = arguments.group_stride,
      .weak_share = static_cast<float>(settings.weak_share),
      .serves = phase};
  recorder.dispatch_indirect(
      kernel, arguments.progress.sub(pass_at, sizeof(gpu::RegistrationPass)), push,
      {arguments.source, arguments.target, arguments.jobs, arguments.progress, arguments.states,
       scratch, texel_slice(arguments.source, texels_), texel_slice(arguments.target, texels_)});
  recorder.barrier();
}

}  // namespace adit::engine
