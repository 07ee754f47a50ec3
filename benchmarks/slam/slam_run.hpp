// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// One system on one sequence: mapped as `adit run` does it, judged as `adit evaluate` does it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/benchmarks/slam/slam_report.hpp"
#include "adit/benchmarks/slam/slam_sequences.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit::bench {

/// Ours with these settings.
struct SlamVariant {
  std::string name = "adit";
  ConfigSource config{};
};

/// Maps the sequence into `folder` and evaluates the trajectory and, where the sequence has a table
/// of them, the loops. What goes wrong with the data or
/// in mapping is a failed result; throws UsageError for settings that make no sense, and
/// std::runtime_error where a signal asked to stop.
SlamResult map_sequence(const SlamSequence& sequence, const SlamVariant& variant,
                        const DeviceOptions& device, const std::filesystem::path& folder);

/// Evaluates what another system left in its folder: NAME.tum (T_any_lidar) and, where the sequence
/// has a table of loops, its closures (loops_of_system). A trajectory that is not there is a
/// missing result, a file that cannot be read or matched a failed one.
SlamResult judge_system(const SlamSequence& sequence, const std::filesystem::path& system);

}  // namespace adit::bench
