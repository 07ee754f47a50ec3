// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/pcd_reader.hpp"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/point_files.hpp"
#include "adit/tools/clouds/pcd_lzf.hpp"

namespace adit {
namespace {

using test::bytes_of;
using test::bytes_of_all;

/// x y z intensity of points 0..n-1, row by row, and field by field.
std::string rows(std::size_t n) {
  std::string data;
  for (std::size_t i = 0; i < n; ++i) {
    const auto v = static_cast<float>(i);
    data += bytes_of_all(v, -v, 0.25F * v, 100.0F + v);
  }
  return data;
}
std::string columns(std::size_t n) {
  std::string data;
  for (int field = 0; field < 4; ++field) {
    for (std::size_t i = 0; i < n; ++i) {
      const auto v = static_cast<float>(i);
      const float values[] = {v, -v, 0.25F * v, 100.0F + v};
      data += bytes_of(values[field]);
    }
  }
  return data;
}

void expect_rows(const CloudFile& cloud, std::size_t n) {
  ASSERT_EQ(cloud.sweep.points.size(), n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto v = static_cast<float>(i);
    EXPECT_EQ(cloud.sweep.points[i].x, v);
    EXPECT_EQ(cloud.sweep.points[i].y, -v);
    EXPECT_EQ(cloud.sweep.points[i].z, 0.25F * v);
    EXPECT_EQ(cloud.sweep.points[i].intensity, 100.0F + v);
  }
}

InputError pcd_error(const std::string& content) {
  try {
    parse_pcd("bad.pcd", content);
  } catch (const InputError& error) {
    return error;
  }
  ADD_FAILURE() << "accepted: " << content.substr(0, 300);
  return InputError("", {}, "", "");
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

TEST(PcdReader, BinaryPoints) {
  expect_rows(parse_pcd("a.pcd", test::pcd_header(100, "binary") + rows(100)), 100);
}

TEST(PcdReader, CompressedPoints) {
  expect_rows(parse_pcd("a.pcd", test::pcd_header(100, "binary_compressed") +
                                     test::pcd_compressed_body(columns(100))),
              100);
}

TEST(PcdReader, AsciiPointsAndNan) {
  const CloudFile cloud =
      parse_pcd("a.pcd", test::pcd_header(2, "ascii") + "1 -2 0.5 7\r\n\nnan nan nan 0");
  ASSERT_EQ(cloud.sweep.points.size(), 2U);
  EXPECT_EQ(cloud.sweep.points[0].z, 0.5F);
  EXPECT_TRUE(std::isnan(cloud.sweep.points[1].x));
  EXPECT_EQ(cloud.sweep.source, "a.pcd");
}

TEST(PcdReader, HeaderWithWindowsLineEnds) {
  std::string text = test::pcd_header(3, "binary");
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) {
    text.replace(at, 1, "\r\n");
  }
  expect_rows(parse_pcd("a.pcd", text + rows(3)), 3);
}

TEST(PcdReader, FieldsOfAnOusterDriver) {
  const std::string header =
      "VERSION 0.7\nFIELDS x y z _ intensity t reflectivity ring _ ambient\nSIZE 4 4 4 1 4 4 2 1 1 "
      "2\n"
      "TYPE F F F U F U U U U U\nCOUNT 1 1 1 4 1 1 1 1 3 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA "
      "binary\n";
  const auto point = [](float x, uint32_t t, uint8_t ring) {
    return bytes_of_all(x, 2.0F, 3.0F, uint32_t{0}, 50.0F, t, uint16_t{9}, ring, uint8_t{0},
                        uint8_t{0}, uint8_t{0}, uint16_t{1});
  };
  const CloudFile cloud =
      parse_pcd("a.pcd", header + point(1.0F, 100000000, 5) + point(4.0F, 2000000, 127));
  ASSERT_EQ(cloud.sweep.points.size(), 2U);
  EXPECT_EQ(cloud.sweep.points[1].x, 4.0F);
  EXPECT_EQ(cloud.sweep.points[1].intensity, 50.0F);
  EXPECT_EQ(cloud.sweep.rings, (std::vector<uint16_t>{5, 127}));
  EXPECT_EQ(cloud.sweep.stamp, Nanoseconds(2000000));
  EXPECT_FALSE(cloud.absolute_stamp);
  EXPECT_NEAR(cloud.sweep.times.at(0), 0.098F, 1e-7F);
}

TEST(PcdReader, CompressedDataMayLeavePaddingOut) {
  const std::string header =
      "FIELDS x _ y z\nSIZE 4 1 4 4\nTYPE F U F F\nCOUNT 1 4 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS "
      "2\nDATA binary_compressed\n";
  const std::string packed = bytes_of_all(1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F);
  const std::string padded = bytes_of_all(1.0F, 2.0F, uint64_t{0}, 3.0F, 4.0F, 5.0F, 6.0F);
  for (const std::string& data : {packed, padded}) {
    const CloudFile cloud = parse_pcd("a.pcd", header + test::pcd_compressed_body(data));
    EXPECT_EQ(cloud.sweep.points.at(1).x, 2.0F);
    EXPECT_EQ(cloud.sweep.points.at(1).y, 4.0F);
    EXPECT_EQ(cloud.sweep.points.at(0).z, 5.0F);
  }
}

TEST(PcdReader, DoublePrecisionAndAbsoluteTimes) {
  const std::string header =
      "FIELDS x y z timestamp\nSIZE 8 8 8 8\nTYPE F F F F\nWIDTH 1\nHEIGHT 1\nDATA binary\n";
  const CloudFile cloud = parse_pcd("a.pcd", header + bytes_of_all(1.0, 2.0, 3.0, 1623370000.25));
  EXPECT_EQ(cloud.sweep.points.at(0).y, 2.0F);
  EXPECT_TRUE(cloud.absolute_stamp);
  EXPECT_EQ(cloud.sweep.stamp, Nanoseconds(1623370000250000000));
}

TEST(PcdReader, NoPointsAreAnEmptySweep) {
  EXPECT_TRUE(parse_pcd("a.pcd", test::pcd_header(0, "binary")).sweep.points.empty());
  EXPECT_TRUE(parse_pcd("a.pcd", test::pcd_header(0, "ascii")).sweep.points.empty());
}

/// Reads a cloud with one fault, and returns what was found.
std::string one_fault(const std::string& content, std::size_t points) {
  const CloudFile cloud = parse_pcd("a.pcd", content);
  expect_rows(cloud, points);
  EXPECT_EQ(cloud.faults.size(), 1U);
  return cloud.faults.empty() ? "" : cloud.faults.front().found();
}

TEST(PcdReader, PointsThatAreThereAreReadWhateverTheHeaderPromises) {
  EXPECT_EQ(one_fault(test::pcd_header(100, "binary") + rows(99), 99),
            "the header promises 100 points; the file holds 99, which are read");
  EXPECT_EQ(one_fault(test::pcd_header(98, "binary") + rows(99), 99),
            "the header promises 98 points; the file holds 99, which are read");
  const std::string cut = rows(100);
  EXPECT_EQ(one_fault(test::pcd_header(100, "binary") + cut.substr(0, cut.size() - 5), 99),
            "the header promises 100 points; the file holds 99, which are read");
  EXPECT_EQ(one_fault(test::pcd_header(98, "binary") + rows(99) + "tail", 98),
            "20 bytes follow the 98 points of the header; they are left out");
  EXPECT_EQ(one_fault(test::pcd_header(101, "binary_compressed") +
                          test::pcd_compressed_body(columns(100)),
                      100),
            "the header promises 101 points; the file holds 100, which are read");
  for (const std::size_t promised : {1U, 3U}) {
    const CloudFile cloud =
        parse_pcd("a.pcd", test::pcd_header(promised, "ascii") + "1 2 3 4\n5 6 7 8\n");
    EXPECT_EQ(cloud.sweep.points.size(), 2U);
    EXPECT_EQ(cloud.faults.size(), 1U);
  }
  EXPECT_NE(pcd_error(test::pcd_header(100, "binary") + "short").found().find("no whole point"),
            std::string::npos);
}

TEST(PcdReader, LinesThatCannotBeReadAreLeftOutAndCounted) {
  const CloudFile cloud =
      parse_pcd("a.pcd", test::pcd_header(4, "ascii") + "1 2 3 4\n1 2\n5 x 7 8\n5 6 7 8\n");
  ASSERT_EQ(cloud.sweep.points.size(), 2U);
  EXPECT_EQ(cloud.sweep.points[1].x, 5.0F);
  ASSERT_EQ(cloud.faults.size(), 1U);
  EXPECT_EQ(cloud.faults[0].place(), "line 13");
  EXPECT_NE(cloud.faults[0].found().find("2 numbers, expected 4; 2 lines in all"),
            std::string::npos)
      << cloud.faults[0].found();
}

TEST(PcdReader, DialectsAreRead) {
  const std::string header = test::pcd_header(3, "binary");
  expect_rows(parse_pcd("a.pcd", replaced(header, "TYPE F F F F", "type f f F f") + rows(3)), 3);
  expect_rows(parse_pcd("a.pcd", replaced(header, "VERSION 0.7\n", "") + rows(3)), 3);
  expect_rows(parse_pcd("a.pcd", replaced(header, "VERSION 0.7", "VERSION .7 # of PCL") + rows(3)),
              3);
  expect_rows(parse_pcd("a.pcd", replaced(header, "COUNT 1 1 1 1\n", "") + rows(3)), 3);
  expect_rows(parse_pcd("a.pcd", replaced(header, "DATA binary", "DATA BINARY") + rows(3)), 3);
  expect_rows(parse_pcd("a.pcd", replaced(header, "WIDTH 3\nHEIGHT 1\n", "") + rows(3)), 3);
}

TEST(PcdReader, FieldsOfCountZeroTakeNoRoom) {
  const std::string header =
      "VERSION 0.7\nFIELDS x _ y z ring intensity\nSIZE 4 1 4 4 2 4\nTYPE F U F F U F\n"
      "COUNT 1 0 1 1 0 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ";
  const CloudFile binary = parse_pcd("a.pcd", header + "binary\n" + rows(2));
  expect_rows(binary, 2);
  EXPECT_TRUE(binary.sweep.rings.empty());
  EXPECT_EQ(parse_pcd("a.pcd", header + "ascii\n1 2 3 4\n5 6 7 8\n").sweep.points[1].z, 7.0F);
  EXPECT_NE(pcd_error(replaced(header, "COUNT 1", "COUNT 0") + "binary\n" + rows(2))
                .found()
                .find("x, y or z"),
            std::string::npos);
}

TEST(PcdReader, AbsurdSizesTakeNoMemory) {
  const std::string header = test::pcd_header(2000000000, "binary");
  EXPECT_NE(one_fault(header + rows(2), 2).find("promises 2000000000 points"), std::string::npos);
  EXPECT_EQ(
      parse_pcd("a.pcd", test::pcd_header(2000000000, "ascii") + "1 2 3 4\n").sweep.points.size(),
      1U);
  // The packed data promise 32 GB with sizes that agree with the header.
  const std::string body = bytes_of_all(uint32_t{4}, uint32_t{16 * 200000000U}) + "abcd";
  EXPECT_NE(pcd_error(test::pcd_header(200000000, "binary_compressed") + body)
                .found()
                .find("cannot stand for"),
            std::string::npos);
  pcd_error(replaced(header, "WIDTH 2000000000", "WIDTH 99999999999999999999"));
  pcd_error(replaced(replaced(header, "COUNT 1 1 1 1", "COUNT 1 1 1 99999999"), "WIDTH 2000000000",
                     "WIDTH 1"));
}

TEST(PcdReader, WhereWidthTimesHeightIsNotPointsTheFileDecides) {
  const std::string header = replaced(test::pcd_header(6, "binary"), "HEIGHT 1", "HEIGHT 2");
  for (const std::size_t there : {6U, 12U}) {
    EXPECT_EQ(one_fault(header + rows(there), there),
              "the header promises 6 points, by WIDTH x HEIGHT 12; the file holds " +
                  std::to_string(there) + ", which are read");
  }
}

TEST(PcdReader, EntriesThatContradictTheFieldsNameTheLine) {
  const std::string header = test::pcd_header(1, "binary");
  EXPECT_EQ(pcd_error(replaced(header, "SIZE 4 4 4 4", "SIZE 4 4 4") + rows(1)).place(), "line 4");
  EXPECT_EQ(pcd_error(replaced(header, "TYPE F F F F", "TYPE F F F F F") + rows(1)).place(),
            "line 5");
  EXPECT_EQ(pcd_error(replaced(header, "COUNT 1 1 1 1", "COUNT 1 1") + rows(1)).place(), "line 6");
  EXPECT_EQ(pcd_error(replaced(header, "COUNT 1 1 1 1", "COUNT 1 1 1 -1") + rows(1)).place(),
            "line 6");
  EXPECT_EQ(pcd_error(replaced(header, "SIZE 4 4 4 4", "SIZE 4 4 4 3") + rows(1)).place(),
            "line 5");
  EXPECT_EQ(pcd_error(replaced(header, "TYPE F F F F", "TYPE F F F Q") + rows(1)).place(),
            "line 5");
  EXPECT_EQ(pcd_error(replaced(header, "DATA binary", "DATA zip") + rows(1)).place(), "line 11");
  EXPECT_EQ(pcd_error(replaced(header, "HEIGHT 1", "HEIGHT -1") + rows(1)).place(), "line 8");
  EXPECT_EQ(pcd_error(replaced(header, "HEIGHT 1", "HIGHT 1") + rows(1)).place(), "line 8");
  EXPECT_EQ(pcd_error(replaced(header, "HEIGHT 1", "WIDTH 1") + rows(1)).place(), "line 8");
}

TEST(PcdReader, MissingEntriesAreNamed) {
  const std::string header = test::pcd_header(1, "binary");
  EXPECT_NE(pcd_error(replaced(replaced(header, "WIDTH 1\n", ""), "POINTS 1\n", "") + rows(1))
                .found()
                .find("WIDTH"),
            std::string::npos);
  EXPECT_NE(pcd_error(replaced(header, "SIZE 4 4 4 4\n", "") + rows(1)).found().find("SIZE"),
            std::string::npos);
  EXPECT_NE(pcd_error("").found().find("DATA"), std::string::npos);
  EXPECT_NE(pcd_error(replaced(header, "FIELDS x y z", "FIELDS x y w") + rows(1))
                .found()
                .find("x, y or z"),
            std::string::npos);
  EXPECT_NE(
      pcd_error("FIELDS\nSIZE\nTYPE\nWIDTH 1\nHEIGHT 1\nDATA binary\n").found().find("x, y or z"),
      std::string::npos);
}

TEST(PcdReader, AsciiErrorsNameTheLine) {
  const std::string header = test::pcd_header(2, "ascii");
  EXPECT_EQ(pcd_error(header + "1 2 3\n").place(), "line 12");
  EXPECT_EQ(pcd_error(header + "1 2 x 4\n").place(), "line 12");
  EXPECT_EQ(pcd_error(header + "\n").place(), "POINTS");
}

TEST(PcdReader, DamagedCompressionNamesTheByte) {
  const std::string header = test::pcd_header(100, "binary_compressed");
  const std::string body = test::pcd_compressed_body(columns(100));
  EXPECT_NE(pcd_error(header + body.substr(0, body.size() / 2)).found().find("the file holds"),
            std::string::npos);
  std::string damaged = body;
  damaged[8] = static_cast<char>(0xff);  // a reference to before the start
  EXPECT_EQ(pcd_error(header + damaged).place(), "byte " + std::to_string(header.size() + 8));
  EXPECT_NE(pcd_error(header + body.substr(0, 7)).found().find("sizes"), std::string::npos);
}

TEST(Lzf, RandomAndRepetitiveDataSurviveTheRoundTrip) {
  std::mt19937 random(1);
  for (std::size_t size = 0; size < 3000; size += 1 + size / 7) {
    for (const unsigned letters : {1U, 2U, 8U, 256U}) {
      std::string data(size, '\0');
      for (char& c : data) {
        c = static_cast<char>(random() % letters);
      }
      const std::string packed = test::lzf_compress(data);
      std::string out(size, '?');
      EXPECT_FALSE(
          lzf_expand(std::as_bytes(std::span(packed)), std::as_writable_bytes(std::span(out))));
      EXPECT_EQ(out, data);
    }
  }
}

TEST(Lzf, LongestReferenceExpandsAsMuchAsIsClaimed) {
  std::string packed = {0, 'x'};
  packed += std::string({static_cast<char>(7U << 5U), static_cast<char>(255), 0});
  std::string out(1 + 3 * kLzfLargestExpansion, '?');
  EXPECT_FALSE(
      lzf_expand(std::as_bytes(std::span(packed)), std::as_writable_bytes(std::span(out))));
  EXPECT_EQ(out, std::string(265, 'x'));
}

TEST(Lzf, BrokenDataGiveTheOffset) {
  const auto expand = [](const std::string& packed, std::size_t size) {
    std::string out(size, '?');
    return lzf_expand(std::as_bytes(std::span(packed)), std::as_writable_bytes(std::span(out)));
  };
  EXPECT_EQ(expand({0, 'x', 0}, 2), 2U);          // a literal run without its byte
  EXPECT_EQ(expand({1, 'x', 'y'}, 1), 0U);        // longer than promised
  EXPECT_EQ(expand({0, 'x'}, 2), 2U);             // shorter than promised
  EXPECT_EQ(expand({0, 'x', 1 << 5, 1}, 4), 2U);  // refers to before the start
  EXPECT_EQ(expand({0, 'x', static_cast<char>(7U << 5U), 9}, 20), 2U);  // a reference breaks off
}

TEST(ParsePcd, IntegersWrittenAsTextNeedAScaleToo) {
  const std::string text =
      "VERSION 0.7\nFIELDS x y z\nSIZE 2 2 2\nTYPE I I I\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
      "POINTS 1\nDATA ascii\n1500 -20 3\n";
  EXPECT_NE(pcd_error(text).found().find("integers of 16 bits"), std::string::npos);
  const CloudFile scaled = parse_pcd("a.pcd", text, {.coordinate_scale = 0.001});
  EXPECT_FLOAT_EQ(scaled.sweep.points.at(0).x, 1.5F);
}

}  // namespace
}  // namespace adit
