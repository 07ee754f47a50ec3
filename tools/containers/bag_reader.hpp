// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "adit/tools/containers/message_file.hpp"

namespace adit {

/// True where the file begins as ROS 1 bags of version 2.0 do.
bool is_bag(const std::filesystem::path& file);

/// Opens a ROS 1 bag. With an index, that alone is read; without (the recorder was killed) all of
/// it is read once. A file that is cut off or damaged opens: damage() tells. Throws InputError
/// where it is no such bag.
std::unique_ptr<MessageFile> open_bag(const std::filesystem::path& file);

}  // namespace adit
