// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/inspection_page.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/drawing/html_page.hpp"
#include "adit/tools/drawing/markup.hpp"
#include "adit/tools/drawing/svg.hpp"
#include "adit/tools/evaluation/run_page.hpp"
#include "adit/tools/inspection/motion_plots.hpp"
#include "adit/tools/inspection/recording_inference.hpp"
#include "adit/tools/inspection/unchecked.hpp"

namespace adit {
namespace {

constexpr double kHeight = 150.0;  // px, of one panel with its title and axis

/// A rectangle on the drawing and the ranges of the data that it shows.
struct Panel {
  double left = 0.0;  // px
  double width = 0.0;
  double top = 0.0;
  double height = 92.0;
  double last = 1.0;  // s
  double low = 0.0;
  double high = 1.0;

  Eigen::Vector2d operator()(double x, double y) const {
    return {left + width * x / last, top + height * (high - y) / (high - low)};
  }
};

void draw_frame(SvgDocument& svg, const Panel& panel, std::string_view title) {
  svg.text({panel.left, panel.top - 10.0}, title,
           {.size = 12.0, .color = kTextColor, .bold = true});
  const std::vector<double> values = round_ticks(panel.low, panel.high, 4);
  const double value_step = values.size() > 1 ? values[1] - values[0] : 1.0;
  for (const double y : values) {
    svg.line(panel(0.0, y), panel(panel.last, y), {.color = kGridColor});
    svg.text(panel(0.0, y) + Eigen::Vector2d(-5.0, 3.5), tick_label(y, value_step),
             {.size = 11.0, .color = kAxisColor, .anchor = SvgAnchor::end});
  }
  const std::vector<double> times = round_ticks(0.0, panel.last, 4);
  const double step = times.size() > 1 ? times[1] - times[0] : 1.0;
  for (const double x : times) {
    svg.text(panel(x, panel.low) + Eigen::Vector2d(0.0, 14.0), tick_label(x, step),
             {.size = 11.0, .color = kAxisColor, .anchor = SvgAnchor::middle});
  }
  svg.rectangle({panel.left, panel.top}, {panel.width, panel.height}, {.color = kAxisColor});
}

/// One value a bin, as a line; bins without events have none.
using Value = std::function<double(const TopicTimeline::Bin&)>;

void draw_line(SvgDocument& svg, const Panel& panel, const TopicTimeline& timeline,
               const Value& value) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < timeline.bins().size(); ++i) {
    if (timeline.bins()[i].events > 0.0) {
      const double x = timeline.bin_width() * (static_cast<double>(i) + 0.5);
      points.push_back(panel(std::min(x, panel.last),
                             std::clamp(value(timeline.bins()[i]), panel.low, panel.high)));
    }
  }
  svg.polyline(points, {.color = kSeriesColors[0], .width = 1.3});
}

/// From the bins to so few that the eye can follow.
TopicTimeline::Bin sum_of(std::span<const TopicTimeline::Bin> bins) {
  TopicTimeline::Bin all;
  for (const TopicTimeline::Bin& bin : bins) {
    all.events += bin.events;
  }
  return all;
}

/// Events a second, over spans that hold ten at the usual rate.
void draw_rate(SvgDocument& svg, Panel panel, const TopicStatistics& s) {
  const TopicTimeline& timeline = s.timeline;
  const double wanted = std::max(10.0 * s.period(), panel.last / 200.0);
  const auto group =
      static_cast<std::size_t>(std::max(1.0, std::ceil(wanted / timeline.bin_width() - 1e-9)));
  std::vector<Eigen::Vector2d> rates;
  const std::span<const TopicTimeline::Bin> bins = timeline.bins();
  for (std::size_t i = 0; i + group <= bins.size(); i += group) {
    const double width = timeline.bin_width() * static_cast<double>(group);
    rates.emplace_back(timeline.bin_width() * static_cast<double>(i) + 0.5 * width,
                       sum_of(bins.subspan(i, group)).events / width);
  }
  for (const Eigen::Vector2d& rate : rates) {
    panel.high = std::max(panel.high, 1.15 * rate.y());
  }
  draw_frame(svg, panel, "events a second");
  std::vector<Eigen::Vector2d> points;
  for (const Eigen::Vector2d& rate : rates) {
    points.push_back(panel(std::min(rate.x(), panel.last), rate.y()));
  }
  svg.polyline(points, {.color = kSeriesColors[0], .width = 1.3});
}

void draw_intervals(SvgDocument& svg, Panel panel, const TopicStatistics& s) {
  panel.high = std::max({1100.0 * s.largest_interval(), 2000.0 * s.period(), 1.0});
  draw_frame(svg, panel, "longest interval (ms); gaps in red");
  const TopicTimeline& timeline = s.timeline;
  draw_line(svg, panel, timeline,
            [](const TopicTimeline::Bin& bin) { return 1e3 * bin.largest_interval; });
  // The bins do not tell whose interval it is: what is usual of the slowest series is no gap.
  const double gap = 2.5 * s.slowest_period();
  for (std::size_t i = 0; i < timeline.bins().size(); ++i) {
    const double interval = timeline.bins()[i].largest_interval;
    if (gap > 0.0 && interval > gap) {
      const double x = timeline.bin_width() * (static_cast<double>(i) + 0.5);
      svg.circle(panel(std::min(x, panel.last), 1e3 * interval), 3.5, kBadColor,
                 {.color = kBadColor});
    }
  }
}

/// Least and greatest delay from the stamps to the receipt: flat where the clocks run alike.
void draw_delay(SvgDocument& svg, Panel panel, const TopicStatistics& s) {
  const double spread = std::max(1e3 * (s.delay.greatest - s.delay.least), 1.0);
  panel.low = 1e3 * s.delay.least - 0.1 * spread;
  panel.high = 1e3 * s.delay.greatest + 0.1 * spread;
  draw_frame(svg, panel, "receipt after stamp (ms)");
  draw_line(svg, panel, s.timeline,
            [](const TopicTimeline::Bin& bin) { return 1e3 * bin.least_delay; });
  draw_line(svg, panel, s.timeline,
            [](const TopicTimeline::Bin& bin) { return 1e3 * bin.greatest_delay; });
}

/// The three panels: beside each other where there is room, else below each other.
std::string drawing(const TopicStatistics& s, double width) {
  constexpr double kLeft = 56.0;  // px, for the labels of a panel
  const bool narrow = width < 600.0;
  const double pitch = narrow ? width : (width + 6.0) / 3.0;
  SvgDocument svg(width, narrow ? 3.0 * kHeight : kHeight);
  const double last = s.timeline.bin_width() *
                      static_cast<double>(std::max<std::size_t>(1, s.timeline.bins().size()));
  const auto panel = [&](int i) {
    return Panel{.left = kLeft + (narrow ? 0.0 : pitch * i),
                 .width = pitch - kLeft - 16.0,
                 .top = 28.0 + (narrow ? kHeight * i : 0.0),
                 .last = last};
  };
  draw_rate(svg, panel(0), s);
  draw_intervals(svg, panel(1), s);
  draw_delay(svg, panel(2), s);
  return svg.str();
}

std::string findings_part(const Inspection& inspection) {
  std::string html;
  for (const Finding& f : inspection.findings) {
    const bool problem = f.severity == Severity::problem;
    html += std::string("<div class=\"finding") + (problem ? " problem" : "") + "\"><p><b>" +
            std::string(to_string(f.severity)) + ":</b> " +
            escape_markup((f.topic.empty() ? "" : f.topic + ": ") + f.found) + ".</p>";
    html += f.effect.empty() ? "" : "<p>Effect: " + escape_markup(f.effect) + "</p>";
    html += f.remedy.empty() ? "" : "<p>What to do: " + escape_markup(f.remedy) + "</p>";
    html += "</div>\n";
  }
  if (const std::string text = conclusion(inspection); !text.empty()) {
    html += std::string("<div class=\"finding") + (has_problem(inspection) ? "" : " good") +
            "\"><p>" + escape_markup(text) + ".</p></div>\n";
  }
  return html;
}

std::string topics_part(const Inspection& inspection) {
  std::string html =
      "<div class=\"scroll\"><table><tr><th>topic</th><th class=\"left\">type</th>"
      "<th class=\"left\">kind</th><th>events</th><th>rate (Hz)</th>"
      "<th>span (s)</th><th>longest gap (s)</th><th>MiB</th></tr>\n";
  for (std::size_t i = 0; i < inspection.topics.size(); ++i) {
    const Topic& topic = inspection.topics[i];
    const TopicStatistics& s = inspection.statistics[i];
    html += "<tr><td>" + escape_markup(topic.name) + "</td><td class=\"left\">" +
            escape_markup(topic.type) + "</td><td class=\"left\">" +
            std::string(to_string(topic.kind)) + "</td>";
    if (topic.kind == TopicKind::other) {
      html += "<td>" + (topic.messages ? std::to_string(*topic.messages) : "?") +
              "</td><td></td><td></td><td></td><td></td></tr>\n";
      continue;
    }
    html += "<td>" + std::to_string(s.events) + "</td><td>" + fmt::format("{:.2f}", s.rate()) +
            "</td><td>" + fmt::format("{:.2f}", s.span()) + "</td><td>" +
            fmt::format("{:.3f}", s.largest_interval()) + "</td><td>" +
            fmt::format("{:.2f}", static_cast<double>(s.bytes) / 1048576.0) + "</td></tr>\n";
  }
  return html + "</table></div>\n";
}

/// How the range sensor lies to an IMU, as far as something tells.
std::optional<Eigen::Matrix3d> mounting_of(const Inspection& inspection, std::size_t imu_topic) {
  for (const MotionCheck& check : inspection.motion) {
    if (check.pair.imu_topic == imu_topic) {
      return check.pair.R_range_gyro;
    }
  }
  return std::nullopt;
}

/// The stretch that was mapped to compare the turns: how well it is held, and the comparison.
std::string motion_part(const Inspection& inspection) {
  std::string html;
  for (const MotionCheck& check : inspection.motion) {
    if (check.mapped.empty()) {
      continue;
    }
    const double begin =
        seconds(check.mapped.front().stamp -
                inspection.statistics[check.pair.sweep_topic].stamps.value_or(TimeSpan{}).begin);
    html += "<h2>" + escape_markup(check.pair.sweeps.name + " and " + check.pair.imu.name) +
            "</h2>\n<p>" +
            fmt::format(
                "{} sweeps from {:.1f} s after the first one on, in which the IMU turns most, each "
                "aligned with those before, without the IMU and not de-skewed. <code>adit "
                "run</code> shows the same of all sweeps, and the IMU's innovations.",
                check.mapped.size(), begin) +
            "</p>\n" + html_drawing([review = review_sweeps(check.mapped)](double width) {
              return draw_run(review, width);
            }) +
            html_drawing([&check](double width) { return draw_turns(check, width); });
  }
  return html;
}

}  // namespace

std::string inspection_page(const Inspection& inspection) {
  std::string html = "<h1>" + escape_markup(inspection.description) + "</h1>\n" +
                     findings_part(inspection) + "<h2>Topics</h2>\n" + topics_part(inspection) +
                     "<h2>What was inferred</h2>\n<ul>\n";
  for (const Inference& one : infer(inspection)) {
    html += "<li>" + escape_markup(one.topic + ": " + one.text) + "</li>\n";
  }
  html += "</ul>\n";
  for (std::size_t i = 0; i < inspection.topics.size(); ++i) {
    if (inspection.statistics[i].lasts()) {
      html += "<h2>" + escape_markup(inspection.topics[i].name) + "</h2>\n" +
              html_drawing([&](double width) { return drawing(inspection.statistics[i], width); }) +
              "<p>Times in seconds after the topic's first event.</p>\n";
      html += html_drawing([&](double width) {
        return draw_imu(inspection.statistics[i].imu, mounting_of(inspection, i), width);
      });
    }
  }
  return html_page(inspection.description, html + motion_part(inspection));
}

}  // namespace adit
