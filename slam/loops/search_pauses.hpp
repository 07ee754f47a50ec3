// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

namespace adit {

/// Keyframes that are not searched for by their looks: galleries and rows of trees look alike for
/// hundreds of keyframes, and verifying what is refused costs most of the search. After a refusal
/// one keyframe is passed over, then three after each.
class SearchPauses {
 public:
  /// Whether this keyframe is searched for. To be asked once for each.
  bool is_due() {
    if (left_ == 0) {
      return true;
    }
    --left_;
    return false;
  }
  /// All that a search has offered was refused.
  void refused() { left_ = pause_ = std::min(2 * pause_ + 1, kLongest); }
  /// A place was verified, or nothing was offered: the next keyframe is searched for.
  void reset() { left_ = pause_ = 0; }

 private:
  static constexpr std::size_t kLongest = 3;

  std::size_t pause_ = 0;
  std::size_t left_ = 0;
};

}  // namespace adit
