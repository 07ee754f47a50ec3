// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/ros_codec.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/message_support.hpp"
#include "adit/tests/support/point_files.hpp"
#include "adit/tools/containers/ros_definitions.hpp"
#include "adit/tools/recordings/ros_visit.hpp"

// fuzz_messages.cpp; renamed by tests/CMakeLists.txt, since the program has another entry.
extern "C" int adit_fuzz_messages(const uint8_t* data, std::size_t size);

namespace adit::ros {
namespace {

using test::bytes_of;
using test::bytes_of_all;

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
std::span<const std::byte> bytes_in(const std::string& text) {
  return std::as_bytes(std::span(text));
}

/// Calls check(message) for one message of every type.
template <class Check>
void for_each_message(Check&& check) {
  check(test::cloud_message(1).message);
  check(test::imu_message(2));
  check(test::fix_message(3));
  check(test::odometry_message(4));
  check(test::pose_message(5));
  check(test::transform_message(6, "lidar"));
  check(TFMessage{{test::transform_message(7, "a"), test::transform_message(8, "bcd")}});
  check(test::livox_message(9));
  check(test::depth_image_message(10).message);
  check(test::camera_info_message(11));
  check(test::velodyne_message(12, 2));
  check(test::twist_message(13));
  check(test::twist_with_covariance_message(14));
  check(test::quaternion_message(15));
  check(test::sentence_message(16));
}

TEST(RosCodec, EveryMessageIsReadAsItWasWritten) {
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    for_each_message([&]<class Message>(const Message& message) {
      const std::vector<std::byte> bytes = encode(encoding, message);
      EXPECT_EQ(encode(encoding, decode<Message>(encoding, bytes)), bytes) << Message::kType;
    });
  }
}

TEST(RosCodec, EncodingsTellTheSame) {
  for_each_message([]<class Message>(const Message& message) {
    const std::vector<std::byte> cdr = encode(Encoding::cdr, message);
    const auto from_cdr = decode<Message>(Encoding::cdr, cdr);
    const std::vector<std::byte> ros1 = encode(Encoding::ros1, from_cdr);
    const auto from_ros1 = decode<Message>(Encoding::ros1, ros1);
    EXPECT_EQ(encode(Encoding::cdr, from_ros1), cdr) << Message::kType;
  });
}

TEST(RosCodec, CdrAlignsFromTheByteAfterTheEncapsulation) {
  // "gps" with its zero ends at 16; the service (2 bytes) lies at 18, the latitude (8) at 24.
  NavSatFix fix = test::fix_message(0);
  fix.header.stamp = Nanoseconds(5000000009);
  fix.header.frame = "gps";
  const std::string expected =
      std::string("\x00\x01\x00\x00", 4) + bytes_of_all(int32_t{5}, uint32_t{9}, uint32_t{4}) +
      std::string("gps\0", 4) + bytes_of(int8_t{2}) + '\0' + bytes_of(uint16_t{1}) +
      std::string(4, '\0') + bytes_of_all(fix.latitude, fix.longitude, fix.altitude);
  const std::string bytes = text_of(encode(Encoding::cdr, fix));
  EXPECT_EQ(bytes.substr(0, expected.size()), expected);
  EXPECT_EQ(bytes.size(), expected.size() + 9 * 8 + 1);
}

TEST(RosCodec, Ros1IsPackedAndHasASequenceNumber) {
  NavSatFix fix = test::fix_message(3);
  fix.header.stamp = Nanoseconds(5000000009);
  const std::string expected = bytes_of_all(uint32_t{3}, uint32_t{5}, uint32_t{9}, uint32_t{4}) +
                               "gnss" + bytes_of(int8_t{2}) + bytes_of(uint16_t{1}) +
                               bytes_of_all(fix.latitude, fix.longitude, fix.altitude);
  const std::string bytes = text_of(encode(Encoding::ros1, fix));
  EXPECT_EQ(bytes.substr(0, expected.size()), expected);
  EXPECT_EQ(bytes.size(), expected.size() + 9 * 8 + 1);
}

TEST(RosCodec, BigEndianCdr) {
  std::string bytes = std::string("\x00\x00\x00\x00", 4) + bytes_of(int32_t{5}, true) +
                      bytes_of(uint32_t{9}, true) + bytes_of(uint32_t{4}, true) +
                      std::string("map\0", 4);
  for (const double value : {1.0, 2.0, 3.0, 0.0, 0.0, 0.6, 0.8}) {
    bytes += bytes_of(value, true);
  }
  const auto pose = decode<PoseStamped>(Encoding::cdr, bytes_in(bytes));
  EXPECT_EQ(pose.header.stamp, Nanoseconds(5000000009));
  EXPECT_EQ(pose.header.frame, "map");
  EXPECT_EQ(pose.pose.position.z, 3.0);
  EXPECT_EQ(pose.pose.orientation.w, 0.8);
}

TEST(RosCodec, TimesBeforeTheEpochAndAtTheEnds) {
  for (const int64_t nanoseconds : {int64_t{-1}, int64_t{-1500000000}, int64_t{2147483647999999999},
                                    int64_t{-2147483648000000000}}) {
    PoseStamped pose;
    pose.header.stamp = Nanoseconds(nanoseconds);
    EXPECT_EQ(decode<PoseStamped>(Encoding::cdr, encode(Encoding::cdr, pose)).header.stamp.count(),
              nanoseconds);
  }
  PoseStamped late;
  late.header.stamp = std::chrono::seconds(4294967295);
  EXPECT_EQ(decode<PoseStamped>(Encoding::ros1, encode(Encoding::ros1, late)).header.stamp,
            late.header.stamp);
  EXPECT_THROW(encode(Encoding::cdr, late), CodecError);
  late.header.stamp = Nanoseconds(-1);
  EXPECT_THROW(encode(Encoding::ros1, late), CodecError);
}

TEST(RosCodec, MessagesCutOffAtEveryByteAreErrors) {
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    for_each_message([&]<class Message>(const Message& message) {
      const std::vector<std::byte> bytes = encode(encoding, message);
      for (std::size_t size = 0; size < bytes.size(); ++size) {
        const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<long>(size));
        EXPECT_THROW(decode<Message>(encoding, cut), CodecError) << Message::kType << " " << size;
      }
    });
  }
}

TEST(RosCodec, MessagesWithAnyByteChangedAreReadOrRefused) {
  // The order of fuzz_messages.cpp.
  const auto feed = [](std::size_t type, Encoding encoding, const auto& message) {
    std::vector<uint8_t> input = {
        static_cast<uint8_t>(2 * type + (encoding == Encoding::ros1 ? 0 : 1))};
    for (const std::byte byte : encode(encoding, message)) {
      input.push_back(std::to_integer<uint8_t>(byte));
    }
    for (std::size_t at = 1; at < input.size(); ++at) {
      for (const int value : {0x00, 0x01, 0x3f, 0x7f, 0xff}) {
        std::vector<uint8_t> changed = input;
        changed[at] = static_cast<uint8_t>(value);
        adit_fuzz_messages(changed.data(), changed.size());
      }
    }
  };
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    feed(0, encoding, test::cloud_message(1).message);
    feed(1, encoding, test::imu_message(1));
    feed(2, encoding, test::fix_message(1));
    feed(3, encoding, test::odometry_message(1));
    feed(4, encoding, test::pose_message(1));
    feed(5, encoding, TFMessage{{test::transform_message(1, "a")}});
    feed(6, encoding, test::livox_message(1));
  }
}

TEST(RosCodec, CountsBeyondTheMessageTakeNoMemory) {
  const std::string many = bytes_of(uint32_t{0xffffffff}) + std::string(100, '\0');
  try {
    decode<TFMessage>(Encoding::ros1, bytes_in(many));
    FAIL();
  } catch (const CodecError& error) {
    EXPECT_NE(std::string(error.what()).find("4294967295 elements where 100 bytes are left"),
              std::string::npos)
        << error.what();
  }
}

TEST(RosCodec, OtherRepresentationsOfCdrAreNamed) {
  const std::string parameters = std::string("\x00\x03\x00\x00", 4) + std::string(100, '\0');
  EXPECT_THROW(decode<PoseStamped>(Encoding::cdr, bytes_in(parameters)), CodecError);
}

TEST(RosDefinitions, HeadersDifferBetweenRos1AndRos2) {
  const Definition ros1 = definition_of("sensor_msgs/Imu", Encoding::ros1).value();
  const Definition ros2 = definition_of("sensor_msgs/Imu", Encoding::cdr).value();
  EXPECT_NE(ros1.text.find("uint32 seq"), std::string::npos);
  EXPECT_EQ(ros2.text.find("uint32 seq"), std::string::npos);
  EXPECT_EQ(ros1.text.find("builtin_interfaces"), std::string::npos);
  EXPECT_NE(ros2.text.find("MSG: builtin_interfaces/Time"), std::string::npos);
  EXPECT_EQ(ros1.md5, "6a62c6daae103f4ff57a132d6f95cec2");
  EXPECT_FALSE(definition_of("std_msgs/Header", Encoding::cdr));
  EXPECT_FALSE(definition_of("sensor_msgs/LaserScan", Encoding::cdr));
}

}  // namespace
}  // namespace adit::ros
