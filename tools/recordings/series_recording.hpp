// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Folders that keep each sensor's data apart: series of events, read side by side.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// A series: what it is, and how it is read from the beginning.
struct EventSeries {
  Topic topic;
  /// The selection's begin, end, point_time_unit and coordinate_scale hold; the indices of the
  /// events' topics do not matter.
  std::function<std::unique_ptr<EventStream>(const EventSelection&)> open;
};

/// A recording of series; the earliest event comes first, as far as each series is in the order of
/// its stamps. Where one is damaged the others go on. `description` is for people.
std::unique_ptr<Recording> make_series_recording(std::string description,
                                                 std::vector<EventSeries> series);

/// What is wrong with a line; whoever knows the file adds the place.
class SeriesLineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A pose from its parts. Throws SeriesLineError where the quaternion's length is far from 1 or the
/// position is not finite.
Eigen::Isometry3d series_pose(const Eigen::Vector3d& position, const std::array<double, 4>& wxyz);

/// A line (not empty, no comment) as an event; throws SeriesLineError where it is none.
using ReadLine = std::function<EventValue(std::string_view line)>;

/// The lines of a text file, in its order, after the first `header` lines. Throws InputError where
/// the file cannot be read.
EventSeries text_series(Topic topic, const std::filesystem::path& file, ReadLine read,
                        uint64_t header = 0);

}  // namespace adit
