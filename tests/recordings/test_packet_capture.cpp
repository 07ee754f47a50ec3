// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Captures of the packets of Velodyne and Ouster sensors.
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"
#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/recordings/packet_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::Bytes;
using test::CapturedFrame;

constexpr Nanoseconds kHour{1'699'999'200'000'000'000};  // a whole one
constexpr uint32_t kMicrosecond = 1'000'000;             // when the first packet came, after that
static_assert(kHour % std::chrono::hours(1) == Nanoseconds(0));

void write(const fs::path& file, const Bytes& bytes) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}

std::vector<CapturedFrame> captured(const Bytes& payload, uint16_t port, Nanoseconds received,
                                    std::size_t most = 65000, uint16_t id = 1) {
  std::vector<CapturedFrame> frames;
  for (Bytes& frame : test::frames_of(payload, port, most, id)) {
    frames.push_back({received, std::move(frame)});
  }
  return frames;
}

void append(std::vector<CapturedFrame>& to, std::vector<CapturedFrame> frames) {
  std::ranges::move(frames, std::back_inserter(to));
}

struct Spin {
  uint8_t mode = 0x37;
  uint8_t model = 0x22;
  double block_time = 110.592e-6;  // s
  double step = 2.5;               // degrees a block
  int packets = 40;
};

/// A turning Velodyne whose laser i measures 10 m + i * 0.1 m. Position packets come in between.
std::vector<CapturedFrame> velodyne_frames(const Spin& spin) {
  std::vector<CapturedFrame> frames;
  const int turns = spin.mode == 0x39 ? 6 : 12;  // firings a packet
  for (int i = 0; i < spin.packets; ++i) {
    const double since = spin.block_time * turns * i;
    const auto microseconds = static_cast<uint32_t>(kMicrosecond + std::lround(1e6 * since));
    const Nanoseconds received = kHour + std::chrono::microseconds(microseconds + 1500);
    const Bytes packet = test::velodyne_packet(
        10.0 + spin.step * turns * i, spin.step, microseconds, spin.mode, spin.model,
        [&](std::size_t block, std::size_t k) {
          const bool second = spin.mode == 0x39 && block % 2 == 1 && k % 2 == 0;
          return k == 5 ? 0 : 5000 + 50 * k + (second ? 1000 : 0);
        });
    append(frames, captured(packet, 2368, received));
    if (i % 8 == 0) {
      append(frames,
             captured(test::position_packet(
                          "$GPRMC,220001,A,4139.0000,N,00052.8000,W,000.0,000.0,141123,,,A*67\r\n"),
                      8308, received));
    }
  }
  return frames;
}

std::vector<Sweep> sweeps_of(const test::ReadEvents& read) {
  std::vector<Sweep> sweeps;
  for (const Event& event : read.events) {
    if (const auto* sweep = std::get_if<Sweep>(&event.value)) {
      sweeps.push_back(*sweep);
    }
  }
  return sweeps;
}

/// Checks every point of the first sweep against what was measured. Returns how many there are.
std::size_t expect_points(const Sweep& sweep, const Spin& spin, double step, double elevation_0) {
  EXPECT_EQ(sweep.stamp, kHour + std::chrono::microseconds(kMicrosecond));
  const Point& first = sweep.points.at(0);  // laser 0, at azimuth 10 degrees: to the right
  EXPECT_NEAR(std::atan2(-first.y, first.x), 10.0 * kDegree, 1e-4);
  EXPECT_NEAR(std::atan2(first.z, std::hypot(first.x, first.y)), elevation_0 * kDegree, 2e-3);
  EXPECT_NEAR(std::hypot(first.x, first.y), 10.0 * std::cos(elevation_0 * kDegree), 1e-3);
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const double azimuth = std::atan2(-static_cast<double>(sweep.points[i].y),
                                      static_cast<double>(sweep.points[i].x)) /
                           kDegree;
    // It turns steadily, so the azimuth tells the time.
    const double turned = std::fmod(azimuth - 10.0 + 720.0, 360.0);
    const double expected = turned / spin.step * spin.block_time;
    const double wrapped = std::abs(static_cast<double>(sweep.times[i]) - expected);
    EXPECT_LT(wrapped, 1.5e-6) << i << ": " << sweep.times[i] << " " << expected;
  }
  EXPECT_NEAR(sweep.times.at(1), step, 1e-9);
  return sweep.points.size();
}

TEST(VelodyneCapture, Vlp16) {
  const test::TemporaryFolder folder;
  const Spin spin;
  write(folder / "drive.pcap", test::pcap(velodyne_frames(spin)));
  const auto recording = open_recording(folder / "drive.pcap");
  ASSERT_EQ(recording->topics().size(), 2U);
  // 40 packets of 30 degrees from 10 degrees on: through 0 three times, last at 1200 degrees.
  EXPECT_EQ(recording->topics()[0].messages, 4U);
  EXPECT_EQ(recording->description(), (folder / "drive.pcap").string() +
                                          ": capture of a Velodyne VLP-16, 0.0 s, 4 sweeps on "
                                          "/points");
  const test::ReadEvents read = test::read_all(*recording);
  EXPECT_TRUE(read.errors.empty());
  const std::vector<Sweep> sweeps = sweeps_of(read);
  ASSERT_EQ(sweeps.size(), 4U);
  // From 10 to 360 degrees there are 140 blocks of 31 returns: one laser never has any.
  EXPECT_EQ(expect_points(sweeps[0], spin, 2.304e-6, -15.0), 140U * 31U);
  EXPECT_EQ(sweeps[0].rings.at(0), 0);
  EXPECT_EQ(sweeps[0].rings.at(1), 8);
  EXPECT_EQ(sweeps[1].points.size(), 144U * 31U);
  EXPECT_NEAR(static_cast<double>((sweeps[1].stamp - sweeps[0].stamp).count()), 140 * 110592.0,
              1000.0);  // packets tell microseconds
  EXPECT_EQ(sweeps[0].points[1].intensity, 1.0F);
}

TEST(VelodyneCapture, Hdl32AndDualReturns) {
  const test::TemporaryFolder folder;
  const Spin single{.model = 0x21, .block_time = 46.08e-6};
  write(folder / "hdl.pcap", test::pcap(velodyne_frames(single)));
  const std::vector<Sweep> hdl = sweeps_of(test::read_all(*open_recording(folder / "hdl.pcap")));
  ASSERT_EQ(hdl.size(), 4U);
  EXPECT_EQ(expect_points(hdl[0], single, 1.152e-6, -30.67), 140U * 31U);
  EXPECT_EQ(hdl[0].rings.at(0), 0);
  EXPECT_EQ(hdl[0].rings.at(1), 16);
  for (const uint8_t model : {uint8_t{0x21}, uint8_t{0x22}}) {
    const Spin dual{.mode = 0x39,
                    .model = model,
                    .block_time = model == 0x21 ? 46.08e-6 : 110.592e-6,
                    .packets = 80};
    write(folder / "dual.pcap", test::pcap(velodyne_frames(dual)));
    const std::vector<Sweep> two = sweeps_of(test::read_all(*open_recording(folder / "dual.pcap")));
    ASSERT_EQ(two.size(), 4U);
    // The second return of every other laser is another one; the rest are the same and count once.
    EXPECT_EQ(two[0].points.size(), 140U * (31U + 16U));
    EXPECT_NEAR(two[0].times.back(), hdl[0].times.back() * (model == 0x21 ? 1.0 : 2.4), 3e-6);
  }
}

TEST(VelodyneCapture, PositionPacketsAreFixes) {
  const test::TemporaryFolder folder;
  write(folder / "drive.pcap", test::pcap(velodyne_frames({})));
  const test::ReadEvents read =
      test::read_all(*open_recording(folder / "drive.pcap"), {.topics = {1}});
  ASSERT_EQ(read.events.size(), 1U) << "a sentence that is repeated is one fix";
  const auto& fix = std::get<GnssFix>(read.events[0].value);
  EXPECT_NEAR(fix.latitude, 41.65, 1e-9);
  EXPECT_NEAR(fix.longitude, -0.88, 1e-9);
  EXPECT_EQ(fix.stamp, kHour + std::chrono::seconds(1));
  EXPECT_EQ(fix.kind, GnssFixKind::single);
}

TEST(VelodyneCapture, HourThatBeginsOnTheWay) {
  const test::TemporaryFolder folder;
  std::vector<CapturedFrame> frames;
  for (int i = 0; i < 12; ++i) {
    const int64_t since = 1327 * i - 4000;  // µs after the hour
    const auto microseconds = static_cast<uint32_t>((since + 3'600'000'000) % 3'600'000'000);
    append(frames, captured(test::velodyne_packet(60.0 * i, 5.0, microseconds, 0x37, 0x22,
                                                  [](auto, auto) { return 1000; }),
                            2368, kHour + std::chrono::microseconds(since + 100)));
  }
  write(folder / "drive.pcap", test::pcap(frames));
  const std::vector<Sweep> sweeps =
      sweeps_of(test::read_all(*open_recording(folder / "drive.pcap")));
  ASSERT_EQ(sweeps.size(), 2U);
  EXPECT_EQ(sweeps[0].stamp, kHour - std::chrono::microseconds(4000));
  EXPECT_NEAR(1e-9 * static_cast<double>((sweeps[1].stamp - sweeps[0].stamp).count()), 6 * 1327e-6,
              1e-9);
}

TEST(VelodyneCapture, ModelsThatAreNotKnownAreNamed) {
  const test::TemporaryFolder folder;
  write(folder / "drive.pcap", test::pcap(velodyne_frames({.model = 0x31})));
  try {
    open_recording(folder / "drive.pcap");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("its Velodyne is none of those that are read"), std::string::npos)
        << error.found();
    EXPECT_NE(error.remedy().find("VLP-32C and VLS-128"), std::string::npos) << error.remedy();
  }
}

TEST(PacketCapture, PcapngAndMicrosecondsTellTheSame) {
  const test::TemporaryFolder folder;
  const std::vector<CapturedFrame> frames = velodyne_frames({});
  write(folder / "a.pcap", test::pcap(frames));
  write(folder / "b.pcap", test::pcap(frames, false));
  write(folder / "c.pcapng", test::pcapng(frames));
  const auto a = test::read_all(*open_recording(folder / "a.pcap")).events;
  for (const char* name : {"b.pcap", "c.pcapng"}) {
    const auto b = test::read_all(*open_recording(folder / name)).events;
    ASSERT_EQ(a.size(), b.size()) << name;
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].received, b[i].received);
      EXPECT_EQ(stamp_of(a[i]), stamp_of(b[i]));
    }
  }
}

TEST(PacketCapture, CutOffAnywhereItGivesWhatIsBefore) {
  const test::TemporaryFolder folder;
  const std::vector<CapturedFrame> frames = velodyne_frames({.packets = 7});
  for (const Bytes& whole : {test::pcap(frames), test::pcapng(frames)}) {
    std::size_t most = 0;
    for (std::size_t size = 4; size <= whole.size(); size += size < 200 ? 1 : 97) {
      write(folder / "cut.pcap", Bytes(whole.begin(), whole.begin() + static_cast<long>(size)));
      try {
        const auto recording = open_recording(folder / "cut.pcap");
        const test::ReadEvents read = test::read_all(*recording);
        std::size_t points = 0;
        for (const Sweep& sweep : sweeps_of(read)) {
          points += sweep.points.size();
        }
        EXPECT_GE(points, most) << size;
        EXPECT_LE(read.errors.size(), 1U);
        most = std::max(most, points);
      } catch (const InputError& error) {
        EXPECT_EQ(most, 0U) << size << error.what();
      }
    }
    EXPECT_GT(most, 0U);
  }
}

class OusterCapture : public testing::TestWithParam<bool> {
 protected:
  static constexpr std::size_t kBeams = 8;

  bool legacy() const { return GetParam(); }
  void write_metadata(const char* name) {
    std::ofstream(folder_ / name) << test::ouster_metadata(
        kBeams, legacy() ? "LEGACY" : "RNG19_RFL8_SIG16_NIR16", !legacy());
  }
  /// Three frames of two packets each with IMU readings between them; beam b measures 10 m + b.
  std::vector<CapturedFrame> frames(std::size_t most) const {
    std::vector<CapturedFrame> all;
    for (uint16_t i = 0; i < 6; ++i) {
      const uint64_t time = 5'000'000'000ULL + 1'600'000ULL * i;
      const Bytes packet =
          test::ouster_packet(legacy(), kBeams, 16U * (i % 2U), static_cast<uint16_t>(i / 2), time,
                              [](std::size_t column, std::size_t beam) {
                                return column == 3 ? 0 : 10000 + 1000 * beam;
                              });
      const Nanoseconds received = kHour + Nanoseconds(static_cast<int64_t>(time));
      append(all, captured(packet, 7502, received, most, i));
      append(all, captured(test::ouster_imu_packet(time + 7), 7503, received));
    }
    return all;
  }

  test::TemporaryFolder folder_;
};

TEST_P(OusterCapture, SweepsImuAndMountings) {
  write_metadata("drive.json");
  for (const std::size_t most : {std::size_t{65000}, std::size_t{1480}}) {
    write(folder_ / "drive.pcap", test::pcap(frames(most)));
    const auto recording = open_recording(folder_ / "drive.pcap");
    EXPECT_EQ(recording->topics()[0].messages, 3U);
    EXPECT_EQ(recording->topics()[1].messages, 6U);
    const test::ReadEvents read = test::read_all(*recording);
    EXPECT_TRUE(read.errors.empty());
    const std::vector<Sweep> sweeps = sweeps_of(read);
    ASSERT_EQ(sweeps.size(), 3U);
    const Sweep& sweep = sweeps[1];
    ASSERT_EQ(sweep.points.size(), 32U * kBeams);
    EXPECT_EQ(sweep.stamp, Nanoseconds(5'003'200'000));
    EXPECT_NEAR(sweep.times.back(), 0.0031, 1e-7);
    EXPECT_EQ(sweep.rings.at(kBeams + 3), 3);
    EXPECT_EQ(sweep.points.at(3 * kBeams).x, 0.0F);  // no return
    // Beam 7 of column 8, a quarter of a turn on: -15 degrees down, 2 degrees aside.
    const Point& p = sweep.points.at(8 * kBeams + 7);
    const double flat = (17.0 - 0.015) * std::cos(15.0 * kDegree);
    EXPECT_NEAR(p.x, flat * std::cos(-90.0 * kDegree + 2.0 * kDegree), 1e-4);
    EXPECT_NEAR(p.y, flat * std::sin(-90.0 * kDegree + 2.0 * kDegree) - 0.015, 1e-4);
    EXPECT_NEAR(p.z, -(17.0 - 0.015) * std::sin(15.0 * kDegree), 1e-4);
    EXPECT_EQ(p.intensity, 107.0F);
  }
}

TEST_P(OusterCapture, ImuInSiUnits) {
  write_metadata("the_sensor.json");  // the only one there is
  write(folder_ / "drive.pcap", test::pcap(frames(65000)));
  const test::ReadEvents read =
      test::read_all(*open_recording(folder_ / "drive.pcap"), {.topics = {1, 2}});
  ASSERT_EQ(read.events.size(), 8U);
  const auto& lidar = std::get<StaticTransform>(read.events[0].value);
  EXPECT_EQ(lidar.parent, "os_sensor");
  EXPECT_EQ(lidar.child, "os_lidar");
  EXPECT_NEAR(lidar.T_parent_child.linear()(0, 0), -1.0, 1e-12);
  const auto& imu = std::get<ImuSample>(read.events[2].value);
  EXPECT_EQ(imu.stamp, Nanoseconds(5'000'000'007));
  EXPECT_TRUE(imu.linear_acceleration.isApprox(Eigen::Vector3d(0.0, 0.5, 1.0) * 9.80665, 1e-6));
  EXPECT_TRUE(imu.angular_velocity.isApprox(
      Eigen::Vector3d(std::numbers::pi, -std::numbers::pi / 2, 0.0), 1e-6));
  EXPECT_EQ(read.events[2].frame, "os_imu");
}

TEST_P(OusterCapture, WithoutOrWithWrongMetadataItSaysWhatIsMissing) {
  write(folder_ / "drive.pcap", test::pcap(frames(65000)));
  const auto found = [&] {
    try {
      open_recording(folder_ / "drive.pcap");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_NE(found().find("drive.json"), std::string::npos) << found();
  std::ofstream(folder_ / "drive.json") << test::ouster_metadata(16, "LEGACY");
  EXPECT_NE(found().find("is it of this sensor"), std::string::npos) << found();
  for (const char* bad : {"", "[]", "{\"beam_altitude_angles\": []}",
                          "{\"beam_altitude_angles\": [1], \"beam_azimuth_angles\": [\"a\"]}",
                          "{\"beam_altitude_angles\": [1], \"beam_azimuth_angles\": [1, 2]}",
                          "{\"beam_altitude_angles\": [1], \"beam_azimuth_angles\": [1]}",
                          "{\"udp_profile_lidar\": \"FIVE_WORD_PIXEL\"}"}) {
    std::ofstream(folder_ / "drive.json", std::ios::trunc) << bad;
    EXPECT_NE(found().find("drive.json"), std::string::npos) << bad << ": " << found();
  }
}

INSTANTIATE_TEST_SUITE_P(Profiles, OusterCapture, testing::Bool(),
                         [](const auto& test) { return test.param ? "legacy" : "rng19"; });

}  // namespace
}  // namespace adit
