// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/container_support.hpp"
#include "adit/tests/recordings/message_support.hpp"
#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/commands/command_convert.hpp"
#include "adit/tools/containers/bag_writer.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/containers/rosbag2_writer.hpp"
#include "adit/tools/recordings/message_recording.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/recordings/ros_clouds.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

class Convert : public testing::Test {
 protected:
  fs::path sample_mcap(Encoding encoding) const {
    McapWriter writer(folder_ / "in.mcap", {});
    test::write_sample(writer, encoding, 4);
    writer.close();
    return folder_ / "in.mcap";
  }

  fs::path convert(const fs::path& input, const std::string& name, ConvertOptions options = {}) {
    options.input = input;
    options.output = folder_ / name;
    options.overwrite = true;
    report_ = convert_recording(options);
    return options.output;
  }

  static std::vector<test::SampleMessage> messages(const fs::path& path) {
    const auto files = open_message_files(path);
    EXPECT_EQ(files.size(), 1U);
    test::Reading reading = test::read(*files.at(0));
    EXPECT_TRUE(reading.errors.empty());
    return reading.messages;
  }

  test::TemporaryFolder folder_;
  ConvertReport report_;
};

TEST_F(Convert, ThroughEveryFormatAndBackTheMessagesStayAsTheyWere) {
  const std::vector<test::SampleMessage> written = test::sample_messages(Encoding::cdr, 4);
  fs::path file = sample_mcap(Encoding::cdr);
  for (const char* name : {"a.bag", "folder", "b.mcap", "c.bag", "d.mcap"}) {
    file = convert(file, name);
    EXPECT_EQ(report_.error_count, 0U);
    EXPECT_EQ(messages(file).size(), written.size()) << name;
  }
  const std::vector<test::SampleMessage> ros1 = messages(file);
  EXPECT_TRUE(
      test::is_prefix(messages(convert(file, "e.mcap", {.encoding = Encoding::cdr})), written));
  ASSERT_EQ(ros1.size(), written.size());
  EXPECT_NE(ros1.front().bytes, written.front().bytes) << "bags hold ROS 1 messages";
}

TEST_F(Convert, TopicsAndTimesAreCut) {
  const fs::path file = convert(sample_mcap(Encoding::ros1), "part.mcap",
                                {.topics = {"/imu", "/fix"}, .begin_s = 0.05, .end_s = 0.25});
  const std::vector<test::SampleMessage> kept = messages(file);
  ASSERT_EQ(kept.size(), 4U) << "two topics, at 0.1 and 0.2 s";
  EXPECT_EQ(kept.front().received, test::kStart + Nanoseconds(102000007));
  EXPECT_EQ(report_.topics.at(0).left_out, "not chosen");
  EXPECT_EQ(report_.topics.at(1).messages, 2U);
}

TEST_F(Convert, PartThatBeginsLaterKeepsWhatStillHolds) {
  McapWriter writer(folder_ / "in.mcap", {});
  const auto channel = [&](const char* topic, std::string_view type, const char* durability) {
    return writer.add_channel(
        {.topic = topic,
         .type = std::string(type),
         .encoding = Encoding::cdr,
         .definition = {},
         .messages = std::nullopt,
         .metadata = {{"offered_qos_profiles",
                       "- history: keep_last\n  durability: " + std::string(durability)}}});
  };
  const std::size_t transforms = channel("/tf_static", ros::TFMessage::kType, "volatile");
  const std::size_t camera = channel("/camera_info", ros::CameraInfo::kType, "volatile");
  const std::size_t latched = channel("/origin", ros::NavSatFix::kType, "transient_local");
  const std::size_t numbered = channel("/imu", ros::Imu::kType, "2");
  const auto write = [&](std::size_t to, int tenths, const auto& message) {
    writer.write(to, test::kStart + std::chrono::milliseconds(100 * tenths),
                 ros::encode(Encoding::cdr, message));
  };
  ros::TransformStamped moved = test::transform_message(0, "lidar");
  moved.translation.x = 5.0;
  write(transforms, 0, ros::TFMessage{{test::transform_message(0, "lidar")}});
  write(transforms, 1, ros::TFMessage{{test::transform_message(0, "imu")}});
  write(camera, 1, test::camera_info_message(1));
  write(latched, 2, test::fix_message(2));
  write(latched, 3, test::fix_message(3));
  write(transforms, 4, ros::TFMessage{{moved}});  // says anew how the lidar is mounted
  for (int i = 0; i < 10; ++i) {
    write(numbered, i, test::imu_message(static_cast<uint32_t>(i)));
  }
  writer.close();
  for (const char* name : {"part.mcap", "part.bag", "part"}) {
    const fs::path part = convert(folder_ / "in.mcap", name, {.begin_s = 0.55});
    const std::vector<test::SampleMessage> kept = messages(part);
    ASSERT_EQ(kept.size(), 8U) << name << ": two transforms, a camera, a fix and four readings";
    const Nanoseconds begin = test::kStart + std::chrono::milliseconds(550);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(kept[i].received, begin);
    }
    EXPECT_EQ(report_.topics.at(0).from_before, 2U);
    EXPECT_EQ(report_.topics.at(3).from_before, 0U);
    const auto recording = open_recording(part);
    const auto events = recording->events({.topics = {0}});
    const auto imu = std::get<StaticTransform>(events->next().value().value);
    const auto lidar = std::get<StaticTransform>(events->next().value().value);
    EXPECT_EQ(imu.child, "imu");
    EXPECT_EQ(lidar.T_parent_child.translation().x(), 5.0) << "what was said last";
  }
  EXPECT_EQ(
      messages(convert(folder_ / "in.mcap", "imu.mcap", {.topics = {"/imu"}, .begin_s = 0.55}))
          .size(),
      4U)
      << "topics that were not chosen are not kept either";
}

TEST_F(Convert, PartOfACaptureKeepsHowItsSensorsAreMounted) {
  std::vector<test::CapturedFrame> frames;
  for (uint16_t i = 0; i < 8; ++i) {
    const uint64_t time = 1000000000ULL * i;
    const test::Bytes packet = test::ouster_packet(
        true, 2, 0, i, time + 1, [](auto column, auto beam) { return 1000 + column + beam; });
    frames.push_back({Nanoseconds(static_cast<int64_t>(time)),
                      std::move(test::frames_of(packet, 7502).front())});
  }
  const test::Bytes bytes = test::pcap(frames);
  folder_.write("drive.pcap", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  folder_.write("drive.json", test::ouster_metadata(2, "LEGACY"));
  const auto part = open_recording(convert(folder_ / "drive.pcap", "part.mcap", {.begin_s = 4.0}));
  ASSERT_EQ(part->topics().at(0).name, "/tf_static");
  EXPECT_EQ(part->topics()[0].messages, 2U);
}

TEST_F(Convert, PackedMessagesAreWrittenPlainAndTheDistributionStays) {
  {
    Rosbag2Writer writer(folder_ / "drive", {.pack_messages = true, .ros_distro = "humble"});
    test::write_sample(writer, Encoding::cdr, 4);
    writer.close();
  }
  const std::vector<test::SampleMessage> written = test::sample_messages(Encoding::cdr, 4);
  EXPECT_TRUE(test::is_prefix(messages(convert(folder_ / "drive", "plain.mcap")), written));
  convert(folder_ / "drive", "again");
  EXPECT_EQ(open_message_files(folder_ / "again").at(0)->ros_distro(), "humble");
  convert(folder_ / "plain.mcap", "other");
  EXPECT_EQ(open_message_files(folder_ / "other").at(0)->ros_distro(), "unknown");
}

TEST_F(Convert, RepairedCloudsHaveNoIntensityThatWasNotThere) {
  McapWriter writer(folder_ / "in.mcap", {});
  const std::size_t channel = writer.add_channel({.topic = "/points",
                                                  .type = "sensor_msgs/PointCloud2",
                                                  .encoding = Encoding::cdr,
                                                  .definition = {},
                                                  .messages = std::nullopt});
  for (const bool intensity : {true, false}) {
    test::CloudExample cloud = test::cloud_message(0);
    cloud.message.fields.at(3).name = intensity ? "i" : "spare";
    writer.write(channel, test::kStart, ros::encode(Encoding::cdr, cloud.message));
  }
  writer.close();
  const auto right =
      open_message_files(convert(folder_ / "in.mcap", "right.mcap", {.repair = RecordingConfig{}}));
  const auto stream = right.at(0)->messages({});
  for (const bool intensity : {true, false}) {
    const RawMessage message = stream->next().value();
    const auto cloud = ros::decode<ros::PointCloud2>(Encoding::cdr, message.bytes);
    EXPECT_EQ(cloud.fields.size(), intensity ? 6U : 5U);
    EXPECT_EQ(cloud.fields.at(3).name, intensity ? "intensity" : "ring");
    const CloudFile points = ros::to_sweep(cloud, {}, "right.mcap");
    EXPECT_EQ(points.sweep.points.at(0).intensity, intensity ? 0.5F : 0.0F);
    EXPECT_FLOAT_EQ(points.sweep.times.at(1), 0.05F);
    EXPECT_EQ(points.sweep.rings.at(1), 5);
  }
}

TEST_F(Convert, UnknownTypesAreCopiedWhereTheEncodingStaysAndLeftOutWhereNot) {
  {
    McapWriter writer(folder_ / "other.mcap", {});
    const std::size_t id = writer.add_channel({.topic = "/birds",
                                               .type = "zoo_msgs/Bird",
                                               .encoding = Encoding::cdr,
                                               .definition = "string name\n",
                                               .messages = std::nullopt});
    const std::string bytes("\0\1\0\0\5\0\0\0wren\0", 13);
    writer.write(id, test::kStart, std::as_bytes(std::span(bytes)));
    writer.close();
  }
  const fs::path copy = convert(folder_ / "other.mcap", "copy.mcap");
  EXPECT_EQ(messages(copy).at(0).bytes.size(), 13U);
  EXPECT_EQ(open_message_files(copy).at(0)->channels().at(0).definition, "string name\n");
  convert(folder_ / "other.mcap", "other.bag");
  EXPECT_NE(report_.topics.at(0).left_out.find("not known well enough"), std::string::npos);
}

TEST_F(Convert, FoldersOfSweepsBecomeClouds) {
  folder_.write("kitti/times.txt", "5.0\n5.1\n");
  for (const char* name : {"kitti/velodyne/0.bin", "kitti/velodyne/1.bin"}) {
    folder_.write(name, test::bytes_of_all(1.0F, 2.0F, 3.0F, 0.5F));
  }
  const fs::path file = convert(folder_ / "kitti", "kitti.mcap");
  const auto recording = open_recording(file);
  const auto events = recording->events({.skip = 1});
  const Sweep sweep = std::get<Sweep>(events->next().value().value);
  EXPECT_EQ(sweep.stamp, Nanoseconds(5100000000));
  EXPECT_EQ(sweep.points.at(0).z, 3.0F);
  EXPECT_EQ(sweep.points.at(0).intensity, 0.5F);
}

TEST_F(Convert, DamageIsReportedAndTheRestIsWritten) {
  BagWriter writer(folder_ / "in.bag", {.compression = Compression::none, .chunk_bytes = 1500});
  test::write_sample(writer, Encoding::ros1, 4);
  writer.close();
  fs::resize_file(folder_ / "in.bag", fs::file_size(folder_ / "in.bag") / 2);
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(
      convert_command({.input = folder_ / "in.bag", .output = folder_ / "out.mcap"}, out, err), 1);
  EXPECT_NE(err.str().find("in.bag, byte "), std::string::npos) << err.str();
  EXPECT_NE(err.str().find("what could be read was written"), std::string::npos);
  EXPECT_GT(messages(folder_ / "out.mcap").size(), 3U);
}

TEST_F(Convert, DamageBeforeTheFirstMessageIsAFailure) {
  for (const char* name : {"in.mcap", "in.bag"}) {
    const fs::path whole = convert(sample_mcap(Encoding::ros1), std::string("x_") + name);
    std::string bytes = test::content_of(whole);
    const std::size_t head = whole.extension() == ".bag" ? 13 + 4096 : 60;
    folder_.write(name, bytes.substr(0, head) + std::string(64, '\xff'));
    std::ostringstream out;
    std::ostringstream err;
    EXPECT_EQ(
        convert_command(
            {.input = folder_ / name, .overwrite = true, .output = folder_ / "out.mcap"}, out, err),
        1)
        << name;
    EXPECT_NE(err.str().find(std::string(name) + ", byte "), std::string::npos) << err.str();
    EXPECT_NE(err.str().find("nothing could be read"), std::string::npos) << err.str();
    EXPECT_EQ(out.str().find("wrote"), std::string::npos) << out.str();
  }
}

TEST_F(Convert, TimesThatCutNothingOutAreUsageErrors) {
  const fs::path in = sample_mcap(Encoding::cdr);  // 0.3 s
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [begin, end] :
       std::vector<std::pair<std::optional<double>, std::optional<double>>>{
           {1e30, {}}, {nan, {}}, {{}, nan}, {-5.0, 1e300}, {{}, -1.0}, {5.0, 1.0}, {100.0, {}}}) {
    EXPECT_THROW(convert(in, "x.mcap", {.begin_s = begin, .end_s = end}), UsageError)
        << begin.value_or(-0.0) << " " << end.value_or(-0.0);
    EXPECT_FALSE(fs::exists(folder_ / "x.mcap"));
  }
  convert(in, "x.mcap", {.begin_s = 0.0, .end_s = 1e9});
  EXPECT_EQ(report_.messages(), 29U);
  folder_.write("kitti/velodyne/0.bin", test::bytes_of_all(1.0F, 2.0F, 3.0F, 0.5F));
  EXPECT_THROW(convert(folder_ / "kitti", "y.mcap", {.begin_s = 7.0}), UsageError);
}

TEST_F(Convert, NamesOfNoFormatAreUsageErrors) {
  const fs::path in = sample_mcap(Encoding::cdr);
  for (const char* name : {"a.xyz", "out.mcpa", "cut.db3", "drive.MCAPS"}) {
    try {
      convert(in, name);
      ADD_FAILURE() << name;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("NAME.mcap, NAME.bag"), std::string::npos);
    }
    EXPECT_FALSE(fs::exists(folder_ / name));
  }
  EXPECT_TRUE(fs::is_regular_file(convert(in, "drive.MCAP")));
  convert(in, "drive.2024/");
  EXPECT_TRUE(fs::is_regular_file(folder_ / "drive.2024/drive.2024_0.db3"));
}

TEST_F(Convert, WhatIsThereIsReplacedOnlyWhereThatIsWanted) {
  const fs::path in = sample_mcap(Encoding::cdr);
  convert(in, "rosbag2");
  folder_.write("file.mcap", "kept");
  for (const char* name : {"file.mcap", "rosbag2"}) {
    const fs::path out = folder_ / name;
    const fs::path file = fs::is_directory(out) ? out / "rosbag2_0.db3" : out;
    const std::string before = test::content_of(file);
    std::ostringstream text;
    EXPECT_EQ(convert_command({.input = in, .output = out}, text, text), 2) << name;
    EXPECT_NE(text.str().find("--overwrite"), std::string::npos) << text.str();
    EXPECT_EQ(test::content_of(file), before) << name;
    // Where the input cannot be read nothing is lost either.
    EXPECT_EQ(
        convert_command({.input = folder_ / "none", .overwrite = true, .output = out}, text, text),
        1);
    EXPECT_EQ(test::content_of(file), before) << name;
    EXPECT_EQ(convert_command({.input = in, .overwrite = true, .output = out}, text, text), 0)
        << text.str();
    EXPECT_EQ(messages(out).size(), 29U) << name;
  }
  // Other files in the folder stay, and keep a recording from being written beside them.
  folder_.write("rosbag2/notes.txt", "mine");
  std::ostringstream text;
  EXPECT_EQ(
      convert_command({.input = in, .overwrite = true, .output = folder_ / "rosbag2"}, text, text),
      1);
  EXPECT_TRUE(fs::exists(folder_ / "rosbag2/notes.txt"));
  // What is read is never replaced.
  convert(in, "other");
  EXPECT_EQ(
      convert_command(
          {.input = folder_ / "other/other_0.db3", .overwrite = true, .output = folder_ / "other"},
          text, text),
      2);
  EXPECT_TRUE(fs::exists(folder_ / "other/other_0.db3"));
}

TEST_F(Convert, PartsThatFollowEachOtherBecomeOne) {
  const fs::path in = sample_mcap(Encoding::cdr);
  const fs::path first = convert(in, "first.mcap", {.end_s = 0.15});
  const fs::path second = convert(in, "second.bag", {.begin_s = 0.15});
  const fs::path both = convert(second, "both.mcap", {.further_inputs = {first}});
  EXPECT_EQ(report_.error_count, 0U);
  const std::vector<test::SampleMessage> all = messages(both);
  EXPECT_EQ(all.size(), 30U) << "the static transform is in both";
  EXPECT_TRUE(std::ranges::is_sorted(all, {}, &test::SampleMessage::received));
}

TEST_F(Convert, WhatMetadataDeclaresAndIsNotThereIsAnError) {
  convert(sample_mcap(Encoding::cdr), "bag");
  const fs::path metadata = folder_ / "bag/metadata.yaml";
  std::string text = test::content_of(metadata);
  const std::string listed = "relative_file_paths:\n";
  text.insert(text.find(listed) + listed.size(), "    - bag_7.db3\n");
  folder_.write("bag/metadata.yaml", text);
  std::ostringstream told;
  EXPECT_EQ(convert_command({.input = folder_ / "bag", .output = folder_ / "out.mcap"}, told, told),
            1);
  EXPECT_NE(told.str().find("bag_7.db3"), std::string::npos) << told.str();
  EXPECT_EQ(messages(folder_ / "out.mcap").size(), 29U);
}

TEST_F(Convert, OptionsThatContradictEachOtherAreUsageErrors) {
  const fs::path in = sample_mcap(Encoding::cdr);
  EXPECT_THROW(convert(in, "x.bag", {.encoding = Encoding::cdr}), UsageError);
  EXPECT_THROW(convert(in, "x.bag", {.compression = Compression::zstd}), UsageError);
  EXPECT_THROW(convert(in, "x.mcap", {.compression = Compression::bz2}), UsageError);
  EXPECT_THROW(convert(in, "x", {.compression = Compression::lz4}), UsageError);
  EXPECT_THROW(convert(in, "x.mcap", {.topics = {"/imuu"}}), UsageError);
  EXPECT_THROW(convert(in, "x.mcap", {.metadata = "sensor.json"}), UsageError);
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(convert_command({.input = in, .output = in}, out, err), 2);
  EXPECT_EQ(convert_command({.input = folder_ / "none", .output = folder_ / "y.mcap"}, out, err),
            1);
  EXPECT_FALSE(fs::exists(folder_ / "y.mcap"));
}

/// Forty points of UTM coordinates a millimetre apart, as double.
std::string far_ply() {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 40\nproperty double x\nproperty double "
      "y\nproperty double z\nend_header\n";
  for (int i = 0; i < 40; ++i) {
    text += test::bytes_of_all(430000.0, 5400000.0 + 0.001 * i, 300.0);
  }
  return text;
}

TEST_F(Convert, LargeCoordinatesKeepTheirMillimetresAndTheirPlace) {
  for (const char* name : {"a.ply", "b.ply"}) {
    folder_.write(std::string("far/") + name, far_ply());
  }
  for (const char* name : {"far.mcap", "far.bag"}) {
    const auto recording = open_recording(convert(folder_ / "far", name));
    ASSERT_EQ(report_.notes.size(), 1U);
    EXPECT_NE(report_.notes[0].find("(430000, 5400000, 300) m is subtracted"), std::string::npos)
        << report_.notes[0];
    std::size_t clouds = 0;
    std::size_t transforms = 0;
    const auto events = recording->events({});
    while (const std::optional<Event> event = events->next()) {
      if (const auto* transform = std::get_if<StaticTransform>(&event->value)) {
        ++transforms;
        EXPECT_EQ(transform->parent, "lidar");
        EXPECT_EQ(transform->child, "lidar_local");
        EXPECT_EQ(transform->T_parent_child.translation(),
                  Eigen::Vector3d(430000.0, 5400000.0, 300.0));
      } else {
        ++clouds;
        const auto& points = std::get<Sweep>(event->value).points;
        EXPECT_EQ(event->frame, "lidar_local");
        for (std::size_t i = 0; i < points.size(); ++i) {
          EXPECT_NEAR(points[i].y, 0.001 * static_cast<double>(i), 1e-6);
        }
      }
    }
    EXPECT_EQ(clouds, 2U);
    EXPECT_EQ(transforms, 1U);
  }
}

TEST_F(Convert, DamagedCloudsAreWrittenAsFarAsTheyCanBeRead) {
  const std::string whole = far_ply();
  folder_.write("cut/a.ply", whole.substr(0, whole.size() - 7));
  const auto recording = open_recording(convert(folder_ / "cut", "cut.mcap"));
  EXPECT_EQ(report_.error_count, 1U);
  EXPECT_EQ(report_.messages(), 2U);  // the cloud, and where it lies
}

}  // namespace
}  // namespace adit
