// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Containers that do not hold what they declare: files and messages that are missing, counts that
// are wrong, files that nobody declared.
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/sequence_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/bag_reader.hpp"
#include "adit/tools/containers/mcap_reader.hpp"
#include "adit/tools/containers/rosbag2_metadata.hpp"
#include "adit/tools/recordings/message_files.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::Container;
using test::SampleMessage;
using test::TemporaryFolder;

constexpr Nanoseconds kPeriod = std::chrono::milliseconds(100);
constexpr const char* kIndented = "\n    - ";

/// A rosbag2 folder of splits of ten rounds each, and its metadata.yaml.
class Splits {
 public:
  explicit Splits(int splits) {
    const auto all = test::sample_messages(Encoding::cdr, static_cast<uint32_t>(10 * splits));
    for (int split = 0; split < splits; ++split) {
      std::vector<SampleMessage> part = all;
      std::erase_if(part, [&](const SampleMessage& message) {
        return (message.received - test::kStart) / (10 * kPeriod) != split;
      });
      test::write_messages(folder_, "bag/drive_" + std::to_string(split), Container::mcap, part);
    }
    declare(splits, 10 * splits);
  }

  void declare(int splits, int rounds) {
    std::string text = "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:";
    for (int split = 0; split < splits; ++split) {
      text += kIndented + ("drive_" + std::to_string(split) + ".mcap");
    }
    text += "\n  topics_with_message_count:\n";
    for (const char* topic : {"/points", "/imu"}) {
      text +=
          "    - topic_metadata:\n        name: " + std::string(topic) +
          "\n        offered_qos_profiles: \"- history: 3\\n  depth: 0\"\n      message_count: " +
          std::to_string(rounds) + "\n";
    }
    folder_.write("bag/metadata.yaml", text);
  }

  fs::path path() const { return folder_ / "bag"; }
  fs::path split(int number) const {
    return path() / ("drive_" + std::to_string(number) + ".mcap");
  }
  const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
};

/// What a recording declares and does not hold, in the order in which it is reported.
std::vector<DeclarationError> contradictions(const Recording& recording,
                                             const EventSelection& selection = {}) {
  std::vector<DeclarationError> found;
  const auto stream = recording.events(selection);
  for (bool more = true; more;) {
    try {
      more = stream->next().has_value();
    } catch (const DeclarationError& error) {
      found.push_back(error);
    } catch (const InputError&) {
      // damage
    }
  }
  return found;
}

TEST(DeclaredContent, OfHealthyRecordingsIsThere) {
  EXPECT_TRUE(contradictions(*open_recording(Splits(3).path())).empty());
  for (const Container container : test::kContainers) {
    const TemporaryFolder folder;
    const auto recording = open_recording(write_messages(
        folder, "a", container, test::sample_messages(test::encoding_of(container), 20)));
    EXPECT_TRUE(contradictions(*recording).empty()) << static_cast<int>(container);
    EXPECT_TRUE(recording->notices().empty()) << static_cast<int>(container);
  }
}

TEST(DeclaredContent, ASplitThatIsMissingIsReportedWhereItWouldBeAndItsMessagesAreCounted) {
  for (const int missing : {0, 1, 2}) {
    const Splits splits(3);
    fs::remove(splits.split(missing));
    const auto recording = open_recording(splits.path());
    EXPECT_EQ(recording->topics().at(0).messages, 20U);
    const auto found = contradictions(*recording);
    ASSERT_EQ(found.size(), 3U) << missing;
    EXPECT_EQ(found[0].file(), splits.split(missing));
    EXPECT_TRUE(found[0].loses());
    EXPECT_EQ(found[0].missing(), 0U) << "those are counted by topic";
    EXPECT_EQ(found[1].topic(), "/imu");
    EXPECT_EQ(found[2].topic(), "/points");
    EXPECT_EQ(found[2].missing(), 10U);
    EXPECT_NE(found[2].found().find("declares 30 messages on /points, but 20 can be read"),
              std::string::npos)
        << found[2].what();
    // Of topics that are not read nothing is said.
    EXPECT_EQ(contradictions(*recording, {.topics = {0}}).size(), 2U);
    // A part of the time is not compared.
    EXPECT_TRUE(contradictions(*recording, {.begin = test::kStart}).empty());
  }
}

TEST(DeclaredContent, WithoutAnyOfTheFilesOfMetadataARecordingIsRefused) {
  const Splits splits(2);
  fs::rename(splits.split(0), splits.path() / "renamed_0.mcap");
  fs::remove(splits.split(1));
  try {
    open_recording(splits.path());
    ADD_FAILURE() << "opened";
  } catch (const InputError& error) {
    EXPECT_EQ(error.file().filename(), "metadata.yaml");
    EXPECT_NE(error.remedy().find("move it away"), std::string::npos);
  }
}

TEST(DeclaredContent, FilesThatMetadataDoesNotListAreNotReadAndANoticeSaysSo) {
  const Splits splits(2);
  fs::copy(splits.split(0), splits.path() / "backup.mcap");
  const auto recording = open_recording(splits.path());
  const test::ReadEvents read = test::read_all(*recording, {.topics = {0}});
  EXPECT_EQ(read.events.size(), 20U);
  EXPECT_TRUE(read.errors.empty());
  ASSERT_EQ(recording->notices().size(), 1U);
  EXPECT_EQ(recording->notices()[0].kind, "unlisted_file");
  EXPECT_NE(recording->notices()[0].found.find("backup.mcap"), std::string::npos);
}

TEST(DeclaredContent, WrongCountsInMetadataAreReportedWhicheverWay) {
  Splits splits(2);
  splits.declare(2, 25);
  auto found = contradictions(*open_recording(splits.path()));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[1].missing(), 5U);
  splits.declare(2, 15);
  found = contradictions(*open_recording(splits.path()));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[1].missing(), 0U) << "nothing is lost";
}

TEST(DeclaredContent, MetadataThatListsNoFileIsReportedAndAllAreRead) {
  for (const char* text : {"", "rosbag2_bagfile_information: {}\n", "][", ": :\n -\n"}) {
    const Splits splits(2);
    splits.folder().write("bag/metadata.yaml", text);
    const auto recording = open_recording(splits.path());
    const test::ReadEvents read = test::read_all(*recording, {.topics = {0}});
    EXPECT_EQ(read.events.size(), 20U) << text;
    ASSERT_EQ(read.errors.size(), 1U) << text;
    EXPECT_EQ(read.errors[0].file().filename(), "metadata.yaml");
  }
}

TEST(DeclaredContent, MetadataMayBeNamedInsteadOfItsFolder) {
  const Splits splits(2);
  const auto recording = open_recording(splits.path() / "metadata.yaml");
  EXPECT_EQ(test::read_all(*recording, {.topics = {0}}).events.size(), 20U);
}

TEST(DeclaredContent, WithoutMetadataAGapInTheNumbersOfTheFilesIsReported) {
  const Splits splits(4);
  fs::remove(splits.path() / "metadata.yaml");
  EXPECT_TRUE(contradictions(*open_recording(splits.path())).empty());
  fs::remove(splits.split(0));  // a part of a recording, from there on
  EXPECT_TRUE(contradictions(*open_recording(splits.path())).empty());
  fs::remove(splits.split(2));
  const auto found = contradictions(*open_recording(splits.path()));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].file(), splits.split(2));
  EXPECT_EQ(found[0].missing(), std::nullopt) << "nothing tells how many are lost";
}

/// Where the statistics record of an MCAP file begins, behind its opcode and length.
std::size_t statistics_of(const std::string& bytes) {
  uint64_t summary = 0;
  std::memcpy(&summary, bytes.data() + bytes.size() - 8 - 20, sizeof summary);
  for (std::size_t at = summary; at < bytes.size();) {
    uint64_t length = 0;
    std::memcpy(&length, bytes.data() + at + 1, sizeof length);
    if (bytes[at] == 0x0b) {
      return at + 9;
    }
    at += 9 + length;
  }
  return 0;
}

/// The same file with a number of its statistics changed, and without the check sum over them.
std::string with_statistics(std::string bytes, std::size_t at, uint64_t value, std::size_t size) {
  std::memcpy(bytes.data() + statistics_of(bytes) + at, &value, size);
  std::memset(bytes.data() + bytes.size() - 8 - 4, 0, 4);
  return bytes;
}

TEST(DeclaredContent, StatisticsOfMcapAreComparedWithTheFile) {
  struct Change {
    const char* what;
    std::size_t at;
    uint64_t value;
    std::size_t size;
    const char* found;
  };
  // messages u64, schemas u16, channels u32, attachments u32, metadata u32, chunks u32, begin u64,
  // end u64, then channel and count of each, after their length.
  const std::size_t first_count = 8 + 2 + 4 + 4 + 4 + 4 + 8 + 8 + 4 + 2;
  for (const Change& change :
       {Change{"messages", 0, 500, 8, "declare 500 messages in all"},
        Change{"channels", 10, 9, 4, "declare 9 topics"},
        Change{"chunks", 22, 999, 4, "declare 999 chunks"},
        Change{"begin", 26, 1000, 8, "other times"}, Change{"end", 34, 1000, 8, "other times"},
        Change{"points", first_count, 50, 8, "declares 50 messages on /points, but 20"}}) {
    for (const Container container : {Container::mcap, Container::mcap_one_chunk}) {
      const TemporaryFolder folder;
      const fs::path file =
          write_messages(folder, "a", container, test::sample_messages(Encoding::cdr, 20));
      const fs::path wrong = folder.write(
          "wrong.mcap",
          with_statistics(test::content_of(file), change.at, change.value, change.size));
      const auto recording = open_recording(wrong);
      EXPECT_EQ(recording->topics().at(0).messages, 20U) << change.what;
      const auto found = contradictions(*recording);
      ASSERT_FALSE(found.empty()) << change.what;
      EXPECT_NE(std::string(found[0].what()).find(change.found), std::string::npos)
          << found[0].what();
      EXPECT_EQ(test::read_all(*recording, {.topics = {0}}).events.size(), 20U);
    }
  }
}

TEST(DeclaredContent, StatisticsWithoutCountsByTopicAreNoFault) {
  const TemporaryFolder folder;
  const fs::path file =
      write_messages(folder, "a", Container::mcap, test::sample_messages(Encoding::cdr, 20));
  std::string bytes = test::content_of(file);
  // The map of counts by channel becomes empty: its entries go.
  const std::size_t length_at = statistics_of(bytes) + 8 + 2 + 4 + 4 + 4 + 4 + 8 + 8;
  uint32_t length = 0;
  std::memcpy(&length, bytes.data() + length_at, sizeof length);
  bytes.erase(length_at + 4, length);
  std::memset(bytes.data() + length_at, 0, 4);
  uint64_t record = 0;
  std::memcpy(&record, bytes.data() + statistics_of(bytes) - 8, sizeof record);
  record -= length;
  std::memcpy(bytes.data() + statistics_of(bytes) - 8, &record, sizeof record);
  std::memset(bytes.data() + bytes.size() - 8 - 4, 0, 4);
  const auto recording = open_recording(folder.write("b.mcap", bytes));
  EXPECT_EQ(recording->topics().at(0).messages, 20U);
  EXPECT_TRUE(contradictions(*recording).empty());
}

TEST(DeclaredContent, MessagesThatAnIndexCountsAndAChunkDoesNotHoldAreMissed) {
  const TemporaryFolder folder;
  for (const Container container : {Container::mcap, Container::bag}) {
    const Encoding encoding = test::encoding_of(container);
    const fs::path file =
        write_messages(folder, "a", container, test::sample_messages(encoding, 20));
    const auto recording = open_recording(test::damage_a_chunk(folder, file));
    uint64_t missing = 0;
    for (const DeclarationError& error : contradictions(*recording)) {
      missing += error.missing().value_or(0);
    }
    EXPECT_EQ(test::read_all(*recording).events.size() + missing, 20U * 7U + 2U)
        << file.extension();
    EXPECT_GT(missing, 0U) << file.extension();
  }
}

/// A field of a record's header in a bag, with its first value.
std::size_t find_field(const std::string& bytes, const std::string& name, std::size_t from) {
  return bytes.find(name + "=", from) + name.size() + 1;
}

TEST(DeclaredContent, TheIndexOfABagIsComparedWithTheBag) {
  const TemporaryFolder folder;
  const fs::path file =
      write_messages(folder, "a", Container::bag, test::sample_messages(Encoding::ros1, 20));
  const std::string whole = test::content_of(file);
  for (const auto& [field, found] :
       {std::pair{"chunk_count", "chunks in the index"}, std::pair{"conn_count", "topics"}}) {
    std::string bytes = whole;
    bytes[find_field(bytes, field, 0)] = 99;
    const auto recording = open_recording(folder.write("b.bag", bytes));
    EXPECT_EQ(recording->topics().at(0).messages, 20U);
    const auto errors = contradictions(*recording);
    ASSERT_EQ(errors.size(), 1U) << field;
    EXPECT_NE(errors[0].found().find(found), std::string::npos) << errors[0].what();
  }
  // The counts of the last chunk's record: pairs of connection and count behind its header.
  for (const int by : {+3, -1}) {
    std::string bytes = whole;
    bytes[bytes.size() - 4] = static_cast<char>(bytes[bytes.size() - 4] + by);
    const auto recording = open_recording(folder.write("c.bag", bytes));
    const auto errors = contradictions(*recording);
    ASSERT_EQ(errors.size(), 1U) << by;
    EXPECT_EQ(errors[0].missing(), by > 0 ? 3U : 0U);
    EXPECT_EQ(test::read_all(*recording).events.size(), 20U * 7U + 2U) << "all that is there";
  }
}

TEST(DeclaredContent, YamlAsOtherProgramsWriteItIsUnderstood) {
  const Splits splits(2);
  // Sorted keys, items as far in as their key, strings over several lines.
  splits.folder().write(
      "bag/metadata.yaml",
      "rosbag2_bagfile_information:\n"
      "  compression_format: ''\n"
      "  custom_data: null\n"
      "  files:\n"
      "  - message_count: 72\n"
      "    path: drive_0.mcap\n"
      "  message_count: 40\n"
      "  relative_file_paths: [drive_0.mcap, \"drive_1.mcap\"]\n"
      "  topics_with_message_count:\n"
      "  - message_count: 20\n"
      "    topic_metadata:\n"
      "      name: '/points'\n"
      "      type_description_hash: \n"
      "        RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5\n"
      "      offered_qos_profiles: '- history: 3\n"
      "\n"
      "        depth: 0'\n"
      "  - message_count: 20  # samples\n"
      "    topic_metadata: \n"
      "      name: /imu\n");
  EXPECT_TRUE(contradictions(*open_recording(splits.path())).empty());
  const auto declared = read_rosbag2_declaration(splits.path());
  ASSERT_TRUE(declared.has_value());
  EXPECT_EQ(declared->files.size(), 2U);
  EXPECT_EQ(declared->topics.size(), 2U);
  EXPECT_EQ(declared->messages, 40U);
}

TEST(DeclaredContent, MetadataThatIsCutOffOrDamagedNeverHinders) {
  const Splits splits(2);
  const std::string whole = test::content_of(splits.path() / "metadata.yaml");
  for (std::size_t size = 0; size < whole.size(); size += 3) {
    for (const bool cut : {true, false}) {
      std::string text = cut ? whole.substr(0, size) : whole;
      if (!cut) {
        text[size] = "\"'[-: \n\t"[size % 8];
      }
      splits.folder().write("bag/metadata.yaml", text);
      try {
        const auto recording = open_recording(splits.path());
        test::read_all(*recording);
      } catch (const InputError& error) {  // none of the files that it lists is there
        EXPECT_EQ(error.file().filename(), "metadata.yaml");
      }
    }
  }
}

}  // namespace
}  // namespace adit
