// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/events_ahead.hpp"

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace adit {
namespace {

/// What a stream has begun to read, seen from another thread.
class Begun {
 public:
  void add() {
    {
      const std::scoped_lock lock(mutex_);
      ++count_;
    }
    changed_.notify_all();
  }
  std::size_t count() const {
    const std::scoped_lock lock(mutex_);
    return count_;
  }
  void wait_for(std::size_t count) const {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return count_ >= count; });
  }

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::size_t count_ = 0;
};

/// Gives what it is told to for 0, 1, 2...
class ToldStream final : public EventStream {
 public:
  using Tell = std::function<std::optional<Event>(std::size_t)>;
  ToldStream(Tell tell, Begun& begun) : tell_(std::move(tell)), begun_(&begun) {}

  std::optional<Event> next() override {
    begun_->add();
    return tell_(index_++);
  }

 private:
  Tell tell_;
  Begun* begun_;
  std::size_t index_ = 0;
};

Event sweep(std::size_t number) {
  Sweep sweep;
  sweep.points.resize(100);
  return {.value = std::move(sweep), .number = number};
}

Event reading(std::size_t number) {
  return {.value = ImuSample{}, .number = number};
}

[[noreturn]] void throw_damage(std::size_t place) {
  throw InputError("file", Place::byte(place), "damaged", "Copy it again");
}

/// What comes of a stream: numbers of events, "!" and the place of damage.
std::string all_of(EventStream& events) {
  std::string text;
  while (true) {
    try {
      const std::optional<Event> event = events.next();
      if (!event) {
        return text + "end";
      }
      text += std::to_string(event->number.value()) + " ";
    } catch (const InputError& error) {
      text += "!" + error.place() + " ";
    }
  }
}

TEST(EventsAhead, GivesWhatTheStreamGivesWithDamageInItsPlace) {
  const auto tell = [](std::size_t index) -> std::optional<Event> {
    if (index == 0 || index == 3 || index == 4 || index == 7) {
      throw_damage(index);
    }
    return index < 8 ? std::optional(index % 2 == 0 ? sweep(index) : reading(index)) : std::nullopt;
  };
  Begun begun;
  ToldStream plain(tell, begun);
  const std::string expected = all_of(plain);
  EXPECT_EQ(expected, "!byte 0 1 2 !byte 3 !byte 4 5 6 !byte 7 end");
  for (const AheadBounds bounds : {AheadBounds{}, AheadBounds{.sweeps = 1, .bytes = 1}}) {
    EventsAhead ahead(std::make_unique<ToldStream>(tell, begun), bounds);
    EXPECT_EQ(all_of(ahead), expected);
    EXPECT_FALSE(ahead.next()) << "the end stays the end";
  }
}

TEST(EventsAhead, KeepsNoMoreSweepsThanItIsToldWhileNobodyTakesThem) {
  Begun begun;
  {
    EventsAhead ahead(std::make_unique<ToldStream>(sweep, begun), {.sweeps = 3});
    begun.wait_for(3);
  }
  EXPECT_EQ(begun.count(), 3U);
}

TEST(EventsAhead, IsNeverFartherAheadOfASlowTakerThanItIsTold) {
  Begun begun;
  EventsAhead ahead(std::make_unique<ToldStream>(sweep, begun));
  for (std::size_t taken = 0; taken < 50; ++taken) {
    begun.wait_for(taken + 2);
    std::this_thread::yield();
    EXPECT_EQ(begun.count(), taken + 2);
    EXPECT_EQ(ahead.next()->number, taken);
  }
}

TEST(EventsAhead, ReadingsDoNotCountAsSweeps) {
  constexpr std::size_t kReadings = 1000;
  const auto tell = [](std::size_t index) {
    return index < kReadings ? reading(index) : sweep(index);
  };
  Begun begun;
  {
    EventsAhead ahead(std::make_unique<ToldStream>(tell, begun));
    begun.wait_for(kReadings + 2);
  }
  EXPECT_EQ(begun.count(), kReadings + 2);
}

TEST(EventsAhead, BytesBoundWhatIsNoSweepAndSweepsThatAreLarge) {
  for (const auto& tell : {reading, sweep}) {
    Begun begun;
    {
      EventsAhead ahead(std::make_unique<ToldStream>(tell, begun), {.sweeps = 9, .bytes = 1});
      begun.wait_for(1);
      EXPECT_EQ(ahead.next()->number, 0U);
      begun.wait_for(2);
    }
    EXPECT_EQ(begun.count(), 2U);
  }
}

TEST(EventsAhead, EndsWithWhatIsBeingRead) {
  Begun begun;
  Begun may_end;
  bool read = false;
  std::thread release;
  {
    EventsAhead ahead(std::make_unique<ToldStream>(
                          [&](std::size_t index) {
                            may_end.wait_for(1);
                            read = true;
                            return sweep(index);
                          },
                          begun),
                      {.sweeps = 9});
    begun.wait_for(1);
    release = std::thread([&] { may_end.add(); });
  }
  EXPECT_TRUE(read);
  release.join();
}

TEST(EventsAhead, WhatIsNoDamageIsTheEnd) {
  Begun begun;
  EventsAhead ahead(std::make_unique<ToldStream>(
      [](std::size_t index) -> std::optional<Event> {
        return index == 0 ? sweep(0) : throw std::bad_alloc();
      },
      begun));
  EXPECT_TRUE(ahead.next());
  EXPECT_THROW(ahead.next(), std::bad_alloc);
  EXPECT_FALSE(ahead.next());
  EXPECT_EQ(begun.count(), 2U);
}

TEST(EventsAhead, TellsWhenTheReaderWasBusy) {
  Begun begun;
  EventsAhead ahead(std::make_unique<ToldStream>(sweep, begun));
  std::chrono::steady_clock::time_point before{};
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(ahead.next());
    EXPECT_LE(before, ahead.last_read().begin);
    EXPECT_LE(ahead.last_read().begin, ahead.last_read().end);
    before = ahead.last_read().end;
  }
}

}  // namespace
}  // namespace adit
