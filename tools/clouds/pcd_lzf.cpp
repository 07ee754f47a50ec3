// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/pcd_lzf.hpp"

#include <cstdint>
#include <cstring>

namespace adit {

// LZF is a sequence of runs. Its first byte C tells the kind:
//   C < 32: C + 1 literal bytes follow;
//   else: a reference. Length L = C >> 5, and if that is 7, plus the next byte; distance D = (C &
//   31) * 256 plus the next byte. L + 2 bytes are repeated from D + 1 bytes back; the two may
//   overlap.
std::optional<std::size_t> lzf_expand(std::span<const std::byte> packed,
                                      std::span<std::byte> unpacked) {
  std::size_t in = 0;
  std::size_t out = 0;
  while (in < packed.size()) {
    const std::size_t run = in;
    const auto control = std::to_integer<std::size_t>(packed[in++]);
    if (control < 32) {
      const std::size_t length = control + 1;
      if (packed.size() - in < length || unpacked.size() - out < length) {
        return run;
      }
      std::memcpy(unpacked.data() + out, packed.data() + in, length);
      in += length;
      out += length;
      continue;
    }
    std::size_t length = (control >> 5U) + 2;
    const std::size_t more = length == 9 ? 2 : 1;
    if (packed.size() - in < more) {
      return run;
    }
    if (more == 2) {
      length += std::to_integer<std::size_t>(packed[in++]);
    }
    const std::size_t distance =
        ((control & 31U) << 8U) + std::to_integer<std::size_t>(packed[in++]) + 1;
    if (distance > out || unpacked.size() - out < length) {
      return run;
    }
    for (const std::size_t end = out + length; out < end; ++out) {
      unpacked[out] = unpacked[out - distance];
    }
  }
  if (out != unpacked.size()) {
    return packed.size();
  }
  return std::nullopt;
}

}  // namespace adit
