// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What worked when in a run: reader, host, device, map and writing, each in a lane of its own.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/support/clock_span.hpp"

namespace adit {

/// What works, from the top of the picture to its bottom. Host and write are one thread.
enum class TimelineLane { reader, host, device, map, write };
inline constexpr std::array kTimelineLanes{TimelineLane::reader, TimelineLane::host,
                                           TimelineLane::device, TimelineLane::map,
                                           TimelineLane::write};
/// The enumerator's name.
std::string_view to_string(TimelineLane lane);

/// What a lane did.
struct TimelineSpan {
  TimelineLane lane = TimelineLane::host;
  std::size_t sweep = 0;  ///< in the recording, counted from 0
  ClockSpan span{};
  bool waits = false;  ///< for another lane
};

/// Collects what the lanes did, up to so many spans (40 bytes each): of long runs the beginning.
class RunTimeline {
 public:
  explicit RunTimeline(std::size_t most_spans = 200'000) : most_(most_spans) {}

  /// Spans too short to be seen, of less than 10 us, are passed over.
  void add(const TimelineSpan& span);

  const std::vector<TimelineSpan>& spans() const { return spans_; }

  /// In the Trace Event Format, which Perfetto and chrome://tracing open. Its times (us) begin with
  /// the first span.
  std::string to_json() const;

  /// A page: how busy each lane was, drawings of sweeps from the middle and about the slowest one.
  std::string to_html(const std::string& title) const;

 private:
  std::size_t most_;
  std::vector<TimelineSpan> spans_;
};

/// Throws UsageError where the name ends neither with .html nor with .json.
void require_timeline_name(const std::filesystem::path& file);

/// As the file's name says. Throws OutputError.
void write_timeline(const RunTimeline& timeline, const std::filesystem::path& file,
                    const std::string& title);

}  // namespace adit
