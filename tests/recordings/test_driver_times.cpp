// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How the drivers of range sensors write the time of a point, each as its own source has it: the
// field, its type and unit, its zero, and what the header's stamp means beside it.
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tools/recordings/ros_clouds.hpp"
#include "adit/tools/recordings/ros_codec.hpp"

namespace adit::ros {
namespace {

constexpr Nanoseconds kStart{1700000000'400000000};  // start of the sweep
constexpr Nanoseconds kEnd = kStart + std::chrono::milliseconds(100);

template <class T>
constexpr uint8_t datatype() {
  if constexpr (std::is_same_v<T, uint32_t>) {
    return 6;
  } else if constexpr (std::is_same_v<T, float>) {
    return 7;
  } else {
    static_assert(std::is_same_v<T, double>);
    return 8;
  }
}

/// The sweep in a cloud whose points have these times in this field; points are NaN where the time
/// is, and get a valid time there.
template <class T>
Sweep sweep_with(Nanoseconds header, const std::string& field, const std::vector<T>& times,
                 std::size_t nan_point = std::numeric_limits<std::size_t>::max()) {
  constexpr std::size_t kStep = 12 + sizeof(T);
  std::vector<std::byte> data(kStep * times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float p[3] = {i == nan_point ? nan : 1.0F, 2.0F, 3.0F};
    std::memcpy(data.data() + kStep * i, p, sizeof p);
    std::memcpy(data.data() + kStep * i + 12, &times[i], sizeof(T));
  }
  PointCloud2 cloud;
  cloud.header.stamp = header;
  cloud.width = static_cast<uint32_t>(times.size());
  cloud.fields = {{"x", 0, 7, 1}, {"y", 4, 7, 1}, {"z", 8, 7, 1}, {field, 12, datatype<T>(), 1}};
  cloud.point_step = kStep;
  cloud.row_step = static_cast<uint32_t>(data.size());
  cloud.data = data;
  return to_sweep(cloud, header, "driver.mcap").sweep;
}

/// The sweep starts at kStart to `tolerance` and its points were taken at these times after it (s).
void expect_times(const Sweep& sweep, const std::vector<float>& times,
                  Nanoseconds tolerance = Nanoseconds(0)) {
  EXPECT_LE(std::chrono::abs(sweep.stamp - kStart), tolerance) << sweep.stamp.count();
  ASSERT_EQ(sweep.times.size(), times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_NEAR(sweep.times[i], times[i], 1e-9 + 1e-9 * static_cast<double>(tolerance.count()))
        << i;
  }
}

TEST(DriverTimes, VelodyneStampedWithItsLastPacket) {
  expect_times(sweep_with<float>(kEnd, "time", {-0.1F, -0.05F, 0.0F}), {0.0F, 0.05F, 0.1F},
               Nanoseconds(10));
}

TEST(DriverTimes, VelodyneStampedWithItsFirstPacket) {
  expect_times(sweep_with<float>(kStart, "time", {0.0F, 0.05F, 0.1F}), {0.0F, 0.05F, 0.1F});
}

TEST(DriverTimes, OusterNanosecondsOutOfOrder) {
  expect_times(sweep_with<uint32_t>(kStart, "t", {100000000, 0, 50000000}), {0.1F, 0.0F, 0.05F});
}

TEST(DriverTimes, LivoxAbsoluteNanosecondsAsDoubles) {
  const double start = static_cast<double>(kStart.count());
  expect_times(sweep_with<double>(kStart, "timestamp", {start, start + 5e7, start + 1e8}),
               {0.0F, 0.05F, 0.1F}, Nanoseconds(256));
}

TEST(DriverTimes, LivoxCustomMessageFromItsTimebase) {
  LivoxCustomMsg message;
  message.timebase = static_cast<uint64_t>(kStart.count());
  message.points = {
      {0, 1, 1, 1, 0, 0, 0}, {50000000, 1, 1, 1, 0, 0, 0}, {100000000, 1, 1, 1, 0, 0, 0}};
  expect_times(to_sweep(message, kEnd).sweep, {0.0F, 0.05F, 0.1F});
  message.timebase = 0;  // a driver without time synchronisation
  expect_times(to_sweep(message, kStart).sweep, {0.0F, 0.05F, 0.1F});
}

TEST(DriverTimes, HesaiAbsoluteSeconds) {
  const double start = seconds(kStart);
  expect_times(sweep_with<double>(kStart, "timestamp", {start, start + 0.05, start + 0.1}),
               {0.0F, 0.05F, 0.1F}, Nanoseconds(240));
}

TEST(DriverTimes, RoboSenseStampedWithItsLastPointAndWithNanPoints) {
  const double start = seconds(kStart);
  const Sweep sweep =
      sweep_with<double>(kEnd, "timestamp", {start, start + 0.05, start + 0.1, start - 7.0}, 3);
  EXPECT_EQ(sweep.times.at(3), 0.0F) << "the time of a point without return does not count";
  expect_times(sweep, {0.0F, 0.05F, 0.1F, 0.0F}, Nanoseconds(240));
}

TEST(DriverTimes, OthersInMillisecondsAndMicroseconds) {
  expect_times(sweep_with<float>(kStart, "time_stamp", {0.0F, 50.0F, 100.0F}), {0.0F, 0.05F, 0.1F});
  expect_times(sweep_with<uint32_t>(kStart, "offset_time", {0, 50000, 100000}),
               {0.0F, 0.05F, 0.1F});
  expect_times(sweep_with<double>(kStart, "time", {0.0, 50000.0, 100000.0}), {0.0F, 0.05F, 0.1F});
}

TEST(DriverTimes, WithoutTheFieldThereAreNoTimes) {
  const Sweep sweep = sweep_with<float>(kStart, "curvature_of_the_wall", {1.0F, 2.0F});
  EXPECT_EQ(sweep.stamp, kStart);
  EXPECT_TRUE(sweep.times.empty());
}

TEST(DriverTimes, AbsoluteSecondsInSinglePrecisionAreRefused) {
  const auto start = static_cast<float>(seconds(kStart));
  try {
    sweep_with<float>(kStart, "timestamp", {start, start + 128.0F * 3.0F, start + 128.0F * 5.0F});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("float32"), std::string::npos) << error.found();
    EXPECT_NE(error.remedy().find("float64"), std::string::npos) << error.remedy();
  }
}

}  // namespace
}  // namespace adit::ros
