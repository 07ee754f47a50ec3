// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/benchmarks/kernels/report.hpp"

namespace adit::test {

/// Two sizes of a kernel with a peer, one that was wrong, and a batch.
inline bench::Report small_report() {
  const auto timing = [](double ms) {
    return bench::Timing{.runs = 9,
                         .device = bench::Spread{0.9 * ms, ms, 1.1 * ms},
                         .wait = bench::Spread{ms, 1.2 * ms, 1.3 * ms},
                         .host = {ms, 1.3 * ms, 1.4 * ms}};
  };
  bench::Report report;
  report.setting = {.version = "1.2.3",
                    .commit = "abc",
                    .date = "2026-01-02T03:04:05Z",
                    .device = "a <device>",
                    .driver = "driver",
                    .driver_version = "7",
                    .vulkan = "1.3.0",
                    .software = true,
                    .host = "host",
                    .threads = 2,
                    .peers = "PCL",
                    .input = "a street",
                    .seconds = 0.5};
  report.limits = {.copy_bytes = 1e10,
                   .flop = 1e11,
                   .reads = 1e7,
                   .near_reads = 1e8,
                   .atomics = 2e8,
                   .dispatch_s = 5e-5,
                   .submission_s = 1e-4};
  const bench::Cost cost{.bytes = 1e6, .flop = 4e6, .dispatches = 1.0};
  report.rows = {{.name = "peer/kernel",
                  .kind = bench::CaseKind::peer,
                  .size = 1000,
                  .item = "point",
                  .items = 1000,
                  .timing = timing(4.0),
                  .verified_by = "nothing"},
                 {.name = "kernel",
                  .size = 1000,
                  .item = "point",
                  .peer = "peer/kernel",
                  .items = 1000,
                  .timing = timing(1.0),
                  .cost = cost,
                  .verified_by = "twin",
                  .figures = {{"voxels", 12.0}, {"error mm", 0.25}}},
                 {.name = "kernel",
                  .size = 5000,
                  .item = "point",
                  .items = 5000,
                  .timing = timing(3.0),
                  .cost = cost,
                  .verified_by = "twin"},
                 {.name = "broken",
                  .size = 1000,
                  .item = "point",
                  .items = 1000,
                  .verified_by = "twin",
                  .problem = "differs"},
                 {.name = "batch",
                  .kind = bench::CaseKind::batch,
                  .size = 8,
                  .item = "pair",
                  .items = 8,
                  .timing = timing(20.0),
                  .verified_by = "true pose"}};
  report.rows.back().timing.device.reset();
  report.rows.back().timing.wait.reset();
  return report;
}

}  // namespace adit::test
