// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace adit {

/// Memory of this process that is in RAM, that of software devices included; bytes, 0 where the
/// system does not tell.
uint64_t resident_bytes();
/// The most that it ever was.
uint64_t peak_resident_bytes();
/// Gives memory that is free but kept for later back to the system.
void release_free_memory();

}  // namespace adit
