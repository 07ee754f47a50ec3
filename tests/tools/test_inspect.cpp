// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit inspect` on a clean recording and on ones that are each spoilt in one way: what is wrong is
// named, and nothing else is.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/tools/inspect_support.hpp"
#include "adit/tools/commands/command_inspect.hpp"
#include "adit/tools/inspection/recording_findings.hpp"
#include "adit/tools/topics/interval_histogram.hpp"

namespace adit {
namespace {

using test::clean_recording;
using test::Kinds;
using test::kinds;
using test::kinds_after;
using test::MovingRig;
using test::Recorded;
using test::write;

namespace fs = std::filesystem;

constexpr Nanoseconds kRigBegin = MovingRig::kBegin;

InspectCommandOptions of(const fs::path& recording) {
  InspectCommandOptions options;
  options.recording = recording;
  return options;
}

TEST(Inspect, NothingIsFoundInCleanRecordings) {
  for (int seed = 0; seed < 10; ++seed) {
    const test::TemporaryFolder folder;
    // Mounted in ever other ways, and turned in all of them.
    MovingRig rig{.seed = static_cast<uint64_t>(seed)};
    rig.T_lidar_imu.linear() = so3_exp({0.3 * seed, 0.5 * (seed % 3), 0.4 * seed});
    rig.T_lidar_imu.translation() << 0.1, -0.05 * seed, 0.2;
    EXPECT_EQ(kinds(write(folder, rig.record())), Kinds{}) << seed;
  }
}

TEST(Inspect, HiddenDirections) {
  EXPECT_EQ(kinds_after([](Recorded& event) {
              if (auto* sweep = std::get_if<Sweep>(&event.value)) {
                for (Point& p : sweep->points) {
                  if (p.y > 0.0F && -p.x > p.y) {  // from 135 to 180 degrees
                    p = {};
                  }
                }
              }
            }),
            Kinds{"blocked_sector /points"});
}

TEST(Inspect, AccelerometersWithoutGyroscope) {
  EXPECT_EQ(kinds_after([](Recorded& event) {
              if (auto* imu = std::get_if<ImuSample>(&event.value)) {
                imu->angular_velocity.setConstant(std::numeric_limits<double>::quiet_NaN());
              }
            }),
            Kinds{"no_gyroscope /imu"});
}

TEST(Inspect, ImpossibleReadingsOfAnAccelerometerAlone) {
  int readings = 0;
  const Kinds kinds = kinds_after([&](Recorded& event) {
    if (auto* imu = std::get_if<ImuSample>(&event.value)) {
      imu->angular_velocity.setConstant(std::numeric_limits<double>::quiet_NaN());
      if (++readings == 7) {
        imu->linear_acceleration.x() = 1e300;  // its square is not finite
      }
    }
  });
  EXPECT_EQ(std::ranges::count(kinds, "no_gyroscope /imu"), 1);
  EXPECT_EQ(std::ranges::count(kinds, "impossible_readings /imu"), 1);
  EXPECT_EQ(kinds.size(), 2U);
}

TEST(Inspect, AccelerometerInG) {
  EXPECT_EQ(kinds_after([](Recorded& event) {
              if (auto* imu = std::get_if<ImuSample>(&event.value)) {
                imu->linear_acceleration /= 9.80665;
              }
            }),
            Kinds{"accelerometer_unit /imu"});
}

TEST(Inspect, FlippedGravity) {
  EXPECT_EQ(kinds_after([](Recorded& event) {
              if (auto* imu = std::get_if<ImuSample>(&event.value)) {
                imu->linear_acceleration *= -1.0;
              }
            }),
            Kinds{"gravity_direction /imu"});
}

TEST(Inspect, RatesInDegreesPerSecond) {
  EXPECT_EQ(kinds_after([](Recorded& event) {
              if (auto* imu = std::get_if<ImuSample>(&event.value)) {
                imu->angular_velocity *= 57.3;
              }
            }),
            Kinds{"gyroscope_unit /imu"});
}

TEST(Inspect, LeapSecondsOfASensorOnTaiOrGpsTime) {
  for (const int seconds : {37, 18}) {
    const auto spoil = [&](Recorded& event) {
      if (auto* sweep = std::get_if<Sweep>(&event.value)) {
        sweep->stamp += std::chrono::seconds(seconds);
      }
    };
    EXPECT_EQ(kinds_after(spoil), Kinds{"clock_offset /points"});
  }
}

TEST(Inspect, ClockThatLeapsOnTheWay) {
  for (const int seconds : {37, -18}) {
    const auto spoil = [&](Recorded& event) {
      auto* imu = std::get_if<ImuSample>(&event.value);
      if (imu != nullptr && event.received - kRigBegin > std::chrono::seconds(4)) {
        imu->stamp += std::chrono::seconds(seconds);
      }
    };
    EXPECT_EQ(kinds_after(spoil), Kinds{"clock_leap /imu"}) << seconds;
  }
}

TEST(Inspect, ClockThatCountsFromTheStartOfTheSensor) {
  EXPECT_EQ(kinds_after([](Recorded& event) {
              if (auto* imu = std::get_if<ImuSample>(&event.value)) {
                imu->stamp -= kRigBegin - std::chrono::seconds(12);
              }
            }),
            Kinds{"clock_offset /imu"});
}

TEST(Inspect, SweepsWithoutTimes) {
  EXPECT_EQ(kinds_after([](Recorded& event) {
              if (auto* sweep = std::get_if<Sweep>(&event.value)) {
                sweep->times.clear();
              }
            }),
            Kinds{"no_point_times /points"});
}

TEST(Inspect, PointTimesInTheWrongUnit) {
  for (const float factor : {10.0F, 1e-2F}) {
    const auto spoil = [&](Recorded& event) {
      if (auto* sweep = std::get_if<Sweep>(&event.value)) {
        for (float& time : sweep->times) {
          time *= factor;
        }
      }
    };
    EXPECT_EQ(kinds_after(spoil), Kinds{"point_time_unit /points"}) << factor;
  }
}

TEST(Inspect, NanPoints) {
  const auto spoil_every = [](std::size_t step) {
    return [step](Recorded& event) {
      if (auto* sweep = std::get_if<Sweep>(&event.value)) {
        for (std::size_t i = 0; i < sweep->points.size(); i += step) {
          sweep->points[i].x = std::numeric_limits<float>::quiet_NaN();
        }
      }
    };
  };
  EXPECT_EQ(kinds_after(spoil_every(10)), Kinds{"nan_points /points"});
  EXPECT_EQ(kinds_after(spoil_every(1)), (Kinds{"empty_sweeps /points", "nan_points /points"}));
}

TEST(Inspect, GapInTheImu) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  std::erase_if(events, [](const Recorded& event) {
    const Nanoseconds at = event.received - kRigBegin;
    return event.topic == "/imu" && at > std::chrono::milliseconds(2000) &&
           at < std::chrono::milliseconds(2200);
  });
  const fs::path file = write(folder, events);
  EXPECT_EQ(kinds(file), Kinds{"gaps /imu"});
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(inspect_command(of(file), out, err), 1);
  EXPECT_NE(out.str().find("1 gap, the longest of 0.2"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("it starts 1.99"), std::string::npos) << out.str();
}

TEST(Inspect, RepeatedMessagesAndThoseOutOfOrder) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  for (std::size_t at : {100U, 300U}) {
    while (events[at].topic != "/imu") {
      ++at;
    }
    const Recorded again = events[at];
    events.insert(events.begin() + static_cast<long>(at), again);
  }
  EXPECT_EQ(kinds(write(folder, events)), Kinds{"repeated_stamps /imu"});
  events = clean_recording();
  const auto first = std::ranges::find_if(events, [](const Recorded& e) {
    return e.received > kRigBegin + std::chrono::seconds(1) && e.topic == "/imu";
  });
  const auto second =
      std::find_if(first + 1, events.end(), [](const Recorded& e) { return e.topic == "/imu"; });
  std::swap(first->value, second->value);
  EXPECT_EQ(kinds(write(folder, events)), Kinds{"stamps_go_back /imu"});
}

/// The pose of a frame of /tf.
Recorded transform(const char* child, Nanoseconds stamp) {
  return {"/tf", stamp + std::chrono::milliseconds(1),
          ReferencePose{stamp, "odom", child, Eigen::Isometry3d::Identity()}};
}

TEST(Inspect, FramesOfATransformTopicAreSeriesOfTheirOwn) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  for (int i = 0; i < 300; ++i) {
    const Nanoseconds at = kRigBegin + std::chrono::milliseconds(20 * i);
    events.push_back(transform("base_link", at));
    events.push_back(transform("left_wheel", at));  // the same stamps
    if (i % 10 == 0) {
      events.push_back(transform("map", at - std::chrono::milliseconds(5)));  // earlier ones
    }
  }
  std::ranges::stable_sort(events, {}, &Recorded::received);
  EXPECT_EQ(kinds(write(folder, events)), Kinds{});
  std::erase_if(events, [](const Recorded& event) {
    const auto* pose = std::get_if<ReferencePose>(&event.value);
    return pose != nullptr && pose->child == "base_link" &&
           pose->stamp - kRigBegin > std::chrono::seconds(2) &&
           pose->stamp - kRigBegin < std::chrono::seconds(3);
  });
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(inspect_command(of(write(folder, events)), out, err), 0) << out.str();
  EXPECT_NE(out.str().find("notice: /tf: of frame 'base_link' 1 gap, the longest of 1.0"),
            std::string::npos)
      << out.str();
}

TEST(Inspect, SimulatedTimeIsNoFaultOfASensor) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  for (Recorded& event : events) {  // counts from the simulation's start, half as fast
    const auto shift = [&](Nanoseconds& stamp) { stamp -= kRigBegin - std::chrono::seconds(12); };
    if (auto* sweep = std::get_if<Sweep>(&event.value)) {
      shift(sweep->stamp);
    } else if (auto* imu = std::get_if<ImuSample>(&event.value)) {
      shift(imu->stamp);
    } else if (auto* fix = std::get_if<GnssFix>(&event.value)) {
      shift(fix->stamp);
    }
    event.received = kRigBegin + 2 * (event.received - kRigBegin);
  }
  const std::vector<std::string> without = kinds(write(folder, events));
  EXPECT_EQ(std::ranges::count(without, "clock_offset /imu"), 1);
  const auto topic = [](const char* name, const char* type) {
    return Topic{name, type, TopicKind::other, 1};
  };
  EXPECT_TRUE(has_simulated_time({topic("/clock", "rosgraph_msgs/Clock")}));
  EXPECT_FALSE(has_simulated_time({topic("/clock", "std_msgs/Header")}));
  const fs::path file = test::write_mcap(folder / "simulated.mcap", events, {"/clock"});
  EXPECT_EQ(kinds(file), Kinds{"simulated_time"});
}

TEST(Inspect, TruncatedFile) {
  const test::TemporaryFolder folder;
  const fs::path file = write(folder, clean_recording());
  fs::resize_file(file, fs::file_size(file) * 2 / 3);
  EXPECT_EQ(kinds(file), Kinds{"damage"});
}

TEST(Inspect, RecordingWithoutSweeps) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  std::erase_if(events, [](const Recorded& event) { return event.topic == "/points"; });
  EXPECT_EQ(kinds(write(folder, events)), Kinds{"no_sweeps"});
}

TEST(Inspect, ImuWhoseMountingNothingTells) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  std::erase_if(events, [](const Recorded& event) { return event.topic == "/tf_static"; });
  EXPECT_EQ(kinds(write(folder, events)), Kinds{"mounting_unknown /imu"});
  EXPECT_EQ(kinds(write(folder, events),
                  {.file = {}, .overrides = {"imu.T_imu_lidar=[0,0,0.1,0,0,0,1]"}}),
            Kinds{});
}

TEST(Inspect, TableTellsWhatThereIs) {
  const test::TemporaryFolder folder;
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(inspect_command(of(write(folder, clean_recording())), out, err), 0);
  for (const char* part :
       {"60 sweeps on /points", "sensor_msgs/PointCloud2", "7200 points a sweep,",
        "rings; times in field 'time', unit 1 s", "lasts 99.7 ms", "acceleration 9.8",
        "offset to /points", "no fault found"}) {
    EXPECT_NE(out.str().find(part), std::string::npos) << part << "\n" << out.str();
  }
  EXPECT_EQ(inspect_command(of(folder / "none"), out, err), 1);
  EXPECT_NE(err.str().find("there is no such file or folder"), std::string::npos);
}

/// "no fault found" is no more than what was looked at.
TEST(Inspect, WhatCouldNotBeCheckedIsNamed) {
  const test::TemporaryFolder folder;
  const auto said = [&](const std::vector<Recorded>& events, bool json) {
    std::ostringstream out;
    std::ostringstream err;
    InspectCommandOptions options = of(write(folder, events));
    options.json = json;
    inspect_command(options, out, err);
    return out.str();
  };
  std::vector<Recorded> few;  // fewer sweeps than a comparison needs
  std::ranges::copy_if(clean_recording(), std::back_inserter(few), [](const Recorded& event) {
    return event.received < kRigBegin + std::chrono::seconds(1);
  });
  EXPECT_NE(said(few, false)
                .find("\nno fault found; not checked: clock and mounting of /imu against "
                      "the sweeps (there are too few sweeps"),
            std::string::npos)
      << said(few, false);
  EXPECT_EQ(nlohmann::json::parse(said(few, true))["not_checked"].size(), 1U);
  std::erase_if(few, [](const Recorded& event) {
    return event.topic == "/points" && event.received > kRigBegin + std::chrono::milliseconds(250);
  });
  EXPECT_NE(said(few, false).find("gaps on /points (there are too few messages)"),
            std::string::npos)
      << said(few, false);
  std::vector<Recorded> untimed = clean_recording();
  for (Recorded& event : untimed) {
    if (auto* sweep = std::get_if<Sweep>(&event.value)) {
      sweep->times.clear();
    }
  }
  EXPECT_NE(said(untimed, false).find("not checked: times of points on /points (there are none)"),
            std::string::npos)
      << said(untimed, false);
  std::vector<Recorded> unmounted = clean_recording();
  std::erase_if(unmounted, [](const Recorded& event) { return event.topic == "/tf_static"; });
  EXPECT_NE(said(unmounted, false).find("mounting of /imu (nothing says how it is mounted)"),
            std::string::npos)
      << said(unmounted, false);
}

TEST(TopicStatistics, MessagesOfOneMomentHaveNoRate) {
  TopicStatistics statistics;
  for (int i = 0; i < 3; ++i) {
    statistics.add({.value = ImuSample{.stamp = kRigBegin + Nanoseconds(i)}});
  }
  EXPECT_EQ(statistics.rate(), 0.0);
  EXPECT_FALSE(statistics.lasts());
  statistics.add({.value = ImuSample{.stamp = kRigBegin + std::chrono::seconds(3)}});
  EXPECT_NEAR(statistics.rate(), 1.0, 1e-9);
}

TEST(IntervalHistogram, QuantilesToOnePercent) {
  IntervalHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5), 0.0);
  for (int i = 1; i <= 1000; ++i) {
    histogram.add(0.001 * i);
  }
  histogram.add(1e9);
  histogram.add(1e-12);
  EXPECT_NEAR(histogram.quantile(0.5), 0.5, 0.005);
  EXPECT_NEAR(histogram.quantile(0.9), 0.9, 0.01);
  EXPECT_EQ(histogram.count(), 1002U);
  EXPECT_NEAR(static_cast<double>(histogram.longer_than(0.5)), 501.0, 10.0);
}

}  // namespace
}  // namespace adit
