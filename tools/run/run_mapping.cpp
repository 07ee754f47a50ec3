// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/run_mapping.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include "adit/engine/error.hpp"
#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tools/clouds/cloud_origin.hpp"
#include "adit/tools/recordings/events_ahead.hpp"
#include "adit/tools/recordings/steady_stamps.hpp"
#include "adit/tools/report/inertial_text.hpp"
#include "adit/tools/setup/device_session.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

using Clock = std::chrono::steady_clock;

ClockSpan since(Clock::time_point start) {
  return {.begin = start, .end = Clock::now()};
}

constexpr Nanoseconds kBehind = std::chrono::seconds(1);
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

/// What the loop has done by now.
struct Mapped {
  std::size_t sweeps = 0;
  std::size_t added = 0;                      ///< sweeps, of which some may not be placed yet
  std::size_t passed_over = 0;                ///< sweeps before the range
  HostTimes times{};                          ///< of reading, since the last sweep
  Clock::time_point last_end = Clock::now();  ///< of the last sweep
  std::size_t read = 0;                       ///< sweeps
  std::optional<Nanoseconds> newest{};        ///< latest stamp of the sweeps that were read
  std::set<Nanoseconds> stepped_back{};  ///< stamps that came after a later one, not placed yet
};

void write(const Mapping& mapping, const ReadingTaken& reading) {
  mapping.statistics.add(reading.arrival);
  if (mapping.high_rate != nullptr && reading.motion) {
    mapping.high_rate->write(*reading.motion);
  }
}

void add_to_timeline(const Mapping& mapping, const SweepPlaced& placed, std::size_t index,
                     const ClockSpan& written) {
  if (mapping.timeline == nullptr) {
    return;
  }
  const auto add = [&](TimelineLane lane, const ClockSpan& span, bool waits = false) {
    mapping.timeline->add({.lane = lane, .sweep = index, .span = span, .waits = waits});
  };
  const SweepClock& clock = placed.result.clock;
  const auto map_ms = std::chrono::duration<double, std::milli>(placed.map_ms);
  add(TimelineLane::host, {clock.begun, clock.submitted});
  add(TimelineLane::host, {clock.submitted, clock.done}, true);
  add(TimelineLane::host, {clock.done, clock.ended});
  add(TimelineLane::device, {clock.submitted, clock.done});
  add(TimelineLane::host,
      {clock.ended, clock.ended + std::chrono::duration_cast<Clock::duration>(map_ms)}, true);
  add(TimelineLane::map, {placed.map_begun, placed.map_ended});
  add(TimelineLane::write, written);
}

void write(const Mapping& mapping, const SweepPlaced& placed, std::size_t index, Mapped& done) {
  const SweepResult& result = placed.result;
  HostTimes times = std::exchange(done.times, {});
  times.host = result.host_ms;
  times.wait = result.wait_ms;
  times.inertial = result.inertial_ms;
  times.map = placed.map_ms;
  const auto start = Clock::now();
  mapping.outputs.write(result, index, placed.mapped);
  if (mapping.high_rate != nullptr) {
    mapping.high_rate->flush();
  }
  const ClockSpan written = since(start);
  times.write = written.ms();
  times.total = ClockSpan{std::exchange(done.last_end, written.end), written.end}.ms();
  add_to_timeline(mapping, placed, index, written);
  const auto failure = mapping.statistics.add(index, placed.sweep, result, times);
  if (result.inertial.event && !mapping.quiet) {
    mapping.progress.note("sweep " + std::to_string(index) + ": IMU " +
                          std::string(to_string(result.inertial.state)) + ": " +
                          describe(*result.inertial.event));
  }
  if (failure && !mapping.quiet) {
    note_failure(mapping.progress, *failure, mapping.statistics.failures().size());
  }
  if (mapping.placed) {
    mapping.placed(placed);
  }
}

void note(const Mapping& mapping, const std::optional<std::string>& text) {
  if (text && !mapping.quiet) {
    mapping.progress.note(*text);
  }
}

/// Writes what has become known, up to the end of the range.
void write_results(const Mapping& mapping, Mapped& done) {
  while (done.sweeps < mapping.range.count) {
    const std::optional<SlamResult> result = mapping.slam.next();
    if (!result) {
      return;
    }
    if (const auto* reading = std::get_if<ReadingTaken>(&*result)) {
      write(mapping, *reading);
      continue;
    }
    const std::size_t counted = mapping.range.first + done.sweeps;
    if (const auto* left_out = std::get_if<SweepLeftOut>(&*result)) {
      done.stepped_back.erase(left_out->sweep.stamp);
      note(mapping, mapping.statistics.left_out().add_sweep(
                        left_out->sweep.number.value_or(counted), left_out->sweep, left_out->last));
    } else {
      const auto& placed = std::get<SweepPlaced>(*result);
      if (done.stepped_back.erase(placed.sweep.stamp) > 0) {
        note(mapping,
             mapping.statistics.left_out().add_put_in_order(placed.sweep.number.value_or(counted)));
      }
      write(mapping, placed, placed.sweep.number.value_or(counted), done);
    }
    ++done.sweeps;
    mapping.progress.update(done.sweeps, mapping.statistics.failures().size());
  }
}

/// Sensors besides the range sensor.
bool has_others(const Mapping& mapping) {
  return mapping.imu_topic || mapping.gnss_topic || mapping.velocity_topic || mapping.heading_topic;
}

void add(const Mapping& mapping, Event event, Mapped& done) {
  if (auto* sweep = std::get_if<Sweep>(&event.value)) {
    // Of sweeps alone the recording passes over those before the range itself.
    if (has_others(mapping) && done.passed_over < mapping.range.first) {
      ++done.passed_over;
      return;
    }
    if (done.added == mapping.range.count) {
      // Of what comes behind the range the last sweeps wait for readings no longer than usual.
      if (done.newest && sweep->stamp > *done.newest + kBehind) {
        mapping.slam.flush();
      }
      return;
    }
    if (done.added == 0 && !sweep->offset.isZero(0.0)) {
      note(mapping, offset_note(sweep->offset));
    }
    ++done.added;
    sweep->number = event.number;
    if (done.newest && sweep->stamp < *done.newest) {
      done.stepped_back.insert(sweep->stamp);
    }
    done.newest = std::max(done.newest.value_or(sweep->stamp), sweep->stamp);
    mapping.slam.add(std::move(*sweep), event.frame);
  } else if (const auto* reading = std::get_if<ImuSample>(&event.value)) {
    if (event.topic == mapping.imu_topic) {  // else it came along with a heading
      mapping.slam.add(*reading, event.frame);
    }
  } else if (const auto* fix = std::get_if<GnssFix>(&event.value)) {
    mapping.slam.add(*fix, event.frame);
  } else if (const auto* velocity = std::get_if<BodyVelocity>(&event.value)) {
    mapping.slam.add(*velocity, event.frame);
  } else if (const auto* heading = std::get_if<Heading>(&event.value)) {
    mapping.slam.add(*heading, event.frame);
  }
}

std::unique_ptr<EventStream> open_events(const Mapping& mapping) {
  if (!has_others(mapping)) {
    return mapping.recording.events({.topics = {mapping.topic}, .skip = mapping.range.first});
  }
  EventSelection selection{.topics = {mapping.topic},
                           .velocities_of = mapping.velocity_topic,
                           .headings_of = mapping.heading_topic};
  for (const std::optional<std::size_t>& other :
       {mapping.imu_topic, mapping.gnss_topic, mapping.velocity_topic, mapping.heading_topic}) {
    if (other && std::ranges::find(selection.topics, *other) == selection.topics.end()) {
      selection.topics.push_back(*other);
    }
  }
  return mapping.recording.events(selection);
}

/// True where the range ends with the recording.
bool reaches_the_end(const Mapping& mapping) {
  return mapping.range.first + mapping.range.count ==
         mapping.recording.topics()[mapping.topic].messages;
}

void add_reading(const Mapping& mapping, const ClockSpan& read, const ClockSpan& waited,
                 Mapped& done) {
  done.times.read += read.ms();
  done.times.read_wait += waited.ms();
  if (mapping.timeline != nullptr && read.end > read.begin) {
    const std::size_t sweep = (has_others(mapping) ? 0 : mapping.range.first) + done.read;
    mapping.timeline->add({.lane = TimelineLane::reader, .sweep = sweep, .span = read});
    mapping.timeline->add(
        {.lane = TimelineLane::host, .sweep = sweep, .span = waited, .waits = true});
  }
}

/// The next event that is whole; nothing at the end.
std::optional<Event> take(const Mapping& mapping, EventsAhead& events, Mapped& done) {
  while (true) {
    const auto start = Clock::now();
    try {
      std::optional<Event> event = events.next();
      add_reading(mapping, events.last_read(), since(start), done);
      done.read += event && std::holds_alternative<Sweep>(event->value) ? 1U : 0U;
      if (event) {
        mapping.statistics.left_out().note_read();
      }
      return event;
    } catch (const InputError& error) {
      add_reading(mapping, events.last_read(), since(start), done);
      if (!mapping.damaged) {
        throw;
      }
      mapping.damaged(error);
    }
  }
}

/// What the map has taken is written as well.
void settle(const Mapping& mapping, Mapped& done) {
  mapping.slam.settle();
  write_results(mapping, done);
}

MappingResult map_events(const Mapping& mapping) {
  EventsAhead events(
      with_steady_stamps(open_events(mapping), mapping.recording.topics(), mapping.path));
  Mapped done;
  while (done.sweeps < mapping.range.count) {
    if (mapping.stop()) {
      settle(mapping, done);
      return {RunEnd::interrupted,
              "stopped by a signal after " + std::to_string(done.sweeps) + " sweeps"};
    }
    std::optional<Event> event;
    try {
      event = take(mapping, events, done);
    } catch (...) {
      mapping.slam.flush();  // what came before the damage is good
      write_results(mapping, done);
      throw;
    }
    if (!event) {
      mapping.slam.flush();
      write_results(mapping, done);
      return {};
    }
    const bool is_sweep = std::holds_alternative<Sweep>(event->value);
    add(mapping, std::move(*event), done);
    write_results(mapping, done);
    if (done.added == mapping.range.count) {
      settle(mapping, done);  // no other sweep is taken up meanwhile
    }
    if (is_sweep && mapping.memory != nullptr && mapping.memory->exceeded()) {
      settle(mapping, done);
      return {RunEnd::memory_limit,
              mapping.memory->text() + " after " + std::to_string(done.sweeps) +
                  " sweeps. Allow more" +
                  (mapping.outputs.thins() ? "; without --map-resolution less is needed" : "")};
    }
  }
  // Behind the last sweep that could be counted, a recording that was cut off says so.
  while (reaches_the_end(mapping) && !mapping.stop() && take(mapping, events, done)) {
  }
  return {};
}

}  // namespace

namespace {

MappingResult caught(const std::function<MappingResult()>& body) {
  try {
    return body();
  } catch (const InputError& error) {
    return {RunEnd::input_error, error.what()};
  } catch (const SubmapDamaged& damage) {
    return {RunEnd::input_error, "a stored submap of the map " + std::string(damage.what())};
  } catch (const OutputError& error) {
    return {RunEnd::output_error, error.what()};
  } catch (const engine::OutOfMemory& error) {
    return {RunEnd::device_error, describe(error)};
  } catch (const engine::Error& error) {
    return {RunEnd::device_error, error.what()};
  } catch (const std::bad_alloc&) {
    return {RunEnd::failed, "out of memory. Allow more, or map a part with --start and --count."};
  } catch (const std::exception& error) {
    return {RunEnd::failed, std::string("an error of adit itself: ") + error.what()};
  }
}

}  // namespace

MappingResult map_recording(const Mapping& mapping) {
  MappingResult result = caught([&] { return map_events(mapping); });
  // However the run has ended: what the map still holds back goes into it.
  const MappingResult end = caught([&] {
    MappingResult ended;
    ended.map = mapping.slam.finish_map();
    return ended;
  });
  result.map = end.map;
  result.faults = mapping.slam.faults();
  if (result.map && result.map->loops && result.map->loops->farthest_from_odometry) {
    const LoopMove& farthest = *result.map->loops->farthest_from_odometry;
    mapping.statistics.note(MovedByLoops{
        .distance = farthest.metres, .sigmas = farthest.sigmas(), .path = farthest.path});
  }
  if (result.end == RunEnd::completed && end.end != RunEnd::completed) {
    result.end = end.end;
    result.reason = end.reason;
  }
  return result;
}

}  // namespace adit
