// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "adit/tools/inspection/recording_findings.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/topics/timeline.hpp"
#include "adit/tools/topics/topic_statistics.hpp"

namespace adit {

/// How a topic's clock runs against the recorder's.
struct ClockTrend {
  double rate = 0.0;   ///< s/s; 1e-4: it gains 0.1 ms a second
  double sigma = 0.0;  ///< s/s, standard deviation of the rate
  double span = 0.0;   ///< s
};

/// The line through the shortest delays of a topic's events. Nothing where there are too few, or
/// where its two halves do not tell the same: a queue that fills is no clock.
std::optional<ClockTrend> clock_trend(const TopicTimeline& timeline);

/// Topics whose clock runs at another rate than that of the sweeps on the topic `range`, by 5 ms or
/// more over the recording. `statistics`: one a topic.
std::vector<Finding> find_clock_drift(const std::vector<Topic>& topics,
                                      const std::vector<TopicStatistics>& statistics,
                                      std::optional<std::size_t> range);

}  // namespace adit
