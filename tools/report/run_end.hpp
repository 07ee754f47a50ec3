// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <exception>
#include <optional>
#include <string>
#include <string_view>

#include "adit/slam/executor/measurement_gate.hpp"
#include "adit/slam/mapping/mapper.hpp"

namespace adit {

/// How a run ended. Whatever the end, what was computed before it is written.
enum class RunEnd {
  completed,
  interrupted,   ///< the user asked for it
  input_error,   ///< a sweep could not be read
  output_error,  ///< a result could not be written
  device_error,  ///< the device or its memory failed
  memory_limit,  ///< more memory was needed than it was allowed
  failed,        ///< something else went wrong, in the program or its host memory
};
std::string_view to_string(RunEnd end);
/// How a run ends with an error of its files, or another.
RunEnd end_of(const std::exception& error);

/// A part of a recording.
struct SweepRange {
  std::size_t first = 0;
  std::size_t count = 0;
};

struct MappingResult {
  RunEnd end = RunEnd::completed;
  std::string reason;              ///< for people; empty when completed
  std::optional<MapReport> map{};  ///< where one was made and could be ended
  MeasurementFaults faults{};      ///< values that no sensor measures
};

}  // namespace adit
