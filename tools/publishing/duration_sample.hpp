// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace adit {

/// Durations of a run, however long: some of all, evenly chosen.
class DurationSample {
 public:
  void add(double ms);

  std::size_t count() const { return count_; }  ///< of all
  double last_ms() const { return last_ms_; }   ///< 0: there is none
  double sum_ms() const { return sum_ms_; }     ///< of all
  /// That this share of them does not exceed, by the nearest rank; 0 where there is none.
  double quantile_ms(double share) const;

 private:
  std::size_t count_ = 0;
  std::size_t stride_ = 1;  ///< of the durations, one is kept
  double last_ms_ = 0.0;
  double sum_ms_ = 0.0;
  std::vector<float> kept_;
};

}  // namespace adit
