// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/container_support.hpp"
#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/recordings/message_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/compression.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/containers/rosbag2_reader.hpp"
#include "adit/tools/containers/rosbag2_writer.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {
namespace {

using test::content_of;
using test::is_prefix;
using test::read;
using test::Reading;
using test::TemporaryFolder;

std::filesystem::path write_rosbag2(const TemporaryFolder& folder, bool pack_messages,
                                    uint32_t rounds = 3) {
  Rosbag2Writer writer(folder / "drive", {.pack_messages = pack_messages});
  test::write_sample(writer, Encoding::cdr, rounds);
  writer.close();
  return folder / "drive/drive_0.db3";
}

std::size_t files_in(const std::filesystem::path& folder) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files += entry.path().filename().string().starts_with("adit_") ? 1U : 0U;
  }
  return files;
}

TEST(Rosbag2, MessagesAreReadAsTheyWereWritten) {
  const std::vector<test::SampleMessage> written = test::sample_messages(Encoding::cdr, 3);
  for (const bool pack_messages : {false, true}) {
    const TemporaryFolder folder;
    const auto file = open_rosbag2_database(write_rosbag2(folder, pack_messages));
    const Reading reading = read(*file);
    EXPECT_TRUE(reading.errors.empty());
    EXPECT_EQ(reading.messages.size(), written.size());
    EXPECT_TRUE(is_prefix(reading.messages, written));
    EXPECT_EQ(file->span().value().end, written.back().received);
    const std::vector<Channel> channels = test::sample_channels(Encoding::cdr);
    ASSERT_EQ(file->channels().size(), channels.size());
    for (std::size_t i = 0; i < channels.size(); ++i) {
      EXPECT_EQ(file->channels()[i].topic, channels[i].topic);
      EXPECT_EQ(file->channels()[i].type, channels[i].type);
      EXPECT_EQ(file->channels()[i].definition, channels[i].definition);
      EXPECT_EQ(file->channels()[i].messages, channels[i].topic == "/tf_static" ? 1U : 3U);
    }
  }
}

TEST(Rosbag2, ChannelsAndTimesAreChosen) {
  const TemporaryFolder folder;
  const auto file = open_rosbag2_database(write_rosbag2(folder, false));
  const Reading imu = read(*file, {.channels = {1}});
  ASSERT_EQ(imu.messages.size(), 3U);
  const Nanoseconds middle = imu.messages[1].received;
  EXPECT_EQ(read(*file, {.channels = {1}, .begin = middle}).messages.size(), 2U);
  EXPECT_EQ(read(*file, {.begin = middle, .end = middle}).messages.size(), 1U);
}

TEST(Rosbag2, FileThatIsPackedAsAWholeIsUnpackedAndCleanedUp) {
  const TemporaryFolder folder;
  const std::string plain = content_of(write_rosbag2(folder, false));
  const std::vector<std::byte> packed =
      compress(Compression::zstd, std::as_bytes(std::span(plain)));
  const std::string bytes(reinterpret_cast<const char*>(packed.data()), packed.size());
  const std::size_t before = files_in(std::filesystem::temp_directory_path());
  {
    const auto file = open_rosbag2_database(folder.write("p/drive_0.db3.zstd", bytes));
    EXPECT_EQ(read(*file).messages.size(), 22U);
    EXPECT_EQ(file->format(), "rosbag2 SQLite zstd");
  }
  for (std::size_t size = 4; size < bytes.size(); size += 13) {
    try {
      open_rosbag2_database(folder.write("p/cut.db3.zstd", bytes.substr(0, size)));
      ADD_FAILURE() << "opened with " << size << " bytes";
    } catch (const InputError& error) {
      EXPECT_EQ(error.file().filename(), "cut.db3.zstd");
    }
  }
  EXPECT_LE(files_in(std::filesystem::temp_directory_path()), before);
}

TEST(Rosbag2, SplitRecordingIsOneStreamOfTheSameTopics) {
  const TemporaryFolder folder;
  const std::vector<test::SampleMessage> all = test::sample_messages(Encoding::cdr, 12);
  for (int part = 0; part < 12; ++part) {
    McapWriter writer(folder / ("drive_" + std::to_string(part) + ".mcap"), {});
    for (const Channel& channel : test::sample_channels(Encoding::cdr)) {
      writer.add_channel(channel);
    }
    for (const test::SampleMessage& message : all) {
      if ((message.received - test::kStart) / std::chrono::milliseconds(100) == part) {
        writer.write(message.channel, message.received, message.bytes);
      }
    }
    writer.close();
  }
  folder.write("metadata.yaml", "rosbag2_bagfile_information: {}\n");
  const auto recording = open_recording(folder.path());
  EXPECT_EQ(recording->topics().size(), 8U);
  EXPECT_EQ(recording->topics()[0].messages, 12U);
  const test::ReadEvents imu = test::read_all(*recording, {.topics = {1}});
  ASSERT_EQ(imu.events.size(), 12U);
  for (uint32_t i = 0; i < 12; ++i) {
    EXPECT_EQ(stamp_of(imu.events[i]), test::header(i, "").stamp) << i;
  }
  EXPECT_EQ(test::read_all(*recording, {.topics = {1}, .skip = 7}).events.size(), 5U);
}

TEST(Rosbag2, DamagedDatabasesAreRefusedOrReadUpToTheDamage) {
  const TemporaryFolder folder;
  const std::string plain = content_of(write_rosbag2(folder, false, 20));
  const std::vector<test::SampleMessage> written = test::sample_messages(Encoding::cdr, 20);
  std::size_t partly = 0;
  for (std::size_t size = 16; size < plain.size(); size += 1021) {
    const std::filesystem::path cut = folder.write("cut.db3", plain.substr(0, size));
    try {
      const auto file = open_rosbag2_database(cut);
      const Reading reading = read(*file);
      // What is missing may be nothing that the messages need.
      EXPECT_TRUE(reading.messages.size() == written.size() || reading.errors.size() == 1);
      partly += reading.messages.empty() ? 0U : 1U;
    } catch (const InputError& error) {
      EXPECT_EQ(error.file(), cut);
    }
  }
  EXPECT_GT(partly, 0U) << "none of the cut files gave a message";
}

TEST(Rosbag2, DatabaseOfSomethingElseIsNamed) {
  const TemporaryFolder folder;
  {
    const SqliteDatabase database(folder / "other.db3", SqliteDatabase::Mode::create);
    database.execute("CREATE TABLE birds(name TEXT)");
  }
  try {
    open_rosbag2_database(folder / "other.db3");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("no such table: topics"), std::string::npos) << error.what();
  }
}

TEST(Rosbag2, FolderThatIsNotEmptyIsNotWrittenInto) {
  const TemporaryFolder folder;
  folder.write("drive/notes.txt", "mine");
  EXPECT_THROW(Rosbag2Writer(folder / "drive", {}), OutputError);
}

}  // namespace
}  // namespace adit
