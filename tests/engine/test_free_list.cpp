// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "adit/engine/vulkan/free_list.hpp"

namespace adit::engine {
namespace {

struct Taken {
  uint64_t position;
  uint64_t bytes;
};

TEST(FreeList, WholeBlockCanBeTakenOnce) {
  FreeList list(1024);
  EXPECT_EQ(list.take(1024), 0U);
  EXPECT_FALSE(list.unused());
  EXPECT_EQ(list.take(1), std::nullopt);
  list.give(0, 1024);
  EXPECT_TRUE(list.unused());
}

TEST(FreeList, NeighboursAreJoinedWhateverTheOrderOfGiving) {
  const std::vector<std::vector<uint64_t>> orders{{0, 1, 2}, {2, 1, 0}, {0, 2, 1},
                                                  {1, 0, 2}, {1, 2, 0}, {2, 0, 1}};
  for (const std::vector<uint64_t>& order : orders) {
    FreeList list(768);
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(list.take(256).has_value());
    }
    for (const uint64_t i : order) {
      list.give(i * 256, 256);
    }
    EXPECT_TRUE(list.unused());
    EXPECT_EQ(list.take(768), 0U);
  }
}

TEST(FreeList, RandomUseNeverHandsOutTheSameByteTwice) {
  constexpr uint64_t kUnit = 256;
  constexpr uint64_t kUnits = 200;
  FreeList list(kUnit * kUnits);
  std::mt19937 random(3);
  std::vector<bool> used(kUnits, false);
  std::vector<Taken> taken;
  for (int round = 0; round < 20'000; ++round) {
    if (taken.empty() || random() % 2 == 0) {
      const uint64_t units = 1 + random() % 20;
      if (const auto position = list.take(units * kUnit)) {
        ASSERT_EQ(*position % kUnit, 0U);
        for (uint64_t i = *position / kUnit; i < *position / kUnit + units; ++i) {
          ASSERT_LT(i, kUnits);
          ASSERT_FALSE(used[i]);
          used[i] = true;
        }
        taken.push_back({*position, units * kUnit});
      }
    } else {
      std::swap(taken[random() % taken.size()], taken.back());
      for (uint64_t i = taken.back().position / kUnit;
           i < (taken.back().position + taken.back().bytes) / kUnit; ++i) {
        used[i] = false;
      }
      list.give(taken.back().position, taken.back().bytes);
      taken.pop_back();
    }
  }
  for (const Taken& each : taken) {
    list.give(each.position, each.bytes);
  }
  EXPECT_TRUE(list.unused());
}

}  // namespace
}  // namespace adit::engine
