// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/run_mapping.hpp"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <variant>

#include "engine/error.hpp"
#include "tools/input_error.hpp"
#include "tools/sweep_feed.hpp"

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

void take_reading(const Mapping& mapping, const ImuSample& sample) {
  const ImuArrival arrival = mapping.reading(sample);
  mapping.statistics.add(arrival);
  if (mapping.high_rate != nullptr) {
    mapping.high_rate->add(sample, arrival);
  }
}

/// One turn of the loop. Returns false where there is no further sweep.
bool map_sweep(const Mapping& mapping, SweepFeed& feed, std::size_t index) {
  const auto start = Clock::now();
  const std::optional<Event> event = feed.next();
  if (!event) {
    return false;
  }
  const Sweep& sweep = std::get<Sweep>(event->value);
  index = event->number.value_or(index);
  const std::optional<Nanoseconds> last = mapping.statistics.last_stamp();
  if (last && sweep.stamp <= *last) {
    const auto note = mapping.statistics.left_out().add_sweep(index, sweep, *last);
    if (note && !mapping.quiet) {
      mapping.progress.note(*note);
    }
    return true;
  }
  HostTimes times{.read = ms_since(start)};
  const SweepResult result = mapping.place(sweep);
  times.host = result.host_ms;
  times.inertial = result.inertial_ms;
  times.wait = result.wait_ms;
  const auto placed = Clock::now();
  mapping.outputs.write(result, index);
  if (mapping.high_rate != nullptr) {
    mapping.high_rate->update(result.inertial);
  }
  times.write = ms_since(placed);
  const auto failure = mapping.statistics.add(index, sweep, result, times);
  if (!result.inertial.event.empty() && !mapping.quiet) {
    mapping.progress.note("sweep " + std::to_string(index) + ": IMU " +
                          std::string(to_string(result.inertial.state)) + ": " +
                          result.inertial.event);
  }
  if (failure && !mapping.quiet) {
    note_failure(mapping.progress, *failure, mapping.statistics.failures().size());
  }
  return true;
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
    SweepFeed feed(
        mapping.recording,
        {.sweeps = mapping.topic, .imu = mapping.imu_topic, .first = mapping.range.first},
        [&](const ImuSample& sample) { take_reading(mapping, sample); });
    for (std::size_t done = 0; done < mapping.range.count; ++done) {
      if (mapping.stop()) {
        return {RunEnd::interrupted,
                "stopped by a signal after " + std::to_string(done) + " sweeps"};
      }
      if (!map_sweep(mapping, feed, mapping.range.first + done)) {
        break;
      }
      mapping.progress.update(done + 1, mapping.statistics.failures().size());
    }
    // Behind the last sweep that could be counted, a recording that was cut off says so.
    const std::size_t behind = mapping.range.first + mapping.range.count;
    if (behind == mapping.recording.topics()[mapping.topic].messages) {
      feed.next();
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
