// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/loop_score.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"
#include "adit/slam/mapping/loop_reason.hpp"
#include "adit/tools/evaluation/true_keyframes.hpp"
#include "adit/tools/maps/map_database.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

using std::chrono::milliseconds;

constexpr Nanoseconds kRevisitGap = milliseconds(3000);  // that a revisit may have
constexpr Nanoseconds kMargin = milliseconds(2000);      // around a keyframe's stamp
constexpr double kRevisitLength = 5.0;                   // m
constexpr double kRevisitDistance = 5.0;                 // m
constexpr double kRevisitOverlap = 0.5;

/// m of the truth's way between two moments.
double way(const Trajectory& truth, Nanoseconds begin, Nanoseconds end) {
  double length = 0.0;
  auto at = std::ranges::lower_bound(truth.poses, begin, {}, &StampedPose::stamp);
  for (; at != truth.poses.end() && at + 1 != truth.poses.end() && (at + 1)->stamp <= end; ++at) {
    length += ((at + 1)->pose.translation() - at->pose.translation()).norm();
  }
  return length;
}

std::vector<Revisit> revisits_in(const Trajectory& truth, const std::vector<TrueLoop>& loops) {
  std::vector<Nanoseconds> stamps;
  for (const TrueLoop& loop : loops) {
    if (loop.overlap >= kRevisitOverlap && loop.distance <= kRevisitDistance) {
      stamps.push_back(loop.later);
    }
  }
  std::ranges::sort(stamps);
  std::vector<Revisit> revisits;
  for (const Nanoseconds stamp : stamps) {
    if (revisits.empty() || stamp - revisits.back().end > kRevisitGap) {
      revisits.push_back({.begin = stamp, .end = stamp});
    }
    revisits.back().end = stamp;
  }
  for (Revisit& revisit : revisits) {
    revisit.length = way(truth, revisit.begin, revisit.end);
  }
  std::erase_if(revisits, [](const Revisit& one) { return one.length < kRevisitLength; });
  return revisits;
}

}  // namespace

std::vector<TrueLoop> read_true_loops(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) {
    throw InputError(file, {}, "it cannot be read, or is empty",
                     "Name the truth.loops.csv that `adit simulate` writes");
  }
  std::map<std::string, std::size_t> columns;
  std::istringstream head(line);
  for (std::string name; std::getline(head, name, ',');) {
    columns.emplace(name, columns.size());
  }
  std::array<std::size_t, 4> wanted{};
  const std::array names = {"time_a_s", "time_b_s", "distance_m", "overlap"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!columns.contains(names[i])) {
      throw InputError(file, Place::line(1), std::string("there is no column ") + names[i],
                       "Name the truth.loops.csv that `adit simulate` writes");
    }
    wanted[i] = columns[names[i]];
  }
  std::vector<TrueLoop> loops;
  for (uint64_t number = 2; std::getline(in, line); ++number) {
    std::vector<double> values;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      std::size_t used = 0;
      double value = std::nan("");
      try {
        value = std::stod(cell, &used);
      } catch (const std::exception&) {
        used = std::string::npos;
      }
      if (used != cell.size() || !std::isfinite(value)) {
        throw InputError(file, Place::line(number), "'" + cell + "' is no number",
                         "Write the table anew");
      }
      values.push_back(value);
    }
    if (values.size() < columns.size()) {
      throw InputError(file, Place::line(number), "the line ends early", "Write the table anew");
    }
    loops.push_back({.earlier = nanoseconds(values[wanted[0]]),
                     .later = nanoseconds(values[wanted[1]]),
                     .distance = values[wanted[2]],
                     .overlap = values[wanted[3]]});
  }
  return loops;
}

LoopScore score_loops(const std::filesystem::path& map_file, const Trajectory& truth,
                      const std::vector<TrueLoop>& loops) {
  const MapDatabase map(map_file, MapAccess::read);
  const std::map<NodeId, TrueKeyframe> keyframes = true_keyframes(map, map_file, truth);
  LoopScore score;
  score.revisits = revisits_in(truth, loops);
  for (const LoopCandidate& candidate : map.candidates()) {
    const auto from = keyframes.find(candidate.from);
    const auto to = keyframes.find(candidate.to);
    if (from == keyframes.end() || to == keyframes.end()) {
      continue;
    }
    const Eigen::Isometry3d off =
        candidate.T_from_to.inverse() *
        (from->second.T_world_keyframe.inverse() * to->second.T_world_keyframe);
    ScoredLoop scored{.candidate = candidate,
                      .metres = off.translation().norm(),
                      .degrees = rotation_angle(off.linear()) * kDegreesPerRadian};
    scored.right = scored.metres <= kFalseLoopMetres && scored.degrees <= kFalseLoopDegrees;
    if (candidate.verdict == CandidateVerdict::accepted) {
      ++score.accepted;
      score.false_ones += scored.right ? 0U : 1U;
      for (Revisit& revisit : score.revisits) {
        revisit.found |= scored.right && to->second.stamp >= revisit.begin - kMargin &&
                         to->second.stamp <= revisit.end + kMargin;
      }
    } else if (candidate.reason != to_string(LoopReason::too_little_overlap) &&
               candidate.reason != to_string(LoopReason::not_aligned)) {
      ++(scored.right ? score.right_refused : score.wrong_refused);
    }
    score.loops.push_back(std::move(scored));
  }
  return score;
}

std::string describe(const LoopScore& score) {
  const auto found = std::ranges::count(score.revisits, true, &Revisit::found);
  double metres = 0.0;
  double degrees = 0.0;
  for (const ScoredLoop& loop : score.loops) {
    if (loop.candidate.verdict == CandidateVerdict::accepted) {
      metres = std::max(metres, loop.metres);
      degrees = std::max(degrees, loop.degrees);
    }
  }
  return fmt::format(
      "loops        {} accepted, {} of them false (beyond {:.1f} m or {:.0f} degrees); off by up "
      "to "
      "{:.3f} m, {:.2f} degrees\n"
      "             {} refused although measured rightly, {} refused with reason\n"
      "revisits     {}, {} of them found\n",
      score.accepted, score.false_ones, kFalseLoopMetres, kFalseLoopDegrees, metres, degrees,
      score.right_refused, score.wrong_refused, score.revisits.size(), found);
}

nlohmann::ordered_json to_json(const LoopScore& score) {
  nlohmann::ordered_json json = {{"accepted", score.accepted},
                                 {"false", score.false_ones},
                                 {"right_refused", score.right_refused},
                                 {"wrong_refused", score.wrong_refused},
                                 {"candidates", nlohmann::ordered_json::array()},
                                 {"revisits", nlohmann::ordered_json::array()}};
  for (const ScoredLoop& loop : score.loops) {
    json["candidates"].push_back(
        {{"id", loop.candidate.id},
         {"from", loop.candidate.from},
         {"to", loop.candidate.to},
         {"accepted", loop.candidate.verdict == CandidateVerdict::accepted},
         {"reason", loop.candidate.reason},
         {"figure", loop.candidate.figure},
         {"off_m", loop.metres},
         {"off_degrees", loop.degrees},
         {"right", loop.right}});
  }
  for (const Revisit& revisit : score.revisits) {
    json["revisits"].push_back({{"begin_s", seconds(revisit.begin)},
                                {"end_s", seconds(revisit.end)},
                                {"length_m", revisit.length},
                                {"found", revisit.found}});
  }
  return json;
}

}  // namespace adit
