// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Points of Pandar40P, PandarQT64, QT128C2X and XT32M2X: where and when the maker's formulas say.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"
#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/recordings/packet_support.hpp"
#include "adit/tests/recordings/sensor_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/packets/hesai_packets.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {
namespace {

using test::Bytes;

constexpr Nanoseconds kUtc = std::chrono::seconds(1'700'000'000);  // 2023-11-14, 22:13:20
constexpr double kTurn = 3600.0;                                   // degrees/s at 600 a minute

Datagram datagram(const Bytes& bytes) {
  return {.received = kUtc, .payload = bytes};
}

/// Azimuths of a packet from `first` on; `returns` blocks have the same.
std::vector<double> azimuths(std::size_t blocks, double first, double step,
                             std::size_t returns = 1) {
  std::vector<double> all;
  for (std::size_t block = 0; block < blocks; ++block) {
    all.push_back(first + step * static_cast<double>(block / returns));
  }
  return all;
}

Sweep sweep_of(const Bytes& packet) {
  const HesaiPacket layout = hesai_packet(datagram(packet)).value();
  HesaiSweeps sweeps(hesai_angles_by_design(layout).value());
  EXPECT_TRUE(sweeps.take(datagram(packet)).empty());
  return sweeps.finish().value();
}

/// A point by what the maker's formula says of it: us after the packet's time, degrees that the
/// rotor turned on since the azimuth of the block was read.
struct Expected {
  double azimuth = 0.0;
  double elevation = 0.0;
  double range = 0.0;
  double micros = 0.0;
};

void expect_point(const Sweep& sweep, std::size_t i, uint32_t packet_micros, const Expected& e) {
  const Point& p = sweep.points.at(i);
  const double azimuth = std::atan2(p.x, p.y) / kDegree;
  EXPECT_NEAR(azimuth, e.azimuth, 1e-3) << i;
  EXPECT_NEAR(std::atan2(p.z, std::hypot(p.x, p.y)) / kDegree, e.elevation, 1e-3) << i;
  EXPECT_NEAR(std::hypot(p.x, p.y, p.z), e.range, 1e-4) << i;
  const double after = seconds(sweep.stamp - kUtc) + static_cast<double>(sweep.times.at(i));
  EXPECT_NEAR(1e6 * after, packet_micros + e.micros, 0.02) << i;
}

TEST(Pandar40p, PointsAreWhereAndWhenTheManualSays) {
  const Bytes packet =
      test::pandar40p_packet(azimuths(10, 50.0, 0.2), 300'000, 0x37, false,
                             [](auto block, auto laser) { return 2500 + 10 * block + laser; });
  EXPECT_EQ(packet.size(), 1262U);
  const Sweep sweep = sweep_of(packet);
  ASSERT_EQ(sweep.points.size(), 400U);
  // Block 10 ends 28.58 us before the packet's time; channel 8 fires 54.67 us before that.
  expect_point(sweep, 9 * 40 + 7, 300'000,
               {.azimuth = 51.8 - 5.208 - kTurn * 54.67e-6,
                .elevation = 1.33,
                .range = 0.004 * (2500 + 90 + 7),
                .micros = -28.58 - 54.67});
  expect_point(sweep, 0, 300'000,
               {.azimuth = 50.0 - 1.042 - kTurn * 42.22e-6,
                .elevation = 15.0,
                .range = 10.0,
                .micros = -28.58 - 9 * 55.56 - 42.22});
  EXPECT_EQ(sweep.rings[0], 39);
  EXPECT_EQ(sweep.points[8].intensity, 8.0F);
}

TEST(Pandar40p, DualReturnsAreOfTheSameFiring) {
  const Bytes packet = test::pandar40p_packet(
      azimuths(10, 50.0, 0.2, 2), 300'000, 0x39, true, [](auto block, std::size_t laser) {
        return 2500 + (block % 2 == 1 && laser % 2 == 0 ? 100 : 0);
      });
  const Sweep sweep = sweep_of(packet);
  ASSERT_EQ(sweep.points.size(), 5U * 60U);
  expect_point(sweep, 40, 300'000,
               {.azimuth = 50.0 - 1.042 - kTurn * 42.22e-6,
                .elevation = 15.0,
                .range = 10.4,
                .micros = -28.58 - 4 * 55.56 - 42.22});
}

TEST(PandarQt64, PointsAreWhereAndWhenTheMakersSdkSays) {
  const Bytes packet =
      test::qt64_packet(azimuths(4, 80.0, 0.6), 300'000, 0x37,
                        [](auto block, auto laser) { return 1000 + 10 * block + laser; });
  EXPECT_EQ(packet.size(), 1072U);
  const Sweep sweep = sweep_of(packet);
  ASSERT_EQ(sweep.points.size(), 256U);
  expect_point(sweep, 3 * 64 + 16, 300'000,
               {.azimuth = 81.8 - 5.27 + kTurn * 36.61e-6,
                .elevation = -22.964,
                .range = 0.004 * (1000 + 30 + 16),
                .micros = 25.71 + 500.0 + 10.0 + 36.61});
  expect_point(sweep, 0, 300'000,
               {.azimuth = 80.0 + 8.736 + kTurn * 2.31e-6,
                .elevation = -52.121,
                .range = 4.0,
                .micros = 25.71 + 12.31});
  EXPECT_EQ(sweep.rings[0], 0);
  const Sweep dual = sweep_of(test::qt64_packet(azimuths(4, 80.0, 0.6, 2), 300'000, 0x39,
                                                [](auto block, auto) { return 900 + block; }));
  ASSERT_EQ(dual.points.size(), 256U);
  expect_point(dual, 3 * 64, 300'000,
               {.azimuth = 80.6 + 8.736 + kTurn * 2.31e-6,
                .elevation = -52.121,
                .range = 0.004 * 903,
                .micros = 25.71 + 166.667 + 12.31});
}

TEST(Qt128, PointsAreWhereAndWhenTheManualSays) {
  const auto range = [](std::size_t block, std::size_t laser) {
    // Channels that do not fire have no return.
    const bool silent = block == 0 ? laser < 32 : laser >= 32 && laser < 64;
    return silent ? 0 : 500 + 100 * block + laser;
  };
  const Bytes packet = test::qt128_packet({}, azimuths(2, 70.0, 0.4), 300'000, range);
  EXPECT_EQ(packet.size(), 1127U);
  const Sweep sweep = sweep_of(packet);
  ASSERT_EQ(sweep.points.size(), 2U * 96U);
  // Channel 33 in the first sequence, channel 5 in the second.
  expect_point(sweep, 0, 300'000,
               {.azimuth = 70.0 - 6.217 + kTurn * 27.656e-6,
                .elevation = -18.331,
                .range = 0.004 * 532,
                .micros = 9.0 + 27.656});
  expect_point(sweep, 96 + 4, 300'000,
               {.azimuth = 70.4 + 8.833 + kTurn * 56.168e-6,
                .elevation = -46.695,
                .range = 0.004 * 604,
                .micros = 9.0 + 111.11 + 56.168});
  for (const uint8_t mode_flag : {uint8_t{0}, uint8_t{1}}) {
    const Sweep dual = sweep_of(test::qt128_packet({.mode = 0x3b, .mode_flag = mode_flag},
                                                   azimuths(2, 70.0, 0.4, 2), 300'000,
                                                   [](auto block, auto) { return 500 + block; }));
    ASSERT_EQ(dual.points.size(), 256U);
    // Channel 65 fires after 1.456 us in the first sequence, 0.6 us in the second.
    const double micros = mode_flag == 1 ? 1.456 : 0.6;
    expect_point(dual, 128 + 64, 300'000,
                 {.azimuth = 70.0 + 5.949 + kTurn * 1e-6 * micros,
                  .elevation = 7.91,
                  .range = 0.004 * 501,
                  .micros = 9.0 + micros});
  }
}

TEST(Qt128, FlagsSayWhatFollowsTheBlocksAndTheLengthHowLongAChannelIs) {
  for (const int flags : {0x00, 0x01, 0x04, 0x05, 0x08, 0x0d, 0x0f}) {
    for (const std::size_t channel_bytes : {3U, 4U}) {
      const Bytes packet = test::qt128_packet(
          {.flags = static_cast<uint8_t>(flags), .channel_bytes = channel_bytes},
          azimuths(2, 70.0, 0.4), 300'000, [](auto, auto laser) { return 500 + laser; });
      const Sweep sweep = sweep_of(packet);
      ASSERT_EQ(sweep.points.size(), 256U) << flags;
      EXPECT_EQ(sweep.points[100].intensity, 100.0F);
      EXPECT_NEAR(seconds(sweep.stamp - kUtc), 0.3, 1e-3);
    }
  }
}

TEST(Xt32m, IsToldByItsPacketsOfSixBlocks) {
  const auto range = [](auto block, auto laser) { return 2500 + 10 * block + laser; };
  const Bytes packet = test::hesai_packet({}, azimuths(6, 30.0, 0.18), 300'000, range);
  EXPECT_EQ(packet.size(), 820U);
  EXPECT_EQ(hesai_packet(datagram(packet)).value().model, "XT32M2X");
  EXPECT_EQ(hesai_packet(datagram(test::hesai_packet({}, azimuths(8, 30.0, 0.18), 1, range)))
                .value()
                .model,
            "PandarXT-32");
}

TEST(Xt32m, PointsOfOneTwoAndThreeReturnsAreWhereAndWhenTheMakerSays) {
  for (const auto& [mode, returns] : {std::pair{0x37, 1U}, {0x39, 2U}, {0x3d, 3U}}) {
    Bytes packet =
        test::hesai_packet({.mode = static_cast<uint8_t>(mode)}, azimuths(6, 30.0, 0.18, returns),
                           300'000, [r = returns](std::size_t block, std::size_t laser) {
                             // Of odd lasers, further returns are the first once more.
                             return 2500 + laser + (laser % 2 == 0 ? 10 * (block % r) : 0);
                           });
    // The layout's motor turns 6000 tenths of a turn a minute.
    const Sweep sweep = sweep_of(packet);
    const std::size_t firings = 6 / returns;
    ASSERT_EQ(sweep.points.size(), firings * (32 + 16 * (returns - 1)));
    // Channels 1 and 17 fire together, 2.888 us after each other.
    const double last = static_cast<double>(firings - 1);
    expect_point(sweep, 18, 300'000,
                 {.azimuth = 30.0 + kTurn * 1e-6 * (6.0 + 2 * 2.888),
                  .elevation = 19.5 - 18 * 1.3,
                  .range = 0.004 * 2518,
                  .micros = 5.632 - 50.0 * last + 0.368 + 2 * 2.888});
    if (returns > 1) {
      expect_point(sweep, 32 + 1, 300'000,
                   {.azimuth = 30.0 + kTurn * 1e-6 * (6.0 + 2 * 2.888),
                    .elevation = 19.5 - 2 * 1.3,
                    .range = 0.004 * 2512,
                    .micros = 5.632 - 50.0 * last + 0.368 + 2 * 2.888});
    }
  }
}

TEST(HesaiModels, CutPacketsAreNone) {
  const auto range = [](auto, auto) { return 500; };
  for (const Bytes& whole : {test::pandar40p_packet(azimuths(10, 1.0, 0.2), 1, 0x37, false, range),
                             test::qt64_packet(azimuths(4, 1.0, 0.2), 1, 0x37, range),
                             test::hesai_packet({}, azimuths(6, 1.0, 0.2), 1, range)}) {
    ASSERT_TRUE(hesai_packet(datagram(whole)));
    for (std::size_t size = 0; size + 4 < whole.size(); ++size) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_FALSE(hesai_packet(datagram(cut)).has_value()) << size;
      const Datagram snapped{.received = kUtc, .payload = cut, .missing = whole.size() - size};
      EXPECT_FALSE(hesai_packet(snapped).has_value()) << size;
    }
  }
}

/// A turn and a half in packets of 10 degrees, as a capture.
Bytes capture(const std::function<Bytes(double, uint32_t)>& packet) {
  std::vector<test::CapturedFrame> frames;
  for (uint32_t i = 0; i < 54; ++i) {
    frames.push_back({kUtc + i * std::chrono::microseconds(2777),
                      test::frames_of(packet(std::fmod(10.0 * i, 360.0), 2777 * i), 2368).front()});
  }
  return test::pcap(frames);
}

TEST(HesaiModels, CapturesAreReadWithTheAnglesOfTheDesignOrWithTheirOwn) {
  const auto range = [](auto, auto) { return 500; };
  const test::TemporaryFolder folder;
  for (const auto& [name, noticed, packet] : std::vector<
           std::tuple<std::string, bool,
                      std::function<Bytes(double, uint32_t)>>>{{"Pandar40P", true,
                                                                [&](double first, uint32_t micros) {
                                                                  return test::pandar40p_packet(
                                                                      azimuths(10, first, 0.2),
                                                                      micros, 0x37, true, range);
                                                                }},
                                                               {"PandarQT64", true,
                                                                [&](double first, uint32_t micros) {
                                                                  return test::qt64_packet(
                                                                      azimuths(4, first, 0.6),
                                                                      micros, 0x37, range);
                                                                }},
                                                               {"QT128C2X", true,
                                                                [&](double first, uint32_t micros) {
                                                                  return test::qt128_packet(
                                                                      {}, azimuths(2, first, 0.4),
                                                                      micros, range);
                                                                }},
                                                               {"XT32M2X", false,
                                                                [&](double first, uint32_t micros) {
                                                                  return test::hesai_packet(
                                                                      {}, azimuths(6, first, 0.18),
                                                                      micros, range);
                                                                }},
                                                               {"PandarXT-32", false,
                                                                [&](double first, uint32_t micros) {
                                                                  return test::hesai_packet(
                                                                      {}, azimuths(8, first, 0.18),
                                                                      micros, range);
                                                                }}}) {
    const Bytes bytes = capture(packet);
    const auto file =
        folder.write("drive.pcap", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const auto recording = open_recording(file);
    EXPECT_NE(recording->description().find("capture of a Hesai " + name + ","), std::string::npos)
        << recording->description();
    EXPECT_EQ(recording->topics().at(0).messages, 2U) << name;
    ASSERT_EQ(recording->notices().size(), noticed ? 1U : 0U) << name;
    std::string table = "Channel,Elevation,Azimuth\n";
    for (int i = 1; i <= 128; ++i) {
      table += std::to_string(i) + ",7.5,0\n";
    }
    const auto own = open_recording(file, folder.write("angles.csv", table));
    EXPECT_TRUE(own->notices().empty()) << name;
    const test::ReadEvents read = test::read_all(*own);
    ASSERT_EQ(read.events.size(), 2U) << name;
    for (const Point& p : std::get<Sweep>(read.events[0].value).points) {
      ASSERT_NEAR(p.z, 2.0 * std::sin(7.5 * kDegree), 1e-5) << name;
    }
  }
}

}  // namespace
}  // namespace adit
