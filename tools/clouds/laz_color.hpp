// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How LAZ files predict the colour of a point by that of the point before, in both directions
// (arithmetic_coder.hpp): items RGB12 of version 2 and RGB14 of version 3 are coded alike.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "adit/tools/clouds/arithmetic_coder.hpp"

namespace adit {

/// As it lies in a LAS file: the lower and the upper byte of red, of green and of blue.
using LazColor = std::array<uint8_t, 6>;

/// Codes each byte as the difference to a prediction: green changes as red does, and blue as both.
class LazColorCodec {
 public:
  template <class Coder>
  LazColor code(Coder& coder, const LazColor& last, const LazColor& color);

 private:
  static constexpr uint32_t kNotGrey = 64;  ///< the bits below it: which bytes have changed

  static uint32_t changes_between(const LazColor& last, const LazColor& color) {
    uint32_t changes = 0;
    for (std::size_t i = 0; i < color.size(); ++i) {
      changes |= color[i] != last[i] ? 1U << i : 0U;
      changes |= color[i] != color[i % 2] ? kNotGrey : 0U;
    }
    return changes;
  }

  SymbolModel changes_{128};
  std::vector<SymbolModel> bytes_ = std::vector<SymbolModel>(6, SymbolModel(256));
};

template <class Coder>
LazColor LazColorCodec::code(Coder& coder, const LazColor& last, const LazColor& color) {
  const uint32_t changes =
      coder.symbol(changes_, Coder::kEncodes ? changes_between(last, color) : 0);
  LazColor now = last;
  const auto take = [&](std::size_t i, int predicted) {
    if (((changes >> i) & 1U) != 0) {
      const auto base = static_cast<uint8_t>(std::clamp(predicted, 0, 255));
      const uint32_t step =
          coder.symbol(bytes_[i], Coder::kEncodes ? static_cast<uint8_t>(color[i] - base) : 0U);
      now[i] = static_cast<uint8_t>(base + step);
    }
  };
  take(0, last[0]);
  take(1, last[1]);
  if ((changes & kNotGrey) == 0) {
    now[2] = now[4] = now[0];
    now[3] = now[5] = now[1];
    return now;
  }
  for (const std::size_t half : {std::size_t{0}, std::size_t{1}}) {
    const int red = now[half] - last[half];
    take(half + 2, last[half + 2] + red);
    take(half + 4, last[half + 4] + (red + now[half + 2] - last[half + 2]) / 2);
  }
  return now;
}

}  // namespace adit
