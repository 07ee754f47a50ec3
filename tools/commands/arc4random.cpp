// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// std::random_device of a libstdc++ that is linked in takes its numbers from arc4random, which
// glibc has from 2.36 on; with this one the packaged program (tools/package.sh) starts with 2.35,
// too. It is part of the program alone, not of a library: nobody else's arc4random is replaced.
#include <cstdint>

#include <unistd.h>

extern "C" {

// Hidden, so that drivers and other libraries of the process keep glibc's.
[[gnu::visibility("hidden")]] std::uint32_t arc4random() noexcept;

std::uint32_t arc4random() noexcept {
  std::uint32_t value = 0;
  if (getentropy(&value, sizeof(value)) != 0) {
    // The kernel has no random numbers: nothing may go on with ones that can be guessed.
    __builtin_trap();
  }
  return value;
}

}  // extern "C"
