// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/submaps/submap_codec.hpp"

#include <cstring>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

KeyframeSubmap some_submap() {
  Random random(5);
  KeyframeSubmap submap{.r_submap = 0.1, .vertical = Vertical::ground, .sweeps = {}, .points = {}};
  for (int i = 0; i < 3; ++i) {
    Vector6d xi;
    xi << random.gaussian(), random.gaussian(), 0.1, 0.02, -0.03, random.gaussian();
    submap.sweeps.push_back({.stamp = Nanoseconds(1'700'000'000'000'000'001 + i),
                             .T_keyframe_lidar = se3_exp(xi),
                             .merged = i != 1});
  }
  for (int i = 0; i < 1000; ++i) {
    const auto number = [&] { return static_cast<int32_t>(random.uniform(-200'000.0, 200'000.0)); };
    submap.points.push_back({.place = {number(), number(), number()},
                             .surface = static_cast<uint32_t>(random.uniform(0.0, 4e9)),
                             .sweep = static_cast<uint16_t>(i % 3),
                             .seen_through = i % 7 == 0});
  }
  submap.points[7].place = {std::numeric_limits<int32_t>::min(),
                            std::numeric_limits<int32_t>::max(), 0};
  return submap;
}

TEST(SubmapCodec, GivesBackEveryBit) {
  const KeyframeSubmap submap = some_submap();
  const MapSubmap stored = encode(submap);
  const KeyframeSubmap back = decode(stored);
  EXPECT_EQ(back.r_submap, submap.r_submap);
  EXPECT_EQ(back.vertical, submap.vertical);
  ASSERT_EQ(back.sweeps.size(), submap.sweeps.size());
  for (std::size_t i = 0; i < submap.sweeps.size(); ++i) {
    EXPECT_EQ(back.sweeps[i].stamp, submap.sweeps[i].stamp);
    EXPECT_EQ(back.sweeps[i].merged, submap.sweeps[i].merged);
    EXPECT_EQ(back.sweeps[i].T_keyframe_lidar.matrix(), submap.sweeps[i].T_keyframe_lidar.matrix());
  }
  ASSERT_EQ(back.points.size(), submap.points.size());
  for (std::size_t i = 0; i < submap.points.size(); ++i) {
    EXPECT_EQ(back.points[i].place, submap.points[i].place);
    EXPECT_EQ(back.points[i].surface, submap.points[i].surface);
    EXPECT_EQ(back.points[i].sweep, submap.points[i].sweep);
    EXPECT_EQ(back.points[i].seen_through, submap.points[i].seen_through);
  }
  EXPECT_EQ(decode_sweeps(stored.chunks[kSweepChunk]).sweeps.size(), 3U);
  EXPECT_TRUE(decode(encode(KeyframeSubmap{})).points.empty());
}

TEST(SubmapCodec, ReadsSubmapsFromBeforePointsHadAFlag) {
  KeyframeSubmap submap = some_submap();
  for (SubmapPoint& point : submap.points) {
    point.seen_through = false;  // the bytes of its points are the same then
  }
  MapSubmap stored = encode(submap);
  std::vector<std::byte>& chunk = stored.chunks[kSweepChunk];
  chunk[0] = std::byte{1};
  uint64_t checksum = 0xcbf29ce484222325U;  // FNV-1a
  for (std::size_t i = 0; i + sizeof checksum < chunk.size(); ++i) {
    checksum = (checksum ^ static_cast<uint64_t>(chunk[i])) * 0x100000001b3U;
  }
  std::memcpy(chunk.data() + chunk.size() - sizeof checksum, &checksum, sizeof checksum);
  EXPECT_EQ(decode(stored).points.size(), submap.points.size());
}

std::string complaint(const MapSubmap& stored) {
  try {
    static_cast<void>(decode(stored));
  } catch (const SubmapDamaged& damage) {
    return damage.what();
  }
  return "nothing";
}

TEST(SubmapCodec, SaysWhatIsWrongWithDamagedChunks) {
  const MapSubmap good = encode(some_submap());
  for (std::size_t chunk = 0; chunk < good.chunks.size(); ++chunk) {
    for (std::size_t size = 0; size < good.chunks[chunk].size(); size += 97) {
      MapSubmap cut = good;
      cut.chunks[chunk].resize(size);
      EXPECT_NE(complaint(cut), "nothing") << "chunk " << chunk << " of " << size << " bytes";
    }
  }
  EXPECT_EQ(complaint({.chunks = {good.chunks[0]}}), "has 1 chunks, expected 2 or 3");
  EXPECT_EQ(complaint({.chunks = {good.chunks[0], {}}}), "ends early, at byte 0");
  EXPECT_NE(complaint({.chunks = {good.chunks[1], good.chunks[0]}}), "nothing");
}

/// The same with checksums that are right, of chunks that have been changed.
MapSubmap with_checksums(MapSubmap stored) {
  for (std::vector<std::byte>& chunk : stored.chunks) {
    uint64_t value = 0xcbf29ce484222325U;  // FNV-1a
    for (std::size_t i = 0; i < chunk.size() - 8; ++i) {
      value = (value ^ static_cast<uint64_t>(chunk[i])) * 0x100000001b3U;
    }
    std::memcpy(chunk.data() + chunk.size() - 8, &value, 8);
  }
  return stored;
}

TEST(SubmapCodec, DoesNotBelieveWhatIsWholeAndMakesNoSense) {
  const MapSubmap good = encode(some_submap());
  ASSERT_EQ(complaint(with_checksums(good)), "nothing");
  MapSubmap longer = good;
  longer.chunks[1].push_back({});
  EXPECT_EQ(complaint(with_checksums(longer)), "has 1 bytes too many");
  MapSubmap newer = good;
  newer.chunks[0][0] = std::byte{9};
  EXPECT_EQ(complaint(with_checksums(newer)), "is of version 9, expected 2");
  MapSubmap greedy = good;
  greedy.chunks[1][3] = std::byte{0xff};
  EXPECT_NE(complaint(with_checksums(greedy)).find("claims"), std::string::npos);
  MapSubmap strange = good;
  strange.chunks[1][good.chunks[1].size() - 9] = std::byte{0x7f};
  EXPECT_NE(complaint(with_checksums(strange)).find("point of sweep"), std::string::npos);
  Random random(9);
  for (std::size_t i = 0; i < 2000; ++i) {  // whatever it is, it ends in a submap or in a word
    MapSubmap changed = good;
    auto& chunk = changed.chunks[i % 2];
    chunk[static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(chunk.size() - 8)))] =
        static_cast<std::byte>(random.uniform(0.0, 256.0));
    static_cast<void>(complaint(with_checksums(changed)));
  }
}

TEST(SubmapCodec, NoticesAnyChangedByte) {
  const MapSubmap good = encode(some_submap());
  Random random(9);
  for (std::size_t i = 0; i < 2000; ++i) {
    MapSubmap changed = good;
    auto& chunk = changed.chunks[i % 2];
    auto& byte =
        chunk[static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(chunk.size())))];
    byte ^= static_cast<std::byte>(random.uniform(1.0, 256.0));
    EXPECT_EQ(complaint(changed), "has a wrong checksum");
  }
}

}  // namespace
}  // namespace adit
