// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/ordered_events.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace adit {
namespace {

using std::chrono::milliseconds;

/// IMU samples with these stamps (ms), each as large as told; a negative stamp is damage. `read`
/// counts what was taken.
class Listed final : public EventStream {
 public:
  Listed(std::vector<int> stamps, std::size_t* read = nullptr, uint64_t bytes = 0)
      : stamps_(std::move(stamps)), read_(read), bytes_(bytes) {}

  std::optional<Event> next() override {
    if (at_ == stamps_.size()) {
      return std::nullopt;
    }
    const int stamp = stamps_[at_++];
    if (read_ != nullptr) {
      ++*read_;
    }
    if (stamp < 0) {
      throw InputError("f", Place::byte(0), "damaged", "Copy it again");
    }
    return Event{.topic = at_ - 1,
                 .received = milliseconds(at_),
                 .value = ImuSample{.stamp = milliseconds(stamp)},
                 .bytes = bytes_};
  }

 private:
  std::vector<int> stamps_;
  std::size_t* read_;
  uint64_t bytes_;
  std::size_t at_ = 0;
};

std::vector<int> ordered(std::vector<int> stamps, int window) {
  const auto stream =
      order_by_stamp(std::make_unique<Listed>(std::move(stamps)), milliseconds(window));
  std::vector<int> result;
  while (const auto event = stream->next()) {
    result.push_back(static_cast<int>(stamp_of(*event) / milliseconds(1)));
  }
  return result;
}

TEST(OrderedEvents, SweepsComeBeforeTheSamplesThatTheyBeganBefore) {
  EXPECT_EQ(ordered({10, 20, 30, 0, 110, 120, 100}, 50),
            (std::vector<int>{0, 10, 20, 30, 100, 110, 120}));
  EXPECT_TRUE(ordered({}, 50).empty());
}

TEST(OrderedEvents, ShuffledWithinTheWindowIsSortedWhole) {
  std::mt19937 random(5);
  std::vector<int> stamps(1000);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    stamps[i] = static_cast<int>(10 * i);
  }
  const std::vector<int> sorted = stamps;
  for (std::size_t i = 0; i + 20 <= stamps.size(); i += 20) {
    std::shuffle(stamps.begin() + static_cast<long>(i), stamps.begin() + static_cast<long>(i + 20),
                 random);
  }
  EXPECT_NE(stamps, sorted);
  EXPECT_EQ(ordered(stamps, 200), sorted);
}

TEST(OrderedEvents, LaterThanTheWindowComesAtOnceAndIsNotLost) {
  EXPECT_EQ(ordered({0, 100, 200, 300, 50, 400}, 100),
            (std::vector<int>{0, 100, 200, 50, 300, 400}));
}

TEST(OrderedEvents, EqualStampsKeepTheirOrder) {
  const auto stream =
      order_by_stamp(std::make_unique<Listed>(std::vector<int>{5, 5, 3, 5}), milliseconds(100));
  std::vector<std::size_t> topics;
  while (const auto event = stream->next()) {
    topics.push_back(event->topic);
  }
  EXPECT_EQ(topics, (std::vector<std::size_t>{2, 0, 1, 3}));
}

TEST(OrderedEvents, HoldsNoMoreThanTheWindowAndNotMoreThanMemoryAllows) {
  std::vector<int> stamps(1000);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    stamps[i] = static_cast<int>(i);
  }
  std::size_t read = 0;
  auto stream = order_by_stamp(std::make_unique<Listed>(stamps, &read), milliseconds(100));
  stream->next();
  EXPECT_EQ(read, 101U);
  read = 0;
  const std::vector<int> still(1000, 7);  // a clock that stands still
  stream = order_by_stamp(std::make_unique<Listed>(still, &read, uint64_t{10} << 20U),
                          milliseconds(100));
  stream->next();
  EXPECT_EQ(read, 26U) << "of 10 MiB each";
}

TEST(OrderedEvents, WhatLiesBeforeDamageComesBeforeItsError) {
  const auto stream = order_by_stamp(
      std::make_unique<Listed>(std::vector<int>{20, 10, -1, 30, -1, -1}), milliseconds(100));
  std::vector<int> order;  // a negative one for an error
  for (bool more = true; more;) {
    try {
      const auto event = stream->next();
      more = event.has_value();
      if (event) {
        order.push_back(static_cast<int>(stamp_of(*event) / milliseconds(1)));
      }
    } catch (const InputError&) {
      order.push_back(-1);
    }
  }
  EXPECT_EQ(order, (std::vector<int>{10, 20, -1, 30, -1, -1}));
}

}  // namespace
}  // namespace adit
