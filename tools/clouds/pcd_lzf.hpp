// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace adit {

/// The most that one byte of LZF data can stand for: a three-byte reference repeats 264 bytes.
constexpr std::size_t kLzfLargestExpansion = 88;

/// Expands LZF data (the compression of PCD's binary_compressed). Returns nothing where all of
/// `packed` gave all of `unpacked`, else the offset in `packed` at which the data makes no sense:
/// it refers to before its start, breaks off, or is longer or shorter than `unpacked`.
std::optional<std::size_t> lzf_expand(std::span<const std::byte> packed,
                                      std::span<std::byte> unpacked);

}  // namespace adit
