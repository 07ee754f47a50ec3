// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "adit/tools/results/high_rate_output.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/run/map_use.hpp"
#include "adit/tools/run/served_page.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {

/// What `adit run` and `adit live` are asked to do.
struct RunCommandOptions {
  std::filesystem::path recording;  ///< empty: that of the map that is gone on with or begun from
  std::vector<std::filesystem::path> further_recordings{};  ///< parts of it that follow in time
  std::filesystem::path output;  ///< empty: default_output() of the recording
  ConfigSource config{};
  DeviceOptions device{};
  MapOptions map{};
  HighRateOptions high_rate{};
  std::optional<std::string> topic{};        ///< the sweeps' topic; none: the only one
  std::vector<std::string> merged_topics{};  ///< further topics of sweeps that are merged with it
  std::optional<int64_t> start{};  ///< the first sweep, counted from 0; none: the first of all
  std::optional<int64_t> count{};  ///< none: to the end
  bool continues = false;          ///< the output's map is gone on with
  std::optional<std::filesystem::path> from{};      ///< a map whose recording and settings to take
  MapUseOptions earlier_map{};                      ///< a map of earlier sessions, and its use
  uint64_t max_ram_bytes = 0;                       ///< that may be resident; 0: no limit
  bool odometry = false;                            ///< odometry alone: no map, loops or GNSS
  bool overwrite = false;                           ///< an earlier run's results are replaced
  bool strict = false;                              ///< anything but a reliable run is a failure
  bool strict_input = false;                        ///< the first damage ends the run
  bool json = false;                                ///< summary.json on `out` instead of the table
  bool quiet = false;                               ///< errors alone
  bool stage_table = false;                         ///< the table with every stage
  std::optional<std::filesystem::path> timeline{};  ///< .html or .json: what worked when
  bool keeps = true;                                ///< false: `output` goes away in the end
  bool view = false;                                ///< the run is shown in a browser
  ServeOptions serve{};                             ///< where, if so
};

/// The recording and those that are parts of it.
std::vector<std::filesystem::path> recordings_of(const RunCommandOptions& options);
/// Sets them; empty: none is named.
void take_recordings(RunCommandOptions& options, const std::vector<std::filesystem::path>& all);

}  // namespace adit
