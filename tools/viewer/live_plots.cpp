// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/live_plots.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr double kLeastStep = 0.01;  // s
constexpr double kMostStep = 10.0;   // s, to begin with

}  // namespace

/// Which bin that time is in, which is there then.
std::size_t LivePlots::place_for(double seconds, uint64_t version) {
  if (step_ == 0.0 && !bins_.empty()) {
    step_ = std::clamp(seconds, kLeastStep, kMostStep);  // a sweep each
    begin_ = -0.5 * step_;  // so that sweeps that are a little early do not share a bin
  }
  const auto place = [&] { return step_ > 0.0 ? std::floor((seconds - begin_) / step_) : 0.0; };
  while (place() >= static_cast<double>(kMostPlotBins)) {
    halve(version);
  }
  const auto at = static_cast<std::size_t>(std::max(0.0, place()));
  if (at >= bins_.size()) {
    Bin unknown{.version = version};
    unknown.least.fill(kUnknown);
    unknown.most.fill(kUnknown);
    bins_.resize(at + 1, unknown);
  }
  return at;
}

void LivePlots::halve(uint64_t version) {
  const std::size_t kept = (bins_.size() + 1) / 2;
  for (std::size_t i = 0; i < kept; ++i) {
    const Bin& first = bins_[2 * i];
    const Bin& second = bins_[std::min(2 * i + 1, bins_.size() - 1)];
    Bin both{.version = version};
    for (std::size_t k = 0; k < kPlotCurves; ++k) {
      both.least[k] = std::fmin(first.least[k], second.least[k]);
      both.most[k] = std::fmax(first.most[k], second.most[k]);
    }
    bins_[i] = both;
  }
  bins_.resize(kept);
  step_ *= 2.0;
  placed_ = version;
}

void LivePlots::add(const SweepRecord& sweep, double seconds, uint64_t version) {
  if (!std::isfinite(seconds)) {
    return;
  }
  Bin& bin = bins_[place_for(seconds, version)];
  bin.version = version;
  for (std::size_t k = 0; k < kPlotCurves; ++k) {
    const double value = plot_curves()[k].value(sweep);
    if (std::isfinite(value)) {
      bin.least[k] = std::fmin(bin.least[k], value);
      bin.most[k] = std::fmax(bin.most[k], value);
    }
  }
}

ordered_json LivePlots::nothing() {
  ordered_json curves = ordered_json::array();
  for (const PlotCurve& curve : plot_curves()) {
    curves.push_back(curve_json(curve));
  }
  return {{"curves", std::move(curves)}, {"stretches", ordered_json::array()}};
}

ordered_json LivePlots::since(uint64_t told) const {
  const auto first =
      told < placed_ ? bins_.begin()
                     : std::ranges::find_if(bins_, [&](const Bin& b) { return b.version > told; });
  if (first == bins_.end()) {
    return nullptr;
  }
  ordered_json least = ordered_json::array();
  ordered_json most = ordered_json::array();
  for (std::size_t k = 0; k < kPlotCurves; ++k) {
    ordered_json lowest = ordered_json::array();
    ordered_json highest = ordered_json::array();
    for (auto bin = first; bin != bins_.end(); ++bin) {
      lowest.push_back(plotted(bin->least[k]));
      highest.push_back(plotted(bin->most[k]));
    }
    least.push_back(std::move(lowest));
    most.push_back(std::move(highest));
  }
  return {{"begin", begin_},
          {"step", step_},
          {"from", first - bins_.begin()},
          {"least", std::move(least)},
          {"most", std::move(most)}};
}

}  // namespace adit
