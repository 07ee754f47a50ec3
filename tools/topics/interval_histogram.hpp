// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace adit {

/// Durations of 0.1 µs to 1e5 s, counted in bins that each are 2 % wide: quantiles of any number of
/// them in constant memory.
class IntervalHistogram {
 public:
  /// Takes a positive duration (s).
  void add(double seconds);

  uint64_t count() const { return count_; }
  /// The value that this share of the durations does not exceed, to 1 %; 0 where there are none.
  double quantile(double share) const;
  /// How many are longer, to the width of a bin.
  uint64_t longer_than(double seconds) const;

 private:
  static constexpr std::size_t kBins = 1400;
  static std::size_t bin_of(double seconds);

  std::array<uint64_t, kBins> bins_{};
  uint64_t count_ = 0;
};

}  // namespace adit
