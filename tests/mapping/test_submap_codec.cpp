// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/submap_codec.hpp"

#include <limits>

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
                             .sweep = static_cast<uint16_t>(i % 3)});
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
  }
  EXPECT_EQ(decode_sweeps(stored.chunks[kSweepChunk]).sweeps.size(), 3U);
  EXPECT_TRUE(decode(encode(KeyframeSubmap{})).points.empty());
}

TEST(SubmapCodec, SaysWhatIsWrongWithDamagedChunks) {
  const MapSubmap good = encode(some_submap());
  const auto says = [](const MapSubmap& stored) -> std::string {
    try {
      static_cast<void>(decode(stored));
    } catch (const SubmapDamaged& damage) {
      return damage.what();
    }
    return "nothing";
  };
  for (std::size_t chunk = 0; chunk < good.chunks.size(); ++chunk) {
    for (std::size_t size = 0; size < good.chunks[chunk].size(); size += 97) {
      MapSubmap cut = good;
      cut.chunks[chunk].resize(size);
      EXPECT_NE(says(cut), "nothing") << "chunk " << chunk << " of " << size << " bytes";
    }
    MapSubmap longer = good;
    longer.chunks[chunk].push_back({});
    EXPECT_NE(says(longer).find("1 bytes too many"), std::string::npos) << says(longer);
  }
  MapSubmap fewer = good;
  fewer.chunks.pop_back();
  EXPECT_NE(says(fewer).find("1 chunks, expected 2"), std::string::npos) << says(fewer);
  MapSubmap newer = good;
  newer.chunks[0][0] = std::byte{9};
  EXPECT_NE(says(newer).find("version 9, expected 1"), std::string::npos) << says(newer);
  MapSubmap greedy = good;
  greedy.chunks[1][3] = std::byte{0xff};
  EXPECT_NE(says(greedy).find("claims"), std::string::npos) << says(greedy);
  MapSubmap strange = good;
  strange.chunks[1].back() = std::byte{0x7f};
  EXPECT_NE(says(strange).find("point of sweep"), std::string::npos) << says(strange);
}

// The bytes of a damaged chunk are anybody's: whatever they are, it ends in a submap or in a word.
TEST(SubmapCodec, SurvivesAnyByte) {
  const MapSubmap good = encode(some_submap());
  Random random(9);
  for (std::size_t i = 0; i < 2000; ++i) {
    MapSubmap changed = good;
    auto& chunk = changed.chunks[i % 2];
    chunk[static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(chunk.size())))] =
        static_cast<std::byte>(random.uniform(0.0, 256.0));
    try {
      static_cast<void>(decode(changed));
    } catch (const SubmapDamaged&) {
    }
  }
}

}  // namespace
}  // namespace adit
