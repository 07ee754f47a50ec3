// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The page: what was measured on, the roofline, how each case scales, and all figures.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <sstream>

#include "adit/benchmarks/kernels/report.hpp"
#include "adit/tools/drawing/html_page.hpp"
#include "adit/tools/drawing/markup.hpp"
#include "adit/tools/drawing/svg.hpp"

namespace adit::bench {
namespace {

constexpr double kHeight = 400.0;  // px, of the chart alone
constexpr double kRight = 24.0;
constexpr double kTop = 20.0;
constexpr double kBottom = 50.0;

/// The colours, then again with dashes.
SvgStroke stroke_of(std::size_t index) {
  constexpr std::array<std::string_view, 4> kDashes = {"", "7 4", "2 3", "9 3 2 3"};
  return {kSeriesColors[index % kSeriesColors.size()], 1.8,
          kDashes[index / kSeriesColors.size() % kDashes.size()]};
}

std::string digits(double value) {
  std::ostringstream text;
  text.precision(3);
  text << value;
  return text.str();
}

// 1000 as 1 k, 1/100 as 0.01.
std::string power_label(int exponent) {
  constexpr std::array<std::string_view, 3> kUnits = {"", " k", " M"};
  if (exponent >= 9) {
    return "1e" + std::to_string(exponent);
  }
  if (exponent < 0) {
    return "0." + std::string(static_cast<size_t>(-exponent - 1), '0') + "1";
  }
  const auto thousands = static_cast<size_t>(exponent / 3);
  return (exponent % 3 == 0 ? "1" : (exponent % 3 == 1 ? "10" : "100")) +
         std::string(kUnits[thousands]);
}

struct Series {
  std::string name;
  std::vector<Eigen::Vector2d> points;
};

// A chart with both axes logarithmic, its legend below.
class LogChart {
 public:
  /// `shown` are in the legend; `framed` too must fit in.
  LogChart(const std::vector<Series>& shown, const std::vector<Series>& framed, double width,
           const std::string& x_title, const std::string& y_title)
      : left_(width < 600.0 ? 58.0 : 70.0),
        width_(width),
        svg_(width, kHeight + legend_height(shown, width)) {
    low_.setConstant(1e300);
    high_.setConstant(1e-300);
    for (const std::vector<Series>* group : {&shown, &framed}) {
      for (const Series& one : *group) {
        for (const Eigen::Vector2d& p : one.points) {
          low_ = low_.cwiseMin(p);
          high_ = high_.cwiseMax(p);
        }
      }
    }
    for (int k = 0; k < 2; ++k) {
      low_[k] = std::pow(10.0, std::floor(std::log10(low_[k])));
      high_[k] = std::max(std::pow(10.0, std::ceil(std::log10(high_[k]))), 10.0 * low_[k]);
    }
    axes(x_title, y_title);
    place_legend(shown, width, [&](std::size_t i, const Eigen::Vector2d& at) {
      svg_.line(at - Eigen::Vector2d(0.0, 4.0), at + Eigen::Vector2d(22.0, -4.0), stroke_of(i));
      svg_.text(at + Eigen::Vector2d(28.0, 0.0), shown[i].name, {.size = 12.0});
    });
  }

  Eigen::Vector2d place(const Eigen::Vector2d& p) const {
    const auto part = [&](int k) {
      return (std::log10(p[k]) - std::log10(low_[k])) /
             (std::log10(high_[k]) - std::log10(low_[k]));
    };
    return {left_ + part(0) * (width_ - left_ - kRight),
            kHeight - kBottom - part(1) * (kHeight - kTop - kBottom)};
  }
  const Eigen::Vector2d& low() const { return low_; }
  const Eigen::Vector2d& high() const { return high_; }
  SvgDocument& svg() { return svg_; }

  void curve(const Series& series, std::size_t index) {
    const SvgStroke stroke = stroke_of(index);
    std::vector<Eigen::Vector2d> placed;
    for (const Eigen::Vector2d& p : series.points) {
      placed.push_back(place(p));
    }
    svg_.polyline(placed, stroke);
    for (const Eigen::Vector2d& at : placed) {
      svg_.circle(at, 3.5, stroke.color, {.color = "#ffffff", .width = 1.0});
    }
  }

 private:
  /// Calls put(i, where) for each name, in rows; returns the height of them.
  template <class Put>
  static double place_legend(const std::vector<Series>& shown, double width, Put&& put) {
    constexpr double kLine = 19.0;  // px
    Eigen::Vector2d at(16.0, kHeight + 14.0);
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const double wanted = 28.0 + text_width(shown[i].name, 12.0) + 18.0;
      if (at.x() > 16.0 && at.x() + wanted > width) {
        at = Eigen::Vector2d(16.0, at.y() + kLine);
      }
      put(i, at);
      at.x() += wanted;
    }
    return at.y() + 12.0 - kHeight;
  }
  static double legend_height(const std::vector<Series>& shown, double width) {
    return place_legend(shown, width, [](std::size_t, const Eigen::Vector2d&) {});
  }

  void axes(const std::string& x_title, const std::string& y_title) {
    for (int k = 0; k < 2; ++k) {
      const int first = static_cast<int>(std::lround(std::log10(low_[k])));
      const int last = static_cast<int>(std::lround(std::log10(high_[k])));
      for (int e = first; e <= last; ++e) {
        Eigen::Vector2d from = low_;
        from[k] = std::pow(10.0, e);
        Eigen::Vector2d to = high_;
        to[k] = from[k];
        svg_.line(place(from), place(to), {.color = kGridColor});
        const Eigen::Vector2d at = place(from);
        if (k == 0) {
          svg_.text({at.x(), at.y() + 18.0}, power_label(e),
                    {.color = kAxisColor, .anchor = SvgAnchor::middle});
        } else {
          svg_.text({at.x() - 8.0, at.y() + 4.0}, power_label(e),
                    {.color = kAxisColor, .anchor = SvgAnchor::end});
        }
      }
    }
    svg_.rectangle({left_, kTop}, {width_ - left_ - kRight, kHeight - kTop - kBottom},
                   {.color = kAxisColor});
    svg_.text({0.5 * (left_ + width_ - kRight), kHeight - 10.0}, x_title,
              {.size = 13.0, .color = kAxisColor, .anchor = SvgAnchor::middle});
    svg_.text({15.0, 0.5 * (kTop + kHeight - kBottom)}, y_title,
              {.size = 13.0, .color = kAxisColor, .anchor = SvgAnchor::middle, .upwards = true});
  }

  double left_;
  double width_;
  SvgDocument svg_;
  Eigen::Vector2d low_;
  Eigen::Vector2d high_;
};

// Rows by case, in their order, as the function places them; cases without a place are left out.
std::vector<Series> series_of(
    const Report& report, const std::function<std::optional<Eigen::Vector2d>(const Row&)>& place) {
  std::vector<Series> all;
  for (const Row& row : report.rows) {
    const std::optional<Eigen::Vector2d> at = place(row);
    if (!at || !row.problem.empty()) {
      continue;
    }
    if (all.empty() || all.back().name != row.name) {
      all.push_back({.name = row.name, .points = {}});
    }
    all.back().points.push_back(*at);
  }
  return all;
}

std::string chart(const std::vector<Series>& series, const std::string& x, const std::string& y) {
  if (series.empty()) {
    return "<p>Nothing of this was measured.</p>";
  }
  return html_drawing([&](double width) {
    LogChart made(series, {}, width, x, y);
    for (std::size_t i = 0; i < series.size(); ++i) {
      made.curve(series[i], i);
    }
    return made.svg().str();
  });
}

std::string roofline(const Report& report) {
  std::vector<Series> series = series_of(report, [](const Row& row) {
    const double ms = row.timing.best().median;
    return row.cost.flop > 0.0 && row.cost.bytes > 0.0
               ? std::optional(
                     Eigen::Vector2d(row.cost.flop / row.cost.bytes, 1e-6 * row.cost.flop / ms))
               : std::nullopt;
  });
  if (series.empty()) {
    return "<p>No case with counted work was measured.</p>";
  }
  const double flop = 1e-9 * report.limits.flop;
  const double bytes = 1e-9 * report.limits.copy_bytes;
  const std::vector<Series> roofs = {
      {.name = "", .points = {{0.3, flop}, {100.0, flop}, {0.3, 0.3 * bytes}}}};
  return html_drawing([&](double width) {
    LogChart made(series, roofs, width, "FLOP a byte that has to move", "GFLOP/s");
    const Eigen::Vector2d ridge(flop / bytes, flop);
    const double left = std::max(made.low().x(), made.low().y() / bytes);
    const SvgStroke roof{.color = kTextColor, .width = 2.0};
    made.svg().line(made.place({left, left * bytes}), made.place(ridge), roof);
    made.svg().line(made.place(ridge), made.place({made.high().x(), flop}), roof);
    for (std::size_t i = 0; i < series.size(); ++i) {
      made.curve(series[i], i);
    }
    made.svg().text(made.place({made.high().x(), flop}) + Eigen::Vector2d(-6.0, -8.0),
                    "multiply-add " + digits(flop) + " GFLOP/s",
                    {.anchor = SvgAnchor::end, .halo = true});
    made.svg().text(made.place({left, left * bytes}) + Eigen::Vector2d(36.0, -4.0),
                    "copy " + digits(bytes) + " GB/s", {.halo = true});
    return made.svg().str();
  });
}

std::string cell(const std::optional<Spread>& spread) {
  return spread ? "<td>" + digits(spread->median) + " <small>" + digits(spread->low) + " to " +
                      digits(spread->high) + "</small></td>"
                : "<td></td>";
}

std::string table(const Report& report) {
  std::ostringstream out;
  out << "<table><tr><th>case<th>size<th>items<th>runs<th>device ms<th>submit to wait ms<th>host "
         "ms<th>ns an item<th>GB/s<th>GFLOP/s<th>share of the limit<th>times its peer<th "
         "class=left>verified by<th class=left>result</tr>\n";
  for (const Row& row : report.rows) {
    out << "<tr><td>" << escape_markup(row.name) << "</td><td>" << row.size << "</td><td>"
        << row.items << "</td>";
    if (!row.problem.empty()) {
      out << "<td colspan=11 class=\"left wrong\">wrong, not timed: " << escape_markup(row.problem)
          << "</td></tr>\n";
      continue;
    }
    const double ms = row.timing.best().median;
    const Bound bound = bound_of(row.cost, report.limits);
    const Row* peer = peer_of(row, report);
    out << "<td>" << row.timing.runs << "</td>" << cell(row.timing.device) << cell(row.timing.wait)
        << cell(row.timing.host) << "<td>" << digits(row.ns_an_item()) << "</td>";
    if (bound.ms > 0.0) {
      out << "<td>" << digits(1e-6 * row.cost.bytes / ms) << "</td><td>"
          << digits(1e-6 * row.cost.flop / ms) << "</td><td>"
          << (limits_hold(report) ? digits(100.0 * bound.ms / ms) + " % of " + bound.by : "void")
          << "</td>";
    } else {
      out << "<td></td><td></td><td></td>";
    }
    out << "<td>";
    if (peer != nullptr && peer->problem.empty()) {
      out << digits(ms / peer->timing.best().median) << " <small>" << escape_markup(peer->name)
          << "</small>";
    }
    out << "</td><td class=left>" << escape_markup(row.verified_by) << "</td><td class=left>";
    const char* separator = "";
    for (const auto& [name, value] : row.figures) {
      out << separator << escape_markup(name) << " " << digits(value);
      separator = ", ";
    }
    out << "</td></tr>\n";
  }
  out << "</table>\n";
  return out.str();
}

}  // namespace

std::string to_html(const Report& report) {
  const Setting& s = report.setting;
  const DeviceLimits& l = report.limits;
  const auto scaling = [&](CaseKind kind) {
    const double unit = kind == CaseKind::batch ? 1e-6 : 1.0;
    return series_of(report, [kind, unit](const Row& row) {
      const Eigen::Vector2d at(static_cast<double>(row.items), unit * row.ns_an_item());
      return row.kind == kind ? std::optional(at) : std::nullopt;
    });
  };
  std::ostringstream out;
  out << "<h1>" << escape_markup(s.device) << "</h1>\n<dl><dt>driver<dd>" << escape_markup(s.driver)
      << " " << escape_markup(s.driver_version) << ", Vulkan " << escape_markup(s.vulkan)
      << (s.software ? ", software" : "") << "<dt>host<dd>" << escape_markup(s.host) << ", "
      << s.threads << " threads<dt>adit<dd>" << escape_markup(s.version) << " ("
      << escape_markup(s.commit) << "), " << escape_markup(s.date) << "<dt>peers<dd>"
      << escape_markup(s.peers) << "<dt>clouds<dd>" << escape_markup(s.input)
      << "</dl>\n<h2>Limits of the device, measured in the same run</h2>\n"
      << "<div class=scroll><table><tr><th>limit<th>value</tr><tr><td>copy, read and written bytes "
         "counted<td>"
      << digits(1e-9 * l.copy_bytes) << " GB/s</tr><tr><td>float32 multiply-adds, 2 each<td>"
      << digits(1e-9 * l.flop) << " GFLOP/s</tr><tr><td>64-byte reads at random places of 1 MiB<td>"
      << digits(1e-6 * l.near_reads) << " M/s</tr><tr><td>of 64 MiB<td>" << digits(1e-6 * l.reads)
      << " M/s</tr><tr><td>integer atomic additions at random places of 1 MiB<td>"
      << digits(1e-6 * l.atomics) << " M/s</tr><tr><td>a further dispatch after a barrier<td>"
      << digits(1e6 * l.dispatch_s) << " us</tr><tr><td>an empty submission and its wait<td>"
      << digits(1e6 * l.submission_s)
      << " us</tr></table></div>\n<p>The better of two measurements, "
         "at the beginning and the end. What moved most: "
      << report.limits_moved.which << ", by " << digits(100.0 * (report.limits_moved.ratio - 1.0))
      << (limits_hold(report) ? " %." : " %: the machine was disturbed, and shares are void.")
      << "</p>\n"
      << "<h2>Roofline</h2>\n<p>Work and bytes are what a kernel has to do at least; what stays in "
         "caches can be above the slanted roof. Dots of a case: its sizes.</p>\n"
      << roofline(report) << "\n<h2>Scaling of kernels</h2>\n"
      << chart(scaling(CaseKind::kernel), "items", "ns an item, device clock")
      << "\n<h2>Scaling of registrations</h2>\n"
      << chart(scaling(CaseKind::registration), "points", "ns a point, host clock")
      << "\n<h2>Batches</h2>\n"
      << chart(scaling(CaseKind::batch), "pairs of a batch", "ms a pair, host clock")
      << "\n<h2>Peers on the host</h2>\n"
      << chart(scaling(CaseKind::peer), "points", "ns a point, host clock")
      << "\n<h2>All figures</h2>\n<p>Medians, with the 10th to 90th percentile. The share of the "
         "limit is the least time that the tightest limit allows, over the time "
         "measured.</p>\n<div class=scroll>\n"
      << table(report) << "</div>\n";
  return html_page("adit bench: " + s.device, out.str());
}

}  // namespace adit::bench
