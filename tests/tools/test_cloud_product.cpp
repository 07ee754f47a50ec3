// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Clouds with colours in all formats, as bytes and as adit reads them back.
#include "adit/tools/map_products/cloud_product.hpp"

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/clouds/las_reader.hpp"
#include "adit/tools/clouds/pcd_reader.hpp"
#include "adit/tools/clouds/ply_reader.hpp"

namespace adit {
namespace {

/// What a file is of.
struct Variant {
  bool measured = false;
  bool classified = false;
};
constexpr std::array<Variant, 4> kVariants = {{{}, {true, false}, {false, true}, {true, true}}};

std::vector<CloudPoint> some_points() {
  std::vector<CloudPoint> points;
  for (int i = 0; i < 300; ++i) {
    points.push_back({.position = {100.0 + 0.5 * i, 7.0 - 0.25 * i, 0.125 * i},
                      .time = std::chrono::milliseconds(i),
                      .intensity = static_cast<float>(i),
                      .ring = static_cast<uint16_t>(i % 16),
                      .keyframe = 3,
                      .moving = i % 5 == 0,
                      .color = {static_cast<uint8_t>(i), static_cast<uint8_t>(255 - i % 256),
                                static_cast<uint8_t>(i / 2)}});
  }
  return points;
}

class ColoredProducts : public testing::Test {
 protected:
  std::string written(CloudFormat format, const Variant& variant, bool colored) {
    file_ = folder_ / ("cloud" + extension_of(format));
    const auto product = make_cloud_product(
        file_, format,
        {.measured = variant.measured, .classified = variant.classified, .colored = colored});
    const std::span<const CloudPoint> all(points_);
    product->write(all.first(100));
    product->write(all.subspan(100));
    product->close();
    EXPECT_EQ(product->count(), points_.size());
    return test::content(file_);
  }
  /// The bytes of one point, behind the header.
  std::string point_of(const std::string& bytes, const std::string& end_of_header, std::size_t i) {
    const std::size_t begin = bytes.find(end_of_header) + end_of_header.size();
    EXPECT_EQ((bytes.size() - begin) % points_.size(), 0U);
    const std::size_t size = (bytes.size() - begin) / points_.size();
    return bytes.substr(begin + i * size, size);
  }
  void expect_the_points(const CloudFile& cloud, const Variant& variant) {
    EXPECT_TRUE(cloud.faults.empty());
    ASSERT_EQ(cloud.sweep.points.size(), points_.size());
    ASSERT_EQ(cloud.sweep.rings.size(), variant.measured ? points_.size() : 0U);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Point& point = cloud.sweep.points[i];
      const Eigen::Vector3f expected = points_[i].position.cast<float>();
      ASSERT_EQ(Eigen::Vector3f(point.x, point.y, point.z), expected);
      ASSERT_EQ(point.intensity, points_[i].intensity);
      if (variant.measured) {
        ASSERT_EQ(cloud.sweep.rings[i], points_[i].ring);
      }
    }
  }

  void expect_the_colors(const CloudFile& cloud) {
    ASSERT_EQ(cloud.colors.size(), points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      ASSERT_EQ(cloud.colors[i], points_[i].color) << i;
    }
  }

  test::TemporaryFolder folder_;
  std::vector<CloudPoint> points_ = some_points();
  std::filesystem::path file_;
};

TEST_F(ColoredProducts, PlyHasThemAsThreeBytes) {
  for (const Variant& variant : kVariants) {
    const std::string plain = written(CloudFormat::ply, variant, false);
    EXPECT_EQ(plain.find("red"), std::string::npos);
    const std::string colored = written(CloudFormat::ply, variant, true);
    const std::string before = variant.measured ? "property ushort ring\n" : "float intensity\n";
    const std::string after = variant.classified ? "property uchar classification\n" : "";
    EXPECT_NE(colored.find(before + "property uchar red\nproperty uchar green\n" +
                           "property uchar blue\n" + after + "end_header\n"),
              std::string::npos)
        << colored.substr(0, 400);
    const std::size_t color_at = variant.measured ? 26 : 16;
    for (const std::size_t i : {std::size_t{0}, std::size_t{299}}) {
      std::string point = point_of(colored, "end_header\n", i);
      EXPECT_EQ(std::memcmp(point.data() + color_at, points_[i].color.data(), 3), 0);
      point.erase(color_at, 3);
      EXPECT_EQ(point, point_of(plain, "end_header\n", i));
    }
    expect_the_points(read_ply(file_), variant);
  }
}

TEST_F(ColoredProducts, PcdHasThemAsOneFieldAsPclDoes) {
  for (const Variant& variant : kVariants) {
    const std::string plain = written(CloudFormat::pcd, variant, false);
    EXPECT_EQ(plain.find("rgb"), std::string::npos);
    const std::string colored = written(CloudFormat::pcd, variant, true);
    const auto line = [&](const char* all, const char* time, const char* color, const char* last) {
      const std::string text = std::string("\n") + all + (variant.measured ? time : "") + color +
                               (variant.classified ? last : "") + "\n";
      EXPECT_NE(colored.find(text), std::string::npos) << text << colored.substr(0, 400);
    };
    line("FIELDS x y z intensity", " time ring", " rgb", " classification");
    line("SIZE 4 4 4 4", " 8 2", " 4", " 1");
    line("TYPE F F F F", " F U", " F", " U");
    line("COUNT 1 1 1 1", " 1 1", " 1", " 1");
    const std::size_t color_at = variant.measured ? 26 : 16;
    for (const std::size_t i : {std::size_t{0}, std::size_t{299}}) {
      std::string point = point_of(colored, "DATA binary\n", i);
      const std::array<uint8_t, 3>& color = points_[i].color;
      const std::array<uint8_t, 4> packed = {color[2], color[1], color[0], 0};  // little-endian
      EXPECT_EQ(std::memcmp(point.data() + color_at, packed.data(), 4), 0);
      point.erase(color_at, 4);
      EXPECT_EQ(point, point_of(plain, "DATA binary\n", i));
    }
    expect_the_points(read_pcd(file_), variant);
  }
}

TEST_F(ColoredProducts, AreReadBackWithTheirColorsWhereTheseAreWanted) {
  for (const Variant& variant : kVariants) {
    written(CloudFormat::ply, variant, true);
    expect_the_colors(read_ply(file_, {.colors = true}));
    EXPECT_TRUE(read_ply(file_).colors.empty());
    written(CloudFormat::pcd, variant, true);
    expect_the_colors(read_pcd(file_, {.colors = true}));
    EXPECT_TRUE(read_pcd(file_).colors.empty());
  }
  for (const CloudFormat format : {CloudFormat::las, CloudFormat::laz}) {
    written(format, {}, true);
    expect_the_colors(read_las(file_, {.colors = true}));
    EXPECT_TRUE(read_las(file_).colors.empty());
    written(format, {}, false);
    EXPECT_TRUE(read_las(file_, {.colors = true}).colors.empty());
  }
}

TEST_F(ColoredProducts, OfOtherProgramsAreReadAsTheyHaveThem) {
  using Colors = std::vector<std::array<uint8_t, 3>>;
  const auto ply = [](const char* type, const char* points) {
    return parse_ply("a.ply",
                     std::string("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
                                 "property float y\nproperty float z\nproperty ") +
                         type + " red\nproperty " + type + " green\nproperty " + type +
                         " blue\nend_header\n" + points,
                     {.colors = true})
        .colors;
  };
  const Colors expected = {{255, 0, 51}, {1, 2, 3}};
  EXPECT_EQ(ply("uchar", "1 1 1 255 0 51\n2 2 2 1 2 3\n"), expected);
  EXPECT_EQ(ply("ushort", "1 1 1 65535 0 13107\n2 2 2 257 514 771\n"), expected);
  EXPECT_EQ(ply("float", "1 1 1 1 0 0.2\n2 2 2 0.004 0.008 0.012\n"), expected);
  EXPECT_EQ(ply("float", "1 1 1 255 0 51\n2 2 2 1 2 3\n"), expected);
  EXPECT_EQ(ply("float", "1 1 1 nan 0 1\n2 2 2 1 1 1\n"), (Colors{{0, 0, 255}, {255, 255, 255}}));
  EXPECT_TRUE(ply("uchar", "1 1 1 0 0 0\n2 2 2 0 0 0\n").empty());
  const auto pcd = [](const char* kind, const char* points) {
    return parse_pcd("a.pcd",
                     std::string("VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F ") +
                         kind + "\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n" +
                         points,
                     {.colors = true})
        .colors;
  };
  EXPECT_EQ(pcd("U", "1 1 1 16711731\n2 2 2 66051\n"), expected);
  EXPECT_EQ(pcd("F", "1 1 1 16711731\n2 2 2 66051\n"), expected);
  EXPECT_EQ(pcd("F", "1 1 1 2.341812298650944e-38\n2 2 2 9.25571648671185e-41\n"), expected);
}

TEST_F(ColoredProducts, TheLasFamilyHasThemIn16Bits) {
  for (const CloudFormat format : {CloudFormat::las, CloudFormat::laz, CloudFormat::copc}) {
    const std::string plain = written(format, {}, false);
    EXPECT_EQ(plain[104] & 0x3f, 6);
    const std::string colored = written(format, {}, true);
    EXPECT_EQ(colored[104] & 0x3f, 7);
    uint32_t begin = 0;
    std::memcpy(&begin, colored.data() + 96, sizeof(begin));
    // The first point: of packed files it is as it is. Their octree begins anywhere.
    if (format != CloudFormat::copc) {
      const std::size_t at = begin + (format == CloudFormat::laz ? 8 : 0) + 30;
      std::array<uint16_t, 3> color{};
      std::memcpy(color.data(), colored.data() + at, sizeof(color));
      EXPECT_EQ(color, (std::array<uint16_t, 3>{0, 65535, 0}));
    }
    EXPECT_EQ(read_las(file_).sweep.points.size(), points_.size());
  }
}

}  // namespace
}  // namespace adit
