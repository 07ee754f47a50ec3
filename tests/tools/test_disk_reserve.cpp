// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/disk_reserve.hpp"

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/live/growing_messages.hpp"
#include "adit/tools/live/message_recorder.hpp"

namespace adit {
namespace {

constexpr std::size_t kMessage = 1U << 16U;  // bytes
constexpr uint8_t kMessages = 200;           // 13 MB, of which 1 MB stays

/// Bytes that the file takes on the disk.
uint64_t taken_by(const std::filesystem::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 ? static_cast<uint64_t>(status.st_blocks) * 512U : 0;
}

class DiskReserveTest : public ::testing::Test {
 protected:
  /// The last byte of each message that is read.
  static std::vector<uint8_t> rest_of(MessageStream& stream) {
    std::vector<uint8_t> found;
    while (const auto message = stream.next()) {
      found.push_back(static_cast<uint8_t>(message->bytes.back()));
    }
    return found;
  }

  void record_until(uint8_t end) {
    for (; written_ < end; ++written_) {
      recorder_.write(0, Nanoseconds(written_),
                      std::vector<std::byte>(kMessage, static_cast<std::byte>(written_)));
    }
  }

  test::TemporaryFolder folder_;
  std::vector<std::string> notes_;
  uint8_t written_ = 0;
  MessageRecorder recorder_{folder_.path() / "live.mcap",
                            {{.topic = "/points",
                              .type = "sensor_msgs/PointCloud2",
                              .encoding = Encoding::cdr,
                              .definition = "",
                              .messages = {}}}};
};

TEST_F(DiskReserveTest, ARecordingStaysWholeWhereThereIsRoom) {
  recorder_.reserve().begin(
      recorder_.path(), [&](const std::string& what) { notes_.push_back(what); }, 1);
  record_until(kMessages);
  recorder_.finish();
  recorder_.reserve().cut();
  EXPECT_FALSE(recorder_.reserve().kept());
  EXPECT_TRUE(notes_.empty());
  EXPECT_GT(taken_by(recorder_.path()), kMessages * kMessage);
}

TEST_F(DiskReserveTest, OnAFullDiskWhatIsReadIsFreedAndNothingIsMissed) {
  recorder_.reserve().begin(
      recorder_.path(), [&](const std::string& what) { notes_.push_back(what); },
      std::numeric_limits<uint64_t>::max() / 2);
  GrowingMessages growing(recorder_);
  growing.wait_for_more();
  const auto stream = growing.messages({});
  const auto slower = growing.messages({});
  std::vector<uint8_t> read;
  for (uint8_t end = 1; end <= kMessages; ++end) {
    record_until(end);
    const auto message = stream->next();
    ASSERT_TRUE(message);
    read.push_back(static_cast<uint8_t>(message->bytes.back()));
  }
  const std::optional<uint64_t> kept = recorder_.reserve().kept();
  ASSERT_TRUE(kept);
  EXPECT_EQ(notes_.size(), 1U);
  EXPECT_GT(taken_by(recorder_.path()), kMessages * kMessage) << "one reader has read nothing yet";
  recorder_.finish();
  EXPECT_EQ(rest_of(*slower), read);
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i], i);
  }
  EXPECT_LT(taken_by(recorder_.path()), *kept + (uint64_t{2} << 20U));
  // One that begins now has what stays, and what is not freed yet.
  const std::vector<uint8_t> late = rest_of(*growing.messages({}));
  EXPECT_LT(late.size(), kMessages / 2U);
  EXPECT_EQ(late.front(), 0);
  recorder_.reserve().cut();
  EXPECT_EQ(std::filesystem::file_size(recorder_.path()), *kept);
}

}  // namespace
}  // namespace adit
