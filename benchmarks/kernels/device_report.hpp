// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// All that somebody who has a device can tell those who do not, in one file.
#pragma once

#include <iosfwd>

#include <nlohmann/json_fwd.hpp>

#include "adit/benchmarks/kernels/report.hpp"
#include "adit/engine/device_info.hpp"

namespace adit::bench {

/// What was measured, as `--json` has it and `--compare` reads it; with the device's limits and
/// requirements, its self-test, how long that took, and what its driver tells of the kernels that
/// it compiled (VK_KHR_pipeline_executable_properties), or why it tells nothing. `notes` is told
/// where kernels have to be compiled first.
nlohmann::ordered_json device_report(const Report& measured, const engine::DeviceInfo& device,
                                     std::ostream& notes);

}  // namespace adit::bench
