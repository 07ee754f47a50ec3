// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Captures of networks as they are: link layers, fragments, packets that come twice, in another
// order, or were captured in part. Each must be read as the same packets on a perfect network.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/recordings/network_support.hpp"
#include "adit/tests/recordings/packet_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::Bytes;
using test::Frames;

constexpr Nanoseconds kTen{1'699'999'200'000'000'000};  // a whole hour: 2023-11-14, 22:00:00

enum class Maker { velodyne, ouster, hesai, livox };

std::string name_of(const testing::TestParamInfo<Maker>& info) {
  constexpr std::array kNames = {"Velodyne", "Ouster", "Hesai", "Livox"};
  return kNames.at(static_cast<std::size_t>(info.param));
}

constexpr std::size_t kPacketsPerTurn = 24;

/// A packet of 15 degrees, 4 ms after the one before. Ranges differ from packet to packet.
Bytes packet_of(Maker maker, int number) {
  const Nanoseconds since = std::chrono::milliseconds(4 * number);
  const auto time = static_cast<uint64_t>((kTen + since).count());
  const auto micros = static_cast<uint32_t>(since.count() / 1000);
  const double azimuth = std::fmod(15.0 * number, 360.0);
  switch (maker) {
    case Maker::velodyne:
      return test::velodyne_packet(azimuth, 1.25, micros, 0x37, 0x22, [&](auto block, auto laser) {
        return 2000 + 10 * block + laser + static_cast<std::size_t>(number);
      });
    case Maker::ouster:
      return test::ouster_packet(
          true, 4, 16 * static_cast<std::size_t>(number % 2), static_cast<uint16_t>(number / 2),
          time, [&](auto column, auto beam) {
            return 2000 + 10 * column + beam + static_cast<std::size_t>(number);
          });
    case Maker::hesai: {
      std::vector<double> azimuths;
      for (int block = 0; block < 8; ++block) {
        azimuths.push_back(std::fmod(azimuth + 1.8 * block, 360.0));
      }
      // 22:13:20 is the layout's second.
      return test::hesai_packet({}, azimuths, micros, [&](auto block, auto laser) {
        return 2000 + 10 * block + laser + static_cast<std::size_t>(number);
      });
    }
    case Maker::livox:
      return test::livox_packet(time, {{1000 + number, 2000, 300, 9, 0}, {500, number, 20, 8, 0}});
  }
  return {};
}

constexpr int kPackets = 230;  // less than a second, as the layout's second stays the same

Frames frames_of(Maker maker, std::size_t most = 65000) {
  Frames frames;
  for (int i = 0; i < kPackets; ++i) {
    const Nanoseconds received = kTen + std::chrono::milliseconds(4 * i + 1);
    for (Bytes& frame :
         test::frames_of(packet_of(maker, i), 2368, most, static_cast<uint16_t>(i))) {
      frames.push_back({received, std::move(frame)});
    }
    if (i % 3 == 0 && (maker == Maker::ouster || maker == Maker::livox)) {
      const auto time = static_cast<uint64_t>((received - kTen + kTen).count());
      const Bytes imu =
          maker == Maker::ouster ? test::ouster_imu_packet(time) : test::livox_imu_packet(time);
      frames.push_back({received, test::frames_of(imu, 7503).front()});
    }
  }
  return frames;
}

void write_capture(const fs::path& file, const Bytes& bytes) {
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

void expect_same(const Sweep& a, const Sweep& b) {
  EXPECT_EQ(a.stamp, b.stamp);
  ASSERT_EQ(a.points.size(), b.points.size());
  EXPECT_EQ(0, std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Point)));
  EXPECT_EQ(a.times, b.times);
  EXPECT_EQ(a.rings, b.rings);
}

/// Topic by topic: a reading of the IMU may come before or after a packet of ranges. With
/// `received`, also when the events were received.
void expect_same(const std::vector<Event>& a, const std::vector<Event>& b, bool received) {
  for (std::size_t topic = 0; topic < 3; ++topic) {
    const auto of_topic = [&](const std::vector<Event>& events) {
      std::vector<const Event*> chosen;
      for (const Event& event : events) {
        if (event.topic == topic) {
          chosen.push_back(&event);
        }
      }
      return chosen;
    };
    const std::vector<const Event*> ours = of_topic(a);
    const std::vector<const Event*> theirs = of_topic(b);
    ASSERT_EQ(ours.size(), theirs.size()) << "topic " << topic;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      if (const auto* sweep = std::get_if<Sweep>(&ours[i]->value)) {
        expect_same(*sweep, std::get<Sweep>(theirs[i]->value));
      } else if (const auto* reading = std::get_if<ImuSample>(&ours[i]->value)) {
        EXPECT_EQ(reading->stamp, std::get<ImuSample>(theirs[i]->value).stamp) << i;
      }
      EXPECT_TRUE(!received || ours[i]->received == theirs[i]->received) << i;
    }
  }
}

class NetworkCapture : public testing::TestWithParam<Maker> {
 protected:
  void SetUp() override {
    if (GetParam() == Maker::ouster) {
      folder_.write("drive.json", test::ouster_metadata(4, "LEGACY"));
    }
    frames_ = frames_of(GetParam());
    perfect_ = read(test::pcap(frames_)).events;
    ASSERT_GE(perfect_.size(), 9U);
    EXPECT_TRUE(notices_.empty());
  }

  test::ReadEvents read(const Bytes& capture) {
    write_capture(folder_ / "drive.pcap", capture);
    const auto recording = open_recording(folder_ / "drive.pcap");
    notices_.clear();
    for (const RecordingNotice& notice : recording->notices()) {
      notices_ += notice.kind + ": " + notice.found + "\n";
    }
    test::ReadEvents all = test::read_all(*recording);
    const auto sweeps = std::ranges::count_if(
        all.events, [](const Event& event) { return std::holds_alternative<Sweep>(event.value); });
    EXPECT_EQ(recording->topics().at(0).messages, static_cast<uint64_t>(sweeps));
    return all;
  }

  test::TemporaryFolder folder_;
  Frames frames_;
  std::vector<Event> perfect_;
  std::string notices_;
};

TEST_P(NetworkCapture, EveryLinkLayerGivesTheSame) {
  const Bytes family = {std::byte{2}, std::byte{0}, std::byte{0}, std::byte{0}};
  Bytes cooked(16);
  test::put_network(cooked, 14, 0x0800);
  Bytes cooked_tagged = cooked;
  test::put_network(cooked_tagged, 14, 0x8100);
  test::append(cooked_tagged, Bytes{std::byte{0}, std::byte{5}, std::byte{8}, std::byte{0}});
  Bytes cooked2(20);
  test::put_network(cooked2, 0, 0x0800);
  for (const auto& [link, head] :
       std::vector<std::pair<uint32_t, Bytes>>{{1, test::tagged_ethernet({})},
                                               {1, test::tagged_ethernet({0x8100})},
                                               {1, test::tagged_ethernet({0x88a8, 0x8100})},
                                               {1, test::tagged_ethernet({0x9100, 0x8100, 0x8100})},
                                               {0, family},
                                               {108, family},
                                               {12, {}},
                                               {14, {}},
                                               {101, {}},
                                               {228, {}},
                                               {113, cooked},
                                               {113, cooked_tagged},
                                               {276, cooked2}}) {
    const test::ReadEvents all = read(test::pcap_of_link(test::behind(frames_, head), link));
    EXPECT_TRUE(all.errors.empty());
    expect_same(perfect_, all.events, true);
  }
}

TEST_P(NetworkCapture, Ipv6GivesTheSameAlsoInFragments) {
  for (const uint32_t link : {101U, 229U}) {
    for (const std::size_t most : {std::size_t{65000}, std::size_t{400}}) {
      Frames packets;
      uint32_t id = 0;
      for (const test::CapturedFrame& frame : frames_) {
        for (Bytes& packet : test::ipv6_of(frame.bytes, most, ++id)) {
          packets.push_back({frame.received, std::move(packet)});
        }
      }
      expect_same(perfect_, read(test::pcap_of_link(packets, link)).events, true);
    }
  }
}

TEST_P(NetworkCapture, FragmentsInAnyOrderAndTwiceGiveTheSame) {
  const Frames pieces = frames_of(GetParam(), 400);
  Frames shuffled = pieces;
  std::mt19937 random(5);
  for (std::size_t i = 0; i + 8 < shuffled.size(); i += 8) {
    for (std::size_t k = 7; k > 0; --k) {
      std::swap(shuffled[i + k].bytes, shuffled[i + random() % (k + 1)].bytes);
    }
  }
  expect_same(perfect_, read(test::pcap(shuffled)).events, false);
  for (const std::size_t later : {1U, 3U, 20U}) {
    expect_same(perfect_, read(test::pcap(test::twice(pieces, later))).events, false);
  }
}

TEST_P(NetworkCapture, PacketsThatWereCapturedTwiceAreUsedOnce) {
  for (const std::size_t later : {1U, 2U, 5U, 70U}) {
    expect_same(perfect_, read(test::pcap(test::twice(frames_, later))).events, false);
    EXPECT_NE(notices_.find("repeated_packets: " + std::to_string(frames_.size())),
              std::string::npos)
        << notices_;
  }
}

TEST_P(NetworkCapture, PacketsInAnotherOrderAreReadInThatOfTheSensor) {
  for (const auto& [every, later] : {std::pair{17U, 1U}, {9U, 4U}, {64U, 40U}}) {
    const test::ReadEvents all = read(test::pcap(test::reordered(frames_, every, later)));
    expect_same(perfect_, all.events, false);
    EXPECT_NE(notices_.find("reordered_packets"), std::string::npos) << notices_;
  }
  Frames shuffled = frames_;
  std::mt19937 random(4);
  for (std::size_t i = 0; i + 16 < shuffled.size(); i += 16) {
    for (std::size_t k = 15; k > 0; --k) {
      std::swap(shuffled[i + k].bytes, shuffled[i + random() % (k + 1)].bytes);
    }
  }
  expect_same(perfect_, read(test::pcap(shuffled)).events, false);
}

TEST_P(NetworkCapture, LostFragmentsAreCounted) {
  Frames pieces = frames_of(GetParam(), 48);
  pieces.erase(pieces.begin() + 41);
  const test::ReadEvents all = read(test::pcap(pieces));
  EXPECT_EQ(all.events.size(), perfect_.size());
  EXPECT_TRUE(all.errors.empty());
  EXPECT_NE(notices_.find("incomplete_packets: 1 "), std::string::npos) << notices_;
}

TEST_P(NetworkCapture, PacketsWithoutTheirEndAreReadAsFarAsTheyGoAndReported) {
  // 42 bytes of headers; of Ouster five columns of 68 bytes, of Livox one of two points of 14.
  const std::size_t snap = GetParam() == Maker::livox ? 42 + 36 + 14 + 11 : 42 + 5 * 68 + 3;
  const bool readable = GetParam() == Maker::ouster || GetParam() == Maker::livox;
  if (!readable) {
    try {
      read(test::snapped_pcap(frames_, snap));
      FAIL();
    } catch (const InputError& error) {
      EXPECT_NE(error.found().find("230 of its packets were captured without the end"),
                std::string::npos)
          << error.what();
      EXPECT_NE(error.remedy().find("snap length"), std::string::npos);
    }
    return;
  }
  const test::ReadEvents all = read(test::snapped_pcap(frames_, snap));
  ASSERT_EQ(all.errors.size(), 1U);
  EXPECT_NE(all.errors[0].found().find("230 packets were captured without the end"),
            std::string::npos)
      << all.errors[0].what();
  ASSERT_EQ(all.events.size(), perfect_.size());
  for (std::size_t i = 0; i < all.events.size(); ++i) {
    if (const auto* sweep = std::get_if<Sweep>(&all.events[i].value)) {
      const auto& whole = std::get<Sweep>(perfect_[i].value);
      const bool ouster = GetParam() == Maker::ouster;
      EXPECT_EQ(sweep->points.size() * (ouster ? 16 : 2), whole.points.size() * (ouster ? 5 : 1));
      EXPECT_EQ(sweep->points.at(0).x, whole.points.at(0).x);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Makers, NetworkCapture,
                         testing::Values(Maker::velodyne, Maker::ouster, Maker::hesai,
                                         Maker::livox),
                         name_of);

TEST(NetworkCaptures, AFewPacketsWithoutTheirEndAreLeftOutAndCounted) {
  const test::TemporaryFolder folder;
  Frames frames = frames_of(Maker::velodyne);
  Bytes capture = test::pcap({});
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Bytes one = test::snapped_pcap({frames[i]}, i % 23 == 5 ? 900 : 65000);
    test::append(capture, std::span(one).subspan(24));
  }
  write_capture(folder / "drive.pcap", capture);
  const test::ReadEvents all = test::read_all(*open_recording(folder / "drive.pcap"));
  EXPECT_EQ(all.events.size(), 10U);
  ASSERT_EQ(all.errors.size(), 1U);
  EXPECT_NE(all.errors[0].found().find("10 packets were"), std::string::npos)
      << all.errors[0].what();
}

TEST(NetworkCaptures, ALinkLayerThatIsNotReadIsNamed) {
  const test::TemporaryFolder folder;
  write_capture(folder / "drive.pcap", test::pcap_of_link(frames_of(Maker::velodyne), 147));
  try {
    open_recording(folder / "drive.pcap");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("230 packets are of the link layer 147"), std::string::npos)
        << error.what();
  }
}

TEST(NetworkCaptures, TheDurationIsThatOfTheCapture) {
  const test::TemporaryFolder folder;
  Frames frames = frames_of(Maker::velodyne);
  frames.resize(kPacketsPerTurn);
  // A position packet that was received a second later is an event before the last sweep.
  frames.push_back(
      {kTen + std::chrono::milliseconds(1300),
       test::frames_of(
           test::position_packet(
               "$GPRMC,220001,A,4139.0000,N,00052.8000,W,000.0,000.0,141123,,,A*67\r\n"),
           8308)
           .front()});
  write_capture(folder / "drive.pcap", test::pcap(frames));
  EXPECT_NE(open_recording(folder / "drive.pcap")->description().find("VLP-16, 1.2 s, 1 sweep"),
            std::string::npos)
      << open_recording(folder / "drive.pcap")->description();
}

}  // namespace
}  // namespace adit
