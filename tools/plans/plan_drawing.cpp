// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/plans/plan_drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include <fmt/core.h>
#include <Eigen/Geometry>

#include "adit/slam/core/text.hpp"
#include "adit/tools/drawing/dxf_drawing.hpp"
#include "adit/tools/drawing/svg.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;

constexpr double kPxPerMm = 96.0 / 25.4;  // CSS
// mm, of A1 less its margins.
constexpr double kSheetWidth = 800.0;
constexpr double kSheetHeight = 540.0;
constexpr std::array<int, 10> kScales = {20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000};
constexpr double kMargin = 60.0;               // px, around the drawing
constexpr double kHeadRoom = 44.0;             // px, for the title
constexpr double kLeast = 420.0;               // px: title and scale bar need as much
constexpr double kWallLine = 0.35 * kPxPerMm;  // ISO 128's line width for visible edges at 1:100

Eigen::AlignedBox2d box_of(const WallLines& lines) {
  Eigen::AlignedBox2d box;
  for (const WallSegment& wall : lines.walls) {
    box.extend(wall.from);
    box.extend(wall.to);
  }
  for (const Vector2d& point : lines.rest) {
    box.extend(point);
  }
  return box;
}

/// Of the largest drawing that fits the sheet, either way.
int scale_of(const Eigen::AlignedBox2d& box) {
  const double longer = 1e3 * box.sizes().maxCoeff();  // mm
  const double shorter = 1e3 * box.sizes().minCoeff();
  for (const int scale : kScales) {
    if (longer <= kSheetWidth * scale && shorter <= kSheetHeight * scale) {
      return scale;
    }
  }
  return kScales.back();
}

/// A plan on its sheet: where a place is on it.
class PlanPage {
 public:
  explicit PlanPage(const PlanSheet& sheet)
      : sheet_(&sheet),
        box_(box_of(sheet.lines)),
        scale_(scale_of(box_)),
        px_per_m_(1e3 * kPxPerMm / scale_),
        size_(std::max(kLeast, px_per_m_ * box_.sizes().x() + 2.0 * kMargin),
              px_per_m_ * box_.sizes().y() + 2.0 * kMargin + kHeadRoom),
        document_(size_.x(), size_.y() + kMargin) {}

  std::string draw() {
    head();
    grid();
    rest();
    for (const WallSegment& wall : sheet_->lines.walls) {
      document_.line(px(wall.from), px(wall.to), {.color = kTextColor, .width = kWallLine});
    }
    foot();
    return document_.str();
  }

 private:
  Vector2d px(const Vector2d& place) const {
    return {kMargin + px_per_m_ * (place.x() - box_.min().x()),
            kHeadRoom + kMargin + px_per_m_ * (box_.max().y() - place.y())};
  }

  void head() {
    document_.text({kMargin, 30.0}, sheet_->title, {.size = 18.0, .bold = true});
    document_.text({kMargin, 50.0},
                   fmt::format("1:{}{}{}", scale_, sheet_->coordinates.empty() ? "" : ", ",
                               sheet_->coordinates),
                   {.size = 12.0, .color = kAxisColor});
  }

  /// Ticks at round coordinates.
  void grid() {
    const double step = round_length(std::max(1e-3, 0.25 * box_.sizes().maxCoeff()));
    const auto ticks = [&](double low, double high) {
      return round_ticks(low, high, std::max(1, static_cast<int>((high - low) / step)));
    };
    const double bottom = px(box_.min()).y() + 12.0;
    for (const double x : ticks(box_.min().x(), box_.max().x())) {
      const double at = px({x, 0.0}).x();
      document_.line({at, px(box_.max()).y() - 12.0}, {at, bottom},
                     {.color = kGridColor, .width = 0.7});
      document_.text({at, bottom + 14.0}, tick_label(x, step),
                     {.size = 10.0, .color = kAxisColor, .anchor = SvgAnchor::middle});
    }
    for (const double y : ticks(box_.min().y(), box_.max().y())) {
      const double at = px({0.0, y}).y();
      document_.line({px(box_.min()).x() - 12.0, at}, {px(box_.max()).x() + 12.0, at},
                     {.color = kGridColor, .width = 0.7});
      document_.text(
          {px(box_.min()).x() - 18.0, at}, tick_label(y, step),
          {.size = 10.0, .color = kAxisColor, .anchor = SvgAnchor::middle, .upwards = true});
    }
  }

  /// Doubtful points as the cells that they are in, in runs.
  void rest() {
    if (sheet_->lines.rest.empty()) {
      return;
    }
    std::map<int64_t, std::vector<int64_t>> rows;  // from the top
    const double edge = SliceCells::kEdge;
    Eigen::AlignedBox2d box;
    for (const Vector2d& point : sheet_->lines.rest) {
      box.extend(point);
    }
    for (const Vector2d& point : sheet_->lines.rest) {
      rows[std::llround((box.max().y() - point.y()) / edge)].push_back(
          std::llround((point.x() - box.min().x()) / edge));
    }
    CellRuns runs{.color = kUnknownColor};
    for (auto& [row, columns] : rows) {
      std::ranges::sort(columns);
      for (const int64_t column : columns) {
        const bool next =
            !runs.runs.empty() && runs.runs.back().row == static_cast<std::size_t>(row) &&
            runs.runs.back().column + runs.runs.back().count == static_cast<std::size_t>(column);
        if (next) {
          ++runs.runs.back().count;
        } else {
          runs.runs.push_back({.column = static_cast<std::size_t>(column),
                               .row = static_cast<std::size_t>(row),
                               .count = 1});
        }
      }
    }
    const Vector2d half = Vector2d(-0.5, 0.5) * edge;
    document_.cells({&runs, 1}, px(Vector2d(box.min().x(), box.max().y()) + half),
                    px_per_m_ * edge);
  }

  void foot() {
    const double length = round_length(160.0 / px_per_m_);
    const Vector2d begin(kMargin, size_.y() + 20.0);
    for (int part = 0; part < 4; ++part) {  // dark and light in turn
      const double from = begin.x() + 0.25 * part * length * px_per_m_;
      document_.line({from, begin.y()}, {from + 0.25 * length * px_per_m_, begin.y()},
                     {.color = part % 2 == 0 ? kTextColor : kUnknownColor, .width = 5.0});
    }
    document_.text(begin + Vector2d(0.0, 18.0), "0", {.size = 11.0, .color = kAxisColor});
    document_.text(begin + Vector2d(length * px_per_m_, 18.0), shortest(length) + " m",
                   {.size = 11.0, .color = kAxisColor, .anchor = SvgAnchor::middle});
    document_.text(begin + Vector2d(length * px_per_m_ + 30.0, 4.0),
                   "black: walls; grey: other points", {.size = 11.0, .color = kAxisColor});
    if (sheet_->north_up) {
      const Vector2d tip(size_.x() - 0.5 * kMargin, 18.0);
      document_.line(tip + Vector2d(0.0, 34.0), tip, {.color = kTextColor, .width = 1.5});
      document_.line(tip + Vector2d(-5.0, 10.0), tip, {.color = kTextColor, .width = 1.5});
      document_.line(tip + Vector2d(5.0, 10.0), tip, {.color = kTextColor, .width = 1.5});
      document_.text(tip + Vector2d(0.0, 48.0), "N",
                     {.size = 12.0, .anchor = SvgAnchor::middle, .bold = true});
    }
  }

  const PlanSheet* sheet_;
  Eigen::AlignedBox2d box_;
  int scale_;
  double px_per_m_;
  Vector2d size_;
  SvgDocument document_;
};

}  // namespace

std::string plan_dxf(const PlanSheet& sheet) {
  DxfDrawing drawing({{.name = "WALLS", .color = 7}, {.name = "POINTS", .color = 8}},
                     fmt::format("adit {}: {}{}{}; metres", version(), sheet.title,
                                 sheet.coordinates.empty() ? "" : ", ", sheet.coordinates));
  for (const WallSegment& wall : sheet.lines.walls) {
    drawing.line("WALLS", wall.from, wall.to);
  }
  for (const Vector2d& point : sheet.lines.rest) {
    drawing.point("POINTS", point);
  }
  return drawing.str();
}

std::string plan_svg(const PlanSheet& sheet) {
  return PlanPage(sheet).draw();
}

}  // namespace adit
