// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a device can do at most, measured: to say how far a kernel is from it.
#pragma once

#include <string>

#include "adit/benchmarks/kernels/work.hpp"
#include "adit/engine/context.hpp"

namespace adit::bench {

struct DeviceLimits {
  double copy_bytes = 0.0;    ///< read and written, each counted, bytes/s, from and to memory
  double flop = 0.0;          ///< multiply-adds of float32, 2 each, 1/s
  double reads = 0.0;         ///< reads of 64 bytes at random places of 64 MiB, 1/s
  double near_reads = 0.0;    ///< the same of 1 MiB: what caches give
  double atomics = 0.0;       ///< integer additions at random places of 1 MiB, 1/s
  double dispatch_s = 0.0;    ///< a further dispatch after a barrier, with nothing to do
  double submission_s = 0.0;  ///< an empty submission and the wait for it, host's clock
};

/// The best of several runs each: what disturbs a machine only makes it slower. Takes about ten
/// times `seconds`. The context must profile.
DeviceLimits measure_limits(engine::Context& context, double seconds);

/// Of each limit the better one.
DeviceLimits best_of(const DeviceLimits& a, const DeviceLimits& b);

/// How far limits that were measured twice lie apart.
struct LimitsMoved {
  double ratio = 1.0;   ///< the larger over the smaller one, of the limit that moved most
  std::string which{};  ///< "memory", "arithmetic", "reads" or "atomics"
};
LimitsMoved moved(const DeviceLimits& before, const DeviceLimits& after);

/// Beyond this ratio shares of a limit say nothing: the machine did something else, too.
inline constexpr double kMostMoved = 1.25;

/// The least time for a cost by these limits, if everything that can overlap does, and which limit
/// gives it.
struct Bound {
  double ms = 0.0;
  std::string by{};  ///< "memory", "arithmetic", "reads", "atomics" or "dispatches"
};
Bound bound_of(const Cost& cost, const DeviceLimits& limits);

}  // namespace adit::bench
