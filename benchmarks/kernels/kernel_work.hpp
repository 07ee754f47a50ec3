// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a kernel's run and its verification are to a report.
#pragma once

#include <string>

#include "adit/benchmarks/kernels/work.hpp"
#include "adit/benchmarks/verify/device_runs.hpp"
#include "adit/benchmarks/verify/verify.hpp"

namespace adit::bench {

/// What the device's clock says of `scope`, and the host's of all.
inline Sample sample_of(const test::Times& times, const std::string& scope) {
  return {.device_ms = test::device_ms(times, scope),
          .wait_ms = times.wait_ms,
          .host_ms = times.host_ms};
}

/// Empty: none.
inline std::string first_problem(const test::Verdict& verdict) {
  return verdict.passed() ? std::string() : verdict.problems.front();
}

}  // namespace adit::bench
