// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace adit {

/// What tells a file, or a folder with all in it, from another one without reading all of it.
struct Fingerprint {
  std::string hash;    ///< XXH3, 128 bits, hexadecimal
  uint64_t bytes = 0;  ///< size of all files
};

/// Of names, sizes and contents; beyond 16 MiB of 1 MiB at each of sixteen places. Folders that may
/// not be read count for nothing, files that may not for their size. Throws InputError where there
/// is no such file.
Fingerprint fingerprint(const std::filesystem::path& path);

/// Of several, in whatever order; of one the same as above.
Fingerprint fingerprint(const std::vector<std::filesystem::path>& paths);

/// Of all that a file holds: XXH3, 128 bits, hexadecimal. Throws InputError.
std::string whole_hash(const std::filesystem::path& file);

/// Of a text: XXH3, 128 bits, hexadecimal.
std::string text_hash(std::string_view text);

}  // namespace adit
