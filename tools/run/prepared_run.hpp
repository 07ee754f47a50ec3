// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <iosfwd>
#include <memory>
#include <optional>

#include "adit/slam/core/config.hpp"
#include "adit/tools/recordings/merged_sweeps.hpp"
#include "adit/tools/recordings/one_sensor.hpp"
#include "adit/tools/run/map_use.hpp"
#include "adit/tools/run/run_job.hpp"
#include "adit/tools/setup/sensor_topics.hpp"

namespace adit {

/// The sweeps to map, and where they come from.
struct SweepChoice {
  std::size_t topic = 0;
  std::size_t size = 0;  ///< sweeps in the recording
  SweepRange range;
  bool counted = true;  ///< false: how many come is known in the end
};

/// A run before anything of it is written.
struct PreparedRun {
  bool replaces_a_run = false;  ///< the folder holds the results of one
  Config config;
  RunSource source;
  SweepChoice sweeps;
  RecordedSensors sensors;
  std::optional<MapUse> map_use{};               ///< of an earlier map
  std::optional<std::size_t> gnss{};             ///< the topic whose fixes are used
  std::size_t most_points = 0;                   ///< of a sweep
  std::unique_ptr<OneSensorRecording> mapped{};  ///< what is mapped; it refers to `source`
  std::unique_ptr<MergedRecording> merged{};     ///< the same, of all range sensors
};

/// Opens the source and chooses the topics. Throws InputError and UsageError.
PreparedRun prepare(const WantedRun& chosen, const OpenSource& open, std::ostream& err);

}  // namespace adit
