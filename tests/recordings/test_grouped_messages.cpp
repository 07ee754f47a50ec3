// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Recordings whose messages are grouped by topic: all clouds, then all IMU samples. They are read
// in the order of their times.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/sequence_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"

namespace adit {
namespace {

using test::Container;
using test::kContainers;
using test::SampleMessage;
using test::TemporaryFolder;

constexpr Nanoseconds kSweepPeriod = std::chrono::milliseconds(100);
constexpr uint32_t kRounds = 42;  // stamps of more do not fit into what counts them

std::vector<std::string> kinds_of(const std::vector<RecordingNotice>& notices) {
  std::vector<std::string> kinds;
  for (const RecordingNotice& notice : notices) {
    kinds.push_back(notice.kind);
  }
  return kinds;
}

/// Every event of the messages, in whatever order.
std::multiset<std::pair<std::size_t, Nanoseconds>> stamps_of(const std::vector<Event>& events) {
  std::multiset<std::pair<std::size_t, Nanoseconds>> stamps;
  for (const Event& event : events) {
    if (!std::holds_alternative<StaticTransform>(event.value)) {
      stamps.insert({event.topic, stamp_of(event)});
    }
  }
  return stamps;
}

TEST(GroupedMessages, AreReadInTheOrderOfTheirTimesOfReceipt) {
  for (const Container container : kContainers) {
    const TemporaryFolder folder;
    const auto messages = test::grouped_messages(test::encoding_of(container));
    const auto recording = open_recording(write_messages(folder, "a", container, messages));
    const test::ReadEvents read = test::read_all(*recording);
    EXPECT_TRUE(read.errors.empty()) << static_cast<int>(container);
    EXPECT_LT(test::largest_step_back(read.events), kSweepPeriod) << static_cast<int>(container);
    const auto ordered = open_recording(write_messages(
        folder, "b", container, test::sample_messages(test::encoding_of(container), 20)));
    EXPECT_EQ(stamps_of(read.events), stamps_of(test::read_all(*ordered).events));
    EXPECT_TRUE(ordered->notices().empty()) << static_cast<int>(container);
    if (container != Container::rosbag2) {  // SQLite has an index of times
      EXPECT_EQ(kinds_of(recording->notices()), std::vector<std::string>{"grouped_by_topic"})
          << static_cast<int>(container);
    }
  }
}

/// Times of receipt as a converter writes them: later from message to message, a millisecond each.
std::vector<SampleMessage> received_as_written(std::vector<SampleMessage> messages) {
  Nanoseconds time = test::kStart + std::chrono::hours(1);
  for (SampleMessage& message : messages) {
    message.received = time;
    time += std::chrono::milliseconds(1);
  }
  return messages;
}

TEST(GroupedMessages, AreReadInTheOrderOfTheirStampsWhereTheyWereReceivedAsTheyAreWritten) {
  for (const Container container : kContainers) {
    const TemporaryFolder folder;
    const auto messages = received_as_written(test::grouped_messages(test::encoding_of(container)));
    const auto recording = open_recording(write_messages(folder, "a", container, messages));
    const test::ReadEvents read = test::read_all(*recording);
    EXPECT_TRUE(read.errors.empty()) << static_cast<int>(container);
    EXPECT_EQ(read.events.size(), 20U * 7U + 2U) << static_cast<int>(container);
    EXPECT_EQ(test::largest_step_back(read.events), Nanoseconds(0)) << static_cast<int>(container);
    EXPECT_EQ(kinds_of(recording->notices()), std::vector<std::string>{"grouped_by_topic"});
    for (const Event& event : read.events) {
      EXPECT_LT(event.received - test::kStart, std::chrono::seconds(3))
          << "the stamps are the times of receipt";
    }
  }
}

TEST(GroupedMessages, ThatAreReceivedOneTopicAfterTheOtherAreReadByTheirStamps) {
  for (const Container container : kContainers) {
    const TemporaryFolder folder;
    auto messages = test::grouped_messages(test::encoding_of(container));
    for (SampleMessage& message : messages) {  // each topic a minute after the one before
      message.received += std::chrono::minutes(message.channel);
    }
    const auto recording = open_recording(write_messages(folder, "a", container, messages));
    const test::ReadEvents read = test::read_all(*recording);
    EXPECT_TRUE(read.errors.empty()) << static_cast<int>(container);
    EXPECT_EQ(test::largest_step_back(read.events), Nanoseconds(0)) << static_cast<int>(container);
  }
}

TEST(GroupedMessages, ThatShareAChunkAtTheirBorderAreInOrderToo) {
  // Chunks as large as all IMU samples: these are in one with the last clouds.
  for (const bool as_written : {false, true}) {
    for (const uint64_t chunk_bytes : {2000U, 3000U, 4000U, 9000U}) {
      const TemporaryFolder folder;
      auto messages = test::grouped_messages(Encoding::cdr, 40);
      std::erase_if(messages, [](const SampleMessage& one) { return one.channel > 1; });
      if (as_written) {
        messages = received_as_written(std::move(messages));
      }
      McapWriter writer(folder / "a.mcap", {.chunk_bytes = chunk_bytes});
      for (const Channel& channel : test::sample_channels(Encoding::cdr)) {
        writer.add_channel(channel);
      }
      for (const SampleMessage& message : messages) {
        writer.write(message.channel, message.received, message.bytes);
      }
      writer.close();
      const test::ReadEvents read = test::read_all(*open_recording(folder / "a.mcap"));
      EXPECT_EQ(read.events.size(), 80U);
      EXPECT_LT(test::largest_step_back(read.events), kSweepPeriod) << as_written << chunk_bytes;
    }
  }
}

TEST(GroupedMessages, TopicsWhoseClocksDifferStayInTheOrderOfTheFile) {
  for (const Container container : kContainers) {
    const TemporaryFolder folder;
    auto messages = test::sample_messages(test::encoding_of(container), 40);
    for (SampleMessage& message : messages) {  // the IMU is a leap of TAI ahead
      if (message.channel == 1) {
        const auto i = static_cast<uint32_t>((message.received - test::kStart) / kSweepPeriod);
        ros::Imu imu = test::imu_message(i);
        imu.header.stamp += std::chrono::seconds(37);
        message.bytes = ros::encode(test::encoding_of(container), imu);
      }
    }
    const auto recording = open_recording(write_messages(folder, "a", container, messages));
    EXPECT_TRUE(recording->notices().empty()) << static_cast<int>(container);
    const test::ReadEvents read = test::read_all(*recording);
    EXPECT_TRUE(std::ranges::is_sorted(read.events, {}, &Event::received));
  }
}

TEST(GroupedMessages, AClockThatLeapsIsNoGrouping) {
  for (const Container container : kContainers) {
    const TemporaryFolder folder;
    auto messages = test::sample_messages(test::encoding_of(container), kRounds);
    for (SampleMessage& message : messages) {  // the IMU's, to TAI, in the middle
      const auto i = static_cast<uint32_t>((message.received - test::kStart) / kSweepPeriod);
      if (message.channel == 1 && i >= 20) {
        ros::Imu imu = test::imu_message(i);
        imu.header.stamp += std::chrono::seconds(37);
        message.bytes = ros::encode(test::encoding_of(container), imu);
      }
    }
    const auto recording = open_recording(write_messages(folder, "a", container, messages));
    EXPECT_TRUE(recording->notices().empty()) << static_cast<int>(container);
  }
}

TEST(GroupedMessages, AnImuThatStartsLateOrStopsEarlyIsNotGrouped) {
  for (const Container container : kContainers) {
    const TemporaryFolder folder;
    auto messages = test::sample_messages(test::encoding_of(container), kRounds);
    std::erase_if(messages, [](const SampleMessage& message) {
      const auto round = (message.received - test::kStart) / kSweepPeriod;
      return message.channel == 1 && (round < 10 || round > 30);
    });
    const auto recording = open_recording(write_messages(folder, "a", container, messages));
    EXPECT_TRUE(recording->notices().empty()) << static_cast<int>(container);
  }
}

TEST(GroupedMessages, ARecordersClockThatIsSetBackIsNoGrouping) {
  for (const Container container : {Container::mcap, Container::mcap_one_chunk, Container::bag}) {
    const TemporaryFolder folder;
    auto messages = test::sample_messages(test::encoding_of(container), 40);
    for (SampleMessage& message : messages) {
      if (message.received > test::kStart + 20 * kSweepPeriod) {
        message.received -= std::chrono::seconds(10);
      }
    }
    const auto recording = open_recording(write_messages(folder, "a", container, messages));
    EXPECT_TRUE(recording->notices().empty()) << static_cast<int>(container);
    const test::ReadEvents read = test::read_all(*recording);
    EXPECT_EQ(test::largest_step_back(read.events), Nanoseconds(0));
  }
}

TEST(GroupedMessages, OfSeveralBlocksAreReadInTheOrderOfTheirTimes) {
  for (const Container container : kContainers) {
    const TemporaryFolder folder;
    for (const bool as_written : {false, true}) {
      auto messages = test::sample_messages(test::encoding_of(container), kRounds);
      std::ranges::stable_sort(messages, {}, [](const SampleMessage& message) {
        return std::pair((message.received - test::kStart) / (14 * kSweepPeriod), message.channel);
      });
      if (as_written) {
        messages = received_as_written(std::move(messages));
      }
      const auto recording =
          open_recording(write_messages(folder, as_written ? "a" : "b", container, messages));
      EXPECT_LT(test::largest_step_back(test::read_all(*recording).events), kSweepPeriod)
          << static_cast<int>(container) << as_written;
    }
  }
}

TEST(GroupedMessages, ASensorThatPausesIsNotGrouped) {
  for (const Container container : kContainers) {
    const TemporaryFolder folder;
    auto messages = test::sample_messages(test::encoding_of(container), kRounds);
    std::erase_if(messages, [](const SampleMessage& message) {
      const auto round = (message.received - test::kStart) / kSweepPeriod;
      return message.channel == 0 && round > 8 && round < 34;
    });
    const auto recording = open_recording(write_messages(folder, "a", container, messages));
    EXPECT_TRUE(recording->notices().empty())
        << static_cast<int>(container) << ": " << recording->notices().front().found;
  }
}

TEST(GroupedMessages, SplitsThatHoldATopicEachAreReadTogether) {
  const TemporaryFolder folder;
  const auto all = test::sample_messages(Encoding::cdr, 20);
  std::string listed;
  for (const std::size_t channel : {0U, 1U, 2U}) {
    auto one = all;
    std::erase_if(one, [&](const SampleMessage& message) { return message.channel != channel; });
    const std::string name = "drive_" + std::to_string(channel);
    write_messages(folder, "bag/" + name, Container::mcap, one);
    listed += "    - " + name + ".mcap\n";
  }
  folder.write("bag/metadata.yaml",
               "rosbag2_bagfile_information:\n  relative_file_paths:\n" + listed);
  const test::ReadEvents read = test::read_all(*open_recording(folder / "bag"));
  EXPECT_TRUE(read.errors.empty());
  EXPECT_EQ(read.events.size(), 60U);
  EXPECT_LT(test::largest_step_back(read.events), kSweepPeriod);
}

TEST(GroupedMessages, APartOfTheTimeIsThatOfTheOrderTheyAreReadIn) {
  const TemporaryFolder folder;
  for (const bool as_written : {false, true}) {
    auto messages = test::grouped_messages(Encoding::cdr);
    if (as_written) {
      messages = received_as_written(std::move(messages));
    }
    const auto recording =
        open_recording(write_messages(folder, as_written ? "a" : "b", Container::mcap, messages));
    const test::ReadEvents read =
        test::read_all(*recording, {.topics = {0, 1},
                                    .begin = test::kStart + 5 * kSweepPeriod,
                                    .end = test::kStart + 10 * kSweepPeriod - Nanoseconds(1)});
    EXPECT_EQ(read.events.size(), 10U) << as_written;
    EXPECT_TRUE(read.errors.empty()) << as_written;
  }
}

TEST(GroupedMessages, DamageIsReportedOnceAndTheOthersAreRead) {
  const TemporaryFolder folder;
  const std::filesystem::path file =
      write_messages(folder, "a", Container::mcap, test::grouped_messages(Encoding::cdr));
  const std::size_t whole = test::read_all(*open_recording(file)).events.size();
  const test::ReadEvents read = test::read_all(*open_recording(test::damage_a_chunk(folder, file)));
  EXPECT_GT(read.events.size(), whole * 8 / 10);
  EXPECT_LT(read.events.size(), whole);
  EXPECT_FALSE(read.errors.empty());
  std::set<std::string> texts;
  for (const InputError& error : read.errors) {
    EXPECT_TRUE(texts.insert(error.what()).second) << error.what();
  }
}

}  // namespace
}  // namespace adit
