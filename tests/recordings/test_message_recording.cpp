// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/message_recording.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/recordings/message_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/mcap_reader.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/recordings/ros_events.hpp"

namespace adit {
namespace {

/// A recording of one topic.
template <class Message>
std::unique_ptr<Recording> record(const test::TemporaryFolder& folder,
                                  const std::vector<Message>& messages,
                                  const std::string& topic = "/topic") {
  const std::filesystem::path file = folder / "one.mcap";
  McapWriter writer(file, {});
  const std::size_t id = writer.add_channel({.topic = topic,
                                             .type = std::string(Message::kType),
                                             .encoding = Encoding::cdr,
                                             .definition = {},
                                             .messages = std::nullopt});
  for (const Message& message : messages) {
    writer.write(id, test::kStart, ros::encode(Encoding::cdr, message));
  }
  writer.close();
  return open_recording(file);
}

TEST(MessageRecording, TheUnitOfPointTimesIsThatOfTheTopicNotOfASweepThatIsCutShort) {
  const test::TemporaryFolder folder;
  std::vector<test::CloudExample> clouds;
  std::vector<ros::PointCloud2> messages;
  for (const uint32_t last : {900'000U, 99'000'000U, 98'000'000U}) {  // ns
    test::CloudExample cloud = test::cloud_message(static_cast<uint32_t>(clouds.size()));
    const uint32_t times[] = {0, last};
    for (std::size_t i = 0; i < 2; ++i) {
      std::memcpy(cloud.data.data() + 24 * i + 16, &times[i], sizeof last);
    }
    cloud.message.fields[4] = {"t", 16, 6, 1};
    clouds.push_back(std::move(cloud));
    messages.push_back(clouds.back().message);
  }
  for (std::size_t i = 0; i < messages.size(); ++i) {
    messages[i].data = clouds[i].data;
  }
  const auto recording = record(folder, messages);
  // Alone the first would last 0.9 s.
  EXPECT_FLOAT_EQ(test::read_sweep(*recording, 0).times.at(1), 0.9e-3F);
  EXPECT_FLOAT_EQ(test::read_sweep(*recording, 2).times.at(1), 98e-3F);
  const auto told = recording->events({.point_time_unit = 1e-6})->next();
  EXPECT_FLOAT_EQ(std::get<Sweep>(told.value().value).times.at(1), 0.9F);
}

/// Counts how often its messages are asked for.
class CountedFile final : public MessageFile {
 public:
  CountedFile(std::unique_ptr<MessageFile> file, int& asked)
      : file_(std::move(file)), asked_(&asked) {}
  const std::filesystem::path& path() const override { return file_->path(); }
  const std::vector<Channel>& channels() const override { return file_->channels(); }
  std::optional<TimeSpan> span() const override { return file_->span(); }
  std::string format() const override { return file_->format(); }
  const std::optional<InputError>& damage() const override { return file_->damage(); }
  std::unique_ptr<MessageStream> messages(const MessageSelection& selection) const override {
    ++*asked_;
    return file_->messages(selection);
  }

 private:
  std::unique_ptr<MessageFile> file_;
  int* asked_;
};

TEST(MessageRecording, CloudsWithoutTimesAreAskedForTheirUnitOnce) {
  const test::TemporaryFolder folder;
  test::CloudExample cloud = test::cloud_message(0);
  cloud.message.fields.erase(cloud.message.fields.begin() + 4);  // time
  record(folder, std::vector<ros::PointCloud2>(9, cloud.message));
  int asked = 0;
  std::vector<std::unique_ptr<MessageFile>> files;
  files.push_back(std::make_unique<CountedFile>(open_mcap(folder / "one.mcap"), asked));
  const auto recording = make_message_recording({folder / "one.mcap"}, std::move(files));
  const auto events = recording->events({});
  int sweeps = 0;
  while (events->next()) {
    ++sweeps;
  }
  EXPECT_EQ(sweeps, 9);
  EXPECT_EQ(asked, 2) << "for the unit, and for the events";
}

TEST(MessageRecording, PacketsOfAVelodyneAreASweep) {
  const test::TemporaryFolder folder;
  const auto recording = record(folder, std::vector{test::velodyne_message(0)});
  EXPECT_EQ(recording->topics()[0].kind, TopicKind::sweeps);
  const Sweep sweep = test::read_sweep(*recording, 0);
  EXPECT_EQ(sweep.stamp, test::kStart + Nanoseconds(7));
  ASSERT_EQ(sweep.points.size(), 24U * 12U * 32U);  // in one, though azimuth 0 lies within
  EXPECT_FLOAT_EQ(sweep.times.front(), 0.0F);
  EXPECT_TRUE(std::ranges::is_sorted(sweep.times));
  EXPECT_NEAR(sweep.times.back(), 24 * 1.327e-3, 1.4e-3);
  // Laser 0: 15 degrees down, azimuth 350, a centimetre above the origin.
  const Point& p = sweep.points[0];
  EXPECT_NEAR(std::hypot(p.x, p.y), 10.0 * std::cos(15.0 * std::numbers::pi / 180.0), 1e-3);
  EXPECT_NEAR(std::atan2(p.y, p.x), 10.0 * std::numbers::pi / 180.0, 1e-4);
  EXPECT_NEAR(p.z, -10.0 * std::sin(15.0 * std::numbers::pi / 180.0) + 0.0112, 1e-3);
}

TEST(MessageRecording, PacketsOfOtherSensorsAreNamed) {
  const test::TemporaryFolder folder;
  ros::VelodyneScan scan = test::velodyne_message(0, 2);
  for (ros::VelodynePacket& packet : scan.packets) {
    packet.data[1205] = 0x31;  // a Velarray
  }
  const test::ReadEvents read = test::read_all(*record(folder, std::vector{scan}));
  EXPECT_TRUE(read.events.empty());
  ASSERT_EQ(read.errors.size(), 1U);
  EXPECT_NE(read.errors[0].found().find("none of its 2 packets is of a Velodyne that is read"),
            std::string::npos);
}

TEST(MessageRecording, PacketsOfAScanThatCameTwiceOrInAnotherOrderGiveTheSameSweep) {
  const test::TemporaryFolder folder;
  const ros::VelodyneScan scan = test::velodyne_message(0);
  ros::VelodyneScan mixed = scan;
  std::swap(mixed.packets[3], mixed.packets[9]);
  std::swap(mixed.packets[12], mixed.packets[13]);
  mixed.packets.insert(mixed.packets.begin() + 5, scan.packets[2]);
  const Sweep first = test::read_sweep(*record(folder, std::vector{scan}), 0);
  const Sweep second = test::read_sweep(*record(folder, std::vector{mixed}), 0);
  EXPECT_EQ(first.stamp, second.stamp);
  EXPECT_EQ(first.times, second.times);
  ASSERT_EQ(first.points.size(), second.points.size());
  EXPECT_EQ(first.points[5000].x, second.points[5000].x);
}

TEST(MessageRecording, ScansOfOtherVelodynesAreRead) {
  const test::TemporaryFolder folder;
  ros::VelodyneScan scan = test::velodyne_message(0);
  for (ros::VelodynePacket& packet : scan.packets) {
    packet.data[1205] = 0x28;  // a VLP-32C: 32 lasers, steps of 4 mm
  }
  const Sweep sweep = test::read_sweep(*record(folder, std::vector{scan}), 0);
  EXPECT_EQ(sweep.points.size(), 24U * 12U * 32U);
  EXPECT_NEAR(std::hypot(sweep.points[0].x, sweep.points[0].y, sweep.points[0].z), 20.0, 1e-2);
}

class MessageRecordingOf : public testing::TestWithParam<Encoding> {};

TEST_P(MessageRecordingOf, EveryTypeBecomesItsEvent) {
  const test::TemporaryFolder folder;
  McapWriter writer(folder / "all.mcap", {});
  test::write_sample(writer, GetParam(), 2);
  writer.close();
  const auto recording = open_recording(folder / "all.mcap");
  const test::ReadEvents read = test::read_all(*recording);
  EXPECT_TRUE(read.errors.empty());
  ASSERT_EQ(read.events.size(), 2U * 7U + 2U);
  const Sweep& sweep = std::get<Sweep>(read.events[0].value);
  EXPECT_EQ(sweep.stamp, test::kStart + Nanoseconds(7));
  EXPECT_EQ(sweep.points.at(1).z, -3.0F);
  EXPECT_EQ(sweep.rings, (std::vector<uint16_t>{4, 5}));
  EXPECT_EQ(sweep.times, (std::vector<float>{0.0F, 0.05F}));
  EXPECT_EQ(sweep.source, "/points#0");
  const auto& imu = std::get<ImuSample>(read.events[1].value);
  EXPECT_EQ(imu.angular_velocity, Eigen::Vector3d(0.0, -0.02, 0.03));
  EXPECT_EQ(imu.linear_acceleration.z(), 9.81);
  EXPECT_EQ(imu.stamp, test::kStart + Nanoseconds(7));
  EXPECT_EQ(read.events[1].received, test::kStart + Nanoseconds(2000007));
  const auto& fix = std::get<GnssFix>(read.events[2].value);
  EXPECT_EQ(fix.kind, GnssFixKind::ground_augmented);
  EXPECT_EQ(fix.latitude, 41.65);
  EXPECT_EQ(fix.covariance.value()(0, 1), 0.001);
  const auto& odometry = std::get<ReferencePose>(read.events[3].value);
  EXPECT_EQ(odometry.parent, "odom");
  EXPECT_EQ(odometry.child, "base_link");
  EXPECT_NEAR(odometry.T_parent_child.linear()(0, 0), 1.0 - 2.0 * 0.36, 1e-15);
  EXPECT_EQ(std::get<ReferencePose>(read.events[4].value).T_parent_child.translation().y(), 2.0);
  EXPECT_EQ(std::get<ReferencePose>(read.events[5].value).child, "vicon");
  EXPECT_EQ(std::get<StaticTransform>(read.events[6].value).child, "lidar");
  EXPECT_EQ(std::get<StaticTransform>(read.events[7].value).child, "imu");
  EXPECT_EQ(stamp_of(read.events[7]), read.events[7].received);
  const auto& livox = std::get<Sweep>(read.events[8].value);
  ASSERT_EQ(livox.points.size(), 2U) << "the point marked as noise is left out";
  EXPECT_EQ(livox.stamp, test::kStart + Nanoseconds(7 + 1000));
  EXPECT_EQ(livox.times, (std::vector<float>{0.0F, 49e-6F}));
  EXPECT_EQ(livox.rings, (std::vector<uint16_t>{1, 3}));
}

TEST_P(MessageRecordingOf, EventsBecomeMessagesThatTellTheSame) {
  const test::TemporaryFolder folder;
  McapWriter writer(folder / "all.mcap", {});
  test::write_sample(writer, GetParam(), 1);
  writer.close();
  for (const Event& event : test::read_all(*open_recording(folder / "all.mcap")).events) {
    const ros::EncodedEvent encoded = ros::from_event(event.value, GetParam(), "frame");
    const Channel channel{.topic = event.topic == 6 ? "/tf_static" : "/t",
                          .type = encoded.type,
                          .encoding = GetParam(),
                          .definition = {},
                          .messages = std::nullopt};
    const std::vector<EventValue> again =
        ros::to_events(channel, {0, event.received, encoded.bytes, 0}, "again").values;
    ASSERT_EQ(again.size(), 1U);
    EXPECT_EQ(again[0].index(), event.value.index());
    EXPECT_EQ(stamp_of({.topic = 0, .received = event.received, .value = again[0]}),
              stamp_of(event));
    EXPECT_EQ(ros::from_event(again[0], GetParam(), "frame").bytes, encoded.bytes);
  }
}

INSTANTIATE_TEST_SUITE_P(Encodings, MessageRecordingOf,
                         testing::Values(Encoding::ros1, Encoding::cdr),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

TEST(MessageRecording, HeaderWithoutTimeCountsAsTakenWhenReceived) {
  const test::TemporaryFolder folder;
  ros::Imu imu = test::imu_message(0);
  imu.header.stamp = Nanoseconds(0);
  const auto read = test::read_all(*record<ros::Imu>(folder, {imu}));
  EXPECT_EQ(stamp_of(read.events.at(0)), test::kStart);
}

TEST(MessageRecording, DamagedMessageIsNamedAndTheOthersAreRead) {
  const test::TemporaryFolder folder;
  std::vector<ros::PointCloud2> clouds(3, test::cloud_message(0).message);
  const test::CloudExample example = test::cloud_message(0);
  for (ros::PointCloud2& cloud : clouds) {
    cloud.data = example.data;
  }
  clouds[1].width = 1000000;
  const auto read = test::read_all(*record(folder, clouds));
  EXPECT_EQ(read.events.size(), 2U);
  ASSERT_EQ(read.errors.size(), 1U);
  const std::string what = read.errors[0].what();
  EXPECT_NE(what.find("one.mcap, message 1 of /topic (at byte "), std::string::npos) << what;
  EXPECT_NE(what.find("1000000 x 1 points, 24000000 bytes, and has 48"), std::string::npos) << what;
}

TEST(MessageRecording, CloudsThatMakeNoSenseSayWhy) {
  const auto error_of = [](const auto& change) {
    const test::TemporaryFolder folder;
    const test::CloudExample example = test::cloud_message(0);
    ros::PointCloud2 cloud = example.message;
    change(cloud);
    const auto read = test::read_all(*record<ros::PointCloud2>(folder, {cloud}));
    return read.errors.size() == 1 ? read.errors[0].found() : "read without an error";
  };
  using ros::PointCloud2;
  EXPECT_NE(
      error_of([](PointCloud2& c) { c.fields[0].offset = 21; }).find("field 'x' lies at byte 21"),
      std::string::npos);
  EXPECT_NE(error_of([](PointCloud2& c) { c.fields[2].name = "height"; }).find("lacks one of"),
            std::string::npos);
  EXPECT_NE(error_of([](PointCloud2& c) { c.fields[4].datatype = 9; }).find("datatype 9"),
            std::string::npos);
  EXPECT_NE(error_of([](PointCloud2& c) { c.point_step = 0; }).find("points of 0 bytes"),
            std::string::npos);
  EXPECT_NE(error_of([](PointCloud2& c) {
              c.height = 2;
              c.width = 1;
              c.row_step = 3;
            }).find("row_step of 3"),
            std::string::npos);
}

TEST(MessageRecording, RowsMayBePadded) {
  const test::TemporaryFolder folder;
  const test::CloudExample example = test::cloud_message(0);
  std::vector<std::byte> padded(example.data.begin(), example.data.begin() + 24);
  padded.resize(30);
  padded.insert(padded.end(), example.data.begin() + 24, example.data.end());
  ros::PointCloud2 cloud = example.message;
  cloud.height = 2;
  cloud.width = 1;
  cloud.row_step = 30;
  cloud.data = padded;
  const auto read = test::read_all(*record<ros::PointCloud2>(folder, {cloud}));
  ASSERT_TRUE(read.errors.empty());
  EXPECT_EQ(std::get<Sweep>(read.events.at(0).value).points.at(1).x, -1.0F);
}

TEST(MessageRecording, PoseBeyondAllBoundsIsRefusedInWords) {
  for (const double w : {1e200, std::numeric_limits<double>::quiet_NaN()}) {
    const test::TemporaryFolder folder;
    ros::PoseStamped pose = test::pose_message(0);
    pose.pose.orientation.w = w;
    const auto read = test::read_all(*record<ros::PoseStamped>(folder, {pose}));
    ASSERT_EQ(read.errors.size(), 1U);
    const std::string& found = read.errors[0].found();
    EXPECT_NE(found.find("quaternion of a length beyond 1000, or of none"), std::string::npos)
        << found;
  }
}

TEST(MessageRecording, PositionBeyondAllBoundsIsRefused) {
  for (const double x : {1e200, -1e13, std::numeric_limits<double>::infinity()}) {
    const test::TemporaryFolder folder;
    ros::PoseStamped pose = test::pose_message(0);
    pose.pose.position.x = x;
    const auto read = test::read_all(*record<ros::PoseStamped>(folder, {pose}));
    ASSERT_EQ(read.errors.size(), 1U) << x;
    EXPECT_NE(read.errors[0].found().find("beyond 1e12 m"), std::string::npos)
        << read.errors[0].found();
  }
}

TEST(MessageRecording, PoseWithoutRotationIsAnError) {
  const test::TemporaryFolder folder;
  ros::PoseStamped pose = test::pose_message(0);
  pose.pose.orientation = {0.0, 0.0, 0.0, 0.0};
  const auto read = test::read_all(*record<ros::PoseStamped>(folder, {pose}));
  ASSERT_EQ(read.errors.size(), 1U);
  EXPECT_NE(read.errors[0].found().find("quaternion of length 0"), std::string::npos);
}

TEST(MessageRecording, OneBadTransformOfAMessageLeavesTheOthers) {
  const test::TemporaryFolder folder;
  ros::TransformStamped zero = test::transform_message(0, "camera");
  zero.rotation = {0.0, 0.0, 0.0, 0.0};
  ros::TransformStamped scaled = test::transform_message(0, "imu");
  scaled.rotation = {0.0, 0.0, 3.0, 0.0};
  const std::filesystem::path file = folder / "transforms.mcap";
  McapWriter writer(file, {});
  const std::size_t channel = writer.add_channel({.topic = "/tf_static",
                                                  .type = std::string(ros::TFMessage::kType),
                                                  .encoding = Encoding::cdr,
                                                  .definition = {},
                                                  .messages = std::nullopt});
  const ros::TFMessage message{{test::transform_message(0, "lidar"), zero, scaled}};
  writer.write(channel, test::kStart, ros::encode(Encoding::cdr, message));
  writer.close();
  const auto read = test::read_all(*open_recording(file));
  ASSERT_EQ(read.events.size(), 2U);
  EXPECT_EQ(std::get<StaticTransform>(read.events[0].value).child, "lidar");
  const auto& imu = std::get<StaticTransform>(read.events[1].value);
  EXPECT_EQ(imu.child, "imu");
  EXPECT_EQ(imu.quaternion_length, 3.0);
  EXPECT_NEAR(imu.T_parent_child.linear().determinant(), 1.0, 1e-12);
  ASSERT_EQ(read.errors.size(), 1U);
  EXPECT_NE(read.errors[0].found().find("from 'base_link' to 'camera': its pose has a quaternion"),
            std::string::npos)
      << read.errors[0].found();
}

TEST(MessageRecording, SeveralTopicsOfSweepsAskForAChoice) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "all.mcap";
  McapWriter writer(file, {});
  test::write_sample(writer, Encoding::cdr, 1);
  writer.close();
  const auto recording = open_recording(file);
  EXPECT_EQ(sweep_topic(*recording, file, "/livox"), 7U);
  try {
    sweep_topic(*recording, file, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("2 topics of sweeps: /points, /livox"), std::string::npos);
    EXPECT_NE(error.remedy().find("--topic"), std::string::npos);
  }
  EXPECT_THROW(sweep_topic(*recording, file, "/none"), InputError);
  const auto imu = record<ros::Imu>(folder, {test::imu_message(0)});
  EXPECT_THROW(sweep_topic(*imu, file, {}), InputError);
}

}  // namespace
}  // namespace adit
