// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Ways to damage a recording: its bytes, its messages, the numbers in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "adit/tests/support/moving_rig.hpp"

namespace adit::test {

enum class Damage { some, none };

/// Whole numbers at random, the same with every standard library; with Damage::none, what follows
/// here leaves everything as it is.
class Dice {
 public:
  explicit Dice(uint64_t seed, Damage damage = Damage::some) : engine_(seed), damage_(damage) {}
  bool is_harmless() const { return damage_ == Damage::none; }
  uint64_t bits() { return engine_(); }
  /// From 0 to `n` - 1; 0 where n is 0.
  std::size_t below(std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(bits() % n); }
  bool one_in(std::size_t n) { return below(n) == 0; }

 private:
  std::mt19937_64 engine_;
  Damage damage_;
};

/// Cut off, flipped, overwritten, zeroed, spliced, doubled, taken out: one to four times.
void damage_bytes(std::string& bytes, Dice& dice);

/// Lines taken out, doubled and exchanged, and numbers replaced by such as are none, or are huge.
void damage_text(std::string& text, Dice& dice);

/// One to four numbers of a text replaced by others that can be read: of the same text, or far off.
void damage_numbers(std::string& text, Dice& dice);

/// Events left out, doubled, exchanged and sent to other topics; stamps anywhere; numbers that are
/// none, or huge; clouds without points, with one, with all in one place; transforms that make no
/// tree; sensors on two topics. One to four kinds of it.
void damage_events(std::vector<Recorded>& events, Dice& dice);

}  // namespace adit::test
