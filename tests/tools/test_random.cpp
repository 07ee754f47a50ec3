// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/random.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

TEST(Random, NumbersAreThoseOfTheStandardEngine) {
  // The 10000th number of std::mt19937_64 with its default seed is fixed by the C++ standard.
  Random random(5489);
  for (int i = 1; i < 10000; ++i) {
    random.uniform(0, 1);
  }
  EXPECT_EQ(random.uniform(0, 1), static_cast<double>(9981545732273789042ULL >> 11U) * 0x1p-53);
}

}  // namespace
}  // namespace adit
