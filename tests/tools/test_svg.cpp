// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/svg.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tools/evaluation_plot.hpp"

namespace adit {
namespace {

TEST(Svg, TextIsEscaped) {
  SvgDocument svg(10, 10);
  svg.text({1, 2}, "a<b & \"c\">\x01", {});
  EXPECT_NE(svg.str().find(">a&lt;b &amp; &quot;c&quot;&gt;?</text>"), std::string::npos)
      << svg.str();
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

}  // namespace
}  // namespace adit
