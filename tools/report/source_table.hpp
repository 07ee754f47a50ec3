// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The sources of a run, out of what was counted.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/mapping/mapper.hpp"
#include "adit/tools/results/run_sources.hpp"

namespace adit {

class RunStatistics;

/// One of several range sensors whose sweeps are merged.
struct MergedLidar {
  std::string topic;
  std::size_t sweeps = 0;  ///< merged ones with points of this sensor
  std::size_t of = 0;      ///< merged ones in all
};

/// Those of the motion so far. `lidars`: none where there is one range sensor.
std::vector<SourceWorth> motion_sources(const RunStatistics& statistics,
                                        const std::vector<MergedLidar>& lidars = {});

/// Those of the map at the run's end.
std::vector<SourceWorth> map_sources(const MapReport& map, const Config& config);

}  // namespace adit
