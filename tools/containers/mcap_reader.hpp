// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "adit/tools/containers/message_file.hpp"

namespace adit {

/// True where the file begins as MCAP files do.
bool is_mcap(const std::filesystem::path& file);

/// Opens an MCAP file. With a summary, that alone is read; without (the recorder was killed, or
/// wrote none) all of it is read once. A file that is cut off or damaged opens: damage() tells.
/// Throws InputError where it is no MCAP file.
std::unique_ptr<MessageFile> open_mcap(const std::filesystem::path& file);

}  // namespace adit
