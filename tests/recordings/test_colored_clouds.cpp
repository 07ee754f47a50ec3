// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Colours in the LAS family: point format 7 and item RGB14.
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/container_support.hpp"
#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/copc_octree.hpp"
#include "adit/tools/clouds/copc_writer.hpp"
#include "adit/tools/clouds/las_reader.hpp"
#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/clouds/laz_color.hpp"
#include "adit/tools/clouds/laz_format.hpp"

namespace adit {
namespace {

using Rgb = std::array<uint8_t, 3>;

const CloudReading kSurvey{.longest = 3600.0};  // s
constexpr std::size_t kColoredBytes = 30 + 6 + 2 + 4;
constexpr std::size_t kColorAt = 30;

template <class T>
T number(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

std::vector<LasPoint> points_with(std::size_t count, const std::function<Rgb(std::size_t)>& color) {
  std::vector<LasPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto along = static_cast<double>(i);
    points.push_back({.position = {0.001 * along, 0.01 * static_cast<double>(i % 97), 2.5},
                      .time = std::chrono::microseconds(10 * i),
                      .intensity = static_cast<uint16_t>(i % 500),
                      .ring = static_cast<uint16_t>(i % 16),
                      .keyframe = static_cast<uint32_t>(i / 100),
                      .color = color(i)});
  }
  return points;
}

Rgb rainbow(std::size_t i) {
  return {static_cast<uint8_t>(i), static_cast<uint8_t>(3 * i / 2), static_cast<uint8_t>(i / 7)};
}

template <class Writer, class... Packing>
std::string written(const std::filesystem::path& file, const std::vector<LasPoint>& points,
                    bool colored, Packing... packing) {
  Writer writer(file, {.colored = colored}, packing...);
  writer.write(points);
  writer.close();
  return test::content_of(file);
}

TEST(LazColor, WhatIsEncodedIsDecoded) {
  std::mt19937 random(4);
  std::vector<LazColor> colors(1);
  for (int i = 0; i < 20'000; ++i) {
    LazColor color = colors.back();
    const bool grey = random() % 4U == 0;
    for (std::size_t byte = 0; byte < color.size(); ++byte) {
      if (random() % 3U != 0) {  // near the last byte, or anywhere
        color[byte] =
            static_cast<uint8_t>(random() % 2U == 0 ? color[byte] + random() % 5U : random());
      }
      color[byte] = grey ? color[byte % 2] : color[byte];
    }
    colors.push_back(color);
  }
  ArithmeticEncoder encoder;
  LazColorCodec in;
  for (std::size_t i = 1; i < colors.size(); ++i) {
    in.code(encoder, colors[i - 1], colors[i]);
  }
  const std::string bytes = encoder.finish();
  ArithmeticDecoder decoder(std::as_bytes(std::span(bytes.data(), bytes.size())));
  LazColorCodec out;
  LazColor last = colors.front();
  for (std::size_t i = 1; i < colors.size(); ++i) {
    last = out.code(decoder, last, {});
    ASSERT_EQ(last, colors[i]) << i;
  }
  EXPECT_FALSE(decoder.is_overrun());
}

TEST(LasWriter, ColoredPointsAreOfFormat7) {
  const test::TemporaryFolder folder;
  const std::vector<LasPoint> points = points_with(500, rainbow);
  const std::string plain = written<LasWriter>(folder / "plain.las", points, false);
  const std::string colored = written<LasWriter>(folder / "colored.las", points, true);
  EXPECT_EQ(plain[104], 6);
  EXPECT_EQ(colored[104], 7);
  EXPECT_EQ(number<uint16_t>(plain, 105), kColoredBytes - 6);
  EXPECT_EQ(number<uint16_t>(colored, 105), kColoredBytes);
  const auto begin = number<uint32_t>(colored, 96);
  ASSERT_EQ(number<uint32_t>(plain, 96), begin);
  ASSERT_EQ(colored.size(), begin + points.size() * kColoredBytes);
  // Headers and records differ in these three bytes alone, points in the colour.
  EXPECT_EQ(colored.substr(0, 104), plain.substr(0, 104));
  EXPECT_EQ(colored.substr(107, begin - 107), plain.substr(107, begin - 107));
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::string point = colored.substr(begin + i * kColoredBytes, kColoredBytes);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      ASSERT_EQ(number<uint16_t>(point, kColorAt + 2 * channel),
                points[i].color[channel] * 65535 / 255);
    }
    point.erase(kColorAt, 6);
    ASSERT_EQ(point, plain.substr(begin + i * point.size(), point.size()));
  }
}

TEST(LasWriter, PackedColoredPointsAreReadBack) {
  const test::TemporaryFolder folder;
  const std::size_t count = kLazChunkPoints + 700;  // two chunks
  const auto same = [](std::size_t) { return Rgb{20, 200, 90}; };
  const auto late = [](std::size_t i) { return i < kLazChunkPoints ? Rgb{} : rainbow(i); };
  std::vector<std::size_t> sizes;
  for (const std::function<Rgb(std::size_t)>& color :
       {std::function<Rgb(std::size_t)>(same), std::function<Rgb(std::size_t)>(late),
        std::function<Rgb(std::size_t)>(rainbow)}) {
    const std::vector<LasPoint> points = points_with(count, color);
    const CloudFile plain =
        parse_las("a.las", written<LasWriter>(folder / "a.las", points, true), kSurvey);
    const std::string packed = written<LasWriter>(folder / "a.laz", points, true, LasPacking::laz);
    EXPECT_EQ(static_cast<uint8_t>(packed[104]), 0x80 | 7);
    // The record, which is the first: three items, of 30, 6 and 6 bytes.
    EXPECT_EQ(number<uint16_t>(packed, 375 + 54 + 32), 3);
    EXPECT_EQ(number<uint16_t>(packed, 375 + 54 + 40), static_cast<uint16_t>(LazItemKind::color14));
    const CloudFile cloud = parse_las("a.laz", packed, kSurvey);
    EXPECT_TRUE(cloud.faults.empty());
    ASSERT_EQ(cloud.sweep.points.size(), count);
    EXPECT_EQ(
        std::memcmp(cloud.sweep.points.data(), plain.sweep.points.data(), count * sizeof(Point)),
        0);
    EXPECT_EQ(cloud.sweep.times, plain.sweep.times);
    sizes.push_back(packed.size());
  }
  EXPECT_LT(sizes[0], sizes[1]);
  EXPECT_LT(sizes[1], sizes[2]);
  // Chunks without a change have no layer of colours: 4 bytes for its size and 6 for its first.
  const std::vector<LasPoint> black = points_with(count, same);
  const std::string without = written<LasWriter>(folder / "b.laz", black, false, LasPacking::laz);
  EXPECT_EQ(sizes[0], without.size() + 6 + 2 * (4 + 6));
}

TEST(CopcWriter, ColorsStayWithTheirPoints) {
  const test::TemporaryFolder folder;
  const std::vector<LasPoint> points = points_with(120'000, rainbow);
  const std::string file = written<CopcWriter>(folder / "a.copc.laz", points, true);
  EXPECT_EQ(static_cast<uint8_t>(file[104]), 0x80 | 7);
  const auto list = number<uint64_t>(file, 429 + 40);
  const auto list_bytes = number<uint64_t>(file, 429 + 48);
  EXPECT_EQ(list + list_bytes, file.size());
  ASSERT_GT(list_bytes, 32U) << "more than one node";
  uint64_t found = 0;
  for (uint64_t at = list; at < list + list_bytes; at += 32) {
    const std::string first = file.substr(number<uint64_t>(file, at + 16), kColoredBytes + 4);
    const auto count = static_cast<uint32_t>(number<int32_t>(file, at + 28));
    EXPECT_EQ(number<uint32_t>(first, kColoredBytes), count);
    found += count;
    // Its first point is as it is: the place says which it is.
    const auto index = static_cast<std::size_t>(number<int32_t>(first, 0));
    ASSERT_LT(index, points.size());
    for (std::size_t channel = 0; channel < 3; ++channel) {
      EXPECT_EQ(number<uint16_t>(first, kColorAt + 2 * channel),
                257 * points[index].color[channel]);
    }
    EXPECT_EQ(number<uint32_t>(first, kColorAt + 8), points[index].keyframe);
  }
  EXPECT_EQ(found, points.size());
  const CloudFile cloud = parse_las("a.copc.laz", file, kSurvey);
  EXPECT_TRUE(cloud.faults.empty());
  EXPECT_EQ(cloud.sweep.points.size(), points.size());
}

// Of large clouds, whose points are sorted by parts first.
TEST(CopcOctree, ColoredPointsStayWholeInAllParts) {
  const test::TemporaryFolder folder;
  const LasHeading heading{.colored = true};
  LasExtent extent;
  std::string bytes;
  const std::vector<LasPoint> points = points_with(20'000, rainbow);
  for (const LasPoint& point : points) {
    append_las_point(bytes, extent, point, heading, "cloud.copc.laz");
  }
  ScratchFile scratch(folder / "points");
  scratch.append(bytes);
  std::multiset<std::string> expected;
  for (std::size_t at = 0; at < bytes.size(); at += kColoredBytes) {
    expected.insert(bytes.substr(at, kColoredBytes));
  }
  std::multiset<std::string> found;
  visit_copc_nodes({.file = &scratch, .point_bytes = kColoredBytes}, cube_of(extent),
                   {.part = 3000, .node = 200}, [&](std::span<const CopcNode> nodes) {
                     for (const CopcNode& node : nodes) {
                       for (std::size_t at = 0; at < node.points.size(); at += kColoredBytes) {
                         found.insert(node.points.substr(at, kColoredBytes));
                       }
                     }
                   });
  EXPECT_EQ(expected.size(), points.size());
  EXPECT_TRUE(found == expected);
}

TEST(LasReader, ColoredFilesThatAreCutOffGiveTheirWholeChunks) {
  const test::TemporaryFolder folder;
  const std::vector<LasPoint> points = points_with(kLazChunkPoints + 500, rainbow);
  const std::string good = written<LasWriter>(folder / "a.laz", points, true, LasPacking::laz);
  const auto begin = number<uint32_t>(good, 96);
  const auto table = number<uint64_t>(good, begin);
  // Anywhere in the last chunk, whose last layers are colours and extra bytes.
  const std::size_t second = [&] {
    const std::size_t sizes = begin + 8 + kColoredBytes + 4;
    std::size_t at = sizes + 16 * 4;
    for (std::size_t layer = 0; layer < 16; ++layer) {
      at += number<uint32_t>(good, sizes + 4 * layer);
    }
    return at;
  }();
  ASSERT_EQ(number<uint32_t>(good, second + kColoredBytes), 500U);
  for (std::size_t end = second + 1; end < table; end += 211) {
    const CloudFile cut = parse_las("a.laz", good.substr(0, end), kSurvey);
    ASSERT_EQ(cut.sweep.points.size(), kLazChunkPoints) << end;
    ASSERT_FALSE(cut.faults.empty());
    EXPECT_NE(cut.faults.back().found().find("promises 50500 packed points; 50000 can be"),
              std::string::npos)
        << cut.faults.back().found();
  }
  EXPECT_TRUE(parse_las("a.laz", good.substr(0, table), kSurvey).faults.empty());
  // A few points, damaged anywhere: a cloud or a reason.
  const std::string few =
      written<LasWriter>(folder / "few.laz", points_with(200, rainbow), true, LasPacking::laz);
  std::mt19937 random(9);
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = few;
    for (int k = 0; k < 3; ++k) {
      bytes[96 + random() % (bytes.size() - 96)] = static_cast<char>(random());
    }
    bytes.resize(i % 4 == 0 ? random() % bytes.size() : bytes.size());
    try {
      EXPECT_LE(parse_las("a.laz", bytes).sweep.points.size(), 2048 * bytes.size() + 200);
    } catch (const InputError&) {
      // the other right answer
    }
  }
}

}  // namespace
}  // namespace adit
