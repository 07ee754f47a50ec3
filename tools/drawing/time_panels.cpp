// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/time_panels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "adit/tools/drawing/svg.hpp"

namespace adit {
namespace {

constexpr double kWidth = 960.0;   // px
constexpr double kLeft = 110.0;    // px
constexpr double kRight = 20.0;    // px
constexpr double kTitle = 34.0;    // px above a panel
constexpr double kHeight = 110.0;  // px, of a panel with curves
constexpr double kBand = 15.0;     // px, of a band
constexpr double kFoot = 44.0;     // px below the last panel
constexpr std::string_view kAxisColor = "#555555";
constexpr std::string_view kGridColor = "#e4e4e4";
constexpr std::string_view kTextColor = "#000000";

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
  double top = 0.0;
  double height = kHeight;
  Range time;
  Range value;

  double x(double t) const {
    const double share = (t - time.low) / (time.high - time.low);
    return kLeft + (kWidth - kLeft - kRight) * share;
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
    svg.line({kLeft, y}, {kWidth - kRight, y}, {.color = kGridColor});
    svg.text({kLeft - 6.0, y + 4.0}, tick_label(value, panel.logarithmic ? value : step_of(ticks)),
             {.size = 11.0, .color = kAxisColor, .anchor = SvgAnchor::end});
  }
}

/// `name` is empty where another panel below has the labels.
void draw_times_axis(SvgDocument& svg, const Frame& frame, std::string_view name) {
  const std::vector<double> ticks = round_ticks(frame.time.low, frame.time.high, 10);
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
    svg.text({0.5 * (kLeft + kWidth - kRight), bottom + 34.0}, name,
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
      svg.polygon(area, curve.color, 0.16);
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
    svg.text({kLeft - 6.0, top + 11.5}, band.name,
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

/// Right of the title, from the right edge.
void draw_legend(SvgDocument& svg, double y, const TimePanel& panel) {
  double x = kWidth - kRight;
  const auto entry = [&](const std::string& name, std::string_view color, std::string_view dash) {
    x -= 6.6 * static_cast<double>(name.size());
    svg.text({x, y}, name, {.size = 11.0, .color = kAxisColor});
    svg.line({x - 22.0, y - 4.0}, {x - 5.0, y - 4.0}, {.color = color, .width = 3.0, .dash = dash});
    x -= 36.0;
  };
  for (auto one = panel.classes.rbegin(); one != panel.classes.rend(); ++one) {
    entry(one->name, one->color, "");
  }
  for (auto one = panel.curves.rbegin(); one != panel.curves.rend(); ++one) {
    if (!one->name.empty()) {
      entry(one->name, one->color, one->dash);
    }
  }
}

void draw_gates(SvgDocument& svg, const Frame& frame, const TimePanel& panel) {
  for (const Gate& gate : panel.gates) {
    const double y = frame.y(scaled(panel, gate.value));
    svg.line({kLeft, y}, {kWidth - kRight, y}, {.color = kPlotOrange, .width = 1.2, .dash = "7 4"});
    const double below = y < frame.top + 16.0 ? 13.0 : -4.0;
    svg.text(
        {kWidth - kRight - 5.0, y + below}, gate.name,
        {.size = 11.0, .color = kPlotOrange, .anchor = SvgAnchor::end, .bold = true, .halo = true});
  }
}

}  // namespace

std::string draw_time_panels(std::span<const double> times, std::span<const TimePanel> panels,
                             std::string_view axis) {
  std::vector<const TimePanel*> shown;
  double height = kFoot;
  for (const TimePanel& panel : panels) {
    if (!times.empty() && shows_something(panel)) {
      shown.push_back(&panel);
      height += kTitle + height_of(panel);
    }
  }
  if (shown.empty()) {
    return {};
  }
  SvgDocument svg(kWidth, height);
  const double last = std::max(times.back(), times.front() + 1e-3);
  double top = 0.0;
  for (const TimePanel* panel : shown) {
    const Frame frame{.top = top + kTitle,
                      .height = height_of(*panel),
                      .time = {times.front(), last},
                      .value = range_of(*panel)};
    svg.text({kLeft, top + kTitle - 8.0}, panel->title,
             {.size = 12.0, .color = kTextColor, .bold = true});
    draw_legend(svg, top + kTitle - 8.0, *panel);
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
    svg.rectangle({kLeft, frame.top}, {kWidth - kLeft - kRight, frame.height},
                  {.color = kAxisColor});
    top += kTitle + frame.height;
  }
  return svg.str();
}

}  // namespace adit
