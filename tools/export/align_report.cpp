// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/align_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tools/clouds/cloud_origin.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

/// Roll, pitch and yaw in degrees: R = Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Vector3d angles_of(const Eigen::Matrix3d& R) {
  return kDegreesPerRadian * Eigen::Vector3d(std::atan2(R(2, 1), R(2, 2)),
                                             std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))),
                                             std::atan2(R(1, 0), R(0, 0)));
}

std::string axis_text(const Eigen::Vector3d& axis) {
  return fmt::format("({:.2f} {:.2f} {:.2f})", axis.x(), axis.y(), axis.z());
}

bool assessed(const ObservedDirection& direction) {
  return direction.axis.norm() > 0.5;
}

/// Directions that are not fully held, in words; empty: all are, or nothing was assessed.
std::string weak_directions(const RegistrationResult& result) {
  std::string text;
  const auto add = [&](std::span<const ObservedDirection> directions, const char* what) {
    for (const ObservedDirection& direction : directions) {
      if (assessed(direction) && direction.localizability != Localizability::full) {
        const bool none = direction.localizability == Localizability::none;
        text += fmt::format("{}{} {} {}", text.empty() ? "" : ", ", none ? "not" : "hardly", what,
                            axis_text(direction.axis));
      }
    }
  };
  add(result.translation, "along");
  add(result.rotation, "about");
  return text;
}

std::string pose_text(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Vector3d angles = angles_of(pose.linear());
  return fmt::format("{:.3f} {:.3f} {:.3f} m, roll {:.2f} pitch {:.2f} yaw {:.2f} degrees", p.x(),
                     p.y(), p.z(), angles.x(), angles.y(), angles.z());
}

ordered_json json_of(std::span<const ObservedDirection> directions) {
  ordered_json json = ordered_json::array();
  for (const ObservedDirection& one : directions) {
    if (assessed(one)) {
      json.push_back({{"axis", {one.axis.x(), one.axis.y(), one.axis.z()}},
                      {"held", std::string(to_string(one.localizability))},
                      {"information", one.information}});
    }
  }
  return json;
}

ordered_json json_of(const Eigen::Isometry3d& pose) {
  const std::array<double, 7> numbers = numbers_of(pose);
  return ordered_json(numbers);
}

}  // namespace

std::vector<std::pair<std::string, RegistrationMethod>> alignment_methods() {
  return {{"vgicp", RegistrationMethod::vgicp},
          {"ndt", RegistrationMethod::ndt},
          {"point-to-plane", RegistrationMethod::point_to_plane},
          {"ndt-to-ndt", RegistrationMethod::ndt_to_ndt}};
}

std::string reason_of(const AlignedPair& pair, const CloudAlignerSettings& settings) {
  if (!pair.unreadable.empty()) {
    return pair.unreadable;
  }
  const CloudAlignment& alignment = pair.alignment;
  const RegistrationResult& result = alignment.registration;
  switch (alignment.refusal) {
    case AlignmentRefusal::none:
      return {};
    case AlignmentRefusal::nothing_to_align:
      return "a cloud has fewer than 100 points after down-sampling";
    case AlignmentRefusal::nothing_found:
      return "nothing rises above the ground that could tell where the two lie; --guess tells it";
    case AlignmentRefusal::not_converged:
      return fmt::format("not converged after {} iterations", result.iterations);
    case AlignmentRefusal::too_little_overlap:
      return fmt::format("too little overlap: {:.0f} % of b's points lie on a, {:.0f} % are needed",
                         100.0 * result.overlap, 100.0 * settings.min_overlap);
    case AlignmentRefusal::poor_fit:
      return fmt::format("poor fit: matched points lie {:.3f} m off (rms)", result.residual_rms);
    case AlignmentRefusal::degenerate:
      return "degenerate: held " + weak_directions(result);
    case AlignmentRefusal::ambiguous:
      return fmt::format("ambiguous: another pose, {:.2f} m away, fits as well",
                         std::abs(alignment.competing ? alignment.competing->apart : 0.0));
  }
  return "unknown";
}

std::string text_of(const AlignedPair& pair, const CloudAlignerSettings& settings) {
  const CloudAlignment& alignment = pair.alignment;
  const RegistrationResult& result = alignment.registration;
  std::string text =
      fmt::format("aligned  {} with {}\nverdict  {}\n", pair.named.b, pair.named.a,
                  pair.usable() ? "usable" : "refused: " + reason_of(pair, settings));
  if (result.source_points == 0) {
    return text;
  }
  text += (pair.usable() ? "T_a_b    " : "found    ") + pose_text(alignment.T_a_b) + "\n";
  for (const auto& [name, offset] : {std::pair("a", pair.offset_a), {"b", pair.offset_b}}) {
    if (!offset.isZero(0.0)) {
      text += fmt::format("offset   {} is subtracted from {}'s coordinates before T_a_b\n",
                          offset_text(offset), name);
    }
  }
  if (pair.usable()) {
    const Eigen::VectorXd sigma = alignment.covariance.diagonal().cwiseSqrt();
    text +=
        fmt::format("sigma    {:.3f} {:.3f} {:.3f} m, {:.2f} {:.2f} {:.2f} degrees, in b's axes\n",
                    sigma(0), sigma(1), sigma(2), kDegreesPerRadian * sigma(3),
                    kDegreesPerRadian * sigma(4), kDegreesPerRadian * sigma(5));
    const std::string weak = weak_directions(result);
    text += "held     " + (weak.empty() ? std::string("in every direction") : weak) + "\n";
  }
  return text + fmt::format(
                    "overlap  {:.0f} % of b's {} points lie on a, {:.3f} m off (rms)\n"
                    "search   {}, {} iterations; one point per {:.2f} m\n",
                    100.0 * result.overlap, result.source_points, result.residual_rms,
                    pair.named.guess
                        ? "from the guess"
                        : fmt::format("from nothing, {} starts", alignment.poses_tried),
                    result.iterations, pair.r_input);
}

std::string table_of(const std::vector<AlignedPair>& pairs, const CloudAlignerSettings& settings) {
  std::string text =
      " overlap   rms m         x         y         z    roll   pitch     yaw  verdict, a, b\n";
  for (const AlignedPair& pair : pairs) {
    const RegistrationResult& result = pair.alignment.registration;
    const Eigen::Vector3d p = pair.alignment.T_a_b.translation();
    const Eigen::Vector3d angles = angles_of(pair.alignment.T_a_b.linear());
    text += fmt::format(
        "{:8.2f} {:7.3f} {:9.3f} {:9.3f} {:9.3f} {:7.2f} {:7.2f} {:7.2f}  {}, {}, {}\n",
        result.overlap, result.residual_rms, p.x(), p.y(), p.z(), angles.x(), angles.y(),
        angles.z(), pair.usable() ? "usable" : "refused (" + reason_of(pair, settings) + ")",
        pair.named.a, pair.named.b);
  }
  const auto usable = std::ranges::count_if(pairs, &AlignedPair::usable);
  return text + fmt::format("{} pairs, {} usable\n", pairs.size(), usable);
}

ordered_json to_json(const AlignedPair& pair, const CloudAlignerSettings& settings) {
  const CloudAlignment& alignment = pair.alignment;
  const RegistrationResult& result = alignment.registration;
  ordered_json json = {{"a", pair.named.a}, {"b", pair.named.b}, {"usable", pair.usable()}};
  json["refusal"] = nullptr;
  json["reason"] = nullptr;
  if (!pair.usable()) {
    json["refusal"] =
        pair.unreadable.empty() ? std::string(to_string(alignment.refusal)) : "unreadable";
    json["reason"] = reason_of(pair, settings);
  }
  json["guess"] = pair.named.guess ? json_of(*pair.named.guess) : ordered_json();
  if (result.source_points == 0) {
    return json;
  }
  json["T_a_b"] = json_of(alignment.T_a_b);
  json["offset_a_m"] = {pair.offset_a.x(), pair.offset_a.y(), pair.offset_a.z()};
  json["offset_b_m"] = {pair.offset_b.x(), pair.offset_b.y(), pair.offset_b.z()};
  json["covariance"] = nullptr;
  if (pair.usable()) {
    ordered_json rows = ordered_json::array();
    for (int row = 0; row < 6; ++row) {
      ordered_json numbers = ordered_json::array();
      for (int column = 0; column < 6; ++column) {
        numbers.push_back(alignment.covariance(row, column));
      }
      rows.push_back(numbers);
    }
    json["covariance"] = rows;
  }
  json["overlap"] = result.overlap;
  json["rms_m"] = result.residual_rms;
  json["points"] = result.source_points;
  json["matched"] = result.inliers;
  json["iterations"] = result.iterations;
  json["starts"] = alignment.poses_tried;
  json["r_input_m"] = pair.r_input;
  json["translation"] = json_of(result.translation);
  json["rotation"] = json_of(result.rotation);
  json["competing"] = nullptr;
  if (alignment.competing) {
    json["competing"] = {{"T_a_b", json_of(alignment.competing->result.T_target_source)},
                         {"overlap", alignment.competing->result.overlap},
                         {"rms_m", alignment.competing->result.residual_rms}};
  }
  return json;
}

}  // namespace adit
