// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The colours of drawings can be read on white and on black, with any kind of colour vision.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "adit/tools/drawing/svg.hpp"

namespace adit {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// "#rrggbb" as linear light, 0 to 1.
Vector3d light_of(std::string_view color) {
  Vector3d light;
  for (int k = 0; k < 3; ++k) {
    const double part =
        std::stoi(std::string(color.substr(static_cast<std::size_t>(1 + 2 * k), 2)), nullptr, 16) /
        255.0;
    light[k] = part <= 0.04045 ? part / 12.92 : std::pow((part + 0.055) / 1.055, 2.4);
  }
  return light;
}

/// What a colour becomes on dark pages, by the style sheet of every drawing.
std::string dark_of(std::string_view color) {
  const std::string style = SvgDocument(1.0, 1.0).str();
  const std::string selector = "[fill=\"" + std::string(color) + "\"] { fill: ";
  const std::size_t at = style.find(selector);
  return at == style.npos ? std::string(color) : style.substr(at + selector.size(), 7);
}

/// WCAG 2's contrast ratio.
double contrast(std::string_view a, std::string_view b) {
  const Vector3d weights(0.2126, 0.7152, 0.0722);
  const auto [darker, lighter] =
      std::minmax({weights.dot(light_of(a)) + 0.05, weights.dot(light_of(b)) + 0.05});
  return lighter / darker;
}

/// How light looks without one kind of cone: matrices of Machado, Oliveira and Fernandes (2009),
/// "A physiologically-based model for simulation of color vision deficiency", severity 1.
std::array<Matrix3d, 4> visions() {
  std::array<Matrix3d, 4> all;
  all[0].setIdentity();
  all[1] << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116,
      1.051998;  // no red cones
  all[2] << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940,
      0.968881;  // no green cones
  all[3] << 1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367,
      0.303900;  // no blue cones
  return all;
}

/// CIE L*a*b* under daylight (D65).
Vector3d lab(const Vector3d& light) {
  Matrix3d to_xyz;
  to_xyz << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505;
  const Vector3d xyz = (to_xyz * light).cwiseQuotient(Vector3d(0.95047, 1.0, 1.08883));
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
  return {116.0 * f(xyz.y()) - 16.0, 500.0 * (f(xyz.x()) - f(xyz.y())),
          200.0 * (f(xyz.y()) - f(xyz.z()))};
}

/// The least distance (CIE 1976; 2.3 is just noticeable) of two of the colours in any vision.
double least_distance(const std::vector<std::string>& colors) {
  double least = 1e9;
  for (const Matrix3d& vision : visions()) {
    const auto seen = [&](const std::string& color) {
      return lab((vision * light_of(color)).cwiseMax(0.0).cwiseMin(1.0));
    };
    for (std::size_t i = 0; i < colors.size(); ++i) {
      for (std::size_t j = i + 1; j < colors.size(); ++j) {
        least = std::min(least, (seen(colors[i]) - seen(colors[j])).norm());
      }
    }
  }
  return least;
}

std::vector<std::string> dark_ones(const std::vector<std::string>& colors) {
  std::vector<std::string> dark;
  for (const std::string& color : colors) {
    dark.push_back(dark_of(color));
  }
  return dark;
}

TEST(Palette, TextAndLinesStandOutOnWhiteAndOnBlack) {
  const std::string dark_ground = dark_of("#ffffff");
  EXPECT_NE(dark_ground, "#ffffff");
  for (const std::string_view color : {kTextColor, kAxisColor}) {
    EXPECT_GE(contrast(color, "#ffffff"), 4.5) << color;
    EXPECT_GE(contrast(dark_of(color), dark_ground), 4.5) << color;
  }
  std::vector<std::string_view> lines(kSeriesColors.begin(), kSeriesColors.end());
  lines.insert(lines.end(), {kGateColor, kGoodColor, kBadColor, kUnknownColor});
  for (const std::string_view color : lines) {
    EXPECT_GE(contrast(color, "#ffffff"), 3.0) << color;
    EXPECT_GE(contrast(dark_of(color), dark_ground), 3.0) << color;
  }
}

TEST(Palette, ColoursDifferForEveryKindOfColourVision) {
  const std::vector<std::string> axes(kAxisColors.begin(), kAxisColors.end());
  const std::vector<std::string> series(kSeriesColors.begin(), kSeriesColors.end());
  const std::vector<std::string> states = {std::string(kGoodColor), std::string(kMiddlingColor),
                                           std::string(kBadColor), std::string(kUnknownColor)};
  for (const std::vector<std::string>& group : {axes, series, states}) {
    EXPECT_GT(least_distance(group), 10.0) << group.front();
    EXPECT_GT(least_distance(dark_ones(group)), 10.0) << group.front();
  }
}

}  // namespace
}  // namespace adit
