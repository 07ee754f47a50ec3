// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/search_pauses.hpp"

#include <string>

#include <gtest/gtest.h>

namespace adit {
namespace {

// A letter a keyframe: searched for (s), passed over (.).
std::string searched(SearchPauses& pauses, int keyframes, bool refused) {
  std::string all;
  for (int i = 0; i < keyframes; ++i) {
    const bool due = pauses.is_due();
    all += due ? 's' : '.';
    if (due && refused) {
      pauses.refused();
    } else if (due) {
      pauses.reset();
    }
  }
  return all;
}

TEST(SearchPauses, GrowToThreeKeyframesWhileAllIsRefused) {
  SearchPauses pauses;
  EXPECT_EQ(searched(pauses, 12, true), "s.s...s...s.");
}

TEST(SearchPauses, EndWithAPlaceThatIsVerified) {
  SearchPauses pauses;
  EXPECT_EQ(searched(pauses, 3, true), "s.s");
  pauses.reset();
  EXPECT_EQ(searched(pauses, 4, false), "ssss");
  EXPECT_EQ(searched(pauses, 3, true), "s.s") << "and begin anew";
}

}  // namespace
}  // namespace adit
