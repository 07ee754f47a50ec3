// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/loop_score.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"
#include "adit/slam/loops/loop_reason.hpp"
#include "adit/tools/evaluation/true_keyframes.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/report/loop_reasons.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

using std::chrono::milliseconds;

constexpr Nanoseconds kRevisitGap = milliseconds(3000);  // that a revisit may have
constexpr double kRevisitLength = 5.0;                   // m
constexpr double kRevisitDistance = 5.0;                 // m
constexpr double kRevisitOverlap = 0.5;
constexpr double kSameDistance = 0.5;  // m, that a table and the truth may differ by: lever arms
constexpr double kSameShare = 0.9;     // of the pairs, that have to agree with the truth

std::vector<Revisit> revisits_in(const Trajectory& truth, std::vector<TrueLoop> loops) {
  std::ranges::sort(loops, {}, &TrueLoop::later);
  std::vector<Revisit> revisits;
  for (const TrueLoop& loop : loops) {
    if (revisits.empty() || loop.later - revisits.back().end > kRevisitGap) {
      revisits.push_back({.begin = loop.later, .end = loop.later});
    }
    revisits.back().end = loop.later;
    revisits.back().pairs.push_back(loop);
  }
  for (Revisit& revisit : revisits) {
    revisit.length = path_between(truth, revisit.begin, revisit.end);
  }
  std::erase_if(revisits, [](const Revisit& one) { return one.length < kRevisitLength; });
  return revisits;
}

/// When keyframes were, in order of time.
struct RunTime {
  std::vector<Nanoseconds> keyframes{};
  Nanoseconds end{0};  ///< of the last sweep

  bool has(Nanoseconds stamp) const {
    return !keyframes.empty() && stamp >= keyframes.front() && stamp <= end;
  }
  Nanoseconds before(Nanoseconds stamp) const {
    const auto at = std::ranges::lower_bound(keyframes, stamp);
    return at == keyframes.begin() ? stamp : *std::prev(at);
  }
  Nanoseconds after(Nanoseconds stamp) const {
    const auto at = std::ranges::upper_bound(keyframes, stamp);
    return at == keyframes.end() ? end : *at;
  }
};

RunTime time_of(const MapDatabase& map, const std::filesystem::path& file) {
  RunTime time;
  NodeId last = 0;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    time.keyframes.push_back(keyframe.stamp);
    if (keyframe.stamp >= time.end) {
      time.end = keyframe.stamp;
      last = keyframe.id;
    }
  }
  std::ranges::sort(time.keyframes);
  if (!time.keyframes.empty()) {
    for (const auto& sweep : load_sweeps(map, last, file).sweeps) {
      time.end = std::max(time.end, sweep.stamp);
    }
  }
  return time;
}

/// Sorts the pairs into revisits of the run and what is left out.
void add_revisits(LoopScore& score, const Trajectory& truth, const RunTime& time,
                  const std::vector<TrueLoop>& loops) {
  std::vector<TrueLoop> all;
  std::vector<TrueLoop> of_run;
  for (const TrueLoop& loop : loops) {
    if (loop.overlap < kRevisitOverlap || loop.distance > kRevisitDistance) {
      continue;
    }
    ++score.pairs;
    if (!pose_at(truth, loop.earlier) || !pose_at(truth, loop.later)) {
      ++score.not_in_truth;
      continue;
    }
    all.push_back(loop);
    if (time.has(loop.earlier) && time.has(loop.later)) {
      of_run.push_back(loop);
    }
  }
  score.revisits = revisits_in(truth, std::move(of_run));
  for (const Revisit& one : revisits_in(truth, std::move(all))) {
    score.not_of_run +=
        std::ranges::none_of(
            score.revisits,
            [&](const Revisit& kept) { return kept.begin <= one.end && kept.end >= one.begin; })
            ? 1U
            : 0U;
  }
}

/// Whether a right edge finds a revisit.
bool finds(const TrueKeyframe& from, const TrueKeyframe& to, const Revisit& revisit,
           const Trajectory& truth, const RunTime& time) {
  const Nanoseconds before = time.before(to.stamp);
  const Nanoseconds after = time.after(to.stamp);
  if (after < revisit.begin || before > revisit.end) {
    return false;
  }
  const auto away = [&](const TrueLoop& pair) { return std::chrono::abs(pair.later - to.stamp); };
  const Nanoseconds nearest = away(*std::ranges::min_element(revisit.pairs, {}, away));
  const Nanoseconds near = std::max({nearest, to.stamp - before, after - to.stamp});
  return std::ranges::any_of(revisit.pairs, [&](const TrueLoop& pair) {
    const auto place = pose_at(truth, pair.earlier);
    return away(pair) <= near && place &&
           (place->translation() - from.T_world_keyframe.translation()).norm() <= kRevisitDistance;
  });
}

void widen(std::optional<LoopSpan>& span, Nanoseconds from, Nanoseconds to) {
  const auto [first, last] = std::minmax(from, to);  // of two sessions the later may be the older
  const LoopSpan known = span.value_or(LoopSpan{first, last});
  span = {.begin = std::min(known.begin, first), .end = std::max(known.end, last)};
}

/// What the map keeps of its candidates.
void add_ledger(LoopScore& score, const std::vector<LoopCandidate>& candidates) {
  score.offered = candidates.size();
  for (const LoopCandidate& candidate : candidates) {
    const bool out = candidate.verdict == CandidateVerdict::rejected ||
                     candidate.verdict == CandidateVerdict::revoked;
    for (std::size_t i = 0; out && i < kLoopReasons; ++i) {
      score.removed[i] += candidate.reason == to_string(static_cast<LoopReason>(i)) ? 1U : 0U;
    }
  }
}

}  // namespace

double path_between(const Trajectory& truth, Nanoseconds begin, Nanoseconds end) {
  double length = 0.0;
  auto at = std::ranges::lower_bound(truth.poses, begin, {}, &StampedPose::stamp);
  for (; at != truth.poses.end() && at + 1 != truth.poses.end() && (at + 1)->stamp <= end; ++at) {
    length += ((at + 1)->pose.translation() - at->pose.translation()).norm();
  }
  return length;
}

void check_true_loops(const std::filesystem::path& file, const std::vector<TrueLoop>& loops,
                      const Trajectory& truth) {
  std::size_t covered = 0;
  std::size_t agree = 0;
  for (const TrueLoop& loop : loops) {
    const auto earlier = pose_at(truth, loop.earlier);
    const auto later = pose_at(truth, loop.later);
    if (earlier && later) {
      const double distance = (earlier->translation() - later->translation()).norm();
      ++covered;
      agree += std::abs(distance - loop.distance) <= kSameDistance ? 1U : 0U;
    }
  }
  constexpr const char* kRemedy = "Name the loops and the truth of the recording that was mapped";
  if (covered == 0 && !loops.empty()) {
    throw InputError(file, {},
                     fmt::format("none of its {} pairs lies within the time of the truth {}",
                                 loops.size(), truth.file.string()),
                     kRemedy);
  }
  if (static_cast<double>(agree) < kSameShare * static_cast<double>(covered)) {
    throw InputError(file, {},
                     fmt::format("it is not of the recording that the truth {} is of: of {} pairs "
                                 "only {} are as far apart there as it says",
                                 truth.file.string(), covered, agree),
                     kRemedy);
  }
}

LoopError loop_error(const Eigen::Isometry3d& T_from_to, const Eigen::Isometry3d& T_world_from,
                     const Eigen::Isometry3d& T_world_to) {
  const Eigen::Isometry3d off = T_from_to.inverse() * (T_world_from.inverse() * T_world_to);
  LoopError error{.metres = off.translation().norm(),
                  .degrees = rotation_angle(off.linear()) * kDegreesPerRadian};
  error.right = error.metres <= kFalseLoopMetres && error.degrees <= kFalseLoopDegrees;
  return error;
}

LoopScore score_loops(const std::filesystem::path& map_file, const Trajectory& truth,
                      const std::vector<TrueLoop>& loops) {
  const MapDatabase map(map_file, MapAccess::read);
  const std::map<NodeId, TrueKeyframe> keyframes = true_keyframes(map, map_file, truth);
  LoopScore score;
  const RunTime time = time_of(map, map_file);
  add_revisits(score, truth, time, loops);
  const std::vector<LoopCandidate> candidates = map.candidates();
  add_ledger(score, candidates);
  for (const LoopCandidate& candidate : candidates) {
    const auto from = keyframes.find(candidate.from);
    const auto to = keyframes.find(candidate.to);
    if (from == keyframes.end() || to == keyframes.end()) {
      score.uncovered += candidate.verdict == CandidateVerdict::accepted ? 1U : 0U;
      continue;
    }
    const LoopError error =
        loop_error(candidate.T_from_to, from->second.T_world_keyframe, to->second.T_world_keyframe);
    if (candidate.verdict == CandidateVerdict::accepted) {
      ++score.accepted;
      score.false_ones += error.right ? 0U : 1U;
      if (error.right) {
        widen(score.span, from->second.stamp, to->second.stamp);
      }
      for (Revisit& revisit : score.revisits) {
        revisit.found |= error.right && finds(from->second, to->second, revisit, truth, time);
      }
    } else if (candidate.reason != to_string(LoopReason::too_little_overlap) &&
               candidate.reason != to_string(LoopReason::not_aligned)) {
      ++(error.right ? score.right_refused : score.wrong_refused);
    }
    score.loops.push_back({.candidate = candidate, .error = error});
  }
  if (score.accepted == 0 && score.uncovered > 0) {
    throw InputError(truth.file, {},
                     fmt::format("it covers none of the {} accepted loops of {}", score.uncovered,
                                 map_file.string()),
                     "Name the truth of the recording that was mapped, the whole of it");
  }
  return score;
}

MeasuredLoopScore score_loops(std::span<const MeasuredLoop> loops, const Trajectory& truth) {
  MeasuredLoopScore score;
  for (const MeasuredLoop& loop : loops) {
    const auto earlier = pose_at(truth, loop.earlier);
    const auto later = pose_at(truth, loop.later);
    if (!earlier || !later) {
      ++score.uncovered;
      continue;
    }
    ++score.accepted;
    if (loop_error(loop.T_earlier_later, *earlier, *later).right) {
      widen(score.span, loop.earlier, loop.later);
    } else {
      ++score.false_ones;
    }
  }
  return score;
}

std::string describe(const LoopScore& score) {
  const auto found = std::ranges::count(score.revisits, true, &Revisit::found);
  double metres = 0.0;
  double degrees = 0.0;
  for (const ScoredLoop& loop : score.loops) {
    if (loop.candidate.verdict == CandidateVerdict::accepted) {
      metres = std::max(metres, loop.error.metres);
      degrees = std::max(degrees, loop.error.degrees);
    }
  }
  std::string text = fmt::format(
      "loops        {} accepted, {} of them false (beyond {:.1f} m or {:.0f} degrees); off by up "
      "to "
      "{:.3f} m, {:.2f} degrees\n",
      score.accepted, score.false_ones, kFalseLoopMetres, kFalseLoopDegrees, metres, degrees);
  if (score.uncovered > 0) {
    text += fmt::format("             {} more are accepted that the truth does not cover\n",
                        score.uncovered);
  }
  text += fmt::format("             {} refused although measured rightly, {} refused with reason\n",
                      score.right_refused, score.wrong_refused);
  text += fmt::format("             {} candidates", score.offered);
  const std::string removed = reasons_text(score.removed);
  text += (removed.empty() ? "" : "; removed: " + removed) + "\n";
  text += score.revisits.empty()
              ? "revisits     none within the run"
              : fmt::format("revisits     {}, {} of them found", score.revisits.size(), found);
  if (score.pairs == 0) {
    text += ": the table holds no pair that sees half of the same from 5 m or less";
  } else if (score.not_of_run > 0) {
    text += fmt::format("; {} more are before or after the run", score.not_of_run);
  }
  return text + "\n";
}

std::vector<std::string> warnings_of(const LoopScore& score) {
  std::vector<std::string> warnings;
  if (score.uncovered > 0) {
    warnings.push_back(fmt::format(
        "{} of {} accepted loops are not covered by the truth: whether they are false is not known",
        score.uncovered, score.uncovered + score.accepted));
  }
  if (score.not_in_truth > 0) {
    warnings.push_back(
        fmt::format("{} of {} pairs that make revisits are not covered by the truth: revisits may "
                    "be missing",
                    score.not_in_truth, score.pairs));
  }
  return warnings;
}

nlohmann::ordered_json to_json(const LoopScore& score) {
  nlohmann::ordered_json json = {{"accepted", score.accepted},
                                 {"false", score.false_ones},
                                 {"right_refused", score.right_refused},
                                 {"wrong_refused", score.wrong_refused},
                                 {"not_covered", score.uncovered},
                                 {"revisits_not_of_run", score.not_of_run},
                                 {"pairs_not_covered", score.not_in_truth},
                                 {"offered", score.offered},
                                 {"removed", reasons_to_json(score.removed)},
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
         {"off_m", loop.error.metres},
         {"off_degrees", loop.error.degrees},
         {"right", loop.error.right}});
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
