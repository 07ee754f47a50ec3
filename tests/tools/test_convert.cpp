// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
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
#include "adit/tools/recordings/message_recording.hpp"
#include "adit/tools/recordings/recording.hpp"
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

TEST_F(Convert, OptionsThatContradictEachOtherAreUsageErrors) {
  const fs::path in = sample_mcap(Encoding::cdr);
  EXPECT_THROW(convert(in, "x.bag", {.encoding = Encoding::cdr}), UsageError);
  EXPECT_THROW(convert(in, "x.bag", {.compression = Compression::zstd}), UsageError);
  EXPECT_THROW(convert(in, "x.mcap", {.compression = Compression::bz2}), UsageError);
  EXPECT_THROW(convert(in, "x", {.compression = Compression::lz4}), UsageError);
  EXPECT_THROW(convert(in, "x.mcap", {.topics = {"/imuu"}}), UsageError);
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(convert_command({.input = in, .output = in}, out, err), 2);
  EXPECT_EQ(convert_command({.input = folder_ / "none", .output = folder_ / "y.mcap"}, out, err),
            1);
  EXPECT_FALSE(fs::exists(folder_ / "y.mcap"));
}

}  // namespace
}  // namespace adit
