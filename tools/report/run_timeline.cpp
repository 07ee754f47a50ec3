// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/run_timeline.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/drawing/html_page.hpp"
#include "adit/tools/drawing/markup.hpp"
#include "adit/tools/drawing/svg.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using TimePoint = std::chrono::steady_clock::time_point;

constexpr double kShortest = 0.01;       // ms
constexpr std::size_t kDrawnSweeps = 8;  // in a drawing

double ms_between(TimePoint begin, TimePoint end) {
  return ClockSpan{.begin = begin, .end = end}.ms();
}

/// From the first begin to the last end.
ClockSpan extent_of(const std::vector<TimelineSpan>& spans) {
  ClockSpan extent{.begin = TimePoint::max(), .end = TimePoint::min()};
  for (const TimelineSpan& span : spans) {
    extent.begin = std::min(extent.begin, span.span.begin);
    extent.end = std::max(extent.end, span.span.end);
  }
  return extent;
}

/// When the host began with each sweep and when its results were written, by its number.
std::map<std::size_t, ClockSpan> placings_of(const std::vector<TimelineSpan>& spans) {
  std::map<std::size_t, ClockSpan> placings;
  for (const TimelineSpan& span : spans) {
    if (span.lane == TimelineLane::reader || span.waits) {
      continue;
    }
    const auto [found, added] = placings.emplace(span.sweep, span.span);
    if (!added) {
      found->second.begin = std::min(found->second.begin, span.span.begin);
      found->second.end = std::max(found->second.end, span.span.end);
    }
  }
  return placings;
}

/// What some sweeps about number `center` took, the sweeps as `placings` has them.
ClockSpan stretch_about(const std::map<std::size_t, ClockSpan>& placings, std::size_t center) {
  const std::size_t first = center - std::min(center, kDrawnSweeps / 2);
  auto begin = placings.lower_bound(first);
  auto end = placings.lower_bound(first + kDrawnSweeps);
  if (begin == end) {
    return {};
  }
  return {.begin = begin->second.begin, .end = std::prev(end)->second.end};
}

std::string_view color_of(const TimelineSpan& span) {
  return span.waits ? kGridColor : kSeriesColors[static_cast<std::size_t>(span.lane)];
}

/// The lanes within a stretch, times in ms from its beginning.
std::string draw(const std::vector<TimelineSpan>& spans, const ClockSpan& stretch, double width) {
  constexpr double kLeft = 56.0;
  constexpr double kRight = 12.0;
  constexpr double kLane = 26.0;
  constexpr double kBar = 18.0;
  const double bottom = kLane * static_cast<double>(kTimelineLanes.size()) + 4.0;
  const double scale = (width - kLeft - kRight) / std::max(stretch.ms(), 1e-6);  // px a ms
  const auto x_of = [&](double ms) { return kLeft + scale * ms; };
  SvgDocument svg(width, bottom + 40.0);
  const std::vector<double> ticks = round_ticks(0.0, stretch.ms(), width > 600.0 ? 10 : 5);
  for (const double tick : ticks) {
    svg.line({x_of(tick), 0.0}, {x_of(tick), bottom}, {.color = kGridColor});
    svg.text({x_of(tick), bottom + 16.0},
             tick_label(tick, ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0),
             {.anchor = SvgAnchor::middle});
  }
  svg.text({x_of(stretch.ms() / 2.0), bottom + 34.0}, "time (ms)", {.anchor = SvgAnchor::middle});
  for (std::size_t i = 0; i < kTimelineLanes.size(); ++i) {
    svg.text({kLeft - 8.0, kLane * static_cast<double>(i) + 17.0}, to_string(kTimelineLanes[i]),
             {.anchor = SvgAnchor::end});
  }
  for (const TimelineSpan& span : spans) {
    const double begin = std::max(ms_between(stretch.begin, span.span.begin), 0.0);
    const double end = std::min(ms_between(stretch.begin, span.span.end), stretch.ms());
    if (end <= begin) {
      continue;
    }
    const double top = kLane * static_cast<double>(span.lane) + 4.0;
    const double left = x_of(begin);
    const double right = std::max(x_of(end), left + 0.5);
    const std::array<Eigen::Vector2d, 4> corners = {
        {{left, top}, {right, top}, {right, top + kBar}, {left, top + kBar}}};
    svg.polygon(corners, color_of(span), span.sweep % 2 == 0 ? 1.0 : 0.7);
  }
  return svg.str();
}

/// How long each lane was busy, and its share of the run.
std::string busy_table(const std::vector<TimelineSpan>& spans, std::size_t sweeps) {
  const double wall = std::max(extent_of(spans).ms(), 1e-6);
  std::string rows;
  for (const TimelineLane lane : kTimelineLanes) {
    double busy = 0.0;
    for (const TimelineSpan& span : spans) {
      busy += span.lane == lane && !span.waits ? span.span.ms() : 0.0;
    }
    rows += fmt::format("<tr><td>{}</td><td>{:.2f}</td><td>{:.0f} %</td></tr>\n", to_string(lane),
                        busy / static_cast<double>(std::max<std::size_t>(sweeps, 1)),
                        100.0 * busy / wall);
  }
  return "<table>\n<tr><th>lane</th><th>busy, ms a sweep</th><th>of the time</th></tr>\n" + rows +
         "</table>\n";
}

}  // namespace

std::string_view to_string(TimelineLane lane) {
  constexpr std::array<std::string_view, kTimelineLanes.size()> kNames = {"reader", "host",
                                                                          "device", "map", "write"};
  return kNames[static_cast<std::size_t>(lane)];
}

void RunTimeline::add(const TimelineSpan& span) {
  if (spans_.size() < most_ && span.span.ms() >= kShortest) {
    spans_.push_back(span);
  }
}

std::string RunTimeline::to_json() const {
  using nlohmann::ordered_json;
  ordered_json events = ordered_json::array();
  for (const TimelineLane lane : kTimelineLanes) {
    events.push_back({{"name", "thread_name"},
                      {"ph", "M"},
                      {"pid", 0},
                      {"tid", static_cast<int>(lane)},
                      {"args", {{"name", to_string(lane)}}}});
  }
  const TimePoint start = extent_of(spans_).begin;
  for (const TimelineSpan& span : spans_) {
    events.push_back({{"name", span.waits ? "waits" : to_string(span.lane)},
                      {"ph", "X"},
                      {"pid", 0},
                      {"tid", static_cast<int>(span.lane)},
                      {"ts", 1e3 * ms_between(start, span.span.begin)},
                      {"dur", 1e3 * span.span.ms()},
                      {"args", {{"sweep", span.sweep}}}});
  }
  return ordered_json{{"traceEvents", events}, {"displayTimeUnit", "ms"}}.dump() + "\n";
}

std::string RunTimeline::to_html(const std::string& title) const {
  const std::map<std::size_t, ClockSpan> placings = placings_of(spans_);
  std::string body = "<h1>" + escape_markup(title) + "</h1>\n";
  if (placings.empty()) {
    return html_page(title, body + "<p>No sweep was placed.</p>\n");
  }
  body +=
      fmt::format("<p>What worked when, over {} sweeps in {:.1f} s. Grey: the host waits.</p>\n",
                  placings.size(), extent_of(spans_).ms() / 1e3);
  body += busy_table(spans_, placings.size());
  const auto add_drawing = [&](const std::string& heading, std::size_t sweep) {
    body += "<h2>" + heading + fmt::format(": about sweep {}</h2>\n", sweep);
    const ClockSpan stretch = stretch_about(placings, sweep);
    body += html_drawing([&](double width) { return draw(spans_, stretch, width); });
  };
  const auto middle = std::next(placings.begin(), static_cast<std::ptrdiff_t>(placings.size() / 2));
  const auto slowest = std::ranges::max_element(
      placings, {}, [](const auto& placing) { return placing.second.ms(); });
  add_drawing("The middle", middle->first);
  add_drawing("The slowest", slowest->first);
  return html_page(title, body);
}

void require_timeline_name(const std::filesystem::path& file) {
  if (file.extension() != ".html" && file.extension() != ".json") {
    throw UsageError("--timeline " + file.string() + ": the name must end with .html or .json.");
  }
}

void write_timeline(const RunTimeline& timeline, const std::filesystem::path& file,
                    const std::string& title) {
  write_text_file(file, file.extension() == ".json" ? timeline.to_json() : timeline.to_html(title));
}

}  // namespace adit
