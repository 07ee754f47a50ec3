// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/core/frame_tree.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/topics/topic_statistics.hpp"

namespace adit {

enum class Severity {
  notice,   ///< to know; nothing need be done
  problem,  ///< mapping will suffer or fail
};
std::string_view to_string(Severity severity);

/// Something about a recording, for people.
struct Finding {
  Severity severity = Severity::notice;
  std::string kind;    ///< a word for programs, e.g. "accelerometer_unit"
  std::string topic;   ///< empty: the recording as a whole
  std::string found;   ///< what, with the numbers
  std::string effect;  ///< on mapping
  std::string remedy;
};

/// What of the other topics counts for one of them.
struct OtherTopics {
  bool simulated_time = false;  ///< stamps are not compared with the recorder's clock
  bool shared_clock = false;    ///< see share_a_clock(): an offset to the recorder's does no harm
  std::string range_frame{};    ///< of the range sensor
};

/// What is wrong with a topic, or worth knowing. Finds: an accelerometer in g, gravity along -z,
/// gaps, stamps that repeat or go back, a clock that is off the recorder's by leap seconds or an
/// epoch, or that restarts on the way, sweeps without times or returns, directions that are hidden,
/// and point times in the wrong unit. What a run makes up for by itself is a notice. Stamps of
/// poses are looked at frame by frame. `frames` tell how an IMU is mounted.
std::vector<Finding> find_in_topic(const Topic& topic, const TopicStatistics& statistics,
                                   const FrameTree& frames, const OtherTopics& others = {});

/// True where the clocks of all range sensors, IMUs and receivers that are `used` (one a topic)
/// agree within a second.
bool share_a_clock(const std::vector<Topic>& topics, const std::vector<TopicStatistics>& statistics,
                   const std::vector<bool>& used);

/// True where the recording has a clock of its own, as simulators and replays publish one
/// (use_sim_time).
bool has_simulated_time(const std::vector<Topic>& topics);

/// What is wrong with the recording as a whole: no sweeps, depth images that are none.
std::vector<Finding> find_in_recording(const std::vector<Topic>& topics);

/// What is damaged, as a finding.
Finding damage_finding(const InputError& error);

}  // namespace adit
