// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/publishing/topic_publisher.hpp"
#include "adit/tools/run/run_options.hpp"

namespace adit {

/// What `adit live` is asked for.
struct LiveOptions {
  std::vector<std::string> sources{};     ///< udp://ADDRESS:PORT, ROS 2 topics, or one recording
  RunCommandOptions run{};                ///< its recording is set by the source
  double wait_s = 10.0;                   ///< for the first packets or messages
  double speed = 1.0;                     ///< of a recording; 0: no pace
  double duration_s = 0.0;                ///< of receiving; 0: until a signal
  bool lists = false;                     ///< the topics are listed, and nothing is mapped
  bool publishes = false;                 ///< to ROS 2, what a run of topics comes to
  RosFrames frames{};                     ///< that are published
  bool record = true;                     ///< what arrived stays in OUT
  bool restarts = false;                  ///< after a failure of the device: in a next session
  bool log_json = false;                  ///< notes as lines of JSON
  std::optional<uint64_t> status_port{};  ///< of /health and /metrics; none: not served
};

}  // namespace adit
