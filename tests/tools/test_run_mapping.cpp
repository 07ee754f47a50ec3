// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/run_mapping.hpp"

#include <algorithm>
#include <csignal>
#include <deque>
#include <functional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "adit/engine/error.hpp"
#include "adit/slam/submaps/submap_cache.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/resident_memory.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

enum class Arrivals { as_they_come, sorted };

/// Places sweeps as it is told: as they come, or all at the end by their times.
class PlacedAsTold : public Slam {
 public:
  PlacedAsTold(std::function<SweepResult(const Sweep&)> place, Arrivals arrivals)
      : place_(std::move(place)), sorted_(arrivals == Arrivals::sorted) {}

  void add(Measurement measurement, std::string_view) override {
    waiting_.push_back(std::get<Sweep>(std::move(measurement)));
  }
  void add(const StaticTransform&) override {}
  void settle() override {}
  void flush() override {
    if (sorted_) {
      std::ranges::stable_sort(waiting_, {}, &Sweep::stamp);
    }
    flushed_ = true;
  }
  std::optional<SlamResult> next() override {
    if (waiting_.empty() || (sorted_ && !flushed_)) {
      return std::nullopt;
    }
    Sweep sweep = std::move(waiting_.front());
    waiting_.pop_front();
    if (last_ && sweep.stamp <= *last_) {
      return SweepLeftOut{.sweep = std::move(sweep), .last = *last_};
    }
    last_ = sweep.stamp;
    SweepResult result = place_(sweep);
    return SweepPlaced{.sweep = std::move(sweep), .result = std::move(result)};
  }
  std::optional<Mounting> mounting() const override { return std::nullopt; }
  const Config& config() const override { return config_; }
  std::optional<MapReport> finish_map() override { return std::nullopt; }

 private:
  Config config_;
  std::function<SweepResult(const Sweep&)> place_;
  bool sorted_;
  bool flushed_ = false;
  std::deque<Sweep> waiting_;
  std::optional<Nanoseconds> last_;
};

/// map_recording() with what it needs; the odometry is test::placed().
class MapRecording : public testing::Test {
 protected:
  MappingResult map(const Recording& recording, SweepRange range,
                    const std::function<SweepResult(const Sweep&)>& place = test::placed,
                    Arrivals arrivals = Arrivals::as_they_come,
                    const MemoryLimit* memory = nullptr) {
    RunOutputs outputs(folder_.path(), {});
    Progress progress(notes_, ProgressStyle::none, "mapping", range.count);
    PlacedAsTold slam(place, arrivals);
    MappingResult result = map_recording({.recording = recording,
                                          .topic = 0,
                                          .range = range,
                                          .slam = slam,
                                          .stop = [] { return StopSignal::received() != 0; },
                                          .damaged = damaged_,
                                          .memory = memory,
                                          .outputs = outputs,
                                          .statistics = statistics_,
                                          .timeline = timeline_,
                                          .progress = progress});
    outputs.close();
    return result;
  }

  std::size_t written() const { return test::lines(folder_ / "trajectory.tum"); }

  test::TemporaryFolder folder_;
  std::function<void(const InputError&)> damaged_;
  RunTimeline* timeline_ = nullptr;
  RunStatistics statistics_{Config{}};
  std::ostringstream notes_;
  StopSignal stop_;
};

TEST_F(MapRecording, TakesEverySweepOfTheRangeInOrder) {
  std::vector<std::size_t> read;
  test::MemoryRecording recording(10, [&](std::size_t index) { read.push_back(index); });
  const MappingResult result = map(recording, {.first = 3, .count = 4});
  EXPECT_EQ(result.end, RunEnd::completed);
  EXPECT_EQ(result.reason, "");
  ASSERT_GE(read.size(), 4U);
  EXPECT_LE(read.size(), 6U) << "not much farther than it needs";
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i], 3 + i);
  }
  EXPECT_EQ(written(), 4U);
  EXPECT_EQ(read_trajectory(folder_ / "trajectory.tum").poses.front().stamp,
            std::chrono::milliseconds(300));
}

TEST_F(MapRecording, DamageIsToldInItsPlaceAndPassedOver) {
  test::MemoryRecording recording(10, [](std::size_t index) {
    if (index == 2 || index == 6) {
      throw InputError("sweep_" + std::to_string(index), {}, "cut short", "Copy it again");
    }
  });
  std::vector<std::string> order;
  damaged_ = [&](const InputError& error) { order.push_back("not " + error.file().string()); };
  const MappingResult result = map(recording, {.first = 0, .count = 8}, [&](const Sweep& sweep) {
    order.push_back(sweep.source);
    return test::placed(sweep);
  });
  EXPECT_EQ(result.end, RunEnd::completed);
  EXPECT_EQ(order,
            (std::vector<std::string>{"sweep_0", "sweep_1", "not sweep_2", "sweep_3", "sweep_4",
                                      "sweep_5", "not sweep_6", "sweep_7", "sweep_8", "sweep_9"}));
}

TEST_F(MapRecording, TheTimelineHasWhatWasWrittenOfEachSweepInOrder) {
  RunTimeline timeline;
  timeline_ = &timeline;
  const test::MemoryRecording recording(5);
  const auto place = [](const Sweep& sweep) {
    SweepResult result = test::placed(sweep);
    const auto start = std::chrono::steady_clock::time_point{};
    using std::chrono::milliseconds;
    result.clock = {start, start + milliseconds(1), start + milliseconds(3),
                    start + milliseconds(4)};
    return result;
  };
  ASSERT_EQ(map(recording, {.first = 1, .count = 3}, place).end, RunEnd::completed);
  std::vector<std::size_t> on_the_device;
  std::size_t written = 0;
  for (const TimelineSpan& span : timeline.spans()) {
    if (span.lane == TimelineLane::device) {
      on_the_device.push_back(span.sweep);
      EXPECT_DOUBLE_EQ(span.span.ms(), 2.0);
    }
    written += span.lane == TimelineLane::write ? 1 : 0;
  }
  EXPECT_EQ(on_the_device, (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(written, 3U);
}

TEST_F(MapRecording, ASweepsTotalIsTimeOnTheClockAndHoldsItsWaits) {
  test::MemoryRecording recording(5);
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(map(recording, {.first = 0, .count = 5}).end, RunEnd::completed);
  const double wall =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  const auto ms = [&](std::string_view stage) {
    return std::ranges::find(statistics_.host_stages(), stage, &StageTimes::stage)->ms;
  };
  double sum = 0.0;
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_GE(ms("read").at(i), 0.0F);
    EXPECT_GE(ms("total").at(i) * 1.0001F, ms("read_wait").at(i) + ms("write").at(i));
    sum += static_cast<double>(ms("total").at(i));
  }
  EXPECT_GT(sum, 0.0);
  EXPECT_LE(sum, 1.0001 * wall);
}

TEST_F(MapRecording, EndsWhereMoreMemoryIsResidentThanMayBe) {
  constexpr uint64_t kMebibyte = uint64_t{1} << 20U;
  release_free_memory();  // what other tests have left
  const MemoryLimit limit(resident_bytes() + 16 * kMebibyte, 0);
  std::vector<char> taken;
  test::MemoryRecording recording(10);
  const auto place = [&](const Sweep& sweep) {
    if (sweep.source == "sweep_4") {
      taken.resize(64 * kMebibyte, 'x');
    }
    return test::placed(sweep);
  };
  const MappingResult result =
      map(recording, {.first = 0, .count = 10}, place, Arrivals::as_they_come, &limit);
  EXPECT_EQ(result.end, RunEnd::memory_limit);
  EXPECT_NE(result.reason.find("after 5 sweeps"), std::string::npos) << result.reason;
  EXPECT_EQ(written(), 5U);
  EXPECT_FALSE(taken.empty());
}

TEST_F(MapRecording, WithoutALimitOrFarBelowItNothingEnds) {
  test::MemoryRecording recording(10, [](std::size_t) {});
  for (const uint64_t most : {uint64_t{0}, uint64_t{1} << 50U}) {
    const MemoryLimit limit(most, 0);
    EXPECT_FALSE(limit.exceeded());
    EXPECT_EQ(
        map(recording, {.first = 0, .count = 10}, test::placed, Arrivals::as_they_come, &limit).end,
        RunEnd::completed);
    EXPECT_EQ(limit.submap_bytes(), kSubmapBytes);
  }
}

TEST(MemoryLimit, LessThanIsNeededIsAUsageError) {
  try {
    const MemoryLimit limit(uint64_t{3} << 20U, uint64_t{100} << 20U);
    FAIL() << "nothing runs in so little";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("100 MiB to work in"), std::string::npos);
  }
  const MemoryLimit limit(resident_bytes() + (uint64_t{120} << 20U), uint64_t{100} << 20U);
  EXPECT_GT(limit.submap_bytes(), uint64_t{24} << 20U);
  EXPECT_LT(limit.submap_bytes(), uint64_t{32} << 20U);
}

TEST(MemoryLimit, AGraphsShareHangsOnTheLimitAlone) {
  constexpr uint64_t kMebibyte = uint64_t{1} << 20U;
  const uint64_t most = resident_bytes() + 400 * kMebibyte;
  const MemoryLimit limit(most, 100 * kMebibyte, true);
  EXPECT_EQ(limit.map_memory().graph_bytes, most / 16);
  EXPECT_EQ(limit.map_memory().submap_bytes, limit.submap_bytes());
  EXPECT_EQ(MemoryLimit(0, 100 * kMebibyte, true).map_memory().graph_bytes,
            MapMemory{}.graph_bytes);
  const uint64_t enough_without = resident_bytes() + 104 * kMebibyte;
  EXPECT_NO_THROW(MemoryLimit(enough_without, 100 * kMebibyte));
  EXPECT_THROW(MemoryLimit(enough_without, 100 * kMebibyte, true), UsageError);
}

TEST_F(MapRecording, DamagedSweepEndsTheRunAndKeepsWhatCameBefore) {
  test::MemoryRecording recording(10, [](std::size_t index) {
    if (index == 6) {
      throw InputError("velodyne/000006.bin", Place::byte(16), "cut short", "Copy it again");
    }
  });
  const MappingResult result = map(recording, {.first = 0, .count = 10});
  EXPECT_EQ(result.end, RunEnd::input_error);
  EXPECT_NE(result.reason.find("velodyne/000006.bin, byte 16: cut short"), std::string::npos)
      << result.reason;
  EXPECT_EQ(written(), 6U);
  EXPECT_EQ(statistics_.sweeps(), 6U);
}

TEST_F(MapRecording, SweepsWhoseTimesDoNotRiseAreLeftOutAndTold) {
  // Stands still at 3, goes back at 6 and 7.
  const std::vector<int> tenths = {0, 1, 2, 2, 4, 5, 1, 3, 8, 9};
  const test::MemoryRecording recording(tenths.size(), {}, [&](std::size_t index) {
    return std::chrono::milliseconds(100 * tenths[index]);
  });
  EXPECT_EQ(map(recording, {.first = 0, .count = 10}).end, RunEnd::completed);
  EXPECT_EQ(statistics_.left_out().not_rising(), 3U);
  EXPECT_EQ(statistics_.sweeps(), 7U);
  const Trajectory trajectory = read_trajectory(folder_ / "trajectory.tum");
  ASSERT_EQ(trajectory.poses.size(), 7U);
  for (std::size_t i = 1; i < trajectory.poses.size(); ++i) {
    EXPECT_GT(trajectory.poses[i].stamp, trajectory.poses[i - 1].stamp);
  }
  for (const char* part :
       {"sweep 3 is left out: its time is that of a sweep that was taken before it",
        "sweep 6 is left out: its time is 0.400000 s before that of"}) {
    EXPECT_NE(notes_.str().find(part), std::string::npos) << notes_.str();
  }
  EXPECT_EQ(statistics_.left_out().text(),
            "3 sweeps whose time is not after that of the sweep before");
}

TEST_F(MapRecording, SweepsThatArePutInOrderAreTold) {
  // The door takes them in the order of their times, as it does where readings come too.
  const std::vector<int> tenths = {0, 1, 3, 2, 4, 5};
  const test::MemoryRecording recording(tenths.size(), {}, [&](std::size_t index) {
    return std::chrono::milliseconds(100 * tenths[index]);
  });
  EXPECT_EQ(map(recording, {.first = 0, .count = 6}, test::placed, Arrivals::sorted).end,
            RunEnd::completed);
  EXPECT_EQ(statistics_.sweeps(), 6U);
  EXPECT_FALSE(statistics_.left_out().any());
  EXPECT_EQ(statistics_.left_out().put_in_order(), 1U);
  EXPECT_NE(notes_.str().find("sweep 2 came after one with a later time"), std::string::npos)
      << notes_.str();
  EXPECT_EQ(statistics_.left_out().order_text(),
            "1 sweep that came after one with a later time, taken in the order of their times");
}

TEST_F(MapRecording, InterruptFinishesTheCurrentSweep) {
  test::MemoryRecording recording(10);
  const MappingResult result = map(recording, {.first = 0, .count = 10}, [](const Sweep& sweep) {
    if (sweep.source == "sweep_2") {
      std::raise(SIGINT);
    }
    return test::placed(sweep);
  });
  EXPECT_EQ(result.end, RunEnd::interrupted);
  EXPECT_EQ(StopSignal::received(), SIGINT);
  EXPECT_EQ(written(), 3U);
}

TEST_F(MapRecording, LostDeviceEndsTheRunAndKeepsWhatCameBefore) {
  test::MemoryRecording recording(10);
  const MappingResult result = map(recording, {.first = 0, .count = 10}, [](const Sweep& sweep) {
    if (sweep.source == "sweep_4") {
      throw engine::DeviceLost("the device was lost");
    }
    return test::placed(sweep);
  });
  EXPECT_EQ(result.end, RunEnd::device_error);
  EXPECT_EQ(result.reason, "the device was lost");
  EXPECT_EQ(written(), 4U);
}

TEST_F(MapRecording, WhateverElseGoesWrongEndsTheRunAndKeepsWhatCameBefore) {
  const auto fails_with = [&](const auto& error) {
    test::MemoryRecording recording(10);
    return map(recording, {.first = 0, .count = 10}, [&](const Sweep& sweep) {
      if (sweep.source == "sweep_4") {
        throw error;
      }
      return test::placed(sweep);
    });
  };
  const MappingResult broken = fails_with(std::logic_error("an accepted loop has no edge"));
  EXPECT_EQ(broken.end, RunEnd::failed);
  EXPECT_NE(broken.reason.find("an accepted loop has no edge"), std::string::npos) << broken.reason;
  EXPECT_EQ(written(), 4U);
  const MappingResult poor = fails_with(std::bad_alloc());
  EXPECT_EQ(poor.end, RunEnd::failed);
  EXPECT_NE(poor.reason.find("out of memory"), std::string::npos) << poor.reason;
  EXPECT_EQ(written(), 4U);
}

TEST_F(MapRecording, FailedSweepsAreNotedWithIndexFileAndReasonAndTheRunGoesOn) {
  test::MemoryRecording recording(20);
  const MappingResult result = map(recording, {.first = 0, .count = 20}, [](const Sweep& sweep) {
    SweepResult result_ = test::placed(sweep);
    if (sweep.stamp.count() > 0) {
      result_.state = OdometryState::coasting;
      result_.valid_points = 0;
      result_.keyframe = false;
    }
    return result_;
  });
  EXPECT_EQ(result.end, RunEnd::completed);
  EXPECT_EQ(written(), 20U);
  EXPECT_EQ(statistics_.failures().size(), 19U);
  EXPECT_NE(notes_.str().find("sweep 1 (sweep_1), coasting: none of its 3 points"),
            std::string::npos)
      << notes_.str();
  EXPECT_EQ(std::ranges::count(notes_.str(), '\n'), 6)
      << "five failures and the word that there are more";
}

TEST(StopSignal, NotesTheSignalAndGivesTheHandlersBack) {
  {
    const StopSignal stop;
    EXPECT_EQ(StopSignal::received(), 0);
    std::raise(SIGTERM);
    EXPECT_EQ(StopSignal::received(), SIGTERM);
  }
  EXPECT_EXIT(std::raise(SIGTERM), testing::KilledBySignal(SIGTERM), "");
}

TEST(StopSignal, ClosedTerminalIsNotedUnlessNohupHadItIgnored) {
  {
    const StopSignal stop;
    std::raise(SIGHUP);
    EXPECT_EQ(StopSignal::received(), SIGHUP);
  }
  const auto earlier = std::signal(SIGHUP, SIG_IGN);
  {
    const StopSignal stop;
    std::raise(SIGHUP);
    EXPECT_EQ(StopSignal::received(), 0);
  }
  EXPECT_EQ(std::signal(SIGHUP, earlier), SIG_IGN) << "as it was";
}

TEST(StopSignal, PipeWithoutAReaderEndsNothing) {
  const StopSignal stop;
  std::raise(SIGPIPE);
  EXPECT_EQ(StopSignal::received(), 0);
}

TEST(StopSignal, SecondSignalEndsTheProcess) {
  EXPECT_EXIT(
      {
        const StopSignal stop;
        std::raise(SIGINT);
        std::raise(SIGINT);
      },
      testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace adit
