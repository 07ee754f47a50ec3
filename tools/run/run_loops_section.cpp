// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/run_loops_section.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/core/units.hpp"
#include "adit/tools/drawing/markup.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_edits/loop_drift.hpp"
#include "adit/tools/map_edits/loops_picture.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

/// The middle one and the largest.
std::string spread_of(std::vector<double> values, const char* unit) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return fmt::format("{:.3f} {} (median), {:.3f} {} at most", *middle, unit,
                     *std::ranges::max_element(values), unit);
}

/// At the ends of accepted loops, beside what these have measured.
std::string drift_at_loops(const PoseGraph& graph, const std::vector<LoopCandidate>& loops) {
  const std::map<NodeId, ChainPlace> places = chain_places(graph);
  std::vector<double> before;
  std::vector<double> after;
  for (const LoopCandidate& loop : loops) {
    if (loop.verdict != CandidateVerdict::accepted) {
      continue;
    }
    const LoopDrift drift = drift_of(loop, places, graph);
    if (drift.odometry) {
      before.push_back(drift.odometry->metres);
      after.push_back(drift.map.metres);
    }
  }
  if (before.empty()) {
    return "";
  }
  return "<p>Drift at accepted loops, beside what they measured:</p><dl><dt>odometry "
         "alone</dt><dd>" +
         spread_of(before, "m") + "</dd><dt>map</dt><dd>" + spread_of(after, "m") + "</dd></dl>\n";
}

/// Where the map has other poses than the odometry.
std::string drift_taken_back(const RunFiles& files) {
  const Trajectory odometry = read_trajectory(files.odometry);
  const Trajectory map = read_trajectory(files.tum);
  double most = 0.0;
  double at = 0.0;
  double end = 0.0;
  auto other = odometry.poses.begin();
  for (const StampedPose& pose : map.poses) {
    other = std::lower_bound(
        other, odometry.poses.end(), pose.stamp,
        [](const StampedPose& one, Nanoseconds stamp) { return one.stamp < stamp; });
    if (other == odometry.poses.end() || other->stamp != pose.stamp) {
      continue;
    }
    end = (pose.pose.translation() - other->pose.translation()).norm();
    if (end > most) {
      most = end;
      at = seconds(pose.stamp - map.poses.front().stamp);
    }
  }
  return fmt::format(
      "<p>Drift taken back: the map lies up to {:.3f} m from the odometry ({:.1f} s after the "
      "start), and {:.3f} m at the end.</p>\n",
      most, at, end);
}

bool is_there(const std::filesystem::path& file) {
  std::error_code unknown;
  return std::filesystem::is_regular_file(file, unknown);
}

LoopsSection section_of(const RunFiles& files) {
  const MapDatabase map(files.database, MapAccess::read);
  const PoseGraph graph = map.graph();
  std::vector<LoopCandidate> loops = map.candidates();
  std::erase_if(loops, [&](const LoopCandidate& loop) {
    return !graph.contains(loop.from) || !graph.contains(loop.to);  // `adit check` tells of them
  });
  if (loops.empty()) {
    return {};
  }
  const auto accepted =
      std::ranges::count(loops, CandidateVerdict::accepted, &LoopCandidate::verdict);
  LoopsSection section{.headline = fmt::format("{} of {} loops accepted", accepted, loops.size()),
                       .body = loop_counts(loops) + drift_at_loops(graph, loops)};
  if (is_there(files.odometry) && is_there(files.tum)) {
    section.body += drift_taken_back(files);
  }
  section.body += loops_from_above(map, graph, loops);
  // Without the folder's name: the same run gives the same page, wherever it is written.
  section.body += "<p><small>`adit loops OUT --html FILE` shows them one by one.</small></p>\n";
  return section;
}

}  // namespace

LoopsSection run_loops_section(const RunFiles& files) {
  if (!is_there(files.database)) {
    return {};
  }
  try {
    return section_of(files);
  } catch (const FileError& error) {
    return {.headline = "The loops cannot be shown",
            .body = "<p>" + escape_markup(error.what()) + "</p>\n"};
  }
}

}  // namespace adit
