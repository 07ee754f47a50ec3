// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/container_support.hpp"
#include "adit/tests/recordings/message_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/bag_reader.hpp"
#include "adit/tools/containers/bag_records.hpp"
#include "adit/tools/containers/bag_writer.hpp"

namespace adit {
namespace {

using test::content_of;
using test::is_prefix;
using test::read;
using test::Reading;
using test::TemporaryFolder;

constexpr Compression kCompressions[] = {Compression::none, Compression::lz4, Compression::bz2};

std::filesystem::path write_bag(const TemporaryFolder& folder, const BagOptions& options,
                                uint32_t rounds = 3, bool definitions = true) {
  const std::filesystem::path file = folder / "sample.bag";
  BagWriter writer(file, options);
  test::write_sample(writer, Encoding::ros1, rounds, definitions);
  writer.close();
  return file;
}

TEST(Bag, EveryCompressionIsReadAsItWasWritten) {
  const std::vector<test::SampleMessage> written = test::sample_messages(Encoding::ros1, 3);
  for (const Compression compression : kCompressions) {
    const TemporaryFolder folder;
    const auto file =
        open_bag(write_bag(folder, {.compression = compression, .chunk_bytes = 2000}));
    const Reading reading = read(*file);
    EXPECT_TRUE(reading.errors.empty());
    EXPECT_EQ(reading.messages.size(), written.size());
    EXPECT_TRUE(is_prefix(reading.messages, written));
    EXPECT_FALSE(file->damage());
    EXPECT_EQ(file->format(), "ROS 1 bag");
    ASSERT_TRUE(file->span());
    EXPECT_EQ(file->span()->begin, written.front().received);
    EXPECT_EQ(file->span()->end, written.back().received);
    const std::vector<Channel> channels = test::sample_channels(Encoding::ros1);
    ASSERT_EQ(file->channels().size(), channels.size());
    for (std::size_t i = 0; i < channels.size(); ++i) {
      EXPECT_EQ(file->channels()[i].topic, channels[i].topic);
      EXPECT_EQ(file->channels()[i].type, channels[i].type);
      EXPECT_EQ(file->channels()[i].definition, channels[i].definition);
      EXPECT_EQ(file->channels()[i].messages, channels[i].topic == "/tf_static" ? 1U : 3U);
    }
  }
}

TEST(Bag, ChannelsAndTimesAreChosen) {
  const TemporaryFolder folder;
  const auto file = open_bag(write_bag(folder, {.chunk_bytes = 1000}));
  const Reading imu = read(*file, {.channels = {1}});
  ASSERT_EQ(imu.messages.size(), 3U);
  const Nanoseconds middle = imu.messages[1].received;
  EXPECT_EQ(read(*file, {.channels = {1}, .begin = middle}).messages.size(), 2U);
  EXPECT_EQ(read(*file, {.begin = middle, .end = middle}).messages.size(), 1U);
  EXPECT_TRUE(read(*file, {.begin = middle + std::chrono::hours(1)}).messages.empty());
}

TEST(Bag, CutOffAtEveryByteGivesWhatCameBeforeAndSaysWhere) {
  const std::vector<test::SampleMessage> written = test::sample_messages(Encoding::ros1, 1);
  for (const Compression compression : kCompressions) {
    const TemporaryFolder folder;
    const std::string whole =
        content_of(write_bag(folder, {.compression = compression, .chunk_bytes = 700}, 1, false));
    std::size_t most = 0;
    const std::size_t head = bag::kMagic.size() + bag::kFileHeader;
    // bzip2 takes megabytes for every start: fewer of them.
    const std::size_t step = compression == Compression::bz2 ? 7 : 1;
    for (std::size_t size = 0; size < whole.size(); size += size < head - 8 ? 97 : step) {
      const std::filesystem::path cut = folder.write("cut.bag", whole.substr(0, size));
      if (size < bag::kMagic.size()) {
        EXPECT_THROW(open_bag(cut), InputError);
        continue;
      }
      const auto file = open_bag(cut);
      const Reading reading = read(*file);
      EXPECT_TRUE(is_prefix(reading.messages, written)) << size;
      EXPECT_GE(reading.messages.size(), most) << size << ": fewer messages than in a shorter file";
      most = reading.messages.size();
      ASSERT_EQ(reading.errors.size(), 1U) << size;
      EXPECT_EQ(reading.errors[0].file(), cut);
      ASSERT_TRUE(file->damage()) << size;
      EXPECT_STREQ(file->damage()->what(), reading.errors[0].what());
    }
    EXPECT_EQ(most, written.size());
  }
}

TEST(Bag, RecorderThatWasKilledLeavesAReadableFile) {
  const TemporaryFolder folder;
  {
    BagWriter writer(folder / "killed.bag", {.chunk_bytes = 1000});
    test::write_sample(writer, Encoding::ros1, 5);
  }
  const auto file = open_bag(folder / "killed.bag");
  const Reading reading = read(*file);
  EXPECT_GT(reading.messages.size(), 20U);
  EXPECT_EQ(file->format(), "ROS 1 bag lz4, without an index");
  ASSERT_EQ(reading.errors.size(), 1U);
  EXPECT_NE(reading.errors[0].found().find("without its index"), std::string::npos);
  EXPECT_NE(reading.errors[0].remedy().find("recorder was killed"), std::string::npos);
}

TEST(Bag, OtherFilesAreRefused) {
  const TemporaryFolder folder;
  EXPECT_FALSE(is_bag(folder.write("a.bag", "#ROSBAG V1.2\n and more")));
  EXPECT_THROW(open_bag(folder / "a.bag"), InputError);
}

}  // namespace
}  // namespace adit
