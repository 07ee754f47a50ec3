// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/kernels/limits.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <utility>

#include "adit/benchmarks/kernels/timing.hpp"
#include "adit/engine/kernels/limit_probes.hpp"

namespace adit::bench {
namespace {

using engine::Buffer;
using engine::Memory;
using engine::Recorder;

constexpr uint64_t kFar = uint64_t{64} << 20U;
constexpr uint64_t kNear = uint64_t{1} << 20U;
constexpr int kDispatches = 100;

struct Seconds {
  double device = 0.0;
  double host = 0.0;
};

// The fastest tenth of submissions that are recorded anew each time.
Seconds time(engine::Context& context, double seconds,
             const std::function<void(Recorder&)>& record) {
  using Clock = std::chrono::steady_clock;
  const Work work{.run = [&] {
    Recorder recorder = context.make_recorder();
    {
      const engine::Scope scope = recorder.scope("probe");
      record(recorder);
    }
    const Clock::time_point begin = Clock::now();
    engine::Submission submission = context.submit(std::move(recorder));
    submission.wait();
    const double host = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    return Sample{
        .device_ms = submission.scope_times().front().device_ms, .wait_ms = host, .host_ms = host};
  }};
  const Timing timing = measure(work, {.seconds = seconds, .least_runs = 5, .most_runs = 200});
  return {1e-3 * timing.device->low, 1e-3 * timing.wait->low};
}

Buffer filled(engine::Context& context, uint64_t bytes, std::string_view name) {
  Buffer buffer = context.make_buffer(bytes, Memory::device, name);
  Recorder recorder = context.make_recorder();
  recorder.fill(buffer, 0x3f800000U);
  context.submit(std::move(recorder)).wait();
  return buffer;
}

}  // namespace

DeviceLimits measure_limits(engine::Context& context, double seconds) {
  const engine::LimitProbes probes(context);
  const Buffer far = filled(context, kFar, "far records");
  const Buffer near = filled(context, kNear, "near records");
  const Buffer results =
      filled(context, probes.threads() * sizeof(gpu::uvec4), "results of probes");
  // Enough work that the launch does not count, whatever the device.
  const bool software = context.device().software;
  const uint32_t rounds = software ? 1000 : 4000;
  const uint32_t accesses = software ? 1U << 19U : 1U << 24U;

  DeviceLimits limits;
  const Seconds copied = time(context, seconds, [&](Recorder& recorder) {
    probes.record_copy(recorder, far.slice(0, kFar / 2), far.slice(kFar / 2, kFar / 2));
  });
  limits.copy_bytes = static_cast<double>(kFar) / copied.device;
  const Seconds multiplied = time(context, seconds, [&](Recorder& recorder) {
    probes.record_multiply_add(recorder, {rounds, 0.999F, 0.001F}, results);
  });
  limits.flop = probes.flop(rounds) / multiplied.device;
  const auto reads = [&](const Buffer& table) {
    return accesses / time(context, seconds, [&](Recorder& recorder) {
                        probes.record_gather(recorder, accesses, table, results);
                      }).device;
  };
  limits.reads = reads(far);
  limits.near_reads = reads(near);
  limits.atomics = accesses / time(context, seconds, [&](Recorder& recorder) {
                                probes.record_atomics(recorder, accesses, near);
                              }).device;
  // Multiply-adds of no rounds: what a hundred cost beyond one, each.
  const auto dispatches = [&](int count) {
    const gpu::LimitMultiplyAddPush nothing{0, 0.0F, 0.0F};
    return time(context, seconds, [&, count](Recorder& recorder) {
      for (int i = 0; i < count; ++i) {
        recorder.barrier();
        probes.record_multiply_add(recorder, nothing, results);
      }
    });
  };
  limits.dispatch_s = (dispatches(kDispatches + 1).device - dispatches(1).device) / kDispatches;
  limits.submission_s = time(context, seconds, [](Recorder&) {}).host;
  return limits;
}

DeviceLimits best_of(const DeviceLimits& a, const DeviceLimits& b) {
  return {.copy_bytes = std::max(a.copy_bytes, b.copy_bytes),
          .flop = std::max(a.flop, b.flop),
          .reads = std::max(a.reads, b.reads),
          .near_reads = std::max(a.near_reads, b.near_reads),
          .atomics = std::max(a.atomics, b.atomics),
          .dispatch_s = std::min(a.dispatch_s, b.dispatch_s),
          .submission_s = std::min(a.submission_s, b.submission_s)};
}

LimitsMoved moved(const DeviceLimits& before, const DeviceLimits& after) {
  const auto ratio = [](double a, double b) { return std::max(a, b) / std::min(a, b); };
  const std::array<LimitsMoved, 4> all = {{{ratio(before.copy_bytes, after.copy_bytes), "memory"},
                                           {ratio(before.flop, after.flop), "arithmetic"},
                                           {ratio(before.near_reads, after.near_reads), "reads"},
                                           {ratio(before.atomics, after.atomics), "atomics"}}};
  return *std::ranges::max_element(all, {}, &LimitsMoved::ratio);
}

Bound bound_of(const Cost& cost, const DeviceLimits& limits) {
  const std::array<Bound, 5> bounds = {{{1e3 * cost.bytes / limits.copy_bytes, "memory"},
                                        {1e3 * cost.flop / limits.flop, "arithmetic"},
                                        {1e3 * cost.reads / limits.near_reads, "reads"},
                                        {1e3 * cost.atomics / limits.atomics, "atomics"},
                                        {1e3 * cost.dispatches * limits.dispatch_s, "dispatches"}}};
  return *std::ranges::max_element(bounds, {}, &Bound::ms);
}

}  // namespace adit::bench
