// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/map_picture.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/tools/drawing/image_canvas.hpp"
#include "adit/tools/drawing/svg.hpp"

namespace adit {
namespace {

constexpr std::string_view kPathColor = kSeriesColors[1];
constexpr std::string_view kLoopColor = kSeriesColors[3];
constexpr float kEmpty = -std::numeric_limits<float>::infinity();
constexpr double kCells = 500.0;         ///< along the longer side
constexpr double kTop = 104.0;           ///< px, title and legend
constexpr double kLeft = 72.0;           ///< px, labels of the axis
constexpr double kRight = 24.0;          ///< px
constexpr double kBottom = 62.0;         ///< px
constexpr double kWidest = 620.0;        ///< px, of the map
constexpr double kHighest = 900.0;       ///< px
constexpr double kKeyframeRadius = 2.5;  ///< px
constexpr SvgStroke kLoopStroke{.color = kLoopColor, .width = 1.5};
constexpr SvgStroke kRevokedStroke{.color = kBadColor, .width = 1.5, .dash = "4 3"};

/// The highest point of each cell; row 0 is the northernmost.
struct Raster {
  Eigen::Vector2d low;
  double cell = 0.0;  ///< m
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::vector<float> top;

  Eigen::Vector2d place(const Eigen::Vector2d& p) const {
    return {(p.x() - low.x()) / cell, static_cast<double>(rows) - (p.y() - low.y()) / cell};
  }
};

Raster rasterize(std::span<const Point> points, std::span<const StampedPose> path) {
  Eigen::AlignedBox2d box;
  for (const Point& p : points) {
    box.extend(Eigen::Vector2d(p.x, p.y));
  }
  for (const StampedPose& pose : path) {
    box.extend(Eigen::Vector2d(pose.pose.translation().head<2>()));
  }
  if (box.isEmpty()) {
    box.extend(Eigen::Vector2d::Zero().eval());
  }
  Raster raster;
  raster.cell = std::max(box.sizes().maxCoeff() / kCells, 0.05);
  raster.low = box.min();
  raster.columns = static_cast<std::size_t>(box.sizes().x() / raster.cell) + 1;
  raster.rows = static_cast<std::size_t>(box.sizes().y() / raster.cell) + 1;
  raster.top.assign(raster.columns * raster.rows, kEmpty);
  for (const Point& p : points) {
    const auto column = static_cast<std::size_t>((p.x - box.min().x()) / raster.cell);
    const auto row =
        raster.rows - 1 - static_cast<std::size_t>((p.y - box.min().y()) / raster.cell);
    float& top = raster.top[row * raster.columns + column];
    top = std::max(top, p.z);
  }
  return raster;
}

/// Heights that 5 % of the cells stay below and above: a lone bird does not bleach the picture.
std::pair<float, float> height_range(const Raster& raster) {
  std::vector<float> heights;
  std::ranges::copy_if(raster.top, std::back_inserter(heights),
                       [](float z) { return z != kEmpty; });
  if (heights.empty()) {
    return {0.0F, 1.0F};
  }
  std::ranges::sort(heights);
  const float low = heights[heights.size() / 20];
  const float high = heights[heights.size() - 1 - heights.size() / 20];
  return {low, std::max(high, low + 0.1F)};
}

/// Places on the drawing.
struct Layout {
  explicit Layout(const Raster& raster) {
    const auto columns = static_cast<double>(raster.columns);
    const auto rows = static_cast<double>(raster.rows);
    scale = std::min(kWidest / columns, kHighest / rows);
    size = scale * Eigen::Vector2d(columns, rows);
  }

  /// From cells to px.
  Eigen::Vector2d operator()(const Eigen::Vector2d& cells) const { return corner + scale * cells; }

  double scale = 1.0;  ///< px a cell
  Eigen::Vector2d corner{kLeft, kTop};
  Eigen::Vector2d size;
};

std::vector<CellRuns> runs_of(const Raster& raster, std::pair<float, float> heights) {
  const auto color_of = [low = heights.first, high = heights.second](float z) {
    const float share = (z - low) / (high - low) * static_cast<float>(kRampColors.size());
    return static_cast<std::size_t>(
        std::clamp(share, 0.0F, static_cast<float>(kRampColors.size()) - 1.0F));
  };
  std::vector<CellRuns> colors;
  std::ranges::transform(kRampColors, std::back_inserter(colors),
                         [](std::string_view color) { return CellRuns{.color = color}; });
  for (std::size_t row = 0; row < raster.rows; ++row) {
    const float* line = &raster.top[row * raster.columns];
    for (std::size_t column = 0; column < raster.columns;) {
      if (line[column] == kEmpty) {
        ++column;
        continue;
      }
      const std::size_t color = color_of(line[column]);
      const std::size_t start = column;
      while (column < raster.columns && line[column] != kEmpty && color_of(line[column]) == color) {
        ++column;
      }
      colors[color].runs.push_back({.column = start, .row = row, .count = column - start});
    }
  }
  return colors;
}

/// A round coordinate, and where it lies on its axis, px.
struct Tick {
  double at = 0.0;  ///< m
  double px = 0.0;
};

struct Ticks {
  Ticks(const Raster& raster, const Layout& layout) {
    const Eigen::Vector2d high =
        raster.low + raster.cell * Eigen::Vector2d(static_cast<double>(raster.columns),
                                                   static_cast<double>(raster.rows));
    const double longest = (high - raster.low).maxCoeff();
    const std::vector<double> steps = round_ticks(0.0, longest, layout.size.x() < 400.0 ? 4 : 8);
    step = steps.size() > 1 ? steps[1] - steps[0] : 1.0;
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Vector2d place = raster.low;
      const auto first = static_cast<long>(std::ceil(raster.low[axis] / step));
      const auto last = static_cast<long>(std::floor(high[axis] / step));
      for (long i = first; i <= last; ++i) {
        place[axis] = static_cast<double>(i) * step;
        along.at(static_cast<std::size_t>(axis))
            .push_back({.at = place[axis], .px = layout(raster.place(place))[axis]});
      }
    }
  }

  double step = 1.0;  ///< m
  std::array<std::vector<Tick>, 2> along;
};

/// Lines of round coordinates, for the ground of the picture.
void draw_grid(Canvas& canvas, const Ticks& ticks, const Layout& layout) {
  const Eigen::Vector2d end = layout.corner + layout.size;
  for (const Tick& x : ticks.along[0]) {
    canvas.line({x.px, layout.corner.y()}, {x.px, end.y()}, {.color = kGridColor});
  }
  for (const Tick& y : ticks.along[1]) {
    canvas.line({layout.corner.x(), y.px}, {end.x(), y.px}, {.color = kGridColor});
  }
}

void draw_axes(Canvas& canvas, const Ticks& ticks, const Layout& layout) {
  const Eigen::Vector2d end = layout.corner + layout.size;
  for (const Tick& x : ticks.along[0]) {
    canvas.line({x.px, end.y()}, {x.px, end.y() + 5.0}, {.color = kAxisColor});
    canvas.text({x.px, end.y() + 21.0}, tick_label(x.at, ticks.step),
                {.size = 14.0, .color = kAxisColor, .anchor = SvgAnchor::middle});
  }
  for (const Tick& y : ticks.along[1]) {
    canvas.line({layout.corner.x() - 5.0, y.px}, {layout.corner.x(), y.px}, {.color = kAxisColor});
    canvas.text({layout.corner.x() - 9.0, y.px + 4.0}, tick_label(y.at, ticks.step),
                {.size = 14.0, .color = kAxisColor, .anchor = SvgAnchor::end});
  }
  canvas.rectangle(layout.corner, layout.size, {.color = kAxisColor});
  canvas.text({0.5 * (layout.corner.x() + end.x()), end.y() + 46.0}, "x (m)",
              {.size = 15.0, .color = kAxisColor, .anchor = SvgAnchor::middle});
  canvas.text({15.0, 0.5 * (layout.corner.y() + end.y())}, "y (m)",
              {.size = 15.0, .color = kAxisColor, .anchor = SvgAnchor::middle, .upwards = true});
}

/// What the colours stand for, and the path.
void draw_legend(Canvas& canvas, const std::optional<std::pair<float, float>>& heights,
                 const PictureGraph& graph) {
  constexpr double kSwatch = 16.0;  // px
  /// Returns how far to go on to the right.
  const auto entry = [&](double left, double base, const std::string& words, auto&& symbol) {
    symbol(left, base - 5.0);
    canvas.text({left + 32.0, base}, words, {.size = 14.0, .color = kAxisColor});
    return 32.0 + text_width(words, 14.0) + 16.0;
  };
  double x = kLeft;
  double y = 56.0;
  if (heights) {
    const std::string low = "height " + tick_label(heights->first, 0.1) + " m";
    canvas.text({x, y}, low, {.size = 14.0, .color = kAxisColor});
    x += text_width(low, 14.0) + 10.0;
    for (const std::string_view color : kRampColors) {
      canvas.square({x + 0.5 * kSwatch, y - 5.0}, kSwatch, color, {.color = color});
      x += kSwatch;
    }
    canvas.text({x + 8.0, y}, tick_label(heights->second, 0.1) + " m and higher",
                {.size = 14.0, .color = kAxisColor});
    x = kLeft;
    y = 84.0;
  }
  x += entry(x, y, "path", [&](double at, double middle) {
    canvas.line({at, middle}, {at + 24.0, middle}, {.color = kPathColor, .width = 3.0});
  });
  x += entry(x, y, "start", [&](double at, double middle) {
    canvas.circle({at + 20.0, middle}, 5.5, kGoodColor, {.color = "#ffffff", .width = 1.2});
  });
  x += entry(x, y, "end", [&](double at, double middle) {
    canvas.square({at + 20.0, middle}, 10.0, kBadColor, {.color = "#ffffff", .width = 1.2});
  });
  if (!graph.keyframes.empty()) {
    x += entry(x, y, "keyframe", [&](double at, double middle) {
      canvas.circle({at + 20.0, middle}, kKeyframeRadius, "#ffffff", {.color = kPathColor});
    });
  }
  if (std::ranges::any_of(graph.loops, std::logical_not(), &PictureGraph::Link::revoked)) {
    x += entry(x, y, "loop", [&](double at, double middle) {
      canvas.line({at, middle}, {at + 24.0, middle}, kLoopStroke);
    });
  }
  if (std::ranges::any_of(graph.loops, &PictureGraph::Link::revoked)) {
    entry(x, y, "revoked", [&](double at, double middle) {
      canvas.line({at, middle}, {at + 24.0, middle}, kRevokedStroke);
    });
  }
}

void draw_path(Canvas& canvas, const Raster& raster, const Layout& layout,
               std::span<const StampedPose> path) {
  std::vector<Eigen::Vector2d> points;
  for (const StampedPose& pose : path) {
    points.push_back(layout(raster.place(pose.pose.translation().head<2>())));
  }
  if (points.empty()) {
    return;
  }
  canvas.polyline(points,
                  {.color = "#ffffff", .width = 5.0});  // an edge against cells of any colour
  canvas.polyline(points, {.color = kPathColor, .width = 2.5});
  canvas.circle(points.front(), 6.0, kGoodColor, {.color = "#ffffff", .width = 1.5});
  canvas.square(points.back(), 11.0, kBadColor, {.color = "#ffffff", .width = 1.5});
}

void draw_graph(Canvas& canvas, const Raster& raster, const Layout& layout,
                const PictureGraph& graph) {
  for (const PictureGraph::Link& loop : graph.loops) {
    canvas.line(layout(raster.place(loop.from)), layout(raster.place(loop.to)),
                loop.revoked ? kRevokedStroke : kLoopStroke);
  }
  for (const Eigen::Vector2d& keyframe : graph.keyframes) {
    canvas.circle(layout(raster.place(keyframe)), kKeyframeRadius, "#ffffff",
                  {.color = kPathColor});
  }
}

void draw_scale_bar(Canvas& canvas, const Raster& raster, const Layout& layout) {
  const double metres = layout.size.x() / layout.scale * raster.cell;
  const double length = round_length(std::max(metres, 0.1) / 4.0);
  const double right = layout.corner.x() + layout.size.x() - 14.0;
  const double left = right - length / raster.cell * layout.scale;
  const double y = layout.corner.y() + layout.size.y() - 14.0;
  for (const auto& [color, width] : {std::pair{"#ffffff", 6.0}, std::pair{"#000000", 2.0}}) {
    canvas.line({left, y}, {right, y}, {.color = color, .width = width});
  }
  canvas.text({0.5 * (left + right), y - 8.0}, tick_label(length, length) + " m",
              {.size = 14.0, .anchor = SvgAnchor::middle, .bold = true, .halo = true});
}

/// In the corner above on the right.
void draw_north_arrow(Canvas& canvas, const Layout& layout) {
  const Eigen::Vector2d tip = layout.corner + Eigen::Vector2d(layout.size.x() - 22.0, 12.0);
  const std::array<Eigen::Vector2d, 3> head = {tip + Eigen::Vector2d(-7.0, 12.0), tip,
                                               tip + Eigen::Vector2d(7.0, 12.0)};
  for (const auto& [color, width] : {std::pair{"#ffffff", 6.0}, std::pair{"#000000", 2.0}}) {
    canvas.line(tip, tip + Eigen::Vector2d(0.0, 36.0), {.color = color, .width = width});
    canvas.polyline(head, {.color = color, .width = width});
  }
  canvas.text(tip + Eigen::Vector2d(0.0, 54.0), "N",
              {.size = 16.0, .anchor = SvgAnchor::middle, .bold = true, .halo = true});
}

}  // namespace

std::string map_picture(std::span<const Point> points, std::span<const StampedPose> path,
                        const std::string& title, const PictureGraph& graph, PictureFormat format) {
  const Raster raster = rasterize(points, path);
  const Layout layout(raster);
  const Ticks ticks(raster, layout);
  const std::pair<float, float> heights = height_range(raster);
  const double width =
      std::max(kLeft + layout.size.x() + kRight, graph.keyframes.empty() ? 480.0 : 700.0);
  const double height = kTop + layout.size.y() + kBottom;
  const auto draw = [&](Canvas& canvas) {
    canvas.text({kLeft, 28.0}, title, {.size = 18.0, .bold = true});
    draw_legend(canvas, points.empty() ? std::nullopt : std::optional(heights), graph);
    draw_grid(canvas, ticks, layout);
    canvas.cells(runs_of(raster, heights), layout.corner, layout.scale);
    draw_axes(canvas, ticks, layout);
    draw_path(canvas, raster, layout, path);
    draw_graph(canvas, raster, layout, graph);
    draw_scale_bar(canvas, raster, layout);
    if (graph.north_up) {
      draw_north_arrow(canvas, layout);
    }
  };
  if (format == PictureFormat::png) {
    ImageCanvas image(width, height);
    draw(image);
    return png_bytes(image.image());
  }
  SvgDocument svg(width, height);
  draw(svg);
  return svg.str();
}

}  // namespace adit
