// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/run_mapping.hpp"

#include <chrono>
#include <filesystem>

#include "engine/error.hpp"
#include "tools/input_error.hpp"

namespace adit {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

constexpr std::size_t kNotedFailures = 5;  // the others are in the summary

void note_failure(Progress& progress, const SweepFailure& failure, std::size_t failures) {
  if (failures <= kNotedFailures) {
    const std::string file = std::filesystem::path(failure.source).filename().string();
    progress.note("sweep " + std::to_string(failure.index) +
                  (file.empty() ? "" : " (" + file + ")") + ", " +
                  std::string(to_string(failure.state)) + ": " + failure.reason);
  }
  if (failures == kNotedFailures) {
    progress.note("further failures are listed in summary.json only");
  }
}

/// One turn of the loop.
void map_sweep(const Mapping& mapping, std::size_t index) {
  const auto start = Clock::now();
  const Sweep sweep = mapping.recording.read(index);
  HostTimes times{.read = ms_since(start)};
  const SweepResult result = mapping.place(sweep);
  times.host = result.host_ms;
  times.wait = result.wait_ms;
  const auto placed = Clock::now();
  mapping.outputs.write(result);
  times.write = ms_since(placed);
  const auto failure = mapping.statistics.add(index, sweep, result, times);
  if (failure && !mapping.quiet) {
    note_failure(mapping.progress, *failure, mapping.statistics.failures().size());
  }
}

}  // namespace

std::string_view to_string(RunEnd end) {
  switch (end) {
    case RunEnd::completed:
      return "completed";
    case RunEnd::interrupted:
      return "interrupted";
    case RunEnd::input_error:
      return "input_error";
    case RunEnd::output_error:
      return "output_error";
    case RunEnd::device_error:
      return "device_error";
  }
  return "unknown";
}

MappingResult map_recording(const Mapping& mapping) {
  try {
    for (std::size_t done = 0; done < mapping.range.count; ++done) {
      if (mapping.stop()) {
        return {RunEnd::interrupted,
                "stopped by a signal after " + std::to_string(done) + " sweeps"};
      }
      map_sweep(mapping, mapping.range.first + done);
      mapping.progress.update(done + 1, mapping.statistics.failures().size());
    }
  } catch (const InputError& error) {
    return {RunEnd::input_error, error.what()};
  } catch (const OutputError& error) {
    return {RunEnd::output_error, error.what()};
  } catch (const engine::Error& error) {
    return {RunEnd::device_error, error.what()};
  }
  return {};
}

}  // namespace adit
