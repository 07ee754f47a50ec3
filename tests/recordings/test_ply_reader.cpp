// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/ply_reader.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/shared_data.hpp"

namespace adit {
namespace {

using test::bytes_of;
using test::bytes_of_all;

std::string header(const std::string& format, const std::string& elements) {
  return "ply\nformat " + format + " 1.0\ncomment made by hand\n" + elements + "end_header\n";
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

InputError ply_error(const std::string& content) {
  try {
    parse_ply("bad.ply", content);
  } catch (const InputError& error) {
    return error;
  }
  ADD_FAILURE() << "accepted: " << content.substr(0, 300);
  return InputError("", {}, "", "");
}

void expect_point(const CloudFile& cloud, std::size_t i, float x, float y, float z) {
  ASSERT_LT(i, cloud.sweep.points.size());
  EXPECT_EQ(cloud.sweep.points[i].x, x);
  EXPECT_EQ(cloud.sweep.points[i].y, y);
  EXPECT_EQ(cloud.sweep.points[i].z, z);
}

TEST(PlyReader, LittleEndian) {
  const CloudFile cloud =
      parse_ply("a", header("binary_little_endian", "element vertex 2\n" + kXyz) +
                         bytes_of_all(1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F));
  expect_point(cloud, 1, 4.0F, 5.0F, 6.0F);
}

TEST(PlyReader, BigEndianOfMixedTypes) {
  const std::string text =
      header("binary_big_endian",
             "element vertex 1\nproperty short x\nproperty double y\nproperty uchar flag\n"
             "property int z\nproperty ushort ring\n");
  const std::string bytes = text + bytes_of(int16_t{-300}, true) + bytes_of(2.5, true) +
                            bytes_of(uint8_t{9}) + bytes_of(int32_t{70000}, true) +
                            bytes_of(uint16_t{513}, true);
  EXPECT_THROW(parse_ply("a", bytes), InputError) << "integers tell no unit";
  const CloudFile cloud =
      parse_ply("a", bytes, {.coordinate_scale = 1.0, .offset = Eigen::Vector3d::Zero()});
  expect_point(cloud, 0, -300.0F, 2.5F, 70000.0F);
  EXPECT_EQ(cloud.sweep.rings, std::vector<uint16_t>{513});
}

TEST(PlyReader, Ascii) {
  const CloudFile cloud =
      parse_ply("a", header("ascii", "element vertex 2\n" + kXyz + "property float time\n") +
                         "1 2 3 0.05\r\n\n4 5 6 0.1");
  expect_point(cloud, 1, 4.0F, 5.0F, 6.0F);
  EXPECT_NEAR(cloud.sweep.times.at(1), 0.05F, 1e-8F);
}

TEST(PlyReader, FacesAfterTheVerticesDoNotMatter) {
  const std::string elements =
      "element vertex 1\n" + kXyz + "element face 1\nproperty list uchar int vertex_indices\n";
  expect_point(parse_ply("a", header("ascii", elements) + "1 2 3\n3 0 0 0\n"), 0, 1.0F, 2.0F, 3.0F);
}

TEST(PlyReader, ElementsBeforeTheVerticesAreSkipped) {
  const std::string elements =
      "element camera 2\nproperty list uchar short params\nproperty double f\nelement grid "
      "1\nproperty int a\n"
      "element vertex 1\n" +
      kXyz;
  const std::string camera =
      bytes_of(uint8_t{2}) + bytes_of_all(int16_t{1}, int16_t{2}) + bytes_of(0.5);
  const std::string empty = bytes_of(uint8_t{0}) + bytes_of(0.5);
  expect_point(parse_ply("a", header("binary_little_endian", elements) + camera + empty +
                                  bytes_of(int32_t{1}) + bytes_of_all(1.0F, 2.0F, 3.0F)),
               0, 1.0F, 2.0F, 3.0F);
  expect_point(parse_ply("a", header("ascii", elements) + "2 1 2 0.5\n0 0.5\n1\n1 2 3\n"), 0, 1.0F,
               2.0F, 3.0F);
}

TEST(PlyReader, ListsInsideVerticesAreSkipped) {
  const std::string elements =
      "element vertex 2\nproperty float x\nproperty list int float tags\nproperty float "
      "y\nproperty float z\n";
  const std::string first =
      bytes_of(1.0F) + bytes_of(int32_t{2}) + bytes_of_all(8.0F, 9.0F, 2.0F, 3.0F);
  const std::string second = bytes_of(4.0F) + bytes_of(int32_t{0}) + bytes_of_all(5.0F, 6.0F);
  const CloudFile binary =
      parse_ply("a", header("binary_little_endian", elements) + first + second);
  const CloudFile ascii = parse_ply("a", header("ascii", elements) + "1 2 8 9 2 3\n4 0 5 6\n");
  for (const CloudFile& cloud : {binary, ascii}) {
    expect_point(cloud, 0, 1.0F, 2.0F, 3.0F);
    expect_point(cloud, 1, 4.0F, 5.0F, 6.0F);
  }
}

TEST(PlyReader, VerticesThatAreThereAreReadWhateverTheHeaderPromises) {
  const auto expect_one_fault = [](const std::string& content, std::size_t there) {
    const CloudFile cloud = parse_ply("a", content);
    ASSERT_EQ(cloud.sweep.points.size(), there) << content;
    EXPECT_EQ(cloud.sweep.points.back().x, 1.0F + 3.0F * static_cast<float>(there - 1));
    ASSERT_EQ(cloud.faults.size(), 1U);
    EXPECT_NE(cloud.faults[0].found().find("the file holds " + std::to_string(there)),
              std::string::npos);
  };
  const std::string two = bytes_of_all(1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F);
  const std::string lists = kXyz + "property list uchar uchar a\n";
  const std::string faces = "element face 1\nproperty list uchar int i\n";
  for (const char* promised : {"1", "3"}) {
    const std::string vertices = "element vertex " + std::string(promised) + "\n";
    expect_one_fault(header("binary_little_endian", vertices + kXyz) + two, 2);
    expect_one_fault(header("ascii", vertices + kXyz) + "1 2 3\n4 5 6\n", 2);
  }
  expect_one_fault(header("binary_little_endian", "element vertex 3\n" + kXyz) + two + "cut", 2);
  expect_one_fault(header("binary_little_endian", "element vertex 3\n" + lists) +
                       two.substr(0, 12) + '\1' + '\7' + two.substr(12) + '\0' + "cut",
                   2);
  // What follows the vertices is not theirs.
  EXPECT_TRUE(
      parse_ply("a", header("ascii", "element vertex 1\n" + kXyz + faces) + "1 2 3\n3 0 0 0\n")
          .faults.empty());
  EXPECT_NE(ply_error(header("binary_little_endian", "element vertex 3\n" + kXyz) + "short")
                .found()
                .find("promises 3 records of 12 bytes or more; 5 bytes are left"),
            std::string::npos);
}

TEST(PlyReader, TypesOfOtherProgramsAreRead) {
  const std::string elements =
      "element vertex 1\nproperty bool valid\nproperty Float32 x\nproperty uint8_t a\nproperty "
      "float32 y\nproperty int8 b\nproperty FLOAT z\n";
  expect_point(parse_ply("a", header("binary_little_endian", elements) + '\1' +
                                  bytes_of_all(1.0F, uint8_t{7}, 2.0F, int8_t{-1}, 3.0F)),
               0, 1.0F, 2.0F, 3.0F);
  expect_point(parse_ply("a", header("ascii", elements) + "true 1 7 2 -1 3\n"), 0, 1.0F, 2.0F,
               3.0F);
}

TEST(PlyReader, AbsurdCountsTakeNoMemoryAndNoTime) {
  for (const char* format : {"ascii", "binary_little_endian"}) {
    const std::string many = header(format, "element vertex 18446744073709551615\n" + kXyz);
    EXPECT_EQ(parse_ply("a", many + "1 2 3\n4 5 6\n").sweep.points.size(),
              format == std::string("ascii") ? 2U : 1U);
    ply_error(many);
    ply_error(header(format, "element x 18446744073709551615\nelement vertex 1\n" + kXyz) +
              "1 2 3\n");
    ply_error(
        header(format, "element x 4000000000000\nproperty uchar a\nelement vertex 1\n" + kXyz) +
        "1 2 3\n");
  }
  ply_error(header("ascii", "element vertex 99999999999999999999\n" + kXyz));
}

TEST(PlyReader, ListLengthBeyondTheFileIsAnErrorWithTheByte) {
  const std::string text =
      header("binary_little_endian",
             "element tags 1\nproperty list int double a\nelement vertex 1\n" + kXyz);
  EXPECT_EQ(ply_error(text + bytes_of(int32_t{1000}) + bytes_of_all(1.0F, 2.0F, 3.0F)).place(),
            "byte " + std::to_string(text.size() + 4));
  EXPECT_EQ(ply_error(text + bytes_of(int32_t{-1}) + bytes_of_all(1.0F, 2.0F, 3.0F)).place(),
            "byte " + std::to_string(text.size() + 4));
}

TEST(PlyReader, AsciiErrorsNameTheLine) {
  const std::string text = header("ascii", "element vertex 2\n" + kXyz);
  EXPECT_EQ(ply_error(text + "100 200\n").place(), "line 9");
  EXPECT_EQ(ply_error(text + "1 2 3 4\n").place(), "line 9");
  EXPECT_EQ(ply_error(text + "1 2 three\n").place(), "line 9");
  for (const char* line : {"100 200\n", "1 2 3 4\n", "1 2 three\n"}) {
    const CloudFile cloud = parse_ply("a", text + "1 2 3\n" + line);
    expect_point(cloud, 0, 1.0F, 2.0F, 3.0F);
    ASSERT_EQ(cloud.faults.size(), 1U) << line;
    EXPECT_EQ(cloud.faults[0].place(), "line 10");
  }
}

TEST(PlyReader, HeaderErrorsNameTheLine) {
  EXPECT_EQ(ply_error("").place(), "line 1");
  EXPECT_EQ(ply_error("plyx\n").place(), "line 1");
  EXPECT_EQ(ply_error("ply\nformat binary 1.0\nend_header\n").place(), "line 2");
  EXPECT_EQ(ply_error("ply\nformat ascii 2.0\nend_header\n").place(), "line 2");
  EXPECT_EQ(ply_error("ply\nend_header\n").place(), "line 2");
  EXPECT_EQ(ply_error("ply\nformat ascii 1.0\nproperty float x\n").place(), "line 3");
  EXPECT_EQ(ply_error("ply\nformat ascii 1.0\nelement vertex two\n").place(), "line 3");
  EXPECT_EQ(ply_error("ply\nformat ascii 1.0\nelement vertex 2\nproperty half x\n").place(),
            "line 4");
  EXPECT_EQ(
      ply_error("ply\nformat ascii 1.0\nelement vertex 2\nproperty list float int x\n").place(),
      "line 4");
  EXPECT_EQ(ply_error("ply\nformat ascii 1.0\nelement vertex 2\n").found(),
            "the header has no 'end_header' line");
  EXPECT_NE(
      ply_error(header("ascii", "element point 1\n" + kXyz) + "1 2 3\n").found().find("vertex"),
      std::string::npos);
  EXPECT_NE(ply_error(header("ascii", "element vertex 1\nproperty float x\n") + "1\n")
                .found()
                .find("x, y or z"),
            std::string::npos);
}

/// Points that are not (0, 0, 0), which stands for no return in these scans.
std::size_t count_returns(const CloudFile& cloud) {
  std::size_t returns = 0;
  for (const Point& p : cloud.sweep.points) {
    returns += p.x != 0.0F || p.y != 0.0F || p.z != 0.0F ? 1 : 0;
  }
  return returns;
}

TEST(PlyReader, RealScansHaveTheReturnsOfTheirDescription) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "registration_pair");
  const CloudFile source = read_ply(folder / "source.ply");
  EXPECT_EQ(source.sweep.points.size(), 69792U);
  EXPECT_EQ(count_returns(source), 64685U);
  EXPECT_EQ(count_returns(read_ply(folder / "target.ply")), 64056U);
}

TEST(ParsePly, IntegersWrittenAsTextNeedAScaleToo) {
  const std::string text =
      header("ascii", "element vertex 1\nproperty short x\nproperty short y\nproperty short z\n") +
      "1500 -20 3\n";
  EXPECT_NE(ply_error(text).found().find("integers of 16 bits"), std::string::npos);
  expect_point(parse_ply("a", text, {.coordinate_scale = 0.01}), 0, 15.0F, -0.2F, 0.03F);
}

}  // namespace
}  // namespace adit
