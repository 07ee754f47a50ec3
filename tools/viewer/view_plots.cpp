// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/view_plots.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <unordered_map>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/registration/registration.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

double sigma_of(const SweepRecord& sweep) {
  const double trace = sweep.uncertainty.in_map().diagonal().head<3>().sum();
  return trace > 0.0 ? std::sqrt(trace) : kUnknown;
}

constexpr std::array<PlotCurve, kPlotCurves> kCurves = {{
    {.name = "overlap",
     .title = "share of points with a match",
     .unit = "",
     .value = [](const SweepRecord& sweep) { return sweep.overlap; }},
    {.name = "sigma",
     .title = "1 sigma of the position in the map",
     .unit = "m",
     .value = sigma_of},
    {.name = "rms",
     .title = "distance of matches, rms",
     .unit = "m",
     .value = [](const SweepRecord& sweep) { return sweep.residual_rms; }},
    {.name = "NIS",
     .title = "innovation, squared and normalised, per degree of freedom",
     .unit = "",
     .logarithmic = true,
     .value =
         [](const SweepRecord& sweep) {
           return sweep.innovation_squared / sweep.innovation_degrees;
         }},
}};

ordered_json bins_json(const std::vector<double>& bins) {
  ordered_json list = ordered_json::array();
  for (const double value : bins) {
    list.push_back(plotted(value));
  }
  return list;
}

/// Null where nothing is known.
ordered_json curve_of(const PlotCurve& curve, const std::vector<SweepRecord>& sweeps,
                      const ViewSpan& span, std::size_t bins) {
  std::vector<double> least(bins, kUnknown);
  std::vector<double> most(bins, kUnknown);
  const double all = span.seconds_of(span.last);
  bool any = false;
  for (const SweepRecord& sweep : sweeps) {
    const double value = curve.value(sweep);
    const double share = span.seconds_of(sweep.stamp) / all;
    if (!std::isfinite(value) || !(share >= 0.0 && share <= 1.0)) {
      continue;
    }
    const std::size_t at =
        std::min(bins - 1, static_cast<std::size_t>(share * static_cast<double>(bins)));
    least[at] = std::fmin(least[at], value);
    most[at] = std::fmax(most[at], value);
    any = true;
  }
  if (!any) {
    return nullptr;
  }
  ordered_json json = curve_json(curve);
  json["least"] = bins_json(least);
  json["most"] = bins_json(most);
  return json;
}

/// Of a run that has ended; times of a summary count from its first sweep.
/// An object without keys where there is none, or no JSON.
ordered_json summary_of(const std::filesystem::path& summary) {
  ordered_json json = std::filesystem::exists(summary)
                          ? ordered_json::parse(read_text_file(summary), nullptr, false)
                          : ordered_json();
  return json.is_object() ? json : ordered_json::object();
}

ordered_json stretches_json(const std::filesystem::path& summary, const ViewSpan& span,
                            Nanoseconds first) {
  ordered_json list = ordered_json::array();
  const ordered_json json = summary_of(summary);
  const ordered_json::json_pointer at("/verdict/stretches");
  if (!json.contains(at) || !json[at].is_array()) {
    return list;
  }
  const double offset = span.seconds_of(first);
  for (const ordered_json& stretch : json[at]) {
    const auto number = [&](const char* key) {
      return stretch.contains(key) && stretch[key].is_number();
    };
    const auto word = [&](const char* key) {
      return stretch.contains(key) && stretch[key].is_string();
    };
    if (number("begin_s") && number("end_s") && word("state") && word("text")) {
      list.push_back({{"state", stretch["state"]},
                      {"begin", stretch["begin_s"].get<double>() + offset},
                      {"end", stretch["end_s"].get<double>() + offset},
                      {"text", stretch["text"]}});
    }
  }
  return list;
}

ordered_json plots_json(const std::vector<SweepRecord>& sweeps, const ViewSpan& span,
                        const std::filesystem::path& folder) {
  if (sweeps.empty() || !(span.last > span.first)) {
    return nullptr;
  }
  const std::size_t bins = std::min(kMostPlotBins, sweeps.size());
  ordered_json curves = ordered_json::array();
  for (const PlotCurve& curve : plot_curves()) {
    ordered_json json = curve_of(curve, sweeps, span, bins);
    if (!json.is_null()) {
      curves.push_back(std::move(json));
    }
  }
  return {{"curves", std::move(curves)},
          {"stretches", stretches_json(folder / "summary.json", span, sweeps.front().stamp)}};
}

struct WeakDirection {
  std::size_t sweep = 0;  ///< its position in "sweeps"
  Eigen::Vector3d axis;
  bool none = false;  ///< nothing holds it
};

std::vector<WeakDirection> weak_directions(const std::vector<SweepRecord>& records,
                                           const std::vector<ViewSweep>& sweeps) {
  std::unordered_map<int64_t, std::size_t> told;  // by stamp
  for (std::size_t i = 0; i < sweeps.size(); i += stride_of(sweeps.size())) {
    told.emplace(sweeps[i].stamp.count(), i / stride_of(sweeps.size()));
  }
  std::vector<WeakDirection> weak;
  for (const SweepRecord& record : records) {
    const auto at = told.find(record.stamp.count());
    if (at == told.end()) {
      continue;
    }
    for (const SweepDirection& direction : record.translation) {
      const bool none = direction.localizability == to_string(Localizability::none);
      const bool partial = direction.localizability == to_string(Localizability::partial);
      if ((none || partial) && direction.axis.allFinite()) {
        weak.push_back({.sweep = at->second, .axis = direction.axis, .none = none});
      }
    }
  }
  return weak;
}

ordered_json weak_json(const std::vector<WeakDirection>& weak) {
  const std::size_t stride = std::max<std::size_t>(1, (weak.size() + kMostWeak - 1) / kMostWeak);
  ordered_json sweeps = ordered_json::array();
  ordered_json axes = ordered_json::array();
  ordered_json none = ordered_json::array();
  for (std::size_t i = 0; i < weak.size(); i += stride) {
    sweeps.push_back(weak[i].sweep);
    for (int k = 0; k < 3; ++k) {
      axes.push_back(plotted(weak[i].axis[k]));
    }
    none.push_back(weak[i].none);
  }
  return {{"sweep", sweeps}, {"axis", axes}, {"none", none}};
}

}  // namespace

const std::array<PlotCurve, kPlotCurves>& plot_curves() {
  return kCurves;
}

ordered_json curve_json(const PlotCurve& curve) {
  return {{"name", curve.name},
          {"title", curve.title},
          {"unit", curve.unit},
          {"logarithmic", curve.logarithmic},
          {"least", ordered_json::array()},
          {"most", ordered_json::array()}};
}

ordered_json plotted(double value) {
  return std::isfinite(value) ? ordered_json(std::stod(fmt::format("{:.3e}", value)))
                              : ordered_json();
}

ViewRun no_run() {
  return {.plots = nullptr, .weak = weak_json({}), .sources = ordered_json::array()};
}

ViewRun run_of(const std::filesystem::path& folder, const ViewSpan& span,
               const std::vector<ViewSweep>& sweeps, std::ostream& progress) {
  const std::filesystem::path table = folder / "sweeps.csv";
  if (!std::filesystem::exists(table)) {
    return no_run();
  }
  try {
    const std::vector<SweepRecord> records = read_sweep_table(table);
    return {.plots = plots_json(records, span, folder),
            .weak = weak_json(weak_directions(records, sweeps)),
            .sources = to_json(sources_of(
                summary_of(folder / "summary.json").value("sources", ordered_json::array())))};
  } catch (const FileError& error) {
    progress << "note: there are no plots: " << error.what() << "\n";
    return no_run();
  }
}

}  // namespace adit
