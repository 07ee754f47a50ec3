// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/tools/inspection/inspection.hpp"

namespace adit {

/// What was inferred about a topic, for people.
struct Inference {
  std::string topic;
  std::string text;  ///< one line, with how sure it is
};
std::vector<Inference> infer(const Inspection& inspection);

/// The configuration with what makes up for the recording's faults: topics, the unit of the times
/// of points, scales, offsets of clocks, the mounting of an IMU whose
/// transform is wrong or missing, and the spacing of the beams. `read_with` is the one that
/// the recording was read with; corrections add to it.
Config suggest_config(const Inspection& inspection, const Config& read_with);

/// suggest_config() as a file for `--config`, with the inferences and findings as comments.
std::string suggested_toml(const Inspection& inspection, const Config& read_with);

}  // namespace adit
