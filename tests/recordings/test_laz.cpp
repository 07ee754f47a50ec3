// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/arithmetic_coder.hpp"
#include "adit/tools/clouds/copc_octree.hpp"
#include "adit/tools/clouds/copc_writer.hpp"
#include "adit/tools/clouds/las_reader.hpp"
#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/clouds/laz_chunk.hpp"
#include "adit/tools/clouds/laz_color.hpp"
#include "adit/tools/clouds/laz_format.hpp"
#include "adit/tools/clouds/laz_reader.hpp"

namespace adit {
namespace {

const CloudReading kSurvey{.longest = 3600.0};   // s
constexpr std::size_t kPointBytes = 30 + 2 + 4;  // without colours

std::span<const std::byte> bytes_in(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string decoded_base64(std::string_view text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  uint32_t bits = 0;
  int held = 0;
  for (const char digit : text.substr(0, text.find('='))) {
    bits = (bits << 6U) | static_cast<uint32_t>(kDigits.find(digit));
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes.push_back(static_cast<char>(static_cast<uint8_t>(bits >> held)));
    }
  }
  return bytes;
}

uint64_t fnv1a(std::string_view bytes) {
  uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : bytes) {
    hash = (hash ^ static_cast<uint8_t>(c)) * 0x100000001b3U;
  }
  return hash;
}

/// Numbers that any language makes alike.
class Congruential {
 public:
  uint64_t below(uint64_t limit) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return (state_ >> 33U) % limit;
  }

 private:
  uint64_t state_ = 1;
};

/// Colours that use every branch of the format: grey ones, and those that change in part.
LazColor wild_color(Congruential& random, LazColor color) {
  const bool grey = random.below(4) == 0;
  for (std::size_t i = 0; i < color.size(); ++i) {
    if (random.below(3) != 0) {
      color[i] = static_cast<uint8_t>(random.below(256));
    }
    color[i] = grey ? color[i % 2] : color[i];
  }
  return color;
}

/// Points that use every branch of the format: all attributes at random, times in four sequences.
std::string wild_points(std::size_t count, const LasPointLayout& layout) {
  Congruential random;
  std::string points;
  LazColor color{};
  for (std::size_t i = 0; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool far = random.below(2) != 0;
      const auto steps = static_cast<int64_t>(random.below(far ? uint64_t{1} << 31U : 2000));
      points += test::bytes_of(static_cast<int32_t>(far ? 2 * steps - (int64_t{1} << 31U) : steps));
    }
    points += test::bytes_of(static_cast<uint16_t>(random.below(65536)));
    points += test::bytes_of(static_cast<uint8_t>(random.below(256)));
    // With colours or extra bytes all of scanner channel 0.
    points += test::bytes_of(
        static_cast<uint8_t>(random.below(256) & (layout.bytes() > kLas6Bytes ? 0xcfU : 0xffU)));
    points += test::bytes_of(static_cast<uint8_t>(random.below(256)));
    points += test::bytes_of(static_cast<uint8_t>(random.below(256)));
    points += test::bytes_of(static_cast<uint16_t>(random.below(65536)));
    points += test::bytes_of(static_cast<uint16_t>(random.below(3)));
    const auto index = static_cast<double>(i);
    double time = 0.0;
    switch (random.below(4)) {
      case 0:
        time = 1e8 + static_cast<double>(random.below(1000)) * 1e-6;
        break;
      case 1:
        time = 1e8 + index * 1e-4;
        break;
      case 2:
        time = std::floor(index / 3.0) * 0.01;
        break;
      default:
        time = static_cast<double>(random.below(uint64_t{1} << 31U)) * 1e3;
    }
    points += test::bytes_of(time);
    if (layout.colored) {
      color = wild_color(random, color);
      points.append(color.begin(), color.end());
    }
    for (std::size_t byte = 0; byte < layout.extra_bytes; ++byte) {
      points += test::bytes_of(static_cast<uint8_t>(random.below(256)));
    }
  }
  return points;
}

/// Returns of a sensor that goes along a wall.
std::vector<LasPoint> scanned_points(std::size_t count, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<LasPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double along = 0.001 * static_cast<double>(i);
    points.push_back({.position = {along + noise(random), 5.0 + noise(random),
                                   2.0 * std::sin(0.37 * static_cast<double>(i))},
                      .time = std::chrono::microseconds(1'700'000'000'000'000 + 10 * i),
                      .intensity = static_cast<uint16_t>(random() % 4096U),
                      .classification = i % 50 == 0 ? LasClass::moving : LasClass::unclassified,
                      .source = 1,
                      .ring = static_cast<uint16_t>(i % 16),
                      .keyframe = static_cast<uint32_t>(i / 1000)});
  }
  return points;
}

template <class Writer, class... Packing>
std::string written(const std::filesystem::path& file, const std::vector<LasPoint>& points,
                    Packing... packing) {
  const LasHeading heading{
      .wkt = "LOCAL_CS[\"here\"]", .offset = {100.0, 200.0, 0.0}, .unix_times = true};
  Writer writer(file, heading, packing...);
  const std::span<const LasPoint> all(points);
  for (std::size_t at = 0; at < all.size(); at += 777) {
    writer.write(all.subspan(at, std::min<std::size_t>(777, all.size() - at)));
  }
  writer.close();
  EXPECT_EQ(writer.count(), points.size());
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(ArithmeticCoder, WhatIsEncodedIsDecoded) {
  std::mt19937 random(7);
  for (const uint32_t bits : {8U, 16U, 32U}) {
    std::vector<std::pair<int32_t, int32_t>> numbers;  // prediction and value
    for (int i = 0; i < 5000; ++i) {
      const auto any = [&] {
        const auto wide = static_cast<uint32_t>(random()) >> (random() % 32U);
        return static_cast<int32_t>(bits < 32 ? wide & ((1U << bits) - 1U) : wide);
      };
      numbers.emplace_back(any(), any());
    }
    if (bits == 32) {
      for (const int32_t extreme :
           {std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::max()}) {
        numbers.emplace_back(0, extreme);
        numbers.emplace_back(extreme, 0);
        numbers.emplace_back(extreme, -1 - extreme);
      }
    }
    ArithmeticEncoder encoder;
    IntegerModel model(bits, 3);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      model.code(encoder, numbers[i].first, numbers[i].second, static_cast<uint32_t>(i % 3));
    }
    const std::string bytes = encoder.finish();
    ArithmeticDecoder decoder(bytes_in(bytes));
    IntegerModel again(bits, 3);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      ASSERT_EQ(again.code(decoder, numbers[i].first, 0, static_cast<uint32_t>(i % 3)),
                numbers[i].second)
          << bits << " bits, " << i;
    }
    EXPECT_FALSE(decoder.is_overrun());
    for (int i = 0; i < 1000; ++i) {
      again.code(decoder, 0, 0, 0);
    }
    EXPECT_TRUE(decoder.is_overrun());
  }
}

// Sizes and hashes are those of chunks that laz-rs 0.12 (PyPI's lazrs 0.8.2) makes of the same
// points.
TEST(LazChunk, IsByteForByteWhatOtherProgramsWrite) {
  struct Case {
    LasPointLayout layout;
    uint64_t points;
    std::size_t size;
    uint64_t chunk;
  };
  for (const Case& c : {Case{{}, 0xda9eb519970d2af9U, 51547, 0xdbe48630b06168c8U},
                        Case{{.extra_bytes = 6}, 0x79da72afe9dbec60U, 61556, 0x6142060bebf673c7U},
                        Case{{.colored = true, .extra_bytes = 6},
                             0x50ee1495eb4fc8e5U,
                             69848,
                             0x14687d57da2308e6U}}) {
    const std::size_t point_bytes = c.layout.bytes();
    const std::string points = wild_points(2000, c.layout);
    ASSERT_EQ(fnv1a(points), c.points);
    const std::string chunk = pack_laz_chunk(points, c.layout);
    EXPECT_EQ(chunk.size(), c.size);
    EXPECT_EQ(fnv1a(chunk), c.chunk);
    const UnpackedChunk unpacked =
        unpack_laz_chunk(bytes_in(chunk), 2000,
                         {.point_bytes = point_bytes,
                          .layers = 9 + (c.layout.colored ? 1U : 0U) + c.layout.extra_bytes});
    EXPECT_TRUE(unpacked.is_whole);
    ASSERT_EQ(unpacked.points.size(), 2000 * kLas6Bytes);
    for (std::size_t i = 0; i < 2000; ++i) {
      ASSERT_EQ(unpacked.points.substr(i * kLas6Bytes, kLas6Bytes),
                points.substr(i * point_bytes, kLas6Bytes))
          << i;
    }
  }
}

/// A file of format 3 with two extra bytes a point that laspy 2.7 with lazrs 0.8.2 wrote of 40
/// points.
constexpr const char* kFormat3 =
    "TEFTRgAAAAAAAAAAAAAAAAAAAAAAAAAAAQJPVEhFUgAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAGxhc3B5IDIuNy"
    "4wAAAAAAAAAAAAAAAAAAAAAAAAAAAATgHqB+MASQIAAAIAAACDJAAoAAAACAAAABEAAAAPAAAAAAAAAAAAAAD8qfHS"
    "TWJQP/yp8dJNYlA//Knx0k1iUD8AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAbL90kBoFDQLpJDAIrh5Y/LbKd76fGDk"
    "ArhxbZzvfDP5LtfD81XtI/AAAAAAAAAAAAAExBU0ZfU3BlYwAAAAAAAAAEAMAARXh0cmEgQnl0ZXMgUmVjb3JkAAAA"
    "AAAAAAAAAAAAAAAAAAMGcmluZwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"
    "AAAAAAAAAABgAAAAAAAAAAAAAAAAAAAAAAAAAAAAAABgAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"
    "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"
    "AAAGxhc3ppcCBlbmNvZGVkAAC8VjoAaHR0cDovL2xhc3ppcC5vcmcAAAAAAAAAAAAAAAAAAAACAAAAAgIAAAAAAABQ"
    "wwAA/////////////////////wQABgAUAAIABwAIAAIACAAGAAIAAAACAAIAawUAAAAAAAAWAAAABw8AAC4AAADHAB"
    "kDGwEAAAAAAACgnRJBTRpNGk0aBgDwjX46Wtu+Nb4CvsUkzYIAAAKybNyPSr+wKTY+NjN5JTdwZvqMxlxWQVCt9tW6"
    "4qoK8ulSiOnKp8/IuLcA6nvhEKTC3Q2K2tin+sZkXgzrqF70QCFQm8SM+0eVMjk2v9W35KmYJ90xCU2JzfHPNCVHj7"
    "YiZiATrUNWoeSjFrFyA39JMzhaXG1fAZz92NMbVRo4W2KoCWO+XTEVhM+nAFimL5lFr/RVAC97ldQKt/ysL20qZs18"
    "DFvMLWrhv0DD3xW/eBcJXOXKybUOk7P+u0YfA9ODgevBgXp6V5h7Iwlj8Wp6QVe75xA81iC+UgYpnZCcUJ5AGqTO8l"
    "hjra2d5p7lSNvgXQ1ec//EagBcYeXvVuD5PJgZU0WHuRghUOLM8Y/sC/g0WHcGInPyR1Wdg+c1PG1SPrBMYIf7W2o4"
    "XY7tSqpNgFZVBLnENzg60IZeBjoQ28b+s0gqhRODoWRgWIgULXj1wwqKoAlDR1W+bbs8PEYntRCLVuHUz0u7cHIklf"
    "uzSAEd6+EJczBtJoIsP7PT/DRCgdbOooW74KcFBoikueznp2u0ZedpN6XrWnWy9eWClHqt3QMmF+PFB1B8ulnQUhXD"
    "59slYVfizKpWo3Z9V4xehy+699hmFjuM7+ZDFzoLyfysBZNOeJO66wk7i85kG4R1PSJWA1f5zYTqLSu9f+BAjfRve8"
    "Dvodd2ndibceP/Rb+DwvpPsFOceT/AfjjvcXxQ4Dp1H9QyJux3CmjzQF+Nes8dLmI/cF+qKW96+0FYE5/kzA9qY3BS"
    "cZO0V0MdxJen32QWpETVdzxakGkwPEqFDgDFaTTXxocWreVtgDBHM+5/EDh6YT+zBdJfCz2jmWlFdZLVvrBJ29p1ln"
    "UR+FbfZ3wXdQC9auC4Vq3gHGwmD6RZqbNpZ6NjEyUtotS4Hr3jOwhfG4B/g6cSH9KqlnRf18OfM9uX2R5CoDZtAtP7"
    "FW+klf+ECsPg9rAJyRFh241B9sENaG8cEKbGA1AxOBArAQAAAAAAAAABAAAAU5PyAAA=";

TEST(LasReader, PackedPointsOfFormat3) {
  const std::string file = decoded_base64(kFormat3);
  const CloudFile cloud = parse_las("a.laz", file, kSurvey);
  EXPECT_EQ(cloud.sweep.points.size(), 40U);
  const auto begin = static_cast<std::size_t>(static_cast<uint8_t>(file[96])) +
                     256U * static_cast<uint8_t>(file[97]);
  const LazPoints points =
      unpack_laz(bytes_in(file), {.begin = begin,
                                  .points = 40,
                                  .format = 3,
                                  .point_bytes = 36,
                                  .records = bytes_in(file).subspan(227, begin - 227)});
  EXPECT_EQ(points.fault, "");
  EXPECT_EQ(fnv1a(points.bytes), 0x21f10782e0735250U);  // of the plain file's points
}

TEST(LasWriter, PackedPointsAreThePlainOnes) {
  const test::TemporaryFolder folder;
  const std::vector<LasPoint> points = scanned_points(2 * kLazChunkPoints + 123);
  const std::string plain = written<LasWriter>(folder / "a.las", points);
  const std::string packed = written<LasWriter>(folder / "a.laz", points, LasPacking::laz);
  EXPECT_LT(packed.size() * 3, plain.size());
  EXPECT_EQ(written<LasWriter>(folder / "b.laz", points, LasPacking::laz), packed);
  const CloudFile a = parse_las("a.las", plain, kSurvey);
  const CloudFile b = parse_las("a.laz", packed, kSurvey);
  EXPECT_TRUE(b.faults.empty());
  ASSERT_EQ(a.sweep.points.size(), b.sweep.points.size());
  EXPECT_EQ(std::memcmp(a.sweep.points.data(), b.sweep.points.data(),
                        a.sweep.points.size() * sizeof(Point)),
            0);
  EXPECT_EQ(a.sweep.times, b.sweep.times);
  // The header says the same but for the packing.
  EXPECT_EQ(packed.substr(179, 196), plain.substr(179, 196));

  const std::string none = written<LasWriter>(folder / "none.laz", {}, LasPacking::laz);
  EXPECT_GT(none.size(), 375U);
}

TEST(LasReader, PackedFilesThatAreDamagedGiveWholeChunksOrAReason) {
  const test::TemporaryFolder folder;
  const std::vector<LasPoint> points = scanned_points(kLazChunkPoints + 500);
  const std::string good = written<LasWriter>(folder / "a.laz", points, LasPacking::laz);
  const CloudFile cut = parse_las("a.laz", good.substr(0, good.size() - 3000));
  EXPECT_EQ(cut.sweep.points.size(), kLazChunkPoints);
  ASSERT_FALSE(cut.faults.empty());
  EXPECT_NE(cut.faults.back().found().find("promises 50500 packed points; 50000 can be"),
            std::string::npos)
      << cut.faults.back().found();
  // Those of version 2, too, whose chunks are found by their table alone.
  const std::string few =
      written<LasWriter>(folder / "few.laz", scanned_points(200), LasPacking::laz);
  std::mt19937 random(5);
  for (const std::string& file : {few, decoded_base64(kFormat3)}) {
    const std::size_t most = file == few ? 200 : 40;
    for (int i = 0; i < 2000; ++i) {
      std::string bytes = file;
      for (int k = 0; k < 3; ++k) {
        bytes[96 + random() % (bytes.size() - 96)] =
            static_cast<char>(random() % 3U == 0 ? 0xff : random());
      }
      bytes.resize(i % 4 == 0 ? random() % bytes.size() : bytes.size());
      try {
        EXPECT_LE(parse_las("a.laz", bytes).sweep.points.size(), 2048 * bytes.size() + most);
      } catch (const InputError&) {
        // the other right answer
      }
    }
  }
}

TEST(LasReader, PackedPointsThatAreAllAlikeAreReadBack) {
  const test::TemporaryFolder folder;
  for (const std::size_t count : {std::size_t{1}, std::size_t{kLazChunkPoints}}) {
    const std::vector<LasPoint> points(count, LasPoint{.position = {101.0, 202.0, 3.0}});
    for (const std::string& file : {written<LasWriter>(folder / "a.laz", points, LasPacking::laz),
                                    written<CopcWriter>(folder / "a.copc.laz", points)}) {
      const CloudFile cloud = parse_las("a.laz", file, kSurvey);
      EXPECT_EQ(cloud.sweep.points.size(), count);
      EXPECT_TRUE(cloud.faults.empty());
    }
  }
}

// A header and a record that agree with each other, but not with how such points are packed.
TEST(LasReader, ARecordThatDoesNotFitThePointFormatIsRefused) {
  const test::TemporaryFolder folder;
  const std::string good =
      written<LasWriter>(folder / "a.laz", scanned_points(200), LasPacking::laz);
  const std::size_t items = 375 + 54 + 34;  // the record is the first
  ASSERT_EQ(static_cast<uint8_t>(good[items]), 10U);
  const auto found = [](const std::string& bytes) {
    try {
      parse_las("a.laz", bytes);
    } catch (const InputError& error) {
      return error.found();
    }
    return std::string("nothing");
  };
  for (const auto& [format, point_bytes, first, extra] :
       {std::array{0, 20, 20, 0}, std::array{1, 28, 28, 0}, std::array{6, 36, 20, 16},
        std::array{3, 36, 30, 6}, std::array{6, 36, 36, 0}, std::array{7, 36, 30, 6},
        std::array{9, 59, 30, 29}}) {
    std::string bytes = good;
    bytes[104] = static_cast<char>(0x80 | format);
    test::put_at(bytes, 105, static_cast<uint16_t>(point_bytes));
    test::put_at(bytes, items + 2, static_cast<uint16_t>(first));
    test::put_at(bytes, items + 8, static_cast<uint16_t>(extra));
    EXPECT_NE(found(bytes).find("in a way that is not known"), std::string::npos)
        << format << ' ' << found(bytes);
  }
}

/// All nodes of an octree of points of a LAS file.
std::map<VoxelKey, std::string> nodes_of(const std::string& points, const CopcCube& cube,
                                         const CopcLimits& limits,
                                         const std::filesystem::path& folder) {
  ScratchFile scratch(folder / "points");
  scratch.append(points);
  std::map<VoxelKey, std::string> nodes;
  visit_copc_nodes({.file = &scratch, .point_bytes = kPointBytes}, cube, limits,
                   [&](std::span<const CopcNode> some) {
                     for (const CopcNode& node : some) {
                       EXPECT_TRUE(nodes.emplace(node.key, node.points).second);
                     }
                   });
  return nodes;
}

TEST(CopcOctree, EachPointIsInOneNodeThatHasItAndNoCoarserOneHasRoom) {
  const test::TemporaryFolder folder;
  constexpr int kPoints = 30'000;
  LasExtent extent;
  std::string points;
  std::mt19937 random(3);
  for (int i = 0; i < kPoints; ++i) {
    const auto at = [&](double scale) { return scale * static_cast<double>(random() % 100'000U); };
    // A dense corner, so that parts lie at different levels.
    const double scale = i % 2 == 0 ? 1e-3 : 1e-5;
    append_las_point(
        points, extent,
        {.position = {at(scale), at(scale), at(0.1 * scale)}, .keyframe = static_cast<uint32_t>(i)},
        {}, "cloud.copc.laz");
  }
  const CopcCube cube = cube_of(extent);
  const CopcLimits limits{.part = 4000, .node = 200};
  const auto nodes = nodes_of(points, cube, limits, folder.path());
  EXPECT_GT(nodes.size(), 10U);
  EXPECT_GE(nodes.rbegin()->first.level, 3);
  std::set<uint32_t> seen;
  for (const auto& [key, held] : nodes) {
    if (key.level > 0) {
      EXPECT_TRUE(nodes.contains({key.level - 1, key.x / 2, key.y / 2, key.z / 2}));
    }
    std::set<uint32_t> cells;
    for (std::size_t at = 0; at < held.size(); at += kPointBytes) {
      const CopcCube::Place place = cube.place_of(held.data() + at);
      EXPECT_EQ(cube.key_of(place, key.level), key);
      cells.insert(cube.cell_of(place, key.level));
      uint32_t number = 0;
      std::memcpy(&number, held.data() + at + 32, sizeof(number));
      EXPECT_TRUE(seen.insert(number).second);
    }
    const std::size_t count = held.size() / kPointBytes;
    EXPECT_TRUE(count <= limits.node || cells.size() == count) << key.level << ' ' << count;
  }
  EXPECT_EQ(seen.size(), std::size_t{kPoints});
  // Whatever is in memory at a time.
  EXPECT_EQ(nodes_of(points, cube, limits, folder.path()), nodes);
  // A point far away leaves all others in one cell of the first count.
  append_las_point(points, extent,
                   {.position = {1.9e6, 0.0, 0.0}, .keyframe = static_cast<uint32_t>(kPoints)}, {},
                   "cloud.copc.laz");
  std::size_t most = 0;
  std::size_t all = 0;
  for (const auto& [key, bytes] : nodes_of(points, cube_of(extent), limits, folder.path())) {
    most = std::max(most, bytes.size() / kPointBytes);
    all += bytes.size() / kPointBytes;
  }
  EXPECT_EQ(all, std::size_t{kPoints} + 1);
  EXPECT_LT(most, 10'000U);
  points.resize(points.size() - kPointBytes);
  // In one part the same points are in as many nodes or more, never lost.
  std::size_t held = 0;
  for (const auto& [key, bytes] : nodes_of(points, cube, {.node = 200}, folder.path())) {
    held += bytes.size() / kPointBytes;
  }
  EXPECT_EQ(held, std::size_t{kPoints});
}

TEST(CopcWriter, IsALazFileWithItsOctreeWhereReadersLookForIt) {
  const test::TemporaryFolder folder;
  const std::vector<LasPoint> points = scanned_points(120'000);
  const std::string file = written<CopcWriter>(folder / "a.copc.laz", points);
  EXPECT_EQ(written<CopcWriter>(folder / "b.copc.laz", points), file);
  EXPECT_EQ(file.substr(377, 4), "copc");
  const auto number = [&](auto value, std::size_t at) {
    std::memcpy(&value, file.data() + at, sizeof(value));
    return value;
  };
  const auto list = number(uint64_t{}, 429 + 40);
  const auto list_bytes = number(uint64_t{}, 429 + 48);
  EXPECT_EQ(list + list_bytes, file.size());
  uint64_t held = 0;
  for (uint64_t at = list; at < list + list_bytes; at += 32) {
    const auto count = static_cast<uint64_t>(number(int32_t{}, at + 28));
    // Each chunk says its number of points behind its first point.
    EXPECT_EQ(number(uint32_t{}, number(uint64_t{}, at + 16) + kPointBytes), count);
    held += count;
  }
  EXPECT_EQ(held, points.size());
  const CloudFile cloud = parse_las("a.copc.laz", file, kSurvey);
  EXPECT_TRUE(cloud.faults.empty());
  EXPECT_EQ(cloud.sweep.points.size(), points.size());
  // Nothing is left beside it, and an empty cloud has a root.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
  const std::string none = written<CopcWriter>(folder / "none.copc.laz", {});
  EXPECT_EQ(
      none.size(), 32 + [&] {
        uint64_t at = 0;
        std::memcpy(&at, none.data() + 429 + 40, sizeof(at));
        return at;
      }());
}

}  // namespace
}  // namespace adit
