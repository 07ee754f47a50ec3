// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/time_panels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "adit/tools/drawing/svg.hpp"

namespace adit {
namespace {

constexpr double kRightMargin = 20.0;  // px
constexpr double kHeight = 110.0;      // px, of a panel with curves
constexpr double kBand = 15.0;         // px, of a band
constexpr double kFoot = 44.0;         // px below the last panel

/// px left of the panels.
double left_of(double width) {
  return width < 600.0 ? 88.0 : 110.0;
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    if (std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  bool empty() const { return low > high; }
};

/// Where a panel lies and what it shows; values as drawn: logarithms where it is logarithmic.
struct Frame {
  double left = 0.0;
  double right = 0.0;
  double top = 0.0;
  double height = kHeight;
  Range time;
  Range value;

  double x(double t) const {
    const double share = (t - time.low) / (time.high - time.low);
    return left + (right - left) * share;
  }
  double y(double v) const {
    const double share = (value.high - v) / (value.high - value.low);
    return top + height * std::clamp(share, 0.0, 1.0);
  }
};

/// As it is drawn; NaN where it cannot be.
double scaled(const TimePanel& panel, double value) {
  if (!panel.logarithmic) {
    return value;
  }
  return value > 0.0 ? std::log10(value) : std::numeric_limits<double>::quiet_NaN();
}

Range range_of(const TimePanel& panel) {
  Range data;
  for (const Curve& curve : panel.curves) {
    for (const double value : curve.values) {
      data.include(scaled(panel, value));
    }
  }
  if (data.empty()) {
    return data;
  }
  for (const Gate& gate : panel.gates) {
    data.include(scaled(panel, gate.value));
  }
  const double margin = 0.06 * std::max(data.high - data.low, 1e-9 + 1e-6 * std::abs(data.high));
  data.low = panel.low ? scaled(panel, *panel.low) : data.low - margin;
  data.high = panel.high ? scaled(panel, *panel.high) : data.high + margin;
  return data;
}

bool shows_something(const TimePanel& panel) {
  const bool banded = std::ranges::any_of(panel.bands, [](const Band& band) {
    return std::ranges::any_of(band.values, [](int value) { return value >= 0; });
  });
  return banded || !range_of(panel).empty();
}

double height_of(const TimePanel& panel) {
  return panel.bands.empty() ? kHeight : kBand * static_cast<double>(panel.bands.size());
}

double step_of(const std::vector<double>& ticks) {
  return ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0;
}

void draw_values_axis(SvgDocument& svg, const Frame& frame, const TimePanel& panel) {
  std::vector<double> ticks = round_ticks(frame.value.low, frame.value.high, 4);
  if (panel.logarithmic) {
    std::erase_if(ticks, [](double tick) { return std::abs(tick - std::round(tick)) > 1e-6; });
  }
  for (const double tick : ticks) {
    const double y = frame.y(tick);
    const double value = panel.logarithmic ? std::pow(10.0, std::round(tick)) : tick;
    svg.line({frame.left, y}, {frame.right, y}, {.color = kGridColor});
    svg.text({frame.left - 6.0, y + 4.0},
             tick_label(value, panel.logarithmic ? value : step_of(ticks)),
             {.size = 11.0, .color = kAxisColor, .anchor = SvgAnchor::end});
  }
}

/// `name` is empty where another panel below has the labels.
void draw_times_axis(SvgDocument& svg, const Frame& frame, std::string_view name) {
  const std::vector<double> ticks =
      round_ticks(frame.time.low, frame.time.high, frame.right - frame.left < 500.0 ? 5 : 10);
  const double bottom = frame.top + frame.height;
  for (const double tick : ticks) {
    const double x = frame.x(tick);
    svg.line({x, frame.top}, {x, bottom}, {.color = kGridColor});
    if (!name.empty()) {
      svg.text({x, bottom + 16.0}, tick_label(tick, step_of(ticks)),
               {.size = 11.0, .color = kAxisColor, .anchor = SvgAnchor::middle});
    }
  }
  if (!name.empty()) {
    svg.text({0.5 * (frame.left + frame.right), bottom + 34.0}, name,
             {.size = 12.0, .color = kAxisColor, .anchor = SvgAnchor::middle});
  }
}

/// The stretches of a curve that have values.
template <class Take>
void for_each_stretch(std::span<const double> times, const Frame& frame, const TimePanel& panel,
                      const std::vector<double>& values, Take&& take) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i <= values.size(); ++i) {
    const double value =
        i < values.size() ? scaled(panel, values[i]) : std::numeric_limits<double>::quiet_NaN();
    if (std::isfinite(value)) {
      points.emplace_back(frame.x(times[i]), frame.y(value));
    } else if (!points.empty()) {
      take(points);
      points.clear();
    }
  }
}

void draw_sigma(SvgDocument& svg, std::span<const double> times, const Frame& frame,
                const TimePanel& panel, const Curve& curve) {
  std::vector<double> above = curve.values;
  std::vector<double> below = curve.values;
  for (std::size_t i = 0; i < curve.sigma.size(); ++i) {
    above[i] += curve.sigma[i];
    below[i] -= curve.sigma[i];
  }
  std::vector<std::vector<Eigen::Vector2d>> edges;
  for_each_stretch(times, frame, panel, above,
                   [&](const auto& points) { edges.push_back(points); });
  std::size_t next = 0;
  for_each_stretch(times, frame, panel, below, [&](const auto& points) {
    if (next < edges.size()) {
      std::vector<Eigen::Vector2d> area = edges[next++];
      area.insert(area.end(), points.rbegin(), points.rend());
      svg.polygon(area, curve.color, 0.25);
      area.push_back(area.front());
      svg.polyline(area, {.color = curve.color, .width = 0.7});
    }
  });
}

void draw_curve(SvgDocument& svg, std::span<const double> times, const Frame& frame,
                const TimePanel& panel, const Curve& curve) {
  if (!curve.sigma.empty()) {
    draw_sigma(svg, times, frame, panel, curve);
  }
  for_each_stretch(times, frame, panel, curve.values, [&](const auto& points) {
    if (curve.dots || points.size() == 1) {
      for (const Eigen::Vector2d& point : points) {
        svg.circle(point, 1.4, curve.color, {.color = curve.color, .width = 0.0});
      }
    } else {
      svg.polyline(points, {.color = curve.color, .width = 1.3, .dash = curve.dash});
    }
  });
}

void draw_bands(SvgDocument& svg, std::span<const double> times, const Frame& frame,
                const TimePanel& panel) {
  for (std::size_t row = 0; row < panel.bands.size(); ++row) {
    const Band& band = panel.bands[row];
    const double top = frame.top + kBand * static_cast<double>(row);
    svg.text({frame.left - 6.0, top + 11.5}, band.name,
             {.size = 11.0, .color = kAxisColor, .anchor = SvgAnchor::end});
    for (std::size_t i = 0; i < times.size();) {
      std::size_t end = i + 1;
      while (end < times.size() && band.values[end] == band.values[i]) {
        ++end;
      }
      if (band.values[i] >= 0) {
        const double left = frame.x(times[i]);
        const double right =
            std::max(left + 1.0, frame.x(end < times.size() ? times[end] : times.back()));
        const std::vector<Eigen::Vector2d> corners = {{left, top + 1.0},
                                                      {right, top + 1.0},
                                                      {right, top + kBand - 1.0},
                                                      {left, top + kBand - 1.0}};
        svg.polygon(corners, panel.classes[static_cast<std::size_t>(band.values[i])].color, 0.85);
      }
      i = end;
    }
  }
}

struct LegendEntry {
  std::string_view name;
  std::string_view color;
  std::string_view dash;
  double width() const { return 30.0 + text_width(name, 11.0) + 12.0; }  // px
};

std::vector<LegendEntry> legend_of(const TimePanel& panel) {
  std::vector<LegendEntry> entries;
  for (const BandClass& one : panel.classes) {
    entries.push_back({one.name, one.color, ""});
  }
  for (const Curve& curve : panel.curves) {
    if (!curve.name.empty()) {
      entries.push_back({curve.name, curve.color, curve.dash});
    }
  }
  return entries;
}

/// Title and legend: beside each other where there is room, else below each other in as many lines
/// as they need. Returns where the panel begins.
double draw_head(SvgDocument& svg, const TimePanel& panel, double top, double left, double right) {
  constexpr double kLine = 17.0;  // px
  const std::vector<LegendEntry> entries = legend_of(panel);
  double wanted = 0.0;
  for (const LegendEntry& entry : entries) {
    wanted += entry.width();
  }
  double y = top + 26.0;
  const double title = text_width(panel.title, 12.0) * 1.12;  // in bold
  const bool beside = title + wanted < right - left;
  const double begin = right - left < 500.0 ? 8.0 : left;
  const double lines = svg.paragraph({begin, y}, panel.title, right,
                                     {.size = 12.0, .color = kTextColor, .bold = true});
  y += beside ? 0.0 : lines;
  double x = beside ? right - wanted : begin;
  for (const LegendEntry& entry : entries) {
    if (!beside && x > begin && x + entry.width() > right) {
      x = begin;
      y += kLine;
    }
    svg.line({x, y - 4.0}, {x + 18.0, y - 4.0},
             {.color = entry.color, .width = 3.0, .dash = entry.dash});
    svg.text({x + 23.0, y}, entry.name, {.size = 11.0, .color = kAxisColor});
    x += entry.width();
  }
  return (entries.empty() && !beside ? y - kLine : y) + 8.0;
}

void draw_gates(SvgDocument& svg, const Frame& frame, const TimePanel& panel) {
  for (const Gate& gate : panel.gates) {
    const double y = frame.y(scaled(panel, gate.value));
    svg.line({frame.left, y}, {frame.right, y}, {.color = kGateColor, .width = 1.2, .dash = "7 4"});
    const double below = y < frame.top + 16.0 ? 13.0 : -4.0;
    svg.text(
        {frame.right - 5.0, y + below}, gate.name,
        {.size = 11.0, .color = kTextColor, .anchor = SvgAnchor::end, .bold = true, .halo = true});
  }
}

}  // namespace

std::string draw_time_panels(std::span<const double> times, std::span<const TimePanel> panels,
                             double width, std::string_view axis) {
  const double left = left_of(width);
  const double right = width - kRightMargin;
  SvgDocument sketch(width, 1.0);  // heights are known once heads are laid out
  std::vector<const TimePanel*> shown;
  double height = kFoot;
  for (const TimePanel& panel : panels) {
    if (!times.empty() && shows_something(panel)) {
      shown.push_back(&panel);
      height += draw_head(sketch, panel, 0.0, left, right) + height_of(panel);
    }
  }
  if (shown.empty()) {
    return {};
  }
  SvgDocument svg(width, height);
  const double last = std::max(times.back(), times.front() + 1e-3);
  double top = 0.0;
  for (const TimePanel* panel : shown) {
    const Frame frame{.left = left,
                      .right = right,
                      .top = draw_head(svg, *panel, top, left, right),
                      .height = height_of(*panel),
                      .time = {times.front(), last},
                      .value = range_of(*panel)};
    draw_times_axis(svg, frame, panel == shown.back() ? axis : "");
    if (panel->bands.empty()) {
      draw_values_axis(svg, frame, *panel);
      for (const Curve& curve : panel->curves) {
        draw_curve(svg, times, frame, *panel, curve);
      }
      draw_gates(svg, frame, *panel);
    } else {
      draw_bands(svg, times, frame, *panel);
    }
    svg.rectangle({left, frame.top}, {right - left, frame.height}, {.color = kAxisColor});
    top = frame.top + frame.height;
  }
  return svg.str();
}

}  // namespace adit
