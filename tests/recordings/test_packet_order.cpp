// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tools/packets/packet_order.hpp"

namespace adit {
namespace {

struct Item {
  Nanoseconds received{0};
  int number = 0;
};

constexpr Nanoseconds kMillisecond = std::chrono::milliseconds(1);

/// Packets of a series, a millisecond apart by the sensor's clock, received in the order given.
class PacketOrderTest : public testing::Test {
 protected:
  void add(int number, std::size_t series = 0) { add_at(number, number * kMillisecond, series); }
  void add_at(int number, Nanoseconds time, std::size_t series = 0) {
    order_.add({.received = received_ += kMillisecond, .number = number},
               {.series = series,
                .time = time,
                .content = static_cast<uint64_t>(number) + 100'000 * series});
    take(false);
  }
  void add_other(int number) {
    order_.add({.received = received_ += kMillisecond, .number = number});
    take(false);
  }
  void take(bool end) {
    while (const std::optional<Item> item = order_.next(end)) {
      EXPECT_GE(item->received, last_received_) << item->number;
      last_received_ = item->received;
      numbers_.push_back(item->number);
    }
  }
  std::vector<int> finish() {
    take(true);
    return numbers_;
  }

  PacketOrder<Item> order_;
  Nanoseconds received_{0};
  Nanoseconds last_received_{0};
  std::vector<int> numbers_;
};

TEST_F(PacketOrderTest, WhatIsInOrderComesOutAsItWentIn) {
  std::vector<int> all;
  for (int i = 0; i < 300; ++i) {
    i % 7 == 3 ? add_other(i) : add(i, i % 3 == 0 ? 1 : 0);
    all.push_back(i);
  }
  EXPECT_EQ(finish(), all);
  EXPECT_EQ(order_.counts().repeated + order_.counts().reordered + order_.counts().late, 0U);
}

TEST_F(PacketOrderTest, PacketsTakeEachOthersPlacesAndOthersKeepTheirs) {
  for (const int i : {1, 3}) {
    add(i);
  }
  add_other(100);
  add(2);
  add(7, 1);
  add(5);
  add(6, 1);
  add(4);
  EXPECT_EQ(finish(), (std::vector<int>{1, 2, 100, 3, 6, 4, 7, 5}));
  EXPECT_EQ(order_.counts().reordered, 3U);
}

TEST_F(PacketOrderTest, PacketsThatComeTwiceAreUsedOnce) {
  std::vector<int> once;
  for (int i = 0; i < 400; ++i) {
    add(i);
    add(i % 2 == 0 ? i : std::max(0, i - 150));  // at once, or much later
    once.push_back(i);
  }
  EXPECT_EQ(finish(), once);
  EXPECT_EQ(order_.counts().repeated, 400U);
  EXPECT_EQ(order_.counts().late, 0U);
}

TEST_F(PacketOrderTest, PacketsThatComeMuchTooLateAreLeftOut) {
  std::vector<int> rest;
  for (int i = 0; i < 400; ++i) {
    if (i == 50) {
      continue;
    }
    add(i);
    rest.push_back(i);
    if (i == 250) {
      add(50);
    }
  }
  EXPECT_EQ(finish(), rest);
  EXPECT_EQ(order_.counts().late, 1U);
}

TEST_F(PacketOrderTest, AClockThatIsSetFarBackLosesNothing) {
  for (int i = 5000; i < 5200; ++i) {
    add(i);
  }
  for (int i = 0; i < 200; ++i) {
    add(i);
  }
  const std::vector<int> numbers = finish();
  ASSERT_EQ(numbers.size(), 400U);
  EXPECT_EQ(numbers[199], 5199);
  EXPECT_EQ(numbers[200], 0);
  EXPECT_EQ(numbers[399], 199);
}

TEST_F(PacketOrderTest, AClockThatIsSetALittleBackLosesAFewPackets) {
  for (int i = 0; i < 400; ++i) {
    add_at(i, i * kMillisecond);
  }
  for (int i = 400; i < 800; ++i) {
    add_at(i, (i - 300) * kMillisecond);
  }
  const std::vector<int> numbers = finish();
  EXPECT_GE(numbers.size(), 780U);
  EXPECT_EQ(numbers.back(), 799);
  EXPECT_EQ(numbers.size() + order_.counts().late, 800U);
}

TEST_F(PacketOrderTest, ATimeThatNoClockShowsHoldsNothingUp) {
  add(1);
  add_at(2, std::chrono::hours(2'000'000));
  add(3);
  add(4);
  EXPECT_EQ(finish(), (std::vector<int>{1, 2, 3, 4}));
}

}  // namespace
}  // namespace adit
