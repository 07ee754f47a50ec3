// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Damaged files: cut off at every byte, with bytes changed at random, with words of the header
// replaced. Whatever is left must read as a sweep or end in an InputError; the sanitizers watch for
// the rest.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/pcd_reader.hpp"
#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/clouds/sweep_times.hpp"
#include "adit/tools/results/trajectory_io.hpp"

// fuzz_clouds.cpp; renamed by tests/CMakeLists.txt, since the program has other entries.
extern "C" int adit_fuzz_clouds(const uint8_t* data, std::size_t size);

namespace adit {
namespace {

using test::bytes_of;
using test::bytes_of_all;

/// Runs the readers; aborts the test program where a sweep is not valid.
void feed_clouds(const std::string& content) {
  // A copy of exactly this size, so that the address sanitizer sees a read beyond the end.
  const std::vector<uint8_t> exact(content.begin(), content.end());
  adit_fuzz_clouds(exact.data(), exact.size());
}

/// x y z ring time of points 0..n-1, point by point.
std::string timed_rows(int points) {
  std::string rows;
  for (int i = 0; i < points; ++i) {
    const auto v = static_cast<float>(i);
    rows += bytes_of_all(v, -v, 1.0F, static_cast<uint16_t>(i), 1.7e9 + 0.001 * i);
  }
  return rows;
}

/// The same field by field, as compressed files store it.
std::string timed_columns(int points) {
  const std::string rows = timed_rows(points);
  constexpr std::size_t kFieldBytes[] = {4, 4, 4, 2, 8};
  constexpr std::size_t kRowBytes = 22;
  std::string columns;
  std::size_t offset = 0;
  for (const std::size_t bytes : kFieldBytes) {
    for (std::size_t row = 0; row < rows.size(); row += kRowBytes) {
      columns += rows.substr(row + offset, bytes);
    }
    offset += bytes;
  }
  return columns;
}

/// Small files of every kind the readers know.
std::vector<std::string> cloud_seeds() {
  const std::string fields =
      "FIELDS x y z ring time\nSIZE 4 4 4 2 8\nTYPE F F F U F\nWIDTH 8\nHEIGHT 1\nPOINTS 8\nDATA ";
  const std::string rows = timed_rows(8);
  const std::string vertex =
      "element vertex 3\nproperty float x\nproperty double y\nproperty int z\nproperty ushort "
      "ring\n";
  const std::string lists =
      "element face 2\nproperty list uchar int a\nelement vertex 2\nproperty float x\nproperty "
      "float y\n"
      "property list ushort double b\nproperty float z\nproperty uint t\n";
  const std::string faces =
      bytes_of(uint8_t{2}) + bytes_of_all(int32_t{5}, int32_t{6}) + bytes_of(uint8_t{0});
  const std::string list_vertex = bytes_of_all(1.0F, 2.0F) + bytes_of(uint16_t{1}) + bytes_of(9.0) +
                                  bytes_of_all(3.0F, uint32_t{77});
  const std::string fixed_vertex =
      bytes_of(1.0F) + bytes_of(2.0) + bytes_of(int32_t{3}) + bytes_of(uint16_t{4});
  return {
      fields + "binary\n" + rows,
      fields + "binary_compressed\n" + test::pcd_compressed_body(timed_columns(8)),
      fields +
          "ascii\n1 2 3 4 0.1\n1 2 3 4 0.2\nnan nan nan 0 0\n1 2 3 4 0.3\n1 2 3 4 .4\n1 2 3 4 "
          "5e-1\n1 2 3 4 .6\n1 2 3 4 .7\n",
      "ply\nformat binary_little_endian 1.0\n" + vertex + "end_header\n" + fixed_vertex +
          fixed_vertex + fixed_vertex,
      "ply\nformat binary_big_endian 1.0\n" + vertex + "end_header\n" + fixed_vertex +
          fixed_vertex + fixed_vertex,
      "ply\nformat ascii 1.0\n" + vertex + "end_header\n1 2 3 4\n5 6 7 8\n9 10 11 12\n",
      "ply\nformat binary_little_endian 1.0\n" + lists + "end_header\n" + faces + list_vertex +
          list_vertex,
      "ply\nformat ascii 1.0\n" + lists + "end_header\n2 5 6\n0\n1 2 1 9 3 77\n4 5 0 6 88\n",
  };
}

TEST(Mutations, SeedsAreValid) {
  for (const std::string& seed : cloud_seeds()) {
    // One of them has a coordinate in whole metres.
    const CloudReading reading{.coordinate_scale = 1.0};
    const CloudFile cloud = seed.starts_with("ply") ? parse_ply("seed", seed, reading)
                                                    : parse_pcd("seed", seed, reading);
    EXPECT_GE(cloud.sweep.points.size(), 2U);
  }
}

TEST(Mutations, ElementsWithoutAnyPoint) {
  // Found by libFuzzer: an offset into an empty vector.
  for (const char* format : {"ascii", "binary_little_endian"}) {
    feed_clouds(
        "ply\nformat " + std::string(format) +
        " 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty list ushort double "
        "b\n"
        "property float z\nproperty uint t\nend_header\n");
  }
  for (const std::string& data : {std::string("ascii\n"), std::string("binary\n"),
                                  "binary_compressed\n" + std::string(8, '\0')}) {
    feed_clouds("FIELDS x y z time\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 0\nHEIGHT 1\nDATA " + data);
  }
}

TEST(Mutations, FilesCutOffAtEveryByte) {
  for (const std::string& seed : cloud_seeds()) {
    for (std::size_t size = 0; size < seed.size(); ++size) {
      feed_clouds(seed.substr(0, size));
    }
  }
}

TEST(Mutations, EveryBitFlipped) {
  for (const std::string& seed : cloud_seeds()) {
    for (std::size_t bit = 0; bit < 8 * seed.size(); ++bit) {
      std::string damaged = seed;
      damaged[bit / 8] =
          static_cast<char>(static_cast<unsigned char>(damaged[bit / 8]) ^ (1U << (bit % 8)));
      feed_clouds(damaged);
    }
  }
}

TEST(Mutations, SeveralBytesChangedMovedAndRepeated) {
  std::mt19937 random(20260101);
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(random() % std::max<std::size_t>(n, 1));
  };
  for (const std::string& seed : cloud_seeds()) {
    for (int round = 0; round < 3000; ++round) {
      std::string damaged = seed;
      for (std::size_t change = 0; change <= below(5); ++change) {
        const std::size_t at = below(damaged.size());
        switch (below(5)) {
          case 0:
            damaged[at] = static_cast<char>(random());
            break;
          case 1:
            damaged.erase(at, below(8));
            break;
          case 2:
            damaged.insert(at, damaged.substr(below(damaged.size()), below(16)));
            break;
          case 3:
            damaged[at] = static_cast<char>('0' + below(10));
            break;
          default:
            damaged.insert(at, 1 + below(4), static_cast<char>(random()));
            break;
        }
        if (damaged.empty()) {
          break;
        }
      }
      feed_clouds(damaged);
    }
  }
}

TEST(Mutations, NumbersInHeadersMadeHugeNegativeAndWrong) {
  const std::vector<std::string> numbers = {"0",
                                            "1",
                                            "-1",
                                            "2147483647",
                                            "2147483648",
                                            "4294967295",
                                            "4294967296",
                                            "9223372036854775807",
                                            "18446744073709551615",
                                            "99999999999999999999",
                                            "1e9",
                                            "nan",
                                            ""};
  for (const std::string& seed : cloud_seeds()) {
    const std::size_t header = std::max(seed.find("DATA"), seed.find("end_header"));
    for (std::size_t at = 0; at < std::min(header, seed.size()); ++at) {
      if (seed[at] < '0' || seed[at] > '9') {
        continue;
      }
      for (const std::string& number : numbers) {
        feed_clouds(std::string(seed).replace(at, 1, number));
      }
    }
  }
}

TEST(Mutations, TextFilesCutOffAndChanged) {
  const test::TemporaryFolder folder;
  const std::string tum = "# t x\n1.5 1 2 3 0 0 0 1\n2.5 1e1 -2 3 0.5 0.5 0.5 0.5\n";
  const std::string kitti = "1 0 0 7 0 1 0 8 0 0 1 9\n0 -1 0 7 1 0 0 8 0 0 1 9\n";
  const std::string times = "2011-09-26 13:02:25.594\n2011-09-26 13:02:25.697\n";
  std::mt19937 random(3);
  const auto feed_text = [&](const std::string& text) {
    const std::filesystem::path file = folder.write("text", text);
    try {
      for (const StampedPose& pose : read_trajectory(file).poses) {
        EXPECT_TRUE(pose.pose.matrix().allFinite());
        EXPECT_NEAR(pose.pose.linear().determinant(), 1.0, 1e-9);
      }
    } catch (const InputError&) {
      // the other right answer
    }
    try {
      read_times(file);
    } catch (const InputError&) {
      // the other right answer
    }
  };
  for (const std::string& seed : {tum, kitti, times}) {
    for (std::size_t at = 0; at < seed.size(); ++at) {
      feed_text(seed.substr(0, at));
      for (int i = 0; i < 4; ++i) {
        std::string damaged = seed;
        damaged[at] = i == 0 ? '9' : i == 1 ? '-' : static_cast<char>(random());
        feed_text(damaged);
      }
    }
  }
}

}  // namespace
}  // namespace adit
