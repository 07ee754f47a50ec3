// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Headings in messages and in NMEA sentences.
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"
#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/recordings/message_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/packets/nmea_heading.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/recordings/topic_survey.hpp"

namespace adit {
namespace {

constexpr double kEast = 0.0;
constexpr double kNorth = std::numbers::pi / 2.0;

/// A sentence with its checksum.
std::string nmea(const std::string& body) {
  unsigned sum = 0;
  for (const char one : body) {
    sum ^= static_cast<unsigned char>(one);
  }
  std::array<char, 4> digits{};
  std::snprintf(digits.data(), digits.size(), "*%02X", sum);
  return "$" + body + digits.data() + "\r\n";
}

template <class Message>
std::vector<EventValue> events_in(const Message& message, Encoding encoding) {
  const Channel channel{.topic = "/heading",
                        .type = std::string(Message::kType),
                        .encoding = encoding,
                        .definition = {},
                        .messages = std::nullopt};
  EXPECT_EQ(ros::kind_of(channel), TopicKind::headings);
  const std::vector<std::byte> bytes = ros::encode(encoding, message);
  return ros::to_events(channel, {0, Nanoseconds(9), bytes, 0}, "drive").values;
}

TEST(NmeaHeadings, BearingsBecomeYawsFromEast) {
  EXPECT_NEAR(nmea_heading("$GPHDT,274.07,T*03")->yaw, yaw_of_bearing(274.07 * kDegree), 1e-12)
      << "the checksum of the standard's own example";
  EXPECT_NEAR(nmea_heading(nmea("GPHDT,0.0,T"))->yaw, kNorth, 1e-12);
  EXPECT_NEAR(nmea_heading(nmea("GNHDT,90.0,T"))->yaw, kEast, 1e-12);
  EXPECT_NEAR(nmea_heading(nmea("HEHDT,180.0,T"))->yaw, -kNorth, 1e-12);
  EXPECT_NEAR(nmea_heading(nmea("GNTHS,90.0,A"))->yaw, kEast, 1e-12);
  EXPECT_FALSE(nmea_heading(nmea("GNTHS,90.0,E"))) << "estimated";
  EXPECT_FALSE(nmea_heading(nmea("GPHDT,,T"))) << "no heading yet";
  EXPECT_FALSE(nmea_heading(nmea("GPHDT,361.0,T")));
  EXPECT_FALSE(nmea_heading(nmea("GPHDT,nan,T")));
  EXPECT_FALSE(nmea_heading(nmea("GPHDG,90.0,,,3.1,E"))) << "magnetic";
  EXPECT_FALSE(nmea_heading("$GPHDT,274.07,T*04"));
  EXPECT_FALSE(nmea_heading("$GPHDT,274.07,T"));
}

TEST(NmeaHeadings, PashrHasADeviation) {
  const auto found =
      nmea_heading(nmea("PASHR,085335.000,224.19,T,-01.26,+00.83,+00.00,0.101,0.113,0.267,1,0"));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->yaw, yaw_of_bearing(224.19 * kDegree), 1e-12);
  EXPECT_NEAR(found->sigma.value_or(0.0), 0.267 * kDegree, 1e-12);
  EXPECT_FALSE(
      nmea_heading(nmea("PASHR,085335.000,224.19,T,-01.26,+00.83,+00.00,0.101,0.113,0.267,0,0")))
      << "no fix";
}

TEST(NmeaHeadings, CutOffAndRandomTextIsNone) {
  const std::string whole = nmea("GPHDT,274.07,T");
  for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
    EXPECT_FALSE(nmea_heading(whole.substr(0, size))) << size;
  }
  std::mt19937 random(1);
  std::uniform_int_distribution<int> letter(0, 255);
  const std::string alphabet = "$GPHDTSNAR,*.0123456789ET-+\r\n";
  for (int i = 0; i < 20000; ++i) {
    std::string text(static_cast<std::size_t>(letter(random) % 60), ' ');
    for (char& one : text) {
      one = i % 2 == 0 ? static_cast<char>(letter(random))
                       : alphabet[static_cast<std::size_t>(letter(random)) % alphabet.size()];
    }
    const auto found = nmea_heading(i % 3 == 0 ? nmea("GPHDT," + text) : text);
    EXPECT_TRUE(!found || std::isfinite(found->yaw)) << text;
  }
}

TEST(Headings, MessagesAreReadInBothEncodings) {
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    ros::QuaternionStamped orientation{.header = test::header(3, "antenna"), .quaternion = {}};
    orientation.quaternion = {0.0, 0.0, 2.0 * std::sin(0.5), 2.0 * std::cos(0.5)};  // scaled
    const auto values = events_in(orientation, encoding);
    ASSERT_EQ(values.size(), 1U);
    const auto& heading = std::get<Heading>(values[0]);
    EXPECT_NEAR(heading.yaw, 1.0, 1e-12);
    EXPECT_EQ(heading.frame, "antenna");
    EXPECT_EQ(heading.stamp, test::header(3, "").stamp);
    EXPECT_FALSE(heading.sigma);
    orientation.quaternion = {0.0, 0.0, 0.0, 0.0};
    EXPECT_THROW(events_in(orientation, encoding), ros::CodecError);

    ros::Sentence sentence{.header = test::header(4, "antenna"), .sentence = nmea("GPHDT,90.0,T")};
    const auto read = events_in(sentence, encoding);
    ASSERT_EQ(read.size(), 1U);
    EXPECT_NEAR(std::get<Heading>(read[0]).yaw, kEast, 1e-12);
    sentence.sentence = nmea("GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,");
    EXPECT_TRUE(events_in(sentence, encoding).empty()) << "other sentences have no heading";
  }
}

TEST(Headings, AreWrittenAsTheyAreRead) {
  const Heading heading{.stamp = Nanoseconds(1700000000123456789), .yaw = -2.5, .frame = "antenna"};
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    const ros::EncodedEvent encoded = ros::from_event(heading, encoding, "base");
    const auto message = ros::decode<ros::QuaternionStamped>(encoding, encoded.bytes);
    const auto again = std::get<Heading>(events_in(message, encoding).at(0));
    EXPECT_NEAR(again.yaw, heading.yaw, 1e-12);
    EXPECT_EQ(again.stamp, heading.stamp);
    EXPECT_EQ(again.frame, "antenna");
  }
}

/// A recording of an IMU whose orientation turns, and of one that has none.
std::filesystem::path recording_of_imus(const test::TemporaryFolder& folder) {
  const std::filesystem::path file = folder / "imus.mcap";
  McapWriter writer(file, {});
  for (const std::string topic : {"/knows_north", "/knows_nothing"}) {
    const std::size_t channel = writer.add_channel({.topic = topic,
                                                    .type = std::string(ros::Imu::kType),
                                                    .encoding = Encoding::cdr,
                                                    .definition = {},
                                                    .messages = std::nullopt});
    for (uint32_t i = 0; i < 5; ++i) {
      ros::Imu imu = test::imu_message(i);
      if (topic == "/knows_north") {
        imu.orientation_covariance.fill(0.0);
        imu.orientation_covariance[8] = 0.0004;
        imu.orientation = {0.0, 0.0, std::sin(0.05 * i), std::cos(0.05 * i)};
      }
      writer.write(channel, imu.header.stamp, ros::encode(Encoding::cdr, imu));
    }
  }
  writer.close();
  return file;
}

TEST(Headings, AnImuGivesThemOnlyWhereItIsAskedTo) {
  const test::TemporaryFolder folder;
  const auto recording = open_recording(recording_of_imus(folder));
  const auto read = [&](EventSelection selection) {
    std::vector<Heading> headings;
    std::size_t readings = 0;
    const auto events = recording->events(selection);
    while (const std::optional<Event> event = events->next()) {
      if (const auto* heading = std::get_if<Heading>(&event->value)) {
        headings.push_back(*heading);
      } else {
        readings += std::holds_alternative<ImuSample>(event->value) ? 1U : 0U;
      }
    }
    EXPECT_EQ(readings, 5U);
    return headings;
  };
  const bool first = recording->topics()[0].name == "/knows_north";
  const std::size_t north = first ? 0 : 1;
  const std::size_t nothing = first ? 1 : 0;
  EXPECT_TRUE(read({.topics = {north}}).empty());
  const std::vector<Heading> headings = read({.topics = {north}, .headings_of = north});
  ASSERT_EQ(headings.size(), 5U);
  EXPECT_NEAR(headings[3].yaw, 0.3, 1e-12);
  EXPECT_NEAR(headings[3].sigma.value_or(0.0), 0.02, 1e-12);
  EXPECT_EQ(headings[3].frame, "imu");
  EXPECT_TRUE(read({.topics = {nothing}, .headings_of = nothing}).empty());
  EXPECT_EQ(first_samples(*recording, north, true).at(0).fault, "");
  EXPECT_EQ(first_samples(*recording, nothing, true).at(0).fault,
            "its first 5 messages have no heading");
}

}  // namespace
}  // namespace adit
