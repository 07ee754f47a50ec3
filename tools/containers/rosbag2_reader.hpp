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

/// The files in a folder that are named as containers are (.db3, .mcap, either with .zstd, .bag,
/// .bag.active), in the order of the numbers in their names; none where there is none.
std::vector<std::filesystem::path> container_files(const std::filesystem::path& folder);

}  // namespace adit
