// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit inspect` on a clean recording and on ones that are each spoilt in one way: what is wrong is
// named, and nothing else is.
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.hpp"
#include "tools/command_inspect.hpp"
#include "tools/interval_histogram.hpp"
#include "tools/recordings/mcap_writer.hpp"
#include "tools/recordings/ros_events.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr Nanoseconds kBegin{1623370000000000000};

/// One event and the topic it goes to.
struct Recorded {
  std::string topic;
  Nanoseconds received{0};
  EventValue value;
};

Sweep clean_sweep(Nanoseconds stamp, int seed) {
  Sweep sweep;
  sweep.stamp = stamp;
  for (int i = 0; i < 200; ++i) {
    const float angle = 0.0314F * static_cast<float>(i);
    sweep.points.push_back({5.0F * std::cos(angle), 5.0F * std::sin(angle),
                            0.01F * static_cast<float>((i * 7 + seed) % 50), 1.0F});
    sweep.times.push_back(0.0005F * static_cast<float>(i));
    sweep.rings.push_back(static_cast<uint16_t>(i % 16));
  }
  return sweep;
}

/// Five seconds: sweeps at 10 Hz, an IMU at 100 Hz with noise, GNSS at 1 Hz.
std::vector<Recorded> clean_recording(int seed = 0) {
  std::vector<Recorded> events;
  for (int i = 0; i < 500; ++i) {
    // Received a little late, by different amounts; the sensor's own clock jitters by 0.2 ms.
    const Nanoseconds stamp =
        kBegin + Nanoseconds(10000000LL * i + 200000 * ((i * 37 + seed) % 3 - 1));
    const Nanoseconds received = stamp + Nanoseconds(1000000 + 100000 * ((i * 13 + seed) % 20));
    const double wobble = 0.3 * std::sin(0.05 * i + seed);
    events.push_back({"/imu", received,
                      ImuSample{.stamp = stamp,
                                .angular_velocity = {0.1 * wobble, 0.02, wobble},
                                .linear_acceleration = {wobble, -0.5 * wobble, 9.81 + wobble}}});
    if (i % 10 == 9) {
      const Nanoseconds start = kBegin + Nanoseconds(10000000LL * (i - 9));
      events.push_back({"/points", start + Nanoseconds(102000000), clean_sweep(start, i + seed)});
    }
    if (i % 100 == 50) {
      events.push_back({"/fix", received,
                        GnssFix{.stamp = stamp,
                                .kind = GnssFixKind::single,
                                .latitude = 41.65,
                                .longitude = -0.88,
                                .altitude = 220.0,
                                .covariance = Eigen::Matrix3d::Identity()}});
    }
  }
  return events;
}

fs::path write(const test::TemporaryFolder& folder, const std::vector<Recorded>& events) {
  const fs::path file = folder / "drive.mcap";
  McapWriter writer(file, {.chunk_bytes = 20000});
  std::map<std::string, std::size_t> channels;
  for (const Recorded& event : events) {
    const ros::EncodedEvent message = ros::from_event(event.value, Encoding::cdr, "frame");
    if (!channels.contains(event.topic)) {
      channels[event.topic] = writer.add_channel({.topic = event.topic,
                                                  .type = message.type,
                                                  .encoding = Encoding::cdr,
                                                  .definition = {},
                                                  .messages = std::nullopt});
    }
    writer.write(channels[event.topic], event.received, message.bytes);
  }
  writer.close();
  return file;
}

/// "kind topic" of each finding.
std::vector<std::string> kinds(const fs::path& file) {
  std::ostringstream out;
  std::ostringstream err;
  const int code = inspect_command({.recording = file, .json = true}, out, err);
  EXPECT_EQ(err.str(), "");
  std::vector<std::string> found;
  bool problem = false;
  const nlohmann::json report = nlohmann::json::parse(out.str());
  for (const auto& finding : report["findings"]) {
    const std::string topic = finding["topic"];
    found.push_back(finding["kind"].get<std::string>() + (topic.empty() ? "" : " " + topic));
    problem = problem || finding["severity"] == "problem";
  }
  EXPECT_EQ(code, problem ? 1 : 0);
  return found;
}

using Kinds = std::vector<std::string>;

/// What is found once `spoil` was let at every event.
Kinds kinds_after(const std::function<void(Recorded&)>& spoil) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  for (Recorded& event : events) {
    spoil(event);
  }
  return kinds(write(folder, events));
}

TEST(Inspect, NothingIsFoundInCleanRecordings) {
  for (int seed = 0; seed < 10; ++seed) {
    const test::TemporaryFolder folder;
    EXPECT_EQ(kinds(write(folder, clean_recording(seed))), Kinds{}) << seed;
  }
}

TEST(Inspect, AccelerometerInG) {
  EXPECT_EQ(kinds_after([](Recorded& event) {
              if (auto* imu = std::get_if<ImuSample>(&event.value)) {
                imu->linear_acceleration /= 9.80665;
              }
            }),
            Kinds{"accelerometer_unit /imu"});
}

TEST(Inspect, FlippedGravityIsToldButMayBeTheMounting) {
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

TEST(Inspect, ClockThatCountsFromTheStartOfTheSensor) {
  EXPECT_EQ(kinds_after([](Recorded& event) {
              if (auto* imu = std::get_if<ImuSample>(&event.value)) {
                imu->stamp -= kBegin - std::chrono::seconds(12);
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

TEST(Inspect, SweepsOfNanPointsAlone) {
  EXPECT_EQ(kinds_after([](Recorded& event) {
              if (auto* sweep = std::get_if<Sweep>(&event.value)) {
                for (Point& point : sweep->points) {
                  point.x = std::numeric_limits<float>::quiet_NaN();
                }
              }
            }),
            Kinds{"empty_sweeps /points"});
}

TEST(Inspect, GapInTheImu) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  std::erase_if(events, [](const Recorded& event) {
    const Nanoseconds at = event.received - kBegin;
    return event.topic == "/imu" && at > std::chrono::milliseconds(2000) &&
           at < std::chrono::milliseconds(2200);
  });
  const fs::path file = write(folder, events);
  EXPECT_EQ(kinds(file), Kinds{"gaps /imu"});
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(inspect_command({.recording = file}, out, err), 1);
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
  std::swap(events[200].value, events[201].value);
  EXPECT_EQ(kinds(write(folder, events)), Kinds{"stamps_go_back /imu"});
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

TEST(Inspect, TableTellsWhatThereIs) {
  const test::TemporaryFolder folder;
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(inspect_command({.recording = write(folder, clean_recording())}, out, err), 0);
  for (const char* part :
       {"50 sweeps on /points", "sensor_msgs/PointCloud2", "200 points a sweep, 100.0 % of them",
        "rings; times over 99.5 ms", "acceleration 9.8", "nothing is wrong with it"}) {
    EXPECT_NE(out.str().find(part), std::string::npos) << part << "\n" << out.str();
  }
  EXPECT_EQ(inspect_command({.recording = folder / "none"}, out, err), 1);
  EXPECT_NE(err.str().find("there is no such file or folder"), std::string::npos);
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
