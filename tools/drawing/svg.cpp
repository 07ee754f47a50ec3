// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/svg.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "adit/slam/core/text.hpp"
#include "adit/tools/drawing/markup.hpp"

namespace adit {
namespace {

constexpr double kVisibleStep = 1.0 / 3.0;  // px

// What the colours of our drawings become where the reader prefers dark pages. Programs that know
// no style sheets show the light ones.
constexpr std::array<std::array<std::string_view, 2>, 15> kDarkColors = {
    {{"#ffffff", "#15181c"},
     {kTextColor, "#eceff3"},
     {kAxisColor, "#b4bac2"},
     {kGridColor, "#2d3238"},
     {"#3c3c3c", "#cfd3d8"},
     {kGateColor, "#f0a33c"},
     {kGoodColor, "#35c496"},
     {kMiddlingColor, "#f5c542"},
     {kBadColor, "#e5636a"},
     {kUnknownColor, "#8a9099"},
     {kSeriesColors[0], "#4ba6ee"},
     {kSeriesColors[1], "#ff8a3d"},
     {kSeriesColors[3], "#dd8abf"},
     {kSeriesColors[4], "#8fd0f7"},
     {kSeriesColors[5], "#c9a35a"}}};

std::string dark_style() {
  std::string style = "<style>@media (prefers-color-scheme: dark) {";
  for (const auto& [light, dark] : kDarkColors) {
    for (const std::string_view what : {"fill", "stroke"}) {
      style += " [" + std::string(what) + "=\"" + std::string(light) + "\"] { " +
               std::string(what) + ": " + std::string(dark) + "; }";
    }
  }
  return style + " }</style>\n";
}

/// A number as SVG wants it, whatever the locale; one hundredth of a pixel is enough.
std::string number(double value) {
  return with_decimals(std::clamp(value, -1e6, 1e6), 2);
}

std::string attribute(std::string_view name, double value) {
  return " " + std::string(name) + "=\"" + number(value) + "\"";
}

std::string attribute(std::string_view name, std::string_view value) {
  return " " + std::string(name) + "=\"" + std::string(value) + "\"";
}

std::string stroke_attributes(const SvgStroke& stroke) {
  std::string text = attribute("stroke", stroke.color) + attribute("stroke-width", stroke.width);
  return stroke.dash.empty() ? text : text + attribute("stroke-dasharray", stroke.dash);
}

std::string point_list(std::span<const Eigen::Vector2d> points) {
  std::string list;
  const Eigen::Vector2d* last = nullptr;
  for (const Eigen::Vector2d& point : points) {
    if (last != nullptr && &point != &points.back() && (point - *last).norm() < kVisibleStep) {
      continue;
    }
    last = &point;
    list += (list.empty() ? "" : " ") + number(point.x()) + "," + number(point.y());
  }
  return list;
}

}  // namespace

SvgDocument::SvgDocument(double width, double height)
    : head_("<svg xmlns=\"http://www.w3.org/2000/svg\" data-generator=\"adit\"" +
            attribute("width", width) + attribute("height", height) + " viewBox=\"0 0 " +
            number(width) + " " + number(height) +
            "\" style=\"max-width:100%;height:auto\" font-family=\"DejaVu Sans, Helvetica, Arial, "
            "sans-serif\">\n" +
            dark_style() +
            "<rect width=\"100%\" "
            "height=\"100%\" "
            "fill=\"#ffffff\"/>\n") {}

void SvgDocument::line(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                       const SvgStroke& stroke) {
  body_ += "<line" + attribute("x1", from.x()) + attribute("y1", from.y()) +
           attribute("x2", to.x()) + attribute("y2", to.y()) + stroke_attributes(stroke) + "/>\n";
}

void SvgDocument::polyline(std::span<const Eigen::Vector2d> points, const SvgStroke& stroke) {
  body_ += R"(<polyline fill="none" stroke-linejoin="round")" + stroke_attributes(stroke) +
           attribute("points", point_list(points)) + "/>\n";
}

void SvgDocument::polygon(std::span<const Eigen::Vector2d> points, std::string_view fill,
                          double opacity) {
  body_ += "<polygon" + attribute("fill", fill) + attribute("fill-opacity", opacity) +
           attribute("points", point_list(points)) + "/>\n";
}

void SvgDocument::rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size,
                            const SvgStroke& stroke) {
  body_ += "<rect fill=\"none\"" + attribute("x", corner.x()) + attribute("y", corner.y()) +
           attribute("width", size.x()) + attribute("height", size.y()) +
           stroke_attributes(stroke) + "/>\n";
}

void SvgDocument::circle(const Eigen::Vector2d& center, double radius, std::string_view fill,
                         const SvgStroke& stroke) {
  body_ += "<circle" + attribute("cx", center.x()) + attribute("cy", center.y()) +
           attribute("r", radius) + attribute("fill", fill) + stroke_attributes(stroke) + "/>\n";
}

void SvgDocument::square(const Eigen::Vector2d& center, double side, std::string_view fill,
                         const SvgStroke& stroke) {
  body_ += "<rect" + attribute("x", center.x() - 0.5 * side) +
           attribute("y", center.y() - 0.5 * side) + attribute("width", side) +
           attribute("height", side) + attribute("fill", fill) + stroke_attributes(stroke) + "/>\n";
}

double SvgDocument::paragraph(const Eigen::Vector2d& at, std::string_view text, double right,
                              const SvgFont& font) {
  const double line_height = 1.6 * font.size;
  double height = 0.0;
  const auto put = [&](const std::string& line) {
    this->text(at + Eigen::Vector2d(0.0, height), line, font);
    height += line_height;
  };
  std::string line;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word(text.substr(begin, end - begin));
    const std::string longer = line.empty() ? word : line + " " + word;
    if (!line.empty() && text_width(longer, font.size) > right - at.x()) {
      put(line);
      line = word;
    } else {
      line = longer;
    }
    begin = end + 1;
  }
  if (!line.empty()) {
    put(line);
  }
  return height;
}

void SvgDocument::text(const Eigen::Vector2d& at, std::string_view text, const SvgFont& font) {
  constexpr std::array<std::string_view, 3> kAnchors = {"start", "middle", "end"};
  body_ += "<text" + attribute("x", at.x()) + attribute("y", at.y()) +
           attribute("font-size", font.size) + attribute("fill", font.color) +
           attribute("text-anchor", kAnchors[static_cast<std::size_t>(font.anchor)]);
  if (font.bold) {
    body_ += attribute("font-weight", "bold");
  }
  if (font.halo) {
    body_ += R"( stroke="#ffffff" stroke-width="4" stroke-linejoin="round" paint-order="stroke")";
  }
  if (font.upwards) {
    body_ += attribute("transform", "rotate(-90 " + number(at.x()) + " " + number(at.y()) + ")");
  }
  body_ += ">" + escape_markup(text) + "</text>\n";
}

// One path a colour: each run of cells is a horizontal stroke.
void SvgDocument::cells(std::span<const CellRuns> runs, const Eigen::Vector2d& corner,
                        double scale) {
  body_ += "<g shape-rendering=\"crispEdges\" stroke-width=\"1.2\" transform=\"translate(" +
           tick_label(corner.x(), 0.01) + " " + tick_label(corner.y(), 0.01) + ") scale(" +
           tick_label(scale, 1e-5) + ")\">\n";
  for (const CellRuns& color : runs) {
    body_ += "<path stroke=\"" + std::string(color.color) + "\" d=\"";
    for (const CellRun& run : color.runs) {
      body_ += "M" + std::to_string(run.column) + " " + std::to_string(run.row) + ".5h" +
               std::to_string(run.count);
    }
    body_ += "\"/>\n";
  }
  body_ += "</g>\n";
}

std::string SvgDocument::str() const {
  return head_ + body_ + "</svg>\n";
}

double text_width(std::string_view text, double font_size) {
  constexpr double kMeanLetter = 0.57;  // times the font size, for the fonts named in the head
  return kMeanLetter * font_size * static_cast<double>(text.size());
}

std::vector<double> round_ticks(double low, double high, int count) {
  const double raw = (high - low) / std::max(count, 1);
  if (!(raw > 0.0) || !std::isfinite(raw)) {
    return {low};
  }
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double mantissa = raw / power;
  const double step = power * (mantissa < 1.5   ? 1.0
                               : mantissa < 3.5 ? 2.0
                               : mantissa < 7.5 ? 5.0
                                                : 10.0);
  std::vector<double> ticks;
  const double first = std::ceil(low / step - 1e-9);
  const double last = std::floor(high / step + 1e-9);
  for (int i = 0; i <= std::min(static_cast<int>(last - first), 10 * count); ++i) {
    ticks.push_back((first + i) * step);
  }
  return ticks;
}

std::string tick_label(double value, double step) {
  const int decimals =
      step > 0.0 ? std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9) : 3;
  std::string label = with_decimals(value, decimals);
  const bool zero = label.find_first_not_of("-0.") == std::string::npos;
  return zero && label.front() == '-' ? label.substr(1) : label;
}

double round_length(double most) {
  if (!(most > 0.0) || !std::isfinite(most)) {
    return 0.0;
  }
  const double power = std::pow(10.0, std::floor(std::log10(most) + 1e-9));
  const double mantissa = most / power + 1e-9;
  return power * (mantissa >= 5.0 ? 5.0 : mantissa >= 2.0 ? 2.0 : 1.0);
}

}  // namespace adit
