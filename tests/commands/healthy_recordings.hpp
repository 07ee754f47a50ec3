// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A small recording of every format that adit reads, for commands to be run on damaged copies.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "adit/tests/support/moving_rig.hpp"

namespace adit::test {

/// One recording, in a folder of its own with what belongs to it.
struct HealthyRecording {
  std::filesystem::path folder;
  std::filesystem::path opened;    ///< what a command is given, in the folder; empty: the folder
  std::filesystem::path metadata;  ///< file in the folder to be named to the command; or empty

  std::filesystem::path path() const { return opened.empty() ? folder : folder / opened; }
};

struct HealthyFormat {
  std::string name;  ///< "bag"
  std::vector<HealthyRecording> recordings;
};

/// Sweeps, readings, fixes, poses and mountings of some tenths of a second, few points a sweep.
std::vector<Recorded> small_drive();

/// Writes them all into `folder`. Those of messages hold `events`; sensors' packets and files of
/// sweeps show a room from within, with stamps from MovingRig::kBegin on.
std::vector<HealthyFormat> write_healthy_recordings(const std::filesystem::path& folder,
                                                    const std::vector<Recorded>& events);

/// Parts of them.
std::vector<HealthyFormat> write_healthy_captures(const std::filesystem::path& folder);
std::vector<HealthyFormat> write_healthy_folders(const std::filesystem::path& folder);

/// Containers of messages: "bag", "mcap", "rosbag2", "rosbag2_mcap". With `change`, what becomes of
/// the bytes of each message.
bool holds_messages(const std::string& format);
HealthyRecording write_messages(const std::filesystem::path& folder, const std::string& format,
                                std::size_t variant, const std::vector<Recorded>& events,
                                const std::function<void(std::string&)>& change = {});

}  // namespace adit::test
