// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Packets of Ouster's profiles, of Hesai and of Livox, made after the published layouts: how many
// points there are, where, and when.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/recordings/packet_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/packets/hesai_packets.hpp"
#include "adit/tools/packets/livox_packets.hpp"
#include "adit/tools/packets/ouster_packets.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/recordings/ros_visit.hpp"

namespace adit {
namespace {

using test::Bytes;

constexpr Nanoseconds kSecond{1'000'000'000};
constexpr Nanoseconds kUtcOffset = 1'700'000'000 * kSecond;  // 2023-11-14, 22:13:20

Datagram packet_in_datagram(const Bytes& bytes, Nanoseconds received = kUtcOffset) {
  return {.received = received, .payload = bytes};
}

float distance(const Point& p) {
  return std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
}

struct ProfileCase {
  const char* name;
  std::size_t pixel_bytes;
  double unit;            ///< m
  std::size_t second_at;  ///< byte of the second return; 0: there is none
  std::size_t intensity_at;
};

TEST(OusterProfiles, RangesReturnsAndFramesAreThoseOfTheLayout) {
  const test::TemporaryFolder folder;
  for (const ProfileCase& c : {ProfileCase{"RNG19_RFL8_SIG16_NIR16", 12, 0.001, 0, 6},
                               {"RNG19_RFL8_SIG16_NIR16_DUAL", 16, 0.001, 4, 8},
                               {"RNG15_RFL8_NIR8", 4, 0.008, 0, 2},
                               {"RNG15_RFL8_NIR8_DUAL", 8, 0.008, 4, 2},
                               {"FUSA_RNG15_RFL8_NIR8_DUAL", 8, 0.008, 4, 2}}) {
    const OusterSensor sensor =
        read_ouster_sensor(folder.write("m.json", test::ouster_metadata(2, c.name, true)));
    const bool fusa = std::string(c.name).starts_with("FUSA");
    const auto write = [&](Bytes& bytes, std::size_t at, std::size_t column, std::size_t beam) {
      // The bits above the range are flags or the reflectivity.
      const uint32_t above = c.unit > 0.001 ? 0x8000U : 0xf8000000U;
      test::put(bytes, at, (1000 + static_cast<uint32_t>(10 * column + beam)) | above);
      if (c.second_at > 0 && column % 2 == 0) {  // an echo behind; elsewhere there is none
        test::put(bytes, at + c.second_at, 2000U | above);
      }
      bytes.at(at + c.intensity_at) = std::byte{42};
    };
    OusterSweeps sweeps(sensor);
    std::vector<Sweep> whole;
    for (uint32_t packet = 0; packet < 3; ++packet) {  // two of a frame, one of the next
      const Bytes bytes = test::ouster_profile_packet(c.pixel_bytes, fusa, 2, 16 * (packet % 2),
                                                      70000 + packet / 2, 1600000 * packet, write);
      ASSERT_EQ(bytes.size(), sensor.packet_bytes()) << c.name;
      ASSERT_TRUE(is_ouster_data(packet_in_datagram(bytes), sensor)) << c.name;
      for (Sweep& sweep : sweeps.take(packet_in_datagram(bytes))) {
        whole.push_back(std::move(sweep));
      }
    }
    ASSERT_EQ(whole.size(), 1U) << c.name;
    const Sweep& sweep = whole[0];
    EXPECT_EQ(sweep.points.size(), c.second_at > 0 ? 96U : 64U) << c.name;
    const std::size_t step = c.second_at > 0 ? 2 : 1;
    EXPECT_NEAR(distance(sweep.points[0]), 1000 * c.unit, 2e-2) << c.name;
    EXPECT_NEAR(distance(sweep.points[step]), 1001 * c.unit, 2e-2) << c.name;
    EXPECT_EQ(sweep.points[0].intensity, 42.0F) << c.name;
    if (c.second_at > 0) {
      EXPECT_NEAR(distance(sweep.points[1]), 2000 * c.unit, 2e-2) << c.name;
      EXPECT_EQ(sweep.rings[1], sweep.rings[0]);
    }
    EXPECT_FLOAT_EQ(sweep.times.back(), 3.1e-3F) << c.name;
    EXPECT_EQ(sweeps.finish().value().stamp, Nanoseconds(3200000));
  }
}

TEST(OusterProfiles, LegacyPacketsThatTellTheirFrameInTheFirstColumnAloneAreOneSweep) {
  const test::TemporaryFolder folder;
  const OusterSensor sensor =
      read_ouster_sensor(folder.write("m.json", test::ouster_metadata(2, "LEGACY")));
  OusterSweeps sweeps(sensor);
  for (const std::size_t first : {0U, 16U}) {
    Bytes packet =
        test::ouster_packet(true, 2, first, 7, 100000 * first, [](auto, auto) { return 3000; });
    for (std::size_t column = 1; column < 16; ++column) {  // as ouster-sdk writes them
      test::put(packet, column * sensor.column_bytes() + 10, uint16_t{0});
    }
    EXPECT_TRUE(sweeps.take(packet_in_datagram(packet)).empty());
  }
  EXPECT_EQ(sweeps.finish().value().points.size(), 64U);
}

TEST(OusterProfiles, CaptureIsReadWithMetadataThatIsNamed) {
  const test::TemporaryFolder folder;
  const auto write = [](Bytes& bytes, std::size_t at, std::size_t, std::size_t) {
    test::put(bytes, at, 500U);
  };
  std::vector<test::CapturedFrame> frames;
  for (uint32_t i = 0; i < 4; ++i) {
    const Bytes packet = test::ouster_profile_packet(4, false, 2, 0, i, 100000000 * i, write);
    frames.push_back({kUtcOffset, test::frames_of(packet, 7502).front()});
  }
  const Bytes bytes = test::pcap(frames);
  folder.write("a/drive.pcap", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  folder.write("b/sensor.json", test::ouster_metadata(2, "RNG15_RFL8_NIR8"));
  EXPECT_THROW(open_recording(folder / "a/drive.pcap"), InputError);
  const auto recording = open_recording(folder / "a/drive.pcap", folder / "b/sensor.json");
  EXPECT_EQ(recording->topics().at(0).messages, 4U);
  const test::ReadEvents read = test::read_all(*recording, {.topics = {0}});
  ASSERT_EQ(read.events.size(), 4U);
  EXPECT_NEAR(distance(std::get<Sweep>(read.events[3].value).points.at(0)), 4.0F, 0.02F);
}

TEST(OusterMessages, PacketsInMessagesAreSweepsReadingsAndMountings) {
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    const test::TemporaryFolder folder;
    McapWriter writer(folder / "drive.mcap", {});
    const auto channel = [&](const char* topic, const char* type) {
      return writer.add_channel({.topic = topic,
                                 .type = type,
                                 .encoding = encoding,
                                 .definition = {},
                                 .messages = std::nullopt});
    };
    const char* type =
        encoding == Encoding::ros1 ? "ouster_ros/PacketMsg" : "ouster_sensor_msgs/PacketMsg";
    const std::size_t lidar = channel("/ouster/lidar_packets", type);
    const std::size_t imu = channel("/ouster/imu_packets", type);
    const std::size_t metadata = channel("/ouster/metadata", "std_msgs/String");
    writer.write(metadata, kUtcOffset,
                 ros::encode(encoding, ros::String{test::ouster_metadata(2, "LEGACY")}));
    for (uint16_t i = 0; i < 6; ++i) {
      const Nanoseconds at = kUtcOffset + i * kSecond / 10;
      const Bytes packet = test::ouster_packet(true, 2, 0, i, static_cast<uint64_t>(at.count()),
                                               [](auto, auto) { return 3000; });
      writer.write(lidar, at, ros::encode(encoding, ros::PacketMsg{packet}));
      const Bytes reading = test::ouster_imu_packet(static_cast<uint64_t>(at.count()));
      writer.write(imu, at, ros::encode(encoding, ros::PacketMsg{reading}));
    }
    writer.write(lidar, kUtcOffset + kSecond, Bytes(3));  // no whole message
    writer.close();
    const auto recording = open_recording(folder / "drive.mcap");
    ASSERT_EQ(recording->topics().size(), 4U);
    EXPECT_EQ(recording->topics()[0].kind, TopicKind::sweeps);
    EXPECT_EQ(recording->topics()[0].messages, 6U) << "sweeps, not packets";
    EXPECT_EQ(recording->topics()[1].kind, TopicKind::imu);
    EXPECT_EQ(recording->topics()[3].kind, TopicKind::transforms);
    const test::ReadEvents all = test::read_all(*recording, {});
    EXPECT_EQ(all.errors.size(), 1U);
    EXPECT_EQ(all.events.size(), 6U + 6U + 2U);
    const test::ReadEvents later = test::read_all(*recording, {.topics = {0}, .skip = 4});
    ASSERT_EQ(later.events.size(), 2U);
    const Sweep& last = std::get<Sweep>(later.events[1].value);
    EXPECT_EQ(last.stamp, kUtcOffset + kSecond / 2);
    EXPECT_EQ(last.points.size(), 32U);
    EXPECT_EQ(later.events[1].number, 5U);
    const test::ReadEvents mountings = test::read_all(*recording, {.topics = {3}});
    ASSERT_EQ(mountings.events.size(), 2U);
    EXPECT_EQ(std::get<StaticTransform>(mountings.events[1].value).child, "os_imu");
  }
}

TEST(OusterMessages, PacketsThatCameTwiceOrInAnotherOrderGiveTheSameEvents) {
  const auto events_of = [](const std::vector<uint16_t>& order) {
    const test::TemporaryFolder folder;
    McapWriter writer(folder / "drive.mcap", {});
    const auto channel = [&](const char* topic, const char* type) {
      return writer.add_channel({.topic = topic,
                                 .type = type,
                                 .encoding = Encoding::cdr,
                                 .definition = {},
                                 .messages = std::nullopt});
    };
    const std::size_t lidar = channel("/ouster/lidar_packets", "ouster_sensor_msgs/PacketMsg");
    const std::size_t other = channel("/imu", "sensor_msgs/Imu");
    const std::size_t metadata = channel("/ouster/metadata", "std_msgs/String");
    writer.write(metadata, kUtcOffset,
                 ros::encode(Encoding::cdr, ros::String{test::ouster_metadata(2, "LEGACY")}));
    Nanoseconds at = kUtcOffset;
    for (const uint16_t i : order) {
      at += kSecond / 100;
      const auto time = static_cast<uint64_t>((kUtcOffset + i * kSecond / 100).count());
      const Bytes packet =
          test::ouster_packet(true, 2, 16 * (i % 2U), i / 2, time, [](auto, auto) { return 3000; });
      writer.write(lidar, at, ros::encode(Encoding::cdr, ros::PacketMsg{packet}));
      if (i % 5 == 4) {  // of another sensor, which keeps its place
        writer.write(other, at, ros::encode(Encoding::cdr, ros::Imu{}));
      }
    }
    writer.close();
    const auto recording = open_recording(folder / "drive.mcap");
    std::vector<std::pair<std::size_t, Nanoseconds>> events;
    const test::ReadEvents read = test::read_all(*recording);
    EXPECT_TRUE(read.errors.empty());
    for (const Event& event : read.events) {
      const auto* sweep = std::get_if<Sweep>(&event.value);
      events.emplace_back(event.topic, sweep != nullptr ? sweep->stamp : Nanoseconds(0));
    }
    return std::tuple(events, recording->topics().at(0).messages, recording->notices().size());
  };
  std::vector<uint16_t> order;
  for (uint16_t i = 0; i < 90; ++i) {
    order.push_back(i);
  }
  const auto [events, sweeps, notices] = events_of(order);
  EXPECT_EQ(sweeps, 45U);
  EXPECT_EQ(notices, 0U);
  EXPECT_EQ(events.size(), 45U + 18U + 2U);
  std::swap(order[20], order[21]);
  std::swap(order[31], order[32]);
  order.insert(order.begin() + 48, order[47]);
  const auto [mended, same_sweeps, two] = events_of(order);
  EXPECT_EQ(mended, events);
  EXPECT_EQ(same_sweeps, sweeps);
  EXPECT_EQ(two, 2U) << "repeated, reordered";
}

TEST(OusterMessages, WithoutMetadataTheyAreNothingThatIsUnderstood) {
  const test::TemporaryFolder folder;
  McapWriter writer(folder / "drive.mcap", {});
  const std::size_t lidar = writer.add_channel({.topic = "/os_node/lidar_packets",
                                                .type = "ouster_ros/PacketMsg",
                                                .encoding = Encoding::ros1,
                                                .definition = {},
                                                .messages = std::nullopt});
  const Bytes packet = test::ouster_packet(true, 2, 0, 1, 5, [](auto, auto) { return 3000; });
  writer.write(lidar, kUtcOffset, ros::encode(Encoding::ros1, ros::PacketMsg{packet}));
  writer.close();
  EXPECT_EQ(open_recording(folder / "drive.mcap")->topics().at(0).kind, TopicKind::other);
  folder.write("m/sensor.json", test::ouster_metadata(2, "LEGACY"));
  const auto recording = open_recording(folder / "drive.mcap", folder / "m/sensor.json");
  EXPECT_EQ(recording->topics().at(0).kind, TopicKind::sweeps);
}

TEST(Livox, PointsInMillimetresAndCentimetresWithTheirTimes) {
  for (const bool centimetres : {false, true}) {
    const std::vector<std::array<int32_t, 5>> points = {{1000, -2000, 3000, 40, 0x00},
                                                        {0, 0, 0, 0, 0x00},            // no return
                                                        {4000, 5000, 6000, 50, 0x20},  // noise
                                                        {-70, 80, 90, 60, 0x10}};
    LivoxSweeps sweeps;
    std::vector<Sweep> whole;
    for (int i = 0; i < 5; ++i) {  // 40 ms apart: three to a sweep
      const Bytes packet = test::livox_packet(
          static_cast<uint64_t>((kUtcOffset + std::chrono::milliseconds(40 * i)).count()), points,
          centimetres);
      ASSERT_TRUE(is_livox_data(packet_in_datagram(packet)));
      for (Sweep& sweep : sweeps.take(packet_in_datagram(packet))) {
        whole.push_back(std::move(sweep));
      }
    }
    ASSERT_EQ(whole.size(), 1U);
    const Sweep& sweep = whole[0];
    EXPECT_EQ(sweep.stamp, kUtcOffset);
    ASSERT_EQ(sweep.points.size(), 6U);
    EXPECT_FLOAT_EQ(sweep.points[0].y, -2.0F);
    EXPECT_FLOAT_EQ(sweep.points[0].intensity, 40.0F);
    EXPECT_FLOAT_EQ(sweep.points[1].x, -0.07F);
    EXPECT_FLOAT_EQ(sweep.times[1], 3e-6F);
    EXPECT_FLOAT_EQ(sweep.times[2], 0.04F);
    EXPECT_EQ(sweeps.finish().value().stamp, kUtcOffset + std::chrono::milliseconds(120));
  }
  Bytes cut = test::livox_packet(1, {{1, 2, 3, 4, 5}});
  cut.pop_back();
  EXPECT_FALSE(is_livox_data(packet_in_datagram(cut)));
}

TEST(Livox, CaptureHasPointsAndReadings) {
  const test::TemporaryFolder folder;
  std::vector<test::CapturedFrame> frames;
  for (int i = 0; i < 30; ++i) {
    const Nanoseconds at = kUtcOffset + std::chrono::milliseconds(10 * i);
    const auto time = static_cast<uint64_t>(at.count());
    frames.push_back(
        {at, test::frames_of(test::livox_packet(time, {{1000, 0, 0, 9, 0}}), 56301).front()});
    frames.push_back({at, test::frames_of(test::livox_imu_packet(time), 56301).front()});
  }
  const Bytes bytes = test::pcap(frames);
  folder.write("drive.pcap", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  const auto recording = open_recording(folder / "drive.pcap");
  EXPECT_EQ(recording->topics().at(0).messages, 3U);
  const test::ReadEvents imu = test::read_all(*recording, {.topics = {1}});
  ASSERT_EQ(imu.events.size(), 30U);
  const auto& sample = std::get<ImuSample>(imu.events[29].value);
  EXPECT_EQ(sample.stamp, kUtcOffset + std::chrono::milliseconds(290));
  EXPECT_NEAR(sample.linear_acceleration.z(), 9.80665, 1e-6);
  EXPECT_NEAR(sample.angular_velocity.x(), 0.1, 1e-6);
}

TEST(Hesai, XtPointsAreWhereAndWhenTheManualSays) {
  HesaiSweeps sweeps(hesai_angles_by_design({.model = "PandarXT-32", .lasers = 32}).value());
  std::vector<double> azimuths;
  for (int block = 0; block < 8; ++block) {
    azimuths.push_back(90.0 + 0.18 * block);
  }
  const Bytes packet = test::hesai_packet({}, azimuths, 123456, [](auto block, auto laser) {
    return laser == 15 ? 2500 + block : 0;  // 10 m, level
  });
  EXPECT_EQ(packet.size(), 1080U);
  EXPECT_TRUE(sweeps.take(packet_in_datagram(packet)).empty());
  const Sweep sweep = sweeps.finish().value();
  ASSERT_EQ(sweep.points.size(), 8U);
  EXPECT_NEAR(sweep.points[0].x, 10.0F, 1e-4F) << "azimuth 90 is along x";
  EXPECT_NEAR(sweep.points[0].y, 0.0F, 1e-4F);
  EXPECT_NEAR(sweep.points[0].z, 0.0F, 1e-4F);
  EXPECT_NEAR(sweep.points[7].x, 10.028F * std::cos(1.26 * std::numbers::pi / 180.0), 1e-3);
  EXPECT_EQ(sweep.rings[0], 16) << "from the lowest up";
  EXPECT_EQ(sweep.points[0].intensity, 15.0F);
  // The first block is fired 7 x 50 µs before the last, which is 5.632 µs after the packet's time.
  EXPECT_EQ(sweep.stamp, kUtcOffset + Nanoseconds(123456000 + 5632 - 350000));
  EXPECT_NEAR(sweep.times[0], 0.28e-6 + 15 * 1.512e-6, 1e-8);
  EXPECT_NEAR(sweep.times[7] - sweep.times[0], 350e-6, 1e-8);
}

TEST(Hesai, SweepsBeginAtAzimuthZeroAndSecondReturnsThatAreTheSameAreLeftOut) {
  HesaiSweeps sweeps(hesai_angles_by_design({.model = "PandarXT-16", .lasers = 16}).value());
  std::vector<Sweep> whole;
  for (uint32_t i = 0; i < 12; ++i) {
    const double azimuth = std::fmod(300.0 + 20.0 * i, 360.0);
    const Bytes packet = test::hesai_packet(
        {.lasers = 16, .mode = 0x39}, {azimuth, azimuth}, 10000 * i,
        [](auto block, auto laser) { return laser < 8 ? 1000 : 1000 + 500 * block; });
    for (Sweep& sweep : sweeps.take(packet_in_datagram(packet))) {
      whole.push_back(std::move(sweep));
    }
  }
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_EQ(whole[0].points.size(), 3U * 24U) << "300, 320 and 340 degrees";
}

TEST(Hesai, OthersAreReadWithTheirAngleCorrection) {
  const test::TemporaryFolder folder;
  const auto angles =
      folder.write("angles.csv", "Laser id,Elevation,Azimuth\n1,10.0,-1.0\n2,-5.0,2.0\n");
  for (const bool pandar64 : {true, false}) {
    const test::HesaiLayout layout{.pandar64 = pandar64, .major = 1, .minor = 4, .lasers = 2};
    std::vector<test::CapturedFrame> frames;
    for (uint32_t i = 0; i < 4; ++i) {
      const double azimuth = 90.0 * i;
      const Bytes packet = test::hesai_packet(layout, {azimuth, azimuth + 0.2}, 25000 * i,
                                              [](auto, auto) { return 500; });
      frames.push_back({kUtcOffset, test::frames_of(packet, 2368).front()});
    }
    const Bytes bytes = test::pcap(frames);
    const auto file =
        folder.write("drive.pcap", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    EXPECT_THROW(open_recording(file), InputError) << "its lasers' angles are not known";
    const auto recording = open_recording(file, angles);
    const test::ReadEvents read = test::read_all(*recording, {.topics = {0}});
    ASSERT_EQ(read.events.size(), 1U);
    const Sweep& sweep = std::get<Sweep>(read.events[0].value);
    ASSERT_EQ(sweep.points.size(), 16U);
    const Point& p = sweep.points[0];
    EXPECT_NEAR(p.z, 2.0 * std::sin(10.0 * std::numbers::pi / 180.0), 1e-4);
    EXPECT_NEAR(std::atan2(p.x, p.y), -std::numbers::pi / 180.0, 1e-4);
    EXPECT_EQ(sweep.rings[0], 1);
    EXPECT_NEAR(static_cast<double>((sweep.stamp - kUtcOffset).count()), 0.0, 1e5);
    EXPECT_NEAR(sweep.times.back(), 0.075F, 1e-4F);
  }
  folder.write("bad.csv", "1,10.0,x\n");
  EXPECT_THROW(read_hesai_angles(folder / "bad.csv"), InputError);
  EXPECT_THROW(read_hesai_angles(folder.write("empty.csv", "nothing\n")), InputError);
}

TEST(Hesai, ChannelsOfProtocol14HaveAByteMoreForEachOfThreeFlags) {
  for (const auto& [flags, more] :
       {std::pair{0x00, 0U}, {0x10, 1U}, {0x20, 1U}, {0x40, 1U}, {0x30, 2U}, {0x74, 3U}}) {
    HesaiSweeps sweeps({.elevations = {10.0, -5.0}, .azimuths = {0.0, 0.0}});
    const test::HesaiLayout layout{
        .major = 1, .minor = 4, .lasers = 2, .flags = static_cast<uint8_t>(flags), .more = more};
    const Bytes packet =
        test::hesai_packet(layout, {90.0, 90.2}, 123456,
                           [](auto block, auto laser) { return 1000 + 100 * block + laser; });
    sweeps.take(packet_in_datagram(packet));
    const Sweep sweep = sweeps.finish().value();
    ASSERT_EQ(sweep.points.size(), 4U) << flags;
    EXPECT_NEAR(distance(sweep.points[1]), 4.004, 1e-4) << flags;
    EXPECT_NEAR(distance(sweep.points[3]), 4.404, 1e-4) << flags;
    EXPECT_EQ(sweep.points[1].intensity, 1.0F) << flags;
    EXPECT_NEAR(static_cast<double>((sweep.stamp - kUtcOffset).count()), 123456000.0, 1e5) << flags;
  }
}

TEST(SensorPackets, CutPacketsAreNone) {
  const Bytes xt = test::hesai_packet({}, {1.0, 2.0}, 1, [](auto, auto) { return 500; });
  const Bytes ot = test::hesai_packet({.major = 1, .minor = 4, .lasers = 2}, {1.0}, 1,
                                      [](auto, auto) { return 500; });
  const Bytes livox = test::livox_packet(1, {{1, 2, 3, 4, 5}, {1, 2, 3, 4, 5}});
  for (const Bytes& whole : {xt, ot, livox}) {
    for (std::size_t size = 0; size + 4 < whole.size(); ++size) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_FALSE(is_livox_data(packet_in_datagram(cut)) ||
                   hesai_packet(packet_in_datagram(cut)).has_value())
          << size;
    }
  }
}

}  // namespace
}  // namespace adit
