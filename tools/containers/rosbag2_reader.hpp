// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "adit/tools/containers/message_file.hpp"

namespace adit {

/// True where the file is an SQLite database.
bool is_rosbag2_database(const std::filesystem::path& file);

/// Opens the SQLite storage of a rosbag2 recording (.db3). Messages that are packed with Zstandard
/// one by one are unpacked. Throws InputError where it is no such database.
std::unique_ptr<MessageFile> open_rosbag2_database(const std::filesystem::path& file);

/// The storage files in a folder that rosbag2 wrote (.db3, .mcap, either with .zstd), in the order
/// of their numbers; none where it is no such folder. metadata.yaml is not needed.
std::vector<std::filesystem::path> rosbag2_files(const std::filesystem::path& folder);

}  // namespace adit
