// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which files of a folder are the sweeps of a recording, and when each was taken.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/clouds/cloud_columns.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// A format with one sweep a file.
struct SweepFileKind {
  std::string_view extension;  ///< with its dot, lower case
  std::string_view name;       ///< for people
  CloudFile (*read)(const std::filesystem::path&, const CloudReading& reading);
  /// For people: what is unusual about the layout of a file, or empty; null where its header tells.
  std::string (*describe)(const std::filesystem::path&);
};

/// The kind by the file's extension, upper or lower case; null where it is none.
const SweepFileKind* sweep_file_kind(const std::filesystem::path& file);

/// The sweeps of a recording and when they were taken.
struct SweepFiles {
  const SweepFileKind* kind = nullptr;
  std::vector<std::filesystem::path> files{};
  std::vector<Nanoseconds> stamps{};  ///< one a file
  std::string layout{};               ///< for people
  std::string times_from{};           ///< for people
  bool times_assumed = false;
};

/// The sweeps in a folder by natural order, all of one kind, without stamps; none where there are
/// none. Throws InputError for a folder of several kinds, or that cannot be read.
SweepFiles list_sweeps(const std::filesystem::path& folder);

/// With the times of a file, one a sweep. Throws InputError.
SweepFiles stamped_by(const std::filesystem::path& times, SweepFiles sweeps);

/// With times from the names, in their order; nothing where not every name tells one. Throws
/// InputError for two of the same time.
std::optional<SweepFiles> stamped_by_names(const SweepFiles& sweeps);

/// At 10 Hz from 0 s on; `reason` for people: why.
SweepFiles stamped_by_assumption(const std::string& reason, SweepFiles sweeps);

}  // namespace adit
