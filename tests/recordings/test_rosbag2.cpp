// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/container_support.hpp"
#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/recordings/message_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/compression.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/containers/rosbag2_metadata.hpp"
#include "adit/tools/containers/rosbag2_reader.hpp"
#include "adit/tools/containers/rosbag2_writer.hpp"
#include "adit/tools/containers/sqlite_database.hpp"
#include "adit/tools/recordings/message_recording.hpp"
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

/// A variable of the environment that has its old value again at the end.
class TemporaryVariable {
 public:
  TemporaryVariable(const char* name, const std::filesystem::path& value) : name_(name) {
    if (const char* old = std::getenv(name)) {
      old_ = old;
    }
    ::setenv(name, value.c_str(), 1);
  }
  ~TemporaryVariable() {
    if (old_) {
      ::setenv(name_, old_->c_str(), 1);
    } else {
      ::unsetenv(name_);
    }
  }
  TemporaryVariable(const TemporaryVariable&) = delete;
  TemporaryVariable& operator=(const TemporaryVariable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> old_;
};

TEST(Rosbag2, FileThatIsPackedAsAWholeIsUnpackedAndCleanedUp) {
  const TemporaryFolder folder;
  const std::string plain = content_of(write_rosbag2(folder, false));
  const std::vector<std::byte> packed =
      compress(Compression::zstd, std::as_bytes(std::span(plain)));
  const std::string bytes(reinterpret_cast<const char*>(packed.data()), packed.size());
  // A folder for temporary files of its own: others write to the system's.
  const test::TemporaryFolder temporary;
  const TemporaryVariable variable("TMPDIR", temporary.path());
  const std::size_t before = files_in(std::filesystem::temp_directory_path());
  {
    const auto files = open_message_files(folder.write("p/drive_0.db3.zstd", bytes));
    EXPECT_EQ(read(*files.at(0)).messages.size(), 22U);
    EXPECT_EQ(files[0]->format(), "rosbag2 SQLite, packed with zstd");
  }
  for (std::size_t size = 4; size < bytes.size(); size += 13) {
    try {
      open_message_files(folder.write("p/cut.db3.zstd", bytes.substr(0, size)));
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

/// A recording in MCAP as rosbag2 writes it.
void write_mcap(const std::filesystem::path& file, bool pack_messages) {
  McapWriter writer(file, {.profile = "ros2"});
  for (const Channel& channel : test::sample_channels(Encoding::cdr)) {
    writer.add_channel(channel);
  }
  for (const test::SampleMessage& message : test::sample_messages(Encoding::cdr, 3)) {
    writer.write(message.channel, message.received,
                 pack_messages ? compress(Compression::zstd, message.bytes) : message.bytes);
  }
  writer.close();
}

TEST(Rosbag2, McapStorageThatIsPackedIsReadAsItWasWritten) {
  const std::vector<test::SampleMessage> written = test::sample_messages(Encoding::cdr, 3);
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "by_message");
  std::filesystem::create_directories(folder / "by_file");
  write_mcap(folder / "by_message/drive_0.mcap", true);
  write_mcap(folder / "by_file/drive_0.mcap", false);
  const std::string plain = content_of(folder / "by_file/drive_0.mcap");
  const auto packed = compress(Compression::zstd, std::as_bytes(std::span(plain)));
  folder.write("by_file/drive_0.mcap.zstd",
               {reinterpret_cast<const char*>(packed.data()), packed.size()});
  for (const char* name : {"by_message", "by_file", "by_file/drive_0.mcap.zstd"}) {
    const auto files = open_message_files(folder / name);
    ASSERT_EQ(files.size(), 1U) << name << ": a file and what it was packed to count once";
    const Reading reading = read(*files[0]);
    EXPECT_TRUE(reading.errors.empty()) << name;
    EXPECT_EQ(reading.messages.size(), written.size()) << name;
    EXPECT_TRUE(is_prefix(reading.messages, written)) << name;
  }
  std::filesystem::remove(folder / "by_file/drive_0.mcap");
  EXPECT_EQ(open_message_files(folder / "by_file").at(0)->format(), "MCAP zstd, packed with zstd");
  folder.write("cut.mcap.zstd",
               std::string_view(reinterpret_cast<const char*>(packed.data()), packed.size() / 2));
  EXPECT_THROW(open_message_files(folder / "cut.mcap.zstd"), InputError);
}

TEST(Rosbag2, DamageOfAPackedMessageIsToldAndTheOthersAreRead) {
  const TemporaryFolder folder;
  McapWriter writer(folder / "drive_0.mcap", {});
  writer.add_channel(test::sample_channels(Encoding::cdr).at(1));
  for (uint32_t i = 0; i < 5; ++i) {
    auto packed = compress(Compression::zstd, ros::encode(Encoding::cdr, test::imu_message(i)));
    if (i == 2) {
      packed.resize(packed.size() / 2);
    }
    writer.write(0, test::header(i, "").stamp, packed);
  }
  writer.close();
  const Reading reading = read(*open_message_files(folder / "drive_0.mcap").at(0));
  EXPECT_EQ(reading.messages.size(), 4U);
  ASSERT_EQ(reading.errors.size(), 1U);
  EXPECT_NE(reading.errors[0].found().find("its packed message cannot be unpacked"),
            std::string::npos);
}

/// A message that fills a batch of the writer.
std::vector<std::byte> large_message() {
  std::vector<std::byte> bytes(9U << 20U);
  bytes[1] = std::byte{1};
  return bytes;
}

TEST(Rosbag2, WriterThatWasKilledLeavesWhatItHadCommitted) {
  const TemporaryFolder folder;
  const TemporaryFolder killed;
  {
    Rosbag2Writer writer(folder / "drive", {});
    const std::size_t channel = writer.add_channel(test::sample_channels(Encoding::cdr).at(0));
    for (int i = 0; i < 3; ++i) {
      writer.write(channel, test::kStart + Nanoseconds(i), large_message());
    }
    // As it lies there when the process ends.
    std::filesystem::copy(folder / "drive", killed / "drive");
  }
  const auto file = open_rosbag2_database(killed / "drive/drive_0.db3");
  EXPECT_EQ(read(*file).messages.size(), 3U);
}

TEST(Rosbag2, JournalOfAKilledWriterIsAppliedToACopy) {
  for (const bool log : {false, true}) {
    const TemporaryFolder folder;
    const std::filesystem::path database = folder / "drive/drive_0.db3";
    write_rosbag2(folder, false);
    {
      const SqliteDatabase writer(database, SqliteDatabase::Mode::create);
      writer.execute(log ? "PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 0"
                         : "PRAGMA cache_size = 1; PRAGMA cache_spill = 1");
      writer.execute("BEGIN; UPDATE messages SET data = zeroblob(5000), timestamp = timestamp + 1");
      if (log) {
        writer.execute("COMMIT");
      }
      std::filesystem::copy(folder / "drive", folder / "killed");
    }
    if (log) {  // as from a medium that cannot be written to
      std::filesystem::remove(folder / "killed/drive_0.db3-shm");
      std::filesystem::permissions(folder / "killed", std::filesystem::perms::owner_read |
                                                          std::filesystem::perms::owner_exec);
    }
    const std::string before = content_of(folder / "killed/drive_0.db3");
    const auto file = open_rosbag2_database(folder / "killed/drive_0.db3");
    const Reading reading = read(*file);
    EXPECT_EQ(reading.messages.size(), 22U);
    EXPECT_TRUE(reading.errors.empty());
    EXPECT_EQ(reading.messages.at(0).bytes.size() == 5000, log) << "what was committed, no more";
    EXPECT_EQ(content_of(folder / "killed/drive_0.db3"), before);
    std::filesystem::permissions(folder / "killed", std::filesystem::perms::owner_all);
    if (!log) {
      EXPECT_EQ(file->format(), "rosbag2 SQLite, recovered by its journal");
    }
  }
}

TEST(Rosbag2, QualitiesOfServiceAreTheSameInTheDatabaseAndInMetadata) {
  const TemporaryFolder folder;
  const std::string numbers =
      "- history: 1\n  depth: 5\n  reliability: 2\n  durability: 1\n  deadline:\n    sec: 9\n"
      "    nsec: 0\n  liveliness: 1\n  liveliness_lease_duration:\n    sec: 9\n    nsec: 0\n";
  {
    Rosbag2Writer writer(folder / "drive", {.ros_distro = "humble"});
    const auto add = [&](const char* topic, std::map<std::string, std::string> metadata) {
      writer.add_channel({.topic = topic,
                          .type = "sensor_msgs/Imu",
                          .encoding = Encoding::cdr,
                          .definition = {},
                          .messages = std::nullopt,
                          .metadata = std::move(metadata)});
    };
    add("/told", {{"offered_qos_profiles", numbers}, {"topic_type_hash", "RIHS01_7"}});
    add("/untold", {});
    add("/nonsense", {{"offered_qos_profiles", "{\x01\n"}});
    writer.close();
  }
  const std::string yaml = content_of(folder / "drive/metadata.yaml");
  for (const char* part :
       {"offered_qos_profiles:\n          - history: keep_last\n            depth: 5\n"
        "            reliability: best_effort\n            durability: transient_local\n",
        "            liveliness: automatic\n            liveliness_lease_duration:\n",
        "type_description_hash: \"RIHS01_7\"", "ros_distro: \"humble\""}) {
    EXPECT_NE(yaml.find(part), std::string::npos) << part << "\n" << yaml;
  }
  const auto file = open_rosbag2_database(folder / "drive/drive_0.db3");
  EXPECT_EQ(file->ros_distro(), "humble");
  EXPECT_EQ(told_ros_distro(folder / "drive"), "humble");
  const std::string in_database = file->channels().at(0).metadata.at("offered_qos_profiles");
  EXPECT_EQ(in_database, named_qos_profiles(numbers));
  EXPECT_EQ(named_qos_profiles(in_database), in_database) << "names stay as they are";
  EXPECT_EQ(file->channels()[0].metadata.at("topic_type_hash"), "RIHS01_7");
  EXPECT_TRUE(file->channels().at(1).metadata.empty());
  EXPECT_TRUE(file->channels().at(2).metadata.empty()) << "what is no YAML is in neither";
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
    EXPECT_NE(error.found().find("without a table of topics"), std::string::npos) << error.what();
  }
}

TEST(Rosbag2, FolderThatIsNotEmptyIsNotWrittenInto) {
  const TemporaryFolder folder;
  folder.write("drive/notes.txt", "mine");
  EXPECT_THROW(Rosbag2Writer(folder / "drive", {}), OutputError);
}

}  // namespace
}  // namespace adit
