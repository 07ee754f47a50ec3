// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/run_review.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <system_error>
#include <type_traits>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/nav_state.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr double kJoined = 0.5;      // s between weak sweeps of one stretch
constexpr std::size_t kFewest = 3;   // sweeps of a stretch
constexpr std::size_t kColumn = 13;  // where a row's text begins
constexpr std::size_t kNamed = 5;    // stretches in the text; all are in the JSON

bool is_weak(const SweepDirection& direction) {
  return direction.localizability == "partial" || direction.localizability == "none";
}

/// The weakest of all directions is the first.
std::vector<WeakStretch> weak_stretches(const RunReview& review, bool rotation) {
  std::vector<WeakStretch> found;
  for (std::size_t i = 0; i < review.sweeps.size(); ++i) {
    const SweepRecord& sweep = review.sweeps[i];
    const auto& directions = rotation ? sweep.rotation : sweep.translation;
    if (!is_weak(directions[0])) {
      continue;
    }
    const double time = review.times[i];
    if (found.empty() || time - found.back().end > kJoined) {
      found.push_back({.begin = time, .end = time, .rotation = rotation});
    }
    WeakStretch& stretch = found.back();
    stretch.end = time;
    ++stretch.sweeps;
    stretch.unheld += directions[0].localizability == "none" ? 1U : 0U;
    const double sign = stretch.axis.dot(directions[0].axis) < 0.0 ? -1.0 : 1.0;
    stretch.axis += sign * directions[0].axis;
  }
  std::erase_if(found, [](const WeakStretch& one) { return one.sweeps < kFewest; });
  for (WeakStretch& stretch : found) {
    stretch.axis.normalize();
  }
  return found;
}

InnovationReview review_innovations(const std::vector<SweepRecord>& sweeps) {
  InnovationReview review;
  double squares = 0.0;
  double degrees = 0.0;
  double beyond = 0.0;
  for (const SweepRecord& sweep : sweeps) {
    if (std::isnan(sweep.innovation_squared) || !(sweep.innovation_degrees > 0.0)) {
      continue;
    }
    ++review.count;
    squares += sweep.innovation_squared;
    degrees += sweep.innovation_degrees;
    const bool outside =
        sweep.innovation_squared > chi_squared_95(static_cast<int>(sweep.innovation_degrees));
    beyond += outside ? 1.0 : 0.0;
    review.beyond_gate += sweep.innovation_squared > sweep.innovation_gate ? 1U : 0U;
  }
  if (review.count > 0) {
    review.per_degree = squares / degrees;
    review.beyond_95 = beyond / static_cast<double>(review.count);
  }
  return review;
}

ordered_json read_summary(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::is_regular_file(file, error)
             ? ordered_json::parse(read_text_file(file), nullptr, false)
             : ordered_json();
}

/// What stands there, where it stands there and is of that type.
template <class T>
std::optional<T> value_at(const ordered_json& json, const char* pointer) {
  const ordered_json::json_pointer at(pointer);
  if (!json.is_object() || !json.contains(at)) {
    return std::nullopt;
  }
  constexpr bool kText = std::is_same_v<T, std::string>;
  const ordered_json& value = json[at];
  return (kText ? value.is_string() : value.is_number()) ? std::optional(value.template get<T>())
                                                         : std::nullopt;
}

RunEnding read_ending(const ordered_json& summary) {
  return {.status = value_at<std::string>(summary, "/status").value_or(""),
          .reason = value_at<std::string>(summary, "/reason").value_or(""),
          .wanted = value_at<std::size_t>(summary, "/input/count")};
}

std::vector<std::string> texts_of(const ordered_json& verdict, const char* key) {
  std::vector<std::string> texts;
  const ordered_json parts = verdict.value(key, ordered_json::array());
  for (const ordered_json& part : parts) {
    if (const auto text = value_at<std::string>(part, "/text")) {
      texts.push_back(*text);
    }
  }
  return texts;
}

std::optional<RunVerdict> read_verdict(const ordered_json& summary) {
  const auto state = value_at<std::string>(summary, "/verdict/state");
  if (!state) {
    return std::nullopt;
  }
  return RunVerdict{.state = *state,
                    .reasons = texts_of(summary["verdict"], "reasons"),
                    .stretches = texts_of(summary["verdict"], "stretches")};
}

/// "394 tracking, 6 coasting".
template <class Word>
std::string counted(const std::vector<SweepRecord>& sweeps, Word&& word) {
  std::map<std::string, std::size_t> counts;
  std::vector<std::string> order;
  for (const SweepRecord& sweep : sweeps) {
    if (counts[word(sweep)]++ == 0) {
      order.push_back(word(sweep));
    }
  }
  std::string text;
  for (const std::string& name : order) {
    text += (text.empty() ? "" : ", ") + std::to_string(counts[name]) + " " + name;
  }
  return text;
}

const SweepRecord* last_fused(const std::vector<SweepRecord>& sweeps) {
  const auto found = std::find_if(sweeps.rbegin(), sweeps.rend(), [](const SweepRecord& sweep) {
    return !sweep.gyro_bias.hasNaN();
  });
  return found == sweeps.rend() ? nullptr : &*found;
}

/// Roots of the traces of a pose's covariance, "0.012 m and 1.3 mrad".
std::string sigmas_text(const Matrix6d& covariance) {
  return fmt::format("{:.3f} m and {:.1f} mrad", std::sqrt(covariance.diagonal().head<3>().sum()),
                     1e3 * std::sqrt(covariance.diagonal().tail<3>().sum()));
}

ordered_json json_of_sigmas(const Matrix6d& covariance) {
  return {{"position_m", std::sqrt(covariance.diagonal().head<3>().sum())},
          {"attitude_rad", std::sqrt(covariance.diagonal().tail<3>().sum())}};
}

bool knows_uncertainty(const RunReview& review) {
  return !review.sweeps.empty() && review.sweeps.back().uncertainty.in_map().allFinite();
}

std::string weak_text(const WeakStretch& weak) {
  return fmt::format(
      "{:.1f} to {:.1f} s, {} ({:.2f}, {:.2f}, {:.2f}) of the map: {} sweeps, {} of them by no "
      "match",
      weak.begin, weak.end, weak.rotation ? "turning about" : "moving along", weak.axis.x(),
      weak.axis.y(), weak.axis.z(), weak.sweeps, weak.unheld);
}

ordered_json json_of(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

double chi_squared_95(int degrees) {
  constexpr std::array kBounds = {0.0, 3.84, 5.99, 7.81, 9.49, 11.07, 12.59};
  return kBounds.at(static_cast<std::size_t>(std::clamp(degrees, 0, 6)));
}

double tilt_of(const SweepRecord& sweep) {
  const Eigen::Vector3d& g = sweep.gravity;
  return std::atan2(std::hypot(g.x(), g.y()), -g.z());
}

RunReview review_sweeps(std::vector<SweepRecord> sweeps) {
  RunReview review;
  review.sweeps = std::move(sweeps);
  for (const SweepRecord& sweep : review.sweeps) {
    review.times.push_back(seconds(sweep.stamp - review.sweeps.front().stamp));
  }
  review.weak = weak_stretches(review, false);
  const std::vector<WeakStretch> turns = weak_stretches(review, true);
  review.weak.insert(review.weak.end(), turns.begin(), turns.end());
  review.innovations = review_innovations(review.sweeps);
  return review;
}

RunReview review_run(const std::filesystem::path& folder) {
  const RunFiles files(folder);
  const ordered_json summary = read_summary(files.summary);
  RunEnding ending = read_ending(summary);
  std::error_code error;
  const bool begun = std::filesystem::file_size(files.sweeps, error) > 0 && !error;
  RunReview review = review_sweeps(begun || ending.status.empty() ? read_sweep_table(files.sweeps)
                                                                  : std::vector<SweepRecord>());
  review.min_overlap = value_at<double>(summary, "/configuration/registration/min_overlap");
  review.ending = std::move(ending);
  review.verdict = read_verdict(summary);
  review.sources =
      sources_of(summary.is_object() ? summary.value("sources", ordered_json()) : ordered_json());
  return review;
}

std::string describe(const RunEnding& ending, std::size_t sweeps) {
  const std::string written = std::to_string(sweeps) +
                              (ending.wanted ? fmt::format(" of {}", *ending.wanted) : "") +
                              " sweeps";
  if (ending.status == "completed") {
    return "completed, " + written;
  }
  if (ending.status.empty()) {
    return "unknown how it ended, summary.json does not tell; " + written;
  }
  const std::string how = ending.status == "running"
                              ? "was killed, or is still going on"
                              : "ended early (" + ending.status + "): " + ending.reason;
  return "NOT COMPLETE, it " + how + "; " + written + " are here";
}

std::string describe(const RunReview& review) {
  std::string text =
      review.ending ? "run          " + describe(*review.ending, review.sweeps.size()) + "\n" : "";
  if (review.verdict) {
    text += "verdict      " + review.verdict->state + "\n";
    for (const auto* texts : {&review.verdict->reasons, &review.verdict->stretches}) {
      for (const std::string& one : *texts) {
        text += "             " + one + "\n";
      }
    }
  }
  if (review.sweeps.empty()) {
    return text;
  }
  text += "sweeps       " + counted(review.sweeps, [](const SweepRecord& s) { return s.state; }) +
          "\nimu          " + counted(review.sweeps, [](const SweepRecord& s) { return s.imu; }) +
          "\n";
  text += review.sources.empty() ? "" : "sources      " + describe(review.sources, kColumn);
  text += "weakly held  ";
  for (std::size_t i = 0; i < std::min(kNamed, review.weak.size()); ++i) {
    text += (i == 0 ? "" : "             ") + weak_text(review.weak[i]) + "\n";
  }
  text += review.weak.empty() ? "no direction for longer\n" : "";
  text += review.weak.size() > kNamed
              ? fmt::format("             and {} more stretches\n", review.weak.size() - kNamed)
              : "";
  if (const InnovationReview& found = review.innovations; found.count > 0) {
    text += fmt::format(
        "innovations  {}; squared {:.2f} per degree of freedom (1: as their covariances promise), "
        "{:.1f} % beyond the 95 % bound, {} not believed\n",
        found.count, found.per_degree, 100.0 * found.beyond_95, found.beyond_gate);
  }
  if (const SweepRecord* last = last_fused(review.sweeps)) {
    const Eigen::Vector3d& g = last->gyro_bias;
    const Eigen::Vector3d& a = last->accel_bias;
    text += fmt::format(
        "biases       gyroscope {:.2f}, {:.2f}, {:.2f} mrad/s (+- {:.2f}), accelerometer {:.3f}, "
        "{:.3f}, {:.3f} m/s^2 (+- {:.3f}) at the end\n",
        1e3 * g.x(), 1e3 * g.y(), 1e3 * g.z(), 1e3 * last->gyro_bias_sigma.maxCoeff(), a.x(), a.y(),
        a.z(), last->accel_bias_sigma.maxCoeff());
    text +=
        fmt::format("gravity      {:.2f} degrees (+- {:.2f}) off the map's -z at the end\n",
                    kDegreesPerRadian * tilt_of(*last), kDegreesPerRadian * last->gravity_sigma);
  }
  if (knows_uncertainty(review)) {
    const PoseUncertainty& last = review.sweeps.back().uncertainty;
    text += "known to     " + sigmas_text(last.local) + " relative to the submap, " +
            sigmas_text(last.in_map()) + " in the map at the end (one sigma of all axes)\n";
  }
  return text;
}

ordered_json to_json(const RunReview& review) {
  ordered_json json = {{"sweeps", review.sweeps.size()}};
  if (review.ending) {
    json["status"] = review.ending->status;
    json["reason"] = review.ending->reason;
    json["sweeps_wanted"] =
        review.ending->wanted ? ordered_json(*review.ending->wanted) : ordered_json();
  }
  if (review.verdict) {
    json["verdict"] = {{"state", review.verdict->state},
                       {"reasons", review.verdict->reasons},
                       {"stretches", review.verdict->stretches}};
  }
  json["sources"] = to_json(review.sources);
  json["weakly_held"] = ordered_json::array();
  for (const WeakStretch& weak : review.weak) {
    json["weakly_held"].push_back({{"begin_s", weak.begin},
                                   {"end_s", weak.end},
                                   {"sweeps", weak.sweeps},
                                   {"what", weak.rotation ? "rotation" : "translation"},
                                   {"unheld", weak.unheld},
                                   {"axis_map", json_of(weak.axis)}});
  }
  const InnovationReview& found = review.innovations;
  json["innovations"] = nullptr;
  if (found.count > 0) {
    json["innovations"] = {{"count", found.count},
                           {"squared_per_degree", found.per_degree},
                           {"beyond_95_percent", found.beyond_95},
                           {"beyond_gate", found.beyond_gate}};
  }
  if (const SweepRecord* last = last_fused(review.sweeps)) {
    json["gyro_bias_rad_per_s"] = json_of(last->gyro_bias);
    json["gyro_bias_sigma_rad_per_s"] = json_of(last->gyro_bias_sigma);
    json["accel_bias_m_per_s2"] = json_of(last->accel_bias);
    json["accel_bias_sigma_m_per_s2"] = json_of(last->accel_bias_sigma);
    json["tilt_rad"] = tilt_of(*last);
    json["tilt_sigma_rad"] = last->gravity_sigma;
  }
  if (knows_uncertainty(review)) {
    const PoseUncertainty& last = review.sweeps.back().uncertainty;
    json["sigma_at_the_end"] = {{"local", json_of_sigmas(last.local)},
                                {"in_map", json_of_sigmas(last.in_map())}};
  }
  return json;
}

}  // namespace adit
