// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/live/growing_messages.hpp"
#include "adit/tools/live/live_folder.hpp"
#include "adit/tools/live/session_recordings.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

// Until the first of two recordings no longer gets what arrives (LiveSessions: 0.3 s).
constexpr auto kLongerThanBoth = std::chrono::milliseconds(350);

std::vector<std::byte> bytes_of(uint8_t value) {
  return {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{value}};
}

/// The payloads' last bytes in a capture.
std::vector<uint8_t> payloads_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string data{std::istreambuf_iterator<char>(in), {}};
  constexpr std::size_t kSize = 16 + 20 + 8 + 5;
  std::vector<uint8_t> found;
  for (std::size_t at = 24 + kSize; at <= data.size(); at += kSize) {
    found.push_back(static_cast<uint8_t>(data[at - 1]));
  }
  return found;
}

class LiveSessionsTest : public ::testing::Test {
 protected:
  RunCommandOptions run() const {
    RunCommandOptions options;
    options.output = folder_.path() / "out";
    return options;
  }

  test::TemporaryFolder folder_;
  StopSignal stop_{false};
  std::vector<std::string> complaints_;
};

TEST_F(LiveSessionsTest, FoldersAreCountedFromTwoAndNoneIsReplaced) {
  EXPECT_EQ(session_folder(run(), 1), folder_.path() / "out");
  EXPECT_EQ(session_folder(run(), 2), folder_.path() / "out-2");
  fs::create_directories(folder_.path() / "out-2");
  EXPECT_EQ(session_folder(run(), 2), folder_.path() / "out-3");
  RunCommandOptions replaces = run();
  replaces.overwrite = true;
  EXPECT_EQ(session_folder(replaces, 2), folder_.path() / "out-2");
}

TEST_F(LiveSessionsTest, AHangUpBeginsTheNextRecordingAndBothOverlap) {
  PacketSessions sessions(
      [&](std::size_t number) {
        LiveSession<PacketRecorder> session{.run = run()};
        session.run.recording = folder_.path() / (std::to_string(number) + ".pcap");
        session.recorder = std::make_unique<PacketRecorder>(session.run.recording);
        return session;
      },
      [&](const std::string& what) { complaints_.push_back(what); });
  const auto add = [&](uint8_t value) {
    const std::vector<std::byte> payload = bytes_of(value);
    sessions.add({.received = Nanoseconds(value), .payload = payload});
    sessions.commit();
  };
  add(1);
  std::raise(SIGHUP);
  EXPECT_TRUE(sessions.is_about_to_begin());
  sessions.commit();
  EXPECT_FALSE(sessions.is_about_to_begin());
  EXPECT_EQ(sessions.size(), 2U);
  EXPECT_FALSE(sessions.has_messages(1));
  add(2);
  EXPECT_TRUE(sessions.has_messages(1));
  EXPECT_FALSE(sessions.at(0).recorder->finished());
  std::this_thread::sleep_for(kLongerThanBoth);
  sessions.commit();
  add(3);
  EXPECT_TRUE(sessions.at(0).recorder->finished());
  sessions.finish();
  EXPECT_EQ(payloads_of(folder_.path() / "1.pcap"), (std::vector<uint8_t>{1, 2}));
  EXPECT_EQ(payloads_of(folder_.path() / "2.pcap"), (std::vector<uint8_t>{2, 3}));
  EXPECT_TRUE(complaints_.empty());
  EXPECT_EQ(StopSignal::received(), 0);
}

TEST_F(LiveSessionsTest, WhereNoSessionCanBeginTheOneBeforeGoesOn) {
  PacketSessions sessions(
      [&](std::size_t number) {
        if (number > 1) {
          throw std::runtime_error("the disk is full");
        }
        LiveSession<PacketRecorder> session{.run = run()};
        session.recorder = std::make_unique<PacketRecorder>(folder_.path() / "1.pcap");
        return session;
      },
      [&](const std::string& what) { complaints_.push_back(what); });
  sessions.request_next();
  const std::vector<std::byte> payload = bytes_of(9);
  sessions.commit();
  sessions.add({.received = Nanoseconds(1), .payload = payload});
  sessions.add({.received = Nanoseconds(2), .payload = payload});
  sessions.finish();
  EXPECT_EQ(sessions.size(), 1U);
  EXPECT_EQ(complaints_, std::vector<std::string>{"the disk is full"});
}

TEST_F(LiveSessionsTest, AFailureOfTheDeviceBeginsTheNextSessionOnlyBehindASweep) {
  PacketSessions sessions(
      [&](std::size_t number) {
        LiveSession<PacketRecorder> session{.run = run()};
        session.recorder =
            std::make_unique<PacketRecorder>(folder_.path() / (std::to_string(number) + ".pcap"));
        return session;
      },
      [&](const std::string& what) { complaints_.push_back(what); });
  LiveOptions options;
  options.restarts = true;
  RunSource source;
  std::size_t placed = 0;
  std::size_t ended = 0;
  source.placed = [&](const Sweep&, const SweepResult&) { ++placed; };
  source.ended = [&](const MappingResult&) { ++ended; };
  restart_where_wanted(options, source, sessions);
  source.ended({RunEnd::device_error, "lost"});
  EXPECT_FALSE(sessions.is_about_to_begin()) << "it would fail again and again";
  source.placed({}, {});
  source.ended({RunEnd::completed, ""});
  EXPECT_FALSE(sessions.is_about_to_begin());
  source.ended({RunEnd::device_error, "lost"});
  EXPECT_TRUE(sessions.is_about_to_begin());
  EXPECT_EQ(placed, 1U);
  EXPECT_EQ(ended, 3U);
  sessions.finish();
  EXPECT_FALSE(sessions.is_about_to_begin()) << "nothing arrives any more that could begin it";
}

TEST_F(LiveSessionsTest, LatchedMessagesAreInEachRecording) {
  const std::vector<Channel> channels = {{.topic = "/tf_static",
                                          .type = "tf2_msgs/TFMessage",
                                          .encoding = Encoding::cdr,
                                          .definition = "",
                                          .messages = {}},
                                         {.topic = "/imu",
                                          .type = "sensor_msgs/Imu",
                                          .encoding = Encoding::cdr,
                                          .definition = "",
                                          .messages = {}}};
  MessageSessions sessions(
      [&](std::size_t number) {
        LiveSession<MessageRecorder> session{.run = run()};
        session.recorder = std::make_unique<MessageRecorder>(
            folder_.path() / (std::to_string(number) + ".mcap"), channels);
        return session;
      },
      [&](const std::string& what) { complaints_.push_back(what); }, {true, false});
  sessions.write(0, Nanoseconds(1), bytes_of(1));
  sessions.write(1, Nanoseconds(2), bytes_of(2));
  sessions.request_next();
  sessions.commit();
  sessions.write(1, Nanoseconds(3), bytes_of(3));
  std::vector<uint8_t> found;
  const GrowingMessages second(*sessions.at(1).recorder);
  const auto messages = second.messages({});
  while (const auto message = messages->next()) {
    found.push_back(static_cast<uint8_t>(message->bytes.back()));
  }
  EXPECT_EQ(found, (std::vector<uint8_t>{1, 3}));
  sessions.finish();
}

}  // namespace
}  // namespace adit
