// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/cloud_pairs.hpp"

#include <array>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/temporary_folder.hpp"

namespace adit {
namespace {

/// What the error says; empty: there was none.
template <class Read>
std::string complaint(Read&& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

std::string bin(const std::vector<std::array<float, 3>>& points) {
  std::string bytes;
  for (const auto& [x, y, z] : points) {
    bytes += test::bytes_of_all(x, y, z, 0.5F);
  }
  return bytes;
}

TEST(CloudPairs, ReadsNamesGuessesAndComments) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("pairs.txt",
                                 "# two clouds each\n\n"
                                 "a.pcd b.ply\n"
                                 "\"with blank.pcd\" /abs/c.las 1 2 3 90  # a yaw\n"
                                 "d.bin e.mcap@12 1 2 3 0 0 1 1\n");
  const std::vector<NamedPair> pairs = read_pairs(file);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(pairs[0].a, (folder / "a.pcd").string());
  EXPECT_EQ(pairs[0].b, (folder / "b.ply").string());
  EXPECT_FALSE(pairs[0].guess.has_value());
  EXPECT_EQ(pairs[1].a, (folder / "with blank.pcd").string());
  EXPECT_EQ(pairs[1].b, "/abs/c.las");
  for (const std::size_t i : {1U, 2U}) {  // both are a quarter turn
    ASSERT_TRUE(pairs[i].guess.has_value());
    EXPECT_TRUE(pairs[i].guess->translation().isApprox(Eigen::Vector3d(1.0, 2.0, 3.0)));
    EXPECT_NEAR(rotation_angle(pairs[i].guess->linear()), 90.0 * kDegree, 1e-12);
    EXPECT_TRUE((*pairs[i].guess * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(1, 3, 3)));
  }
}

TEST(CloudPairs, WrongLinesAreErrorsWithTheirNumber) {
  const test::TemporaryFolder folder;
  for (const auto& [line, part] :
       {std::pair("a.pcd", "it names one cloud"), std::pair("a b 1 2 3", "3 numbers are no pose"),
        std::pair("a b 1 2 x 4", "'x' is not a number"), std::pair("a b 1 2 nan 4", "no pose"),
        std::pair("a b 1 2 inf 4", "no pose"), std::pair("a b 1 2 1e9 4", "no pose"),
        std::pair("a b 1 2 3 0 0 0 0", "no pose"),
        std::pair("a b 1 2 3 4 5 6 7 8", "8 numbers are no pose")}) {
    const auto file = folder.write("pairs.txt", std::string("a b\n") + line + "\n");
    const std::string said = complaint([&] { read_pairs(file); });
    EXPECT_NE(said.find("pairs.txt, line 2: "), std::string::npos) << line << ": " << said;
    EXPECT_NE(said.find(part), std::string::npos) << line << ": " << said;
  }
  const auto empty = folder.write("empty.txt", "# nothing\n");
  EXPECT_NE(complaint([&] { read_pairs(empty); }).find("no pairs in it"), std::string::npos);
  EXPECT_NE(complaint([&] { read_pairs(folder / "missing"); }).find("cannot be read"),
            std::string::npos);
  EXPECT_NE(complaint([&] { read_pairs(folder.path()); }).find("cannot be read"),
            std::string::npos);
}

TEST(CloudPairs, ReadsTheSweepThatIsNamed) {
  const test::TemporaryFolder folder;
  folder.write("velodyne/000000.bin", bin({{1.0F, 2.0F, 3.0F}}));
  folder.write("velodyne/000001.bin", bin({{4.0F, 5.0F, 6.0F}, {7.0F, 8.0F, 9.0F}}));
  const std::string recording = folder.path().string();
  EXPECT_EQ(read_cloud(recording).points.size(), 1U);
  EXPECT_EQ(read_cloud(recording + "@0").points.size(), 1U);
  EXPECT_EQ(read_cloud(recording + "@1").points.size(), 2U);
  EXPECT_NE(complaint([&] { read_cloud(recording + "@2"); }).find("no sweep number 2"),
            std::string::npos);
  EXPECT_NE(complaint([&] { read_cloud(recording + "@x"); }).find("@x: there is no such file"),
            std::string::npos);
  // A file may be called so.
  folder.write("velodyne/a@1.bin", bin({{4.0F, 5.0F, 6.0F}}));
  EXPECT_EQ(read_cloud((folder / "velodyne/a@1.bin").string()).points.size(), 1U);
}

TEST(CloudPairs, CloudsThatAreNoneSayWhy) {
  const test::TemporaryFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto said = [&](const std::string& name, const std::string& bytes) {
    const auto file = folder.write(name, bytes);
    return complaint([&] { read_cloud(file.string()); });
  };
  EXPECT_NE(said("empty.bin", "").find("no points"), std::string::npos);
  EXPECT_NE(said("nan.bin", bin({{nan, nan, nan}, {0.0F, 0.0F, 0.0F}})).find("none is a return"),
            std::string::npos);
  EXPECT_NE(said("utm.bin", bin({{1.0F, 2.0F, 3.0F}, {4.5e5F, 5.4e6F, 300.0F}}))
                .find("rounded to float32, which has steps of 0.5 m"),
            std::string::npos);
  EXPECT_NE(said("far.bin", bin({{1.0F, 2.0F, 3.0F}, {1.0F, 2.0F, 3.0F}, {2e5F, 0.0F, 0.0F}}))
                .find("point 2: it lies more than 100 km"),
            std::string::npos);
  EXPECT_NE(said("cut.bin", "abc").find("cut.bin"), std::string::npos);
  EXPECT_NE(said("cloud.xyz", "1 2 3").find("no recording"), std::string::npos);
}

}  // namespace
}  // namespace adit
