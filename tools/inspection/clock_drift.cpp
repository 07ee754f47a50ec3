// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/clock_drift.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/core.h>

namespace adit {
namespace {

constexpr std::size_t kLeastBins = 50;
constexpr double kLeastRate = 2e-5;    // s/s: crystals differ by as much
constexpr double kHarmless = 5e-3;     // s, over the recording
constexpr double kLongestDelay = 1.0;  // s: beyond, clocks leap or count from elsewhere
constexpr double kSure = 8.0;          // standard deviations

/// When (s), and the shortest delay then (s).
struct Sample {
  double time = 0.0;
  double delay = 0.0;
};

struct Line {
  double slope = 0.0;
  double sigma = 0.0;
};

/// By least squares.
Line fit(std::span<const Sample> samples) {
  const auto n = static_cast<double>(samples.size());
  double time = 0.0;
  double delay = 0.0;
  for (const Sample& s : samples) {
    time += s.time / n;
    delay += s.delay / n;
  }
  double tt = 0.0;
  double td = 0.0;
  double dd = 0.0;
  for (const Sample& s : samples) {
    tt += (s.time - time) * (s.time - time);
    td += (s.time - time) * (s.delay - delay);
    dd += (s.delay - delay) * (s.delay - delay);
  }
  const double slope = td / tt;
  const double residuals = std::max(0.0, dd - slope * td);
  return {slope, std::sqrt(residuals / (n - 2.0) / tt)};
}

}  // namespace

std::optional<ClockTrend> clock_trend(const TopicTimeline& timeline) {
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < timeline.bins().size(); ++i) {
    const TopicTimeline::Bin& bin = timeline.bins()[i];
    if (bin.events > 0.0) {
      samples.push_back({timeline.bin_width() * static_cast<double>(i), bin.least_delay});
    }
  }
  if (samples.size() < kLeastBins) {
    return std::nullopt;
  }
  const auto delays = std::ranges::minmax(samples, {}, &Sample::delay);
  if (delays.max.delay - delays.min.delay > kLongestDelay) {
    return std::nullopt;
  }
  const Line whole = fit(samples);
  const std::span all(samples);
  const double first = fit(all.first(all.size() / 2)).slope;
  const double second = fit(all.subspan(all.size() / 2)).slope;
  constexpr double kAlike = 0.5;
  const double least = kAlike * std::abs(whole.slope);
  if (std::abs(first - whole.slope) > least || std::abs(second - whole.slope) > least) {
    return std::abs(whole.slope) < kLeastRate
               ? std::optional(ClockTrend{0.0, whole.sigma, samples.back().time})
               : std::nullopt;
  }
  return ClockTrend{-whole.slope, whole.sigma, samples.back().time};
}

std::vector<Finding> find_clock_drift(const std::vector<Topic>& topics,
                                      const std::vector<TopicStatistics>& statistics,
                                      std::optional<std::size_t> range) {
  std::vector<Finding> findings;
  if (!range) {
    return findings;
  }
  const Topic& sweeps = topics[*range];
  const auto reference = clock_trend(statistics[*range].timeline);
  for (std::size_t i = 0; i < topics.size() && reference; ++i) {
    const bool sensor = topics[i].kind == TopicKind::imu || topics[i].kind == TopicKind::sweeps ||
                        topics[i].kind == TopicKind::gnss ||
                        topics[i].kind == TopicKind::velocities ||
                        topics[i].kind == TopicKind::headings;
    const auto trend = sensor ? clock_trend(statistics[i].timeline) : std::nullopt;
    if (!trend) {
      continue;
    }
    const double rate = trend->rate - reference->rate;
    const double sigma = std::hypot(trend->sigma, reference->sigma);
    const double gained = rate * trend->span;
    if (std::abs(rate) < kLeastRate + kSure * sigma || std::abs(gained) < kHarmless) {
      continue;
    }
    const std::string found = fmt::format(
        "its clock runs {:.0f} ppm {} than that of {} (+- {:.0f}): {:.1f} ms over the recording",
        1e6 * std::abs(rate), rate > 0.0 ? "faster" : "slower", sweeps.name, 1e6 * kSure * sigma,
        1e3 * std::abs(gained));
    findings.push_back({Severity::problem, "clock_drift", topics[i].name, found,
                        "what fits at the start does not at the end",
                        "Synchronise the clocks (PTP, GPS, NTP); until then map it in pieces"});
  }
  return findings;
}

}  // namespace adit
