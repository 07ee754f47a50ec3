// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/loop_score.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"
#include "adit/slam/mapping/loop_reason.hpp"
#include "adit/tools/evaluation/true_keyframes.hpp"
#include "adit/tools/maps/map_database.hpp"
#include "adit/tools/maps/map_trajectory.hpp"
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
constexpr const char* kWriteAnew = "Name the truth.loops.csv that `adit simulate` writes";

/// m of the truth's way between two moments.
double way(const Trajectory& truth, Nanoseconds begin, Nanoseconds end) {
  double length = 0.0;
  auto at = std::ranges::lower_bound(truth.poses, begin, {}, &StampedPose::stamp);
  for (; at != truth.poses.end() && at + 1 != truth.poses.end() && (at + 1)->stamp <= end; ++at) {
    length += ((at + 1)->pose.translation() - at->pose.translation()).norm();
  }
  return length;
}

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
    revisit.length = way(truth, revisit.begin, revisit.end);
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

/// The cells of a line; of Windows' line ends nothing is left.
std::vector<std::string> table_cells(std::string line) {
  while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0) {
    line.pop_back();
  }
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    cells.push_back(cell);
  }
  return cells;
}

double number_of(const std::string& cell, const std::filesystem::path& file, uint64_t line) {
  std::size_t used = 0;
  double value = std::nan("");
  try {
    value = std::stod(cell, &used);
  } catch (const std::exception&) {
    used = std::string::npos;
  }
  if (used != cell.size() || !std::isfinite(value)) {
    throw InputError(file, Place::line(line), "'" + cell + "' is no number", kWriteAnew);
  }
  return value;
}

}  // namespace

std::vector<TrueLoop> read_true_loops(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) {
    throw InputError(file, {}, "it cannot be read, or is empty", kWriteAnew);
  }
  const std::vector<std::string> head = table_cells(line);
  std::array<std::size_t, 4> wanted{};
  const std::array names = {"time_a_s", "time_b_s", "distance_m", "overlap"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto found = std::ranges::find(head, names[i]);
    if (found == head.end()) {
      throw InputError(file, Place::line(1), std::string("there is no column ") + names[i],
                       kWriteAnew);
    }
    wanted[i] = static_cast<std::size_t>(found - head.begin());
  }
  std::vector<TrueLoop> loops;
  for (uint64_t number = 2; std::getline(in, line); ++number) {
    const std::vector<std::string> cells = table_cells(line);
    if (cells.empty()) {
      continue;
    }
    if (cells.size() < head.size()) {
      throw InputError(file, Place::line(number), "the line ends early", kWriteAnew);
    }
    std::array<double, 4> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = number_of(cells[wanted[i]], file, number);
    }
    loops.push_back({.earlier = nanoseconds(values[0]),
                     .later = nanoseconds(values[1]),
                     .distance = values[2],
                     .overlap = values[3]});
    if (loops.back().later <= loops.back().earlier) {
      throw InputError(file, Place::line(number), "the second moment is not later than the first",
                       kWriteAnew);
    }
  }
  return loops;
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

LoopScore score_loops(const std::filesystem::path& map_file, const Trajectory& truth,
                      const std::vector<TrueLoop>& loops) {
  const MapDatabase map(map_file, MapAccess::read);
  const std::map<NodeId, TrueKeyframe> keyframes = true_keyframes(map, map_file, truth);
  LoopScore score;
  const RunTime time = time_of(map, map_file);
  add_revisits(score, truth, time, loops);
  for (const LoopCandidate& candidate : map.candidates()) {
    const auto from = keyframes.find(candidate.from);
    const auto to = keyframes.find(candidate.to);
    if (from == keyframes.end() || to == keyframes.end()) {
      score.uncovered += candidate.verdict == CandidateVerdict::accepted ? 1U : 0U;
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
        revisit.found |= scored.right && finds(from->second, to->second, revisit, truth, time);
      }
    } else if (candidate.reason != to_string(LoopReason::too_little_overlap) &&
               candidate.reason != to_string(LoopReason::not_aligned)) {
      ++(scored.right ? score.right_refused : score.wrong_refused);
    }
    score.loops.push_back(std::move(scored));
  }
  if (score.accepted == 0 && score.uncovered > 0) {
    throw InputError(truth.file, {},
                     fmt::format("it covers none of the {} accepted loops of {}", score.uncovered,
                                 map_file.string()),
                     "Name the truth of the recording that was mapped, the whole of it");
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
