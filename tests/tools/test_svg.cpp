// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/svg.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tools/drawing/markup.hpp"
#include "adit/tools/evaluation/evaluation_plot.hpp"

namespace adit {
namespace {

TEST(Svg, TextIsEscaped) {
  SvgDocument svg(10, 10);
  svg.text({1, 2}, "a<b & \"c\">\x01", {});
  EXPECT_NE(svg.str().find(">a&lt;b &amp; &quot;c&quot;&gt; </text>"), std::string::npos)
      << svg.str();
}

TEST(Markup, WhatIsNoUtf8IsReplaced) {
  EXPECT_EQ(escape_markup("caf\xc3\xa9"), "caf\xc3\xa9");
  EXPECT_EQ(escape_markup("caf\xe9 <\xff"), "caf\xef\xbf\xbd &lt;\xef\xbf\xbd");
}

TEST(Svg, PolylinesLeaveOutWhatNoOneSees) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= 100000; ++i) {
    points.emplace_back(1e-3 * i, 5.0);
  }
  SvgDocument svg(100, 10);
  svg.polyline(points, {});
  const std::string text = svg.str();
  EXPECT_LT(std::count(text.begin(), text.end(), ','), 310);
  EXPECT_NE(text.find("100.00,5.00"), std::string::npos);  // the end stays
}

TEST(Svg, TicksAreRoundAndInside) {
  EXPECT_EQ(round_ticks(0.0, 10.0, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(round_ticks(-7.0, 12.0, 4), (std::vector<double>{-5, 0, 5, 10}));
  EXPECT_EQ(round_ticks(3.0, 3.0, 5), std::vector<double>{3.0});
  EXPECT_EQ(round_ticks(0.0, 0.00032, 3).size(), 4U);
}

TEST(Svg, TickLabelsHaveTheDecimalsTheyNeed) {
  EXPECT_EQ(tick_label(50.0, 10.0), "50");
  EXPECT_EQ(tick_label(0.30000000000000004, 0.1), "0.3");
  EXPECT_EQ(tick_label(-0.0, 0.05), "0.00");
  EXPECT_EQ(tick_label(1.30345, 1e-3), "1.303");
  EXPECT_EQ(tick_label(-1.5, 0.1), "-1.5");
}

TEST(Svg, ZeroHasNoSign) {
  EXPECT_EQ(tick_label(-0.0, -0.0), "0.000");
  EXPECT_EQ(tick_label(-0.04, 0.1), "0.0");
  EXPECT_EQ(tick_label(-0.06, 0.1), "-0.1");
  EXPECT_EQ(tick_label(-0.4, 1.0), "0");
}

TEST(Svg, LengthsAreTheLongestRoundOnes) {
  EXPECT_DOUBLE_EQ(round_length(19.99), 10.0);
  EXPECT_DOUBLE_EQ(round_length(20.0), 20.0);
  EXPECT_DOUBLE_EQ(round_length(0.0099), 0.005);
  EXPECT_DOUBLE_EQ(round_length(1000.0), 1000.0);
  EXPECT_DOUBLE_EQ(round_length(0.001), 0.001);
  EXPECT_EQ(round_length(0.0), 0.0);
  EXPECT_EQ(round_length(-3.0), 0.0);
}

/// An evaluation of `poses` against themselves.
Evaluation perfect(const std::vector<Eigen::Vector3d>& positions) {
  Trajectory trajectory;
  for (const Eigen::Vector3d& position : positions) {
    StampedPose pose;
    pose.pose.translation() = position;
    trajectory.poses.push_back(pose);
  }
  EvaluationOptions options;
  options.alignment = Alignment::none;
  return evaluate(trajectory, trajectory, options);
}

TEST(EvaluationPlot, LooksAlongTheShortestAxis) {
  EXPECT_NE(plot_evaluation(perfect({{0, 0, 0}, {50, 1, 90}}), "t").find(">z (m)<"),
            std::string::npos);
  EXPECT_EQ(plot_evaluation(perfect({{0, 0, 0}, {50, 90, 1}}), "t").find(">z (m)<"),
            std::string::npos);
  EXPECT_EQ(plot_evaluation(perfect({{0, 0, 0}, {1, 90, 50}}), "t").find(">x (m)<"),
            std::string::npos);
}

TEST(EvaluationPlot, TicksOfErrorsAreShortEnoughToLeaveRoomForTheirName) {
  for (const auto& [error, unit] :
       {std::pair{3e-5, "mm"}, {1.2e-3, "mm"}, {0.034, "cm"}, {0.9, "cm"}, {2500.0, "m"}}) {
    Trajectory truth;
    Trajectory estimate;
    for (int i = 0; i < 3; ++i) {
      StampedPose pose;
      pose.pose.translation() << 1.0 * i, 0.3 * i, 0.0;
      truth.poses.push_back(pose);
      pose.pose.translation().y() += 0.5 * error * i;
      estimate.poses.push_back(pose);
    }
    EvaluationOptions options;
    options.alignment = Alignment::none;
    const std::string svg = plot_evaluation(evaluate(estimate, truth, options), "t");
    EXPECT_NE(svg.find("position error (" + std::string(unit) + ")"), std::string::npos) << error;
    // The ticks of the axis that the name stands beside; the first of the panel is that of zero.
    const std::string panel = svg.substr(svg.find("distance along the truth") - 3000, 3000);
    const std::string end = "text-anchor=\"end\"";
    for (std::size_t at = panel.find(end); at != panel.npos; at = panel.find(end, at + 1)) {
      const std::size_t begin = panel.find('>', at) + 1;
      EXPECT_LE(panel.find('<', begin) - begin, 5U) << panel.substr(begin, 12);
    }
  }
}

TEST(EvaluationPlot, DegeneratePathsGiveFiniteNumbers) {
  for (const std::vector<Eigen::Vector3d>& positions :
       {std::vector<Eigen::Vector3d>{{1, 2, 3}},
        std::vector<Eigen::Vector3d>(5, Eigen::Vector3d(1, 2, 3)),
        std::vector<Eigen::Vector3d>{{0, 0, 0}, {1000, 0, 0}},
        std::vector<Eigen::Vector3d>{{1e12, 0, 0}, {1e12, 1e-6, 0}}}) {
    const std::string svg = plot_evaluation(perfect(positions), "t");
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf\""), std::string::npos);
    EXPECT_LT(svg.size(), 100000U);
  }
}

/// The text of the scale bar: the only one that is a number and its unit.
std::string scale_label(const std::string& svg) {
  const std::string tail = " m</text>";
  for (std::size_t end = svg.find(tail); end != std::string::npos; end = svg.find(tail, end + 1)) {
    const std::size_t begin = svg.rfind('>', end) + 1;
    std::string label = svg.substr(begin, end - begin);
    if (label.find_first_not_of("-.0123456789") == std::string::npos) {
      return label;
    }
  }
  return "none";
}

TEST(EvaluationPlot, TheScaleBarHasALengthWhateverTheExtent) {
  for (int step = 0; step < 270; ++step) {
    const double extent = 1e-3 * std::pow(1.07, step);  // to 80 km
    const std::string label =
        scale_label(plot_evaluation(perfect({{0, 0, 0}, {extent, extent, 0}}), "t"));
    ASSERT_NE(label, "none");
    EXPECT_GT(std::stod(label), 0.0) << label << " at an extent of " << extent << " m";
  }
}

}  // namespace
}  // namespace adit
