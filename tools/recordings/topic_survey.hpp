// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What topics of sensors hold, by their first messages: a topic's name and type say too little.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// The name of a frame without leading slashes, which tf's first version wrote.
std::string plain_frame(const std::string& frame);

/// What the first messages of a topic are like that come from one frame.
struct SensorSample {
  std::string frame;       ///< without leading slashes; empty where the messages name none
  std::size_t events = 0;  ///< among the first of the topic
  double rate = 0.0;       ///< Hz, by the median of the intervals of stamps; 0 where unknown
  std::string fault;       ///< why a run cannot use them, a clause; empty where it can
};

/// The frames of a topic of sweeps, readings, fixes, velocities or headings by its first messages
/// (10, 400 and 50), the one with most of them first. A topic of odometry counts as one of
/// velocities; `headings`: one of an IMU counts as one of headings.
/// Messages without a frame count for the frame with most. Empty where not one can be read; damage
/// is passed over.
std::vector<SensorSample> first_samples(const Recording& recording, std::size_t topic,
                                        bool headings = false);

/// Why a run cannot use a topic, by its first messages; empty where it can.
std::string fault_of_topic(const Recording& recording, std::size_t topic);

}  // namespace adit
