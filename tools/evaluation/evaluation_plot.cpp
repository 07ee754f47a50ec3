// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/evaluation_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "adit/tools/drawing/svg.hpp"

namespace adit {
namespace {

constexpr double kWidth = 960.0;        // px, of the drawing
constexpr double kLeft = 76.0;          // px, of both panels
constexpr double kPanelWidth = 860.0;   // px
constexpr double kMapTop = 100.0;       // px
constexpr double kErrorHeight = 190.0;  // px
constexpr double kGap = 74.0;           // px between the panels

constexpr std::string_view kTruthColor = "#3c3c3c";
constexpr std::string_view kEstimateColor = "#0a6ebd";
constexpr std::string_view kAxisColor = "#555555";
constexpr std::string_view kGridColor = "#e4e4e4";
constexpr std::string_view kStartColor = "#2a9d3a";
constexpr std::string_view kEndColor = "#d1352b";
constexpr std::string_view kRmseColor = "#d98000";

/// A rectangle on the page and the ranges of the data that it shows.
struct Panel {
  Eigen::Vector2d corner;  // px, top left
  Eigen::Vector2d size;    // px
  Eigen::Vector2d low;
  Eigen::Vector2d high;

  Eigen::Vector2d operator()(double x, double y) const {
    return {corner.x() + size.x() * (x - low.x()) / (high.x() - low.x()),
            corner.y() + size.y() * (high.y() - y) / (high.y() - low.y())};
  }
};

/// Which two axes of the poses are drawn.
struct View {
  Eigen::Index right = 0;
  Eigen::Index up = 1;
};

constexpr std::array<std::string_view, 3> kAxisNames = {"x (m)", "y (m)", "z (m)"};

struct Bounds {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  void include(std::span<const Eigen::Isometry3d> poses) {
    for (const Eigen::Isometry3d& pose : poses) {
      low = low.cwiseMin(pose.translation());
      high = high.cwiseMax(pose.translation());
    }
  }
};

/// The axis in which the truth extends least is looked along; where none stands out, z.
View choose_view(std::span<const Eigen::Isometry3d> truth) {
  Bounds bounds;
  bounds.include(truth);
  const Eigen::Vector3d extent = bounds.high - bounds.low;
  if (extent.y() < extent.z() && extent.y() < extent.x()) {
    return {0, 2};
  }
  if (extent.x() < extent.z() && extent.x() < extent.y()) {
    return {1, 2};
  }
  return {0, 1};
}

void draw_axes(SvgDocument& svg, const Panel& panel, std::string_view x_name,
               std::string_view y_name, const std::vector<double>& x_ticks,
               const std::vector<double>& y_ticks) {
  const auto step = [](const std::vector<double>& ticks) {
    return ticks.size() > 1 ? ticks[1] - ticks[0] : 0.0;
  };
  const double bottom = panel.corner.y() + panel.size.y();
  for (const double x : x_ticks) {
    const double px = panel(x, panel.low.y()).x();
    svg.line({px, panel.corner.y()}, {px, bottom}, {kGridColor, 1.0});
    svg.text({px, bottom + 17.0}, tick_label(x, step(x_ticks)),
             {12.0, kAxisColor, SvgAnchor::middle});
  }
  for (const double y : y_ticks) {
    const double py = panel(panel.low.x(), y).y();
    svg.line({panel.corner.x(), py}, {panel.corner.x() + panel.size.x(), py}, {kGridColor, 1.0});
    svg.text({panel.corner.x() - 7.0, py + 4.0}, tick_label(y, step(y_ticks)),
             {12.0, kAxisColor, SvgAnchor::end});
  }
  svg.rectangle(panel.corner, panel.size, {kAxisColor, 1.0});
  svg.text({panel.corner.x() + panel.size.x() / 2.0, bottom + 36.0}, x_name,
           {13.0, kAxisColor, SvgAnchor::middle});
  svg.text({panel.corner.x() - 52.0, panel.corner.y() + panel.size.y() / 2.0}, y_name,
           {13.0, kAxisColor, SvgAnchor::middle, false, true});
}

std::vector<Eigen::Vector2d> project(const Panel& panel, const View& view,
                                     std::span<const Eigen::Isometry3d> poses) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(poses.size());
  for (const Eigen::Isometry3d& pose : poses) {
    points.push_back(panel(pose.translation()(view.right), pose.translation()(view.up)));
  }
  return points;
}

/// A panel with the same scale in both directions that shows everything.
Panel map_panel(const Evaluation& evaluation, const View& view) {
  Bounds bounds;
  bounds.include(evaluation.truth);
  bounds.include(evaluation.estimate);
  const Eigen::Vector2d low(bounds.low(view.right), bounds.low(view.up));
  const Eigen::Vector2d high(bounds.high(view.right), bounds.high(view.up));
  const Eigen::Vector2d center = 0.5 * (low + high);
  // Far from the origin, doubles do not resolve a small extent.
  const double resolved = 1e-9 * center.cwiseAbs().maxCoeff();
  const double least = std::max({1e-3, resolved, 0.02 * (high - low).maxCoeff()});
  const Eigen::Vector2d extent = 1.1 * (high - low).cwiseMax(least);
  const double height = std::clamp(kPanelWidth * extent.y() / extent.x(), 240.0, 720.0);
  const double metres_per_px = std::max(extent.x() / kPanelWidth, extent.y() / height);
  const Eigen::Vector2d half = 0.5 * metres_per_px * Eigen::Vector2d(kPanelWidth, height);
  return {{kLeft, kMapTop}, {kPanelWidth, height}, center - half, center + half};
}

void draw_scale_bar(SvgDocument& svg, const Panel& panel) {
  const double metres_per_px = (panel.high.x() - panel.low.x()) / panel.size.x();
  const double length = round_length(150.0 * metres_per_px);
  const double right = panel.corner.x() + panel.size.x() - 18.0;
  const double left = right - length / metres_per_px;
  const double y = panel.corner.y() + panel.size.y() - 16.0;
  const SvgStroke stroke{kTruthColor, 2.0};
  svg.line({left, y}, {right, y}, stroke);
  svg.line({left, y - 5.0}, {left, y + 5.0}, stroke);
  svg.line({right, y - 5.0}, {right, y + 5.0}, stroke);
  svg.text({0.5 * (left + right), y - 7.0}, tick_label(length, length) + " m",
           {12.0, kTruthColor, SvgAnchor::middle});
}

void draw_legend(SvgDocument& svg, double y, bool aligned) {
  double x = kLeft;
  const auto entry = [&](std::string_view name, double width, auto&& symbol) {
    symbol(x);
    svg.text({x + 36.0, y + 4.0}, name, {13.0});
    x += width;
  };
  entry("truth", 96.0, [&](double at) {
    svg.line({at, y}, {at + 28.0, y}, {kTruthColor, 2.4, "6 4"});
  });
  entry(aligned ? "estimate, aligned" : "estimate", aligned ? 186.0 : 124.0, [&](double at) {
    svg.line({at, y}, {at + 28.0, y}, {kEstimateColor, 2.0});
  });
  entry("start", 84.0, [&](double at) {
    svg.circle({at + 22.0, y}, 5.0, kStartColor, {"#ffffff", 1.2});
  });
  entry("end", 84.0, [&](double at) {
    svg.circle({at + 22.0, y}, 5.0, kEndColor, {"#ffffff", 1.2});
  });
}

void draw_map(SvgDocument& svg, const Evaluation& evaluation, const Panel& panel,
              const View& view) {
  // The same step on both axes: squares stay squares.
  const std::vector<double> x_ticks = round_ticks(panel.low.x(), panel.high.x(), 10);
  const double step = x_ticks.size() > 1 ? x_ticks[1] - x_ticks[0] : 1.0;
  const double first = std::ceil(panel.low.y() / step);
  std::vector<double> y_ticks;
  for (int i = 0; i < 50 && (first + i) * step <= panel.high.y(); ++i) {
    y_ticks.push_back((first + i) * step);
  }
  draw_axes(svg, panel, kAxisNames[static_cast<std::size_t>(view.right)],
            kAxisNames[static_cast<std::size_t>(view.up)], x_ticks, y_ticks);
  const std::vector<Eigen::Vector2d> truth = project(panel, view, evaluation.truth);
  const std::vector<Eigen::Vector2d> estimate = project(panel, view, evaluation.estimate);
  svg.polyline(estimate, {kEstimateColor, 2.0});
  svg.polyline(truth, {kTruthColor, 1.6, "6 4"});
  svg.circle(estimate.front(), 6.0, kStartColor, {"#ffffff", 1.5});
  svg.circle(estimate.back(), 6.0, kEndColor, {"#ffffff", 1.5});
  draw_scale_bar(svg, panel);
}

void draw_errors(SvgDocument& svg, const Evaluation& evaluation, double top) {
  const std::vector<double>& path = evaluation.truth_path;
  const double length = std::max(path.back(), 1e-6);
  const double highest = std::max(1.08 * evaluation.ate.max, 1e-6);
  const Panel panel{{kLeft, top}, {kPanelWidth, kErrorHeight}, {0.0, 0.0}, {length, highest}};
  const std::vector<double> x_ticks = round_ticks(0.0, length, 10);
  const std::vector<double> y_ticks = round_ticks(0.0, highest, 5);
  draw_axes(svg, panel, "distance along the truth (m)", "position error (m)", x_ticks, y_ticks);
  std::vector<Eigen::Vector2d> curve;
  curve.reserve(path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    curve.push_back(panel(path[i], evaluation.position_errors[i]));
  }
  std::vector<Eigen::Vector2d> area = curve;
  area.push_back(panel(path.back(), 0.0));
  area.push_back(panel(0.0, 0.0));
  svg.polygon(area, kEstimateColor, 0.15);
  svg.polyline(curve, {kEstimateColor, 1.5});
  const double rmse = evaluation.ate.rmse;
  svg.line(panel(0.0, rmse), panel(length, rmse), {kRmseColor, 1.5, "7 4"});
  svg.text(panel(length, rmse) + Eigen::Vector2d(-6.0, -5.0),
           "rmse " + tick_label(rmse, 1e-3) + " m",
           {12.0, kRmseColor, SvgAnchor::end, true, false, true});
}

std::string summary(const Evaluation& evaluation) {
  return "ATE rmse " + tick_label(evaluation.ate.rmse, 1e-3) + " m, max " +
         tick_label(evaluation.ate.max, 1e-3) + " m (alignment " +
         std::string(to_string(evaluation.options.alignment)) + "); " +
         std::to_string(evaluation.ate.count) + " pairs of poses over " +
         tick_label(evaluation.truth_path.back(), 0.1) + " m";
}

}  // namespace

std::string plot_evaluation(const Evaluation& evaluation, const std::string& title) {
  const View view = choose_view(evaluation.truth);
  const Panel map = map_panel(evaluation, view);
  const double errors_top = map.corner.y() + map.size.y() + kGap;
  SvgDocument svg(kWidth, errors_top + kErrorHeight + 54.0);
  svg.text({kLeft, 30.0}, title, {17.0, "#000000", SvgAnchor::start, true});
  svg.text({kLeft, 51.0}, summary(evaluation), {13.0, kAxisColor});
  draw_legend(svg, 80.0, evaluation.options.alignment != Alignment::none);
  draw_map(svg, evaluation, map, view);
  draw_errors(svg, evaluation, errors_top);
  return svg.str();
}

}  // namespace adit
