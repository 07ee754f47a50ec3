// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/source_table.hpp"

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/report/gnss_text.hpp"
#include "adit/tools/report/loop_reasons.hpp"
#include "adit/tools/report/run_statistics.hpp"

namespace adit {
namespace {

SourceWorth lidar_source(const RunStatistics& statistics) {
  const std::size_t failed = statistics.failures().size();
  return {.name = "lidar",
          .unit = "sweeps",
          .used = statistics.sweeps() - failed,
          .refused = failed,
          .innovation_squared = statistics.shares().innovation_squared(),
          .shares = statistics.shares().of(MotionSource::range)};
}

SourceWorth imu_source(const RunStatistics& statistics) {
  const InertialStatistics& imu = statistics.inertial();
  const std::size_t fused = imu.count(InertialState::fused);
  const std::size_t refused = imu.count(InertialState::lost) + imu.count(InertialState::refused);
  return {.name = "imu",
          .unit = "sweeps",
          .used = fused,
          .refused = refused,
          .left_out = statistics.sweeps() - fused - refused,
          .remark = imu.why_not_fused(),
          .shares = statistics.shares().of(MotionSource::imu)};
}

std::size_t count_of(const GnssReport& gnss, FixVerdict verdict) {
  return gnss.verdicts[static_cast<std::size_t>(verdict)];
}

std::size_t count_of(const HeadingReport& heading, HeadingVerdict verdict) {
  return heading.verdicts[static_cast<std::size_t>(verdict)];
}

/// The shares of a map, where they are known.
std::vector<std::pair<std::string, double>> shares_of(const MapReport& map, MapSource source) {
  std::vector<std::pair<std::string, double>> shares;
  for (std::size_t k = 0; map.shares && k < kMapParts; ++k) {
    const auto part = static_cast<MapPart>(k);
    shares.emplace_back(to_string(part), (*map.shares)(source, part));
  }
  return shares;
}

SourceWorth loop_source(const MapReport& map) {
  const LoopReport& loops = *map.loops;
  const std::size_t refused =
      std::accumulate(loops.refused.begin(), loops.refused.end(), std::size_t{0});
  const std::string reasons = reasons_text(loops.refused);
  return {.name = "loops",
          .estimate = SourceEstimate::map,
          .unit = "loops",
          .used = loops.accepted,
          .refused = refused,
          .left_out = loops.candidates - std::min(loops.candidates, loops.accepted + refused),
          .remark = reasons.empty() ? "" : "refused: " + reasons,
          .innovation_squared =
              loops.accepted > 0 ? std::optional(loops.residual_squared) : std::nullopt,
          .shares = shares_of(map, MapSource::loops)};
}

SourceWorth fix_source(const MapReport& map, const Config& config) {
  const GnssReport& gnss = map.gnss;
  const std::size_t used = count_of(gnss, FixVerdict::used);
  const std::size_t refused = count_of(gnss, FixVerdict::outlier) +
                              count_of(gnss, FixVerdict::frozen) +
                              count_of(gnss, FixVerdict::impossible);
  return {.name = "gnss",
          .topic = config.recording.gnss_topic.value_or(""),
          .estimate = SourceEstimate::map,
          .unit = "fixes",
          .used = used,
          .refused = refused,
          .left_out =
              gnss.fixes - used - refused + gnss.without_position + gnss.outside + gnss.left_out,
          .remark = used == 0 ? why_not_placed(gnss) : "",
          .innovation_squared = used > 0 ? std::optional(gnss.innovation_squared) : std::nullopt,
          .shares = shares_of(map, MapSource::fixes)};
}

SourceWorth heading_source(const MapReport& map, const Config& config) {
  const HeadingReport& heading = map.gnss.heading;
  const std::size_t used = count_of(heading, HeadingVerdict::used);
  const std::size_t refused =
      count_of(heading, HeadingVerdict::outlier) + count_of(heading, HeadingVerdict::frozen) +
      count_of(heading, HeadingVerdict::impossible) + count_of(heading, HeadingVerdict::refused);
  return {.name = "headings",
          .topic = config.recording.heading_topic.value_or(""),
          .estimate = SourceEstimate::map,
          .unit = "headings",
          .used = used,
          .refused = refused,
          .left_out = heading.headings - used - refused + heading.outside + heading.left_out,
          .remark = used == 0 ? why_not_used(heading) : "",
          .innovation_squared = used > 0 ? std::optional(heading.innovation_squared) : std::nullopt,
          .shares = shares_of(map, MapSource::headings)};
}

}  // namespace

std::vector<SourceWorth> motion_sources(const RunStatistics& statistics,
                                        const std::vector<MergedLidar>& lidars) {
  std::vector<SourceWorth> sources = {lidar_source(statistics)};
  for (const MergedLidar& one : lidars) {
    sources.push_back({.name = "lidar",
                       .topic = one.topic,
                       .unit = "sweeps",
                       .used = one.sweeps,
                       .left_out = one.of - std::min(one.of, one.sweeps)});
  }
  if (statistics.inertial().any()) {
    sources.push_back(imu_source(statistics));
  }
  for (SourceWorth& one : statistics.velocity().sources(statistics.config(), statistics.shares())) {
    sources.push_back(std::move(one));
  }
  if (std::vector shares = statistics.shares().of(MotionSource::start); !shares.empty()) {
    sources.push_back({.name = "start",
                       .unit = "states",
                       .used = 1,
                       .remark = "what was known when the IMU started",
                       .shares = std::move(shares)});
  }
  return sources;
}

std::vector<SourceWorth> map_sources(const MapReport& map, const Config& config) {
  std::vector<SourceWorth> sources = {{.name = "odometry",
                                       .estimate = SourceEstimate::map,
                                       .unit = "edges",
                                       .used = map.edges,
                                       .shares = shares_of(map, MapSource::odometry)}};
  if (map.loops) {
    sources.push_back(loop_source(map));
  }
  if (map.gnss.any()) {
    sources.push_back(fix_source(map, config));
  }
  if (!describe(map.gnss.heading).empty()) {
    sources.push_back(heading_source(map, config));
  }
  if (map.shares) {
    sources.push_back({.name = "verticals",
                       .estimate = SourceEstimate::map,
                       .unit = "",
                       .remark = "which way is up, by gravity or the ground",
                       .shares = shares_of(map, MapSource::verticals)});
  }
  return sources;
}

}  // namespace adit
