// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Files in a folder that several machines share: each appears whole, also where two write it at the
// same time.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace adit {

/// The name of this machine.
std::string host_name();

/// Replaces the file. Its folder is made if need be. Throws OutputError.
void put_text(const std::filesystem::path& file, std::string_view text);

/// Replaces the file or folder `to` by a copy of `from`, which may be on another disk. Throws
/// OutputError; then `to` is as it was.
void put_copy(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace adit
