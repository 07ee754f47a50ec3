// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Several files that are one recording, since their times follow each other.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/sequence_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/recordings/message_files.hpp"
#include "adit/tools/support/fingerprint.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::Container;
using test::SampleMessage;
using test::TemporaryFolder;

constexpr Nanoseconds kPeriod = std::chrono::milliseconds(100);

/// The rounds from `first` on, `count` of them.
std::vector<SampleMessage> rounds(Encoding encoding, int first, int count) {
  auto messages = test::sample_messages(encoding, static_cast<uint32_t>(first + count));
  std::erase_if(messages, [&](const SampleMessage& message) {
    return (message.received - test::kStart) / kPeriod < first;
  });
  return messages;
}

class SeveralRecordings : public testing::TestWithParam<Container> {
 protected:
  fs::path write(const std::string& name, int first, int count) const {
    return write_messages(folder_, name, GetParam(),
                          rounds(test::encoding_of(GetParam()), first, count));
  }
  TemporaryFolder folder_;
};

TEST_P(SeveralRecordings, ThatFollowEachOtherAreOneInWhateverOrderTheyAreGiven) {
  const fs::path first = write("z", 0, 20);
  const fs::path second = write("a", 20, 10);
  const fs::path whole = write("whole", 0, 30);
  const test::ReadEvents expected = test::read_all(*open_recording(whole));
  for (const auto& paths : {std::vector{first, second}, std::vector{second, first}}) {
    const auto recording = open_recording(paths);
    EXPECT_EQ(recording->topics().at(0).messages, 30U);
    const test::ReadEvents read = test::read_all(*recording);
    EXPECT_TRUE(read.errors.empty());
    ASSERT_EQ(read.events.size(), expected.events.size());
    for (std::size_t i = 0; i < read.events.size(); ++i) {
      EXPECT_EQ(stamp_of(read.events[i]), stamp_of(expected.events[i]));
      EXPECT_EQ(read.events[i].topic, expected.events[i].topic);
    }
  }
  EXPECT_EQ(open_recording(std::vector{whole})->topics().at(0).messages, 30U);
}

TEST_P(SeveralRecordings, WhoseTimesOverlapAreRefusedWithTheReason) {
  const fs::path first = write("a", 0, 30);
  const fs::path second = write("b", 10, 30);
  try {
    open_recording(std::vector{second, first});
    ADD_FAILURE() << "opened";
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("its times overlap with those of"), std::string::npos)
        << error.what();
    EXPECT_NE(error.found().find("by 1.9 s"), std::string::npos) << error.what();
    EXPECT_NE(error.remedy().find("Name one of them"), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryContainer, SeveralRecordings, testing::ValuesIn(test::kContainers));

TEST(SeveralRecordingsOf, AFolderOfBagsOrMcapFilesAreOneByTheirTimes) {
  for (const Container container : {Container::bag, Container::mcap}) {
    const Encoding encoding = test::encoding_of(container);
    const TemporaryFolder folder;
    write_messages(folder, "drives/drive_b", container, rounds(encoding, 0, 10));
    write_messages(folder, "drives/drive_a", container, rounds(encoding, 10, 10));
    const auto recording = open_recording(folder / "drives");
    EXPECT_EQ(recording->topics().at(0).messages, 20U);
    const test::ReadEvents read = test::read_all(*recording, {.topics = {0}});
    EXPECT_TRUE(read.errors.empty());
    EXPECT_EQ(test::largest_step_back(read.events), Nanoseconds(0));
    write_messages(folder, "drives/copy", container, rounds(encoding, 0, 15));
    EXPECT_THROW(open_recording(folder / "drives"), InputError);
  }
}

TEST(SeveralRecordingsOf, ATopicWithAnotherTypeAreRefused) {
  const TemporaryFolder folder;
  const fs::path first = write_messages(folder, "a", Container::mcap, rounds(Encoding::cdr, 0, 10));
  McapWriter writer(folder / "b.mcap", {});
  Channel channel = test::sample_channels(Encoding::cdr).at(1);
  channel.topic = "/points";
  writer.add_channel(channel);
  writer.write(0, test::kStart + 20 * kPeriod, ros::encode(Encoding::cdr, test::imu_message(20)));
  writer.close();
  try {
    open_recording(std::vector{first, folder / "b.mcap"});
    ADD_FAILURE() << "opened";
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("its topic /points is of type sensor_msgs/Imu"), std::string::npos)
        << error.what();
  }
}

TEST(SeveralRecordingsOf, AnotherKindOrNoneAreRefused) {
  const TemporaryFolder folder;
  const fs::path first = write_messages(folder, "a", Container::mcap, rounds(Encoding::cdr, 0, 10));
  const fs::path cloud = folder.write("cloud.pcd", "VERSION .7\n");
  EXPECT_THROW(open_recording(std::vector{first, cloud}), InputError);
  EXPECT_THROW(open_recording(std::vector{first, folder / "none"}), InputError);
}

TEST(SeveralRecordingsOf, TheirFingerprintCoversAllOfThemInAnyOrder) {
  const TemporaryFolder folder;
  const fs::path a = folder.write("a", "one");
  const fs::path b = folder.write("b", "two");
  const fs::path c = folder.write("c", "three");
  EXPECT_EQ(fingerprint(std::vector{a}).hash, fingerprint(a).hash);
  EXPECT_EQ(fingerprint(std::vector{a, b}).hash, fingerprint(std::vector{b, a}).hash);
  EXPECT_NE(fingerprint(std::vector{a, b}).hash, fingerprint(std::vector{a, c}).hash);
  EXPECT_NE(fingerprint(std::vector{a, b}).hash, fingerprint(a).hash);
  EXPECT_EQ(fingerprint(std::vector{a, b}).bytes, 6U);
}

}  // namespace
}  // namespace adit
