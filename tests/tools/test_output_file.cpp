// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/output_file.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/clouds/ply_writer.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

/// The message of the OutputError that `action` throws, or "" where it throws none.
template <class Action>
std::string output_error(Action&& action) {
  try {
    action();
  } catch (const OutputError& error) {
    return error.what();
  }
  return "";
}

std::vector<Point> some_points(std::size_t count) {
  std::vector<Point> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto v = static_cast<float>(i);
    points[i] = {v, -v, 0.5F * v, v / 7.0F};
  }
  return points;
}

void expect_same_points(const std::vector<Point>& a, const std::vector<Point>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].x, b[i].x);
    EXPECT_EQ(a[i].y, b[i].y);
    EXPECT_EQ(a[i].z, b[i].z);
    EXPECT_EQ(a[i].intensity, b[i].intensity);
  }
}

TEST(OutputFile, FullDiskIsAnErrorThatNamesTheFile) {
  if (!std::filesystem::exists("/dev/full")) {
    GTEST_SKIP() << "needs /dev/full";
  }
  const std::string message = output_error([] { write_text_file("/dev/full", "some text"); });
  EXPECT_NE(message.find("/dev/full"), std::string::npos);
  EXPECT_NE(message.find("No space left on device"), std::string::npos);
}

TEST(OutputFile, FullDiskIsNoticedInEveryMember) {
  if (!std::filesystem::exists("/dev/full")) {
    GTEST_SKIP() << "needs /dev/full";
  }
  EXPECT_NE(output_error([] {
              OutputFile file("/dev/full");
              file.write("x");
              file.flush();
            }),
            "");
  EXPECT_NE(output_error([] {
              OutputFile file("/dev/full");
              file.write(std::string(1U << 20U, 'x'));  // beyond the buffer
            }),
            "");
  EXPECT_NE(output_error([] {
              OutputFile file("/dev/full");
              file.write("x");
              file.close();
            }),
            "");
}

TEST(OutputFile, MissingFolderIsAnErrorThatNamesTheFile) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder / "missing/out.txt";
  const std::string message = output_error([&] { write_text_file(path, "x"); });
  EXPECT_NE(message.find(path.string()), std::string::npos);
  EXPECT_NE(message.find("No such file or directory"), std::string::npos);
}

TEST(OutputFile, OverwriteGoesOnAtTheEnd) {
  const test::TemporaryFolder folder;
  OutputFile file(folder / "a.txt");
  file.write("abcdef");
  file.overwrite(1, "XY");
  file.write("g");
  file.close();
  EXPECT_EQ(read_text_file(folder / "a.txt"), "aXYdefg");
}

TEST(PlyWriter, CloudReadsBackBitForBit) {
  const test::TemporaryFolder folder;
  const std::vector<Point> points = some_points(1000);
  PlyWriter writer(folder / "map.ply");
  writer.write(std::span(points).first(300));
  writer.write({});
  writer.write(std::span(points).subspan(300));
  writer.close();
  EXPECT_EQ(writer.count(), 1000U);
  expect_same_points(read_ply(folder / "map.ply").sweep.points, points);
}

TEST(PlyWriter, FileIsValidAfterEachFlush) {
  const test::TemporaryFolder folder;
  const std::vector<Point> points = some_points(50);
  PlyWriter writer(folder / "map.ply");
  EXPECT_TRUE(read_ply(folder / "map.ply").sweep.points.empty());
  writer.write(std::span(points).first(20));
  writer.flush();
  EXPECT_EQ(read_ply(folder / "map.ply").sweep.points.size(), 20U);
  writer.write(std::span(points).subspan(20));
  writer.flush();
  expect_same_points(read_ply(folder / "map.ply").sweep.points, points);
}

TEST(PlyWriter, HeaderIsTheOneOtherProgramsExpect) {
  const test::TemporaryFolder folder;
  PlyWriter writer(folder / "map.ply");
  writer.write(some_points(3));
  writer.close();
  const std::string text = read_text_file(folder / "map.ply");
  EXPECT_EQ(text.substr(0, text.find("end_header")),
            "ply\nformat binary_little_endian 1.0\nelement vertex                    3\n"
            "property float x\nproperty float y\nproperty float z\nproperty float intensity\n");
}

TEST(PlyWriter, FullDiskIsAnErrorThatNamesTheFile) {
  if (!std::filesystem::exists("/dev/full")) {
    GTEST_SKIP() << "needs /dev/full";
  }
  EXPECT_NE(output_error([] { PlyWriter writer("/dev/full"); }).find("/dev/full"),
            std::string::npos);
}

}  // namespace
}  // namespace adit
