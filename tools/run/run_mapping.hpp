// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The loop of `adit run`: take a sweep, place it, write it, until the recording ends or something
// ends it early. The recording is read ahead in a thread of its own.
#pragma once

#include <cstddef>
#include <exception>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/executor/slam.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/report/run_end.hpp"
#include "adit/tools/report/run_statistics.hpp"
#include "adit/tools/report/run_timeline.hpp"
#include "adit/tools/results/high_rate_output.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/setup/memory_limit.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/progress.hpp"

namespace adit {

/// What map_recording() works with.
struct Mapping {
  const Recording& recording;
  std::size_t topic;  ///< index of the sweeps' topic
  SweepRange range;
  std::filesystem::path path{};                 ///< of the recording, for messages to people
  std::optional<std::size_t> imu_topic{};       ///< none: there is none, or it is not used
  std::optional<std::size_t> gnss_topic{};      ///< likewise
  std::optional<std::size_t> velocity_topic{};  ///< likewise
  std::optional<std::size_t> heading_topic{};   ///< likewise
  Slam& slam;
  std::function<bool()> stop;  ///< asked before each event is taken
  /// Gets what is damaged, and the run goes on behind it; empty: damage ends the run.
  std::function<void(const InputError&)> damaged{};
  const MemoryLimit* memory = nullptr;  ///< none: no limit
  RunOutputs& outputs;
  HighRateOutput* high_rate = nullptr;  ///< none: not asked for
  RunStatistics& statistics;
  RunTimeline* timeline = nullptr;  ///< none: not asked for
  /// Gets each sweep that was placed, when it is written and counted; empty: nobody wants them.
  std::function<void(const SweepPlaced&)> placed{};
  Progress& progress;
  bool quiet = false;  ///< no note on each failed sweep
};

/// Maps the sweeps of the range in their order. Does not close the outputs.
MappingResult map_recording(const Mapping& mapping);

}  // namespace adit
