// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What LAZ files predict attributes of points by, in both directions (arithmetic_coder.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "adit/tools/clouds/arithmetic_coder.hpp"

namespace adit {

/// The median of five values that follow a series: each new one replaces the largest or the
/// smallest in turn, whichever side the one before it did not fall on.
class RunningMedian {
 public:
  int32_t value() const { return values_[2]; }

  void add(int32_t value) {
    const bool drops_largest = drops_largest_;
    drops_largest_ = drops_largest ? value < values_[2] : values_[2] >= value;
    if (drops_largest) {
      values_[4] = value;
      for (std::size_t i = 4; i > 0 && values_[i] < values_[i - 1]; --i) {
        std::swap(values_[i], values_[i - 1]);
      }
    } else {
      values_[0] = value;
      for (std::size_t i = 0; i < 4 && values_[i + 1] < values_[i]; ++i) {
        std::swap(values_[i], values_[i + 1]);
      }
    }
  }

 private:
  std::array<int32_t, 5> values_{};
  bool drops_largest_ = true;
};

/// What GPS times of pulses follow: up to four sequences, each with a usual step, in units of the
/// last place of a double.
class PulseTimes {
 public:
  /// Whether a symbol says that a time is that of the point before, as up to LAS 1.3.
  enum Unchanged : uint32_t { change_is_known = 0, unchanged_is_coded = 1 };

  PulseTimes(uint64_t first, Unchanged unchanged) : unchanged_(unchanged) {
    times_[0] = static_cast<int64_t>(first);
  }

  template <class Coder>
  uint64_t code(Coder& coder, uint64_t time);

 private:
  static constexpr int32_t kMost = 500;  ///< steps: of larger multiples only the excess is coded
  static constexpr int32_t kLeast = -10;
  static constexpr int32_t kMostExtremes = 3;  ///< in a row, before one becomes the step
  static constexpr uint32_t kMultiples = kMost - kLeast + 1;

  static bool is_near(int64_t difference) {
    return difference == static_cast<int64_t>(static_cast<int32_t>(difference));
  }
  static int64_t between(int64_t from, int64_t to) {
    return static_cast<int64_t>(static_cast<uint64_t>(to) - static_cast<uint64_t>(from));
  }
  int32_t times_step(int32_t factor) const {
    return static_cast<int32_t>(static_cast<uint32_t>(factor) *
                                static_cast<uint32_t>(steps_[current_]));
  }
  /// Of the sequences after the current one, the first that a time is near; 0: none.
  uint32_t other_sequence(int64_t time) const;
  /// What is coded of a time that is near the current sequence.
  uint32_t multiple_of(int64_t difference) const;
  template <class Coder>
  void begin_sequence(Coder& coder, int64_t time);
  template <class Coder>
  void code_near(Coder& coder, bool has_step, uint32_t multiple, int32_t difference);

  uint32_t unchanged_;
  std::array<int64_t, 4> times_{};
  std::array<int32_t, 4> steps_{};
  std::array<int32_t, 4> extremes_{};  ///< in a row
  std::size_t current_ = 0;
  std::size_t newest_ = 0;
  SymbolModel multiple_{kMultiples + unchanged_ + 4};
  SymbolModel without_step_{unchanged_ + 5};
  IntegerModel difference_{32, 9};
};

template <class Coder>
void PulseTimes::begin_sequence(Coder& coder, int64_t time) {
  const int32_t upper = difference_.code(coder, static_cast<int32_t>(times_[current_] >> 32),
                                         static_cast<int32_t>(time >> 32), 8);
  const uint32_t lower = coder.bits(32, static_cast<uint32_t>(time));
  newest_ = (newest_ + 1) & 3U;
  current_ = newest_;
  times_[current_] =
      static_cast<int64_t>((static_cast<uint64_t>(static_cast<uint32_t>(upper)) << 32) | lower);
  steps_[current_] = 0;
  extremes_[current_] = 0;
}

template <class Coder>
void PulseTimes::code_near(Coder& coder, bool has_step, uint32_t multiple, int32_t difference) {
  const auto up = static_cast<int32_t>(multiple);
  const int32_t factor = up <= kMost ? up : kMost - up;
  const uint32_t context = !has_step         ? 0
                           : factor == 1     ? 1
                           : factor == 0     ? 7
                           : factor >= kMost ? 4
                           : factor >= 10    ? 3
                           : factor > 0      ? 2
                           : factor > kLeast ? 5
                                             : 6;
  const int32_t predicted = has_step ? times_step(factor) : 0;
  difference = difference_.code(coder, predicted, difference, context);
  times_[current_] = static_cast<int64_t>(static_cast<uint64_t>(times_[current_]) +
                                          static_cast<uint64_t>(int64_t{difference}));
  int32_t& extremes = extremes_[current_];
  const bool is_extreme = factor == 0 || factor == kMost || factor == kLeast;
  if (!has_step || (is_extreme && ++extremes > kMostExtremes)) {
    steps_[current_] = difference;
    extremes = 0;
  } else if (factor == 1) {
    extremes = 0;
  }
}

template <class Coder>
uint64_t PulseTimes::code(Coder& coder, uint64_t bits) {
  const auto time = static_cast<int64_t>(bits);
  // A time takes one change of the sequence; damaged files would have no end of them.
  for (int changes = 0; changes < 4; ++changes) {
    const int64_t difference = between(times_[current_], time);
    const bool has_step = steps_[current_] != 0;
    // The symbols in order, with a step: its multiples; unchanged; a new sequence; changes to
    // others. Without: unchanged; a difference; a new sequence; changes to others.
    const uint32_t same = has_step ? kMultiples : 0;
    const uint32_t new_sequence = (has_step ? kMultiples : 1) + unchanged_;
    uint32_t symbol = 0;
    if (Coder::kEncodes) {
      symbol = unchanged_ != 0 && difference == 0 ? same
               : !is_near(difference)             ? new_sequence + other_sequence(time)
               : has_step                         ? multiple_of(difference)
                                                  : unchanged_;
    }
    symbol = coder.symbol(has_step ? multiple_ : without_step_, symbol);
    if (symbol > new_sequence) {
      current_ = (current_ + symbol - new_sequence) & 3U;
      continue;
    }
    if (symbol == new_sequence) {
      begin_sequence(coder, time);
    } else if (unchanged_ == 0 || symbol != same) {
      code_near(coder, has_step, symbol, static_cast<int32_t>(difference));
    }
    break;
  }
  return static_cast<uint64_t>(times_[current_]);
}

}  // namespace adit
