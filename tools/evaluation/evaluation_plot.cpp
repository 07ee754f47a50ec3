// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/evaluation_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "adit/tools/drawing/svg.hpp"

namespace adit {
namespace {

constexpr double kErrorHeight = 190.0;  // px
constexpr double kGap = 74.0;           // px between the panels
constexpr std::string_view kTruthColor = "#3c3c3c";

/// Where things lie across a drawing of some width, px.
struct Columns {
  explicit Columns(double width)
      : left(width < 600.0 ? 58.0 : 76.0),
        panel(width - left - 24.0),
        ticks(width < 600.0 ? 5 : 10) {}

  double left;
  double panel;  ///< width of a panel
  int ticks;
};

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
  svg.text({std::max(13.0, panel.corner.x() - 52.0), panel.corner.y() + panel.size.y() / 2.0},
           y_name, {13.0, kAxisColor, SvgAnchor::middle, false, true});
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

/// The evaluation whose truth is drawn: it covers most.
const Evaluation& widest(std::span<const PlottedEstimate> estimates) {
  return *std::ranges::max_element(estimates, {}, [](const PlottedEstimate& one) {
            return one.evaluation->truth_path.back();
          })->evaluation;
}

/// A panel with the same scale in both directions that shows everything.
Panel map_panel(std::span<const PlottedEstimate> estimates, const View& view,
                const Columns& columns, double top) {
  Bounds bounds;
  for (const PlottedEstimate& one : estimates) {
    bounds.include(one.evaluation->truth);
    bounds.include(one.evaluation->estimate);
  }
  const Eigen::Vector2d low(bounds.low(view.right), bounds.low(view.up));
  const Eigen::Vector2d high(bounds.high(view.right), bounds.high(view.up));
  const Eigen::Vector2d center = 0.5 * (low + high);
  // Far from the origin, doubles do not resolve a small extent.
  const double resolved = 1e-9 * center.cwiseAbs().maxCoeff();
  const double least = std::max({1e-3, resolved, 0.02 * (high - low).maxCoeff()});
  const Eigen::Vector2d extent = 1.1 * (high - low).cwiseMax(least);
  const double height = std::clamp(columns.panel * extent.y() / extent.x(), 240.0, 720.0);
  const double metres_per_px = std::max(extent.x() / columns.panel, extent.y() / height);
  const Eigen::Vector2d half = 0.5 * metres_per_px * Eigen::Vector2d(columns.panel, height);
  return {{columns.left, top}, {columns.panel, height}, center - half, center + half};
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

/// Estimates beyond the colours have dashes.
SvgStroke stroke_of(std::size_t estimate) {
  constexpr std::array<std::string_view, 3> kDashes = {"", "10 3", "2 3"};
  return {kSeriesColors[estimate % kSeriesColors.size()], 2.0,
          kDashes[estimate / kSeriesColors.size() % kDashes.size()]};
}

/// Returns the height of a legend that begins at `y`, in as many rows as it needs.
double draw_legend(SvgDocument& svg, double y, std::span<const PlottedEstimate> estimates,
                   const Columns& columns) {
  const double first = y;
  double x = columns.left;
  const auto entry = [&](const std::string& name, auto&& symbol) {
    const double width = 50.0 + text_width(name, 13.0);
    if (x > columns.left && x + width > columns.left + columns.panel) {
      x = columns.left;
      y += 22.0;
    }
    symbol(x);
    svg.text({x + 34.0, y + 4.0}, name, {13.0});
    x += width;
  };
  entry("truth", [&](double at) { svg.line({at, y}, {at + 28.0, y}, {kTruthColor, 2.4, "6 4"}); });
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    entry(estimates[i].name, [&](double at) { svg.line({at, y}, {at + 28.0, y}, stroke_of(i)); });
  }
  entry("start", [&](double at) { svg.circle({at + 22.0, y}, 5.0, kGoodColor, {"#ffffff", 1.2}); });
  entry("end", [&](double at) { svg.square({at + 22.0, y}, 9.0, kBadColor, {"#ffffff", 1.2}); });
  return y - first;
}

void draw_map(SvgDocument& svg, std::span<const PlottedEstimate> estimates, const Panel& panel,
              const View& view, const Columns& columns) {
  // The same step on both axes: squares stay squares.
  const std::vector<double> x_ticks = round_ticks(panel.low.x(), panel.high.x(), columns.ticks);
  const double step = x_ticks.size() > 1 ? x_ticks[1] - x_ticks[0] : 1.0;
  const double first = std::ceil(panel.low.y() / step);
  std::vector<double> y_ticks;
  for (int i = 0; i < 50 && (first + i) * step <= panel.high.y(); ++i) {
    y_ticks.push_back((first + i) * step);
  }
  draw_axes(svg, panel, kAxisNames[static_cast<std::size_t>(view.right)],
            kAxisNames[static_cast<std::size_t>(view.up)], x_ticks, y_ticks);
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    svg.polyline(project(panel, view, estimates[i].evaluation->estimate), stroke_of(i));
  }
  const std::vector<Eigen::Vector2d> truth = project(panel, view, widest(estimates).truth);
  svg.polyline(truth, {kTruthColor, 1.6, "6 4"});
  for (const PlottedEstimate& one : estimates) {
    const auto ends = project(panel, view, one.evaluation->estimate);
    svg.circle(ends.front(), 6.0, kGoodColor, {"#ffffff", 1.5});
    svg.square(ends.back(), 11.0, kBadColor, {"#ffffff", 1.5});
  }
  draw_scale_bar(svg, panel);
}

/// m along the truth of `reference` at each pose of the other; where both have times, estimates
/// that begin later are drawn later.
std::vector<double> path_of(const Evaluation& evaluation, const Evaluation& reference) {
  std::vector<double> path = evaluation.truth_path;
  if (evaluation.stamps.empty() || reference.stamps.empty()) {
    return path;
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto after = std::ranges::lower_bound(reference.stamps, evaluation.stamps[i]);
    const auto at = std::min(static_cast<std::size_t>(after - reference.stamps.begin()),
                             reference.truth_path.size() - 1);
    path[i] = reference.truth_path[at];
  }
  return path;
}

/// What errors are drawn in, so that their ticks are short.
struct LengthUnit {
  std::string name;
  double per_metre;
};
LengthUnit unit_for(double highest) {
  if (highest < 0.02) {
    return {"mm", 1e3};
  }
  return highest < 1.0 ? LengthUnit{"cm", 1e2} : LengthUnit{"m", 1.0};
}

void draw_errors(SvgDocument& svg, std::span<const PlottedEstimate> estimates,
                 const Columns& columns, double top) {
  const Evaluation& reference = widest(estimates);
  double highest = 1e-4;
  for (const PlottedEstimate& one : estimates) {
    highest = std::max(highest, 1.08 * one.evaluation->ate.max);
  }
  const double length = std::max(reference.truth_path.back(), 1e-6);
  const LengthUnit unit = unit_for(highest);
  highest *= unit.per_metre;
  const Panel panel{
      {columns.left, top}, {columns.panel, kErrorHeight}, {0.0, 0.0}, {length, highest}};
  draw_axes(svg, panel, "distance along the truth (m)", "position error (" + unit.name + ")",
            round_ticks(0.0, length, columns.ticks), round_ticks(0.0, highest, 5));
  for (std::size_t k = 0; k < estimates.size(); ++k) {
    const Evaluation& evaluation = *estimates[k].evaluation;
    const std::vector<double> path = path_of(evaluation, reference);
    std::vector<Eigen::Vector2d> curve;
    for (std::size_t i = 0; i < path.size(); ++i) {
      curve.push_back(panel(path[i], unit.per_metre * evaluation.position_errors[i]));
    }
    SvgStroke stroke = stroke_of(k);
    stroke.width = 1.5;
    if (estimates.size() == 1) {
      std::vector<Eigen::Vector2d> area = curve;
      area.push_back(panel(path.back(), 0.0));
      area.push_back(panel(path.front(), 0.0));
      svg.polygon(area, stroke.color, 0.2);
    }
    svg.polyline(curve, stroke);
  }
  if (estimates.size() == 1) {
    const double rmse = reference.ate.rmse;
    const Eigen::Vector2d at = panel(length, unit.per_metre * rmse);
    svg.line({columns.left, at.y()}, at, {kGateColor, 1.5, "7 4"});
    svg.text(at + Eigen::Vector2d(-6.0, -5.0),
             "rmse " + tick_label(unit.per_metre * rmse, 0.01) + " " + unit.name,
             {12.0, kTextColor, SvgAnchor::end, true, false, true});
  }
}

std::string summary(const Evaluation& evaluation) {
  return "ATE rmse " + tick_label(evaluation.ate.rmse, 1e-3) + " m, max " +
         tick_label(evaluation.ate.max, 1e-3) + " m (alignment " +
         std::string(to_string(evaluation.options.alignment)) + "); " +
         std::to_string(evaluation.ate.count) + " pairs of poses over " +
         tick_label(evaluation.truth_path.back(), 0.1) + " m";
}

std::string draw(std::span<const PlottedEstimate> estimates, const std::string& title,
                 const std::string& words, double width) {
  const Columns columns(width);
  const double right = columns.left + columns.panel;
  const View view = choose_view(widest(estimates).truth);
  /// Returns where the map begins.
  const auto draw_head = [&](SvgDocument& svg) {
    double y = 30.0;
    y += svg.paragraph({columns.left, y}, title, right, {17.0, kTextColor, SvgAnchor::start, true});
    y += svg.paragraph({columns.left, y}, words, right, {13.0, kAxisColor}) + 8.0;
    return y + draw_legend(svg, y, estimates, columns) + 20.0;
  };
  SvgDocument sketch(width, 1.0);  // the heights are known once it is laid out
  const Panel map = map_panel(estimates, view, columns, draw_head(sketch));
  const double errors_top = map.corner.y() + map.size.y() + kGap;
  SvgDocument svg(width, errors_top + kErrorHeight + 54.0);
  draw_head(svg);
  draw_map(svg, estimates, map, view, columns);
  draw_errors(svg, estimates, columns, errors_top);
  return svg.str();
}

}  // namespace

std::string plot_evaluations(std::span<const PlottedEstimate> estimates, const std::string& title,
                             double width) {
  std::string words;
  for (const PlottedEstimate& one : estimates) {
    words += (words.empty() ? "ATE rmse: " : ", ") + one.name + " " +
             tick_label(one.evaluation->ate.rmse, 1e-3) + " m";
  }
  return draw(estimates, title, words, width);
}

std::string plot_evaluation(const Evaluation& evaluation, const std::string& title, double width) {
  const bool aligned = evaluation.options.alignment != Alignment::none;
  const PlottedEstimate one{aligned ? "estimate, aligned" : "estimate", &evaluation};
  return draw(std::span(&one, 1), title, summary(evaluation), width);
}

}  // namespace adit
