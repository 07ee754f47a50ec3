// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/evaluation_report.hpp"

#include <array>
#include <cmath>
#include <string_view>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/text.hpp"
#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

std::string percent(double part, double whole) {
  return with_decimals(whole > 0.0 ? 100.0 * part / whole : 0.0, 1) + " %";
}

std::string association_text(const Evaluation& evaluation) {
  const AssociationSummary& a = evaluation.association;
  std::string text = std::to_string(a.pairs) + " pairs ";
  text += a.by_time ? "by time (nearest within " + with_decimals(evaluation.options.tolerance, 3) +
                          " s; largest difference " + with_decimals(a.largest_difference, 4) + " s)"
                    : std::string("by index");
  return text;
}

std::string coverage_text(const AssociationSummary& a) {
  return std::to_string(a.pairs) + " of " + std::to_string(a.estimate_poses) +
         " poses of the estimate, of " + std::to_string(a.truth_poses) + " of the truth; " +
         with_decimals(a.covered_path, 1) + " of " + with_decimals(a.truth_path, 1) +
         " m of the truth's path (" + percent(a.covered_path, a.truth_path) + ")";
}

std::string alignment_text(const Evaluation& evaluation) {
  switch (evaluation.options.alignment) {
    case Alignment::none:
      return "none: both are taken to be in the same frame";
    case Alignment::origin:
      return "origin: the first matched poses are made equal";
    case Alignment::se3:
      return "SE(3) Umeyama over all matched positions";
    case Alignment::sim3:
      return "Sim(3) Umeyama over all matched positions, scale " +
             with_decimals(evaluation.alignment.scale, 6);
  }
  return {};
}

std::string rpe_text(const Evaluation& evaluation) {
  const RpeOptions& rpe = evaluation.options.rpe;
  if (rpe.unit == DeltaUnit::frames) {
    return with_decimals(rpe.delta, 0) + " frames apart";
  }
  return fmt::format("{:g} m apart along the {}{}", rpe.delta,
                     rpe.pairs_from == PairSource::estimate ? "estimate" : "truth",
                     rpe.from_first_pose ? ", from its first pose" : "");
}

void write_head(std::string& out) {
  out += fmt::format("  {:26}", "");
  for (const std::string_view name : {"rmse", "mean", "median", "std", "min", "max"}) {
    out += fmt::format("{:>12}", name);
  }
  out += "\n";
}

void write_row(std::string& out, std::string_view name, const Statistics& s) {
  out += fmt::format("  {:26}", name);
  if (s.count == 0) {
    out += fmt::format("{:>12}   (the path is too short for one pair)\n", "-");
    return;
  }
  for (const double value : {s.rmse, s.mean, s.median, s.std, s.min, s.max}) {
    out += fmt::format("{:>12.6f}", value);
  }
  out += "\n";
}

void write_segments(std::string& out, const Evaluation& evaluation) {
  const SegmentErrors& all = evaluation.all_segments;
  out += "KITTI segments";
  if (all.count == 0) {
    out += ": none, the truth's path is shorter than 100 m\n";
    return;
  }
  out += " (every 10th pose; mean error over the length)\n";
  out += fmt::format("  {:>10}{:>10}{:>18}{:>22}\n", "length (m)", "segments", "translation (%)",
                     "rotation (deg/100 m)");
  const auto row = [&](const std::string& name, const SegmentErrors& s) {
    out += fmt::format("  {:>10}{:>10}{:>18.4f}{:>22.4f}\n", name, s.count, 100.0 * s.translation,
                       100.0 * kDegreesPerRadian * s.rotation);
  };
  for (const SegmentErrors& segment : evaluation.segments) {
    row(with_decimals(segment.length, 0), segment);
  }
  row("all", all);
}

nlohmann::ordered_json to_json(const Statistics& s) {
  if (s.count == 0) {
    return nullptr;
  }
  return {{"count", s.count}, {"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median},
          {"std", s.std},     {"min", s.min},   {"max", s.max},   {"sse", s.sse}};
}

nlohmann::ordered_json to_json(const SegmentErrors& s) {
  return {{"count", s.count},
          {"translation_percent", 100.0 * s.translation},
          {"rotation_deg_per_m", kDegreesPerRadian * s.rotation}};
}

nlohmann::ordered_json to_json(const Similarity& s) {
  const Eigen::Matrix3d& r = s.rotation;
  return {{"rotation",
           {{r(0, 0), r(0, 1), r(0, 2)}, {r(1, 0), r(1, 1), r(1, 2)}, {r(2, 0), r(2, 1), r(2, 2)}}},
          {"translation_m", {s.translation.x(), s.translation.y(), s.translation.z()}},
          {"scale", s.scale}};
}

}  // namespace

std::string format_evaluation(const Evaluation& evaluation, const std::filesystem::path& estimate,
                              const std::filesystem::path& truth) {
  std::string out = fmt::format(
      "estimate     {}\ntruth        {}\nassociation  {}\ncoverage     {}\nalignment    {}\n",
      estimate.string(), truth.string(), association_text(evaluation),
      coverage_text(evaluation.association), alignment_text(evaluation));
  for (const std::string& warning : evaluation.warnings) {
    out += fmt::format("warning      {}\n", warning);
  }
  out += "\nabsolute trajectory error (ATE)\n";
  write_head(out);
  write_row(out, "position (m)", evaluation.ate);
  write_row(out, evaluation.rotation_determined ? "rotation (deg)" : "rotation (deg), free",
            evaluation.ate_rotation);
  if (evaluation.options.alignment != Alignment::none) {
    write_row(out, "position, unaligned (m)", evaluation.ate_unaligned);
  }
  out += fmt::format("  sum of squared position errors {:.6f} m^2\n", evaluation.ate.sse);
  out += fmt::format("\nrelative pose error (RPE), {} consecutive pairs {}\n",
                     evaluation.rpe.translation.count, rpe_text(evaluation));
  write_head(out);
  write_row(out, "translation (m)", evaluation.rpe.translation);
  write_row(out, "rotation (deg)", evaluation.rpe.rotation);
  out += "\n";
  write_segments(out, evaluation);
  return out;
}

std::string evaluation_json(const Evaluation& evaluation, const std::filesystem::path& estimate,
                            const std::filesystem::path& truth) {
  const AssociationSummary& a = evaluation.association;
  const RpeOptions& rpe = evaluation.options.rpe;
  nlohmann::ordered_json segments = nlohmann::ordered_json::array();
  for (const SegmentErrors& segment : evaluation.segments) {
    nlohmann::ordered_json entry = {{"length_m", segment.length}};
    entry.update(to_json(segment));
    segments.push_back(entry);
  }
  const nlohmann::ordered_json report = {
      {"estimate", estimate.string()},
      {"truth", truth.string()},
      {"association",
       {{"method", a.by_time ? "time" : "index"},
        {"tolerance_s", a.by_time ? nlohmann::ordered_json(evaluation.options.tolerance) : nullptr},
        {"largest_difference_s", a.largest_difference},
        {"pairs", a.pairs},
        {"estimate_poses", a.estimate_poses},
        {"truth_poses", a.truth_poses},
        {"truth_path_m", a.truth_path},
        {"covered_path_m", a.covered_path},
        {"repeated_times",
         {{"estimate", a.estimate_stamps.repeated}, {"truth", a.truth_stamps.repeated}}},
        {"time_step_s",
         {{"estimate",
           a.by_time ? nlohmann::ordered_json(seconds(a.estimate_stamps.step)) : nullptr},
          {"truth", a.by_time ? nlohmann::ordered_json(seconds(a.truth_stamps.step)) : nullptr}}},
        {"shared_poses", {{"estimate", a.shared_estimate}, {"truth", a.shared_truth}}}}},
      {"alignment",
       {{"method", to_string(evaluation.options.alignment)},
        {"truth_from_estimate", to_json(evaluation.alignment)}}},
      {"ate",
       {{"position_m", to_json(evaluation.ate)},
        {"rotation_deg", to_json(evaluation.ate_rotation)},
        {"rotation_determined", evaluation.rotation_determined},
        {"position_unaligned_m", to_json(evaluation.ate_unaligned)}}},
      {"rpe",
       {{"delta", rpe.delta},
        {"delta_unit", rpe.unit == DeltaUnit::frames ? "f" : "m"},
        {"pairs_from", rpe.pairs_from == PairSource::estimate ? "estimate" : "truth"},
        {"from_first_pose", rpe.from_first_pose},
        {"translation_m", to_json(evaluation.rpe.translation)},
        {"rotation_deg", to_json(evaluation.rpe.rotation)}}},
      {"kitti_segments",
       {{"all", evaluation.all_segments.count > 0 ? to_json(evaluation.all_segments)
                                                  : nlohmann::ordered_json(nullptr)},
        {"by_length", segments}}},
      {"warnings", evaluation.warnings}};
  // Paths may hold bytes that are no UTF-8.
  return report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace adit
