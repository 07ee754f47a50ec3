// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What becomes of settings in a run: which have no effect, and which came to something else.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/slam/executor/slam.hpp"
#include "adit/tools/setup/config_file.hpp"

namespace adit {

/// Throws UsageError where --metadata tells of packets, and the recording holds none. Throws as
/// open_recording() does.
void require_packets(const ConfigSource& source, const std::filesystem::path& recording);

/// How the IMU was found to be mounted is the effective setting.
Config with_mounting(Config config, const std::optional<Mounting>& mounting);

/// Lines about settings that a run has not used as they were stated; empty where there are none.
std::string notes_of(const Config& stated, const Config& used,
                     const std::optional<Mounting>& mounting);

/// A line for each sentence.
std::string as_notes(const std::vector<std::string>& texts);

/// A line.
inline constexpr const char* kFixesAreLeftOut =
    "note: odometry alone does not use the recording's GNSS fixes; a map does (leave out "
    "--odometry "
    "and mapping.enabled=false)\n";

}  // namespace adit
