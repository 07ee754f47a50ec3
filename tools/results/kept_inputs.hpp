// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a command reads it never writes over: every check of that is made here. command_line.cpp
// asks for all options that name a file to write (CommandOption::written()).
#pragma once

#include <filesystem>
#include <string>

namespace adit {

/// Whether both are the same file or folder, links followed.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Whether a path, which need not exist yet, is the other one or lies below it.
bool is_within(const std::filesystem::path& path, const std::filesystem::path& other);

/// Whether to write the file would change what is read from `input`: the same file, whatever its
/// name, the draft of the output, what SQLite keeps beside a map, a file that a run's folder
/// consists of, or any file that is in the folder of a recording. Pages and drawings that adit made
/// are never read.
bool would_change(const std::filesystem::path& output, const std::filesystem::path& input);

/// Whether the file is a recording (MCAP, a ROS 1 bag) or a database (a map, a rosbag2 recording,
/// no GeoPackage).
bool is_recording_or_map(const std::filesystem::path& file);

/// Throws UsageError, which begins with the option that names the output, where would_change().
void keep_input(const std::string& option, const std::filesystem::path& output,
                const std::filesystem::path& input);

}  // namespace adit
