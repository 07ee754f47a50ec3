// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace adit {

/// The check sum that MCAP, PNG and zlib call CRC-32. `before` is the sum of the bytes before
/// these, so that pieces can be added up.
uint32_t crc32(std::span<const std::byte> bytes, uint32_t before = 0);

}  // namespace adit
