// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include <Eigen/Core>

#include "adit/slam/core/types.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {

/// Classes of points: one of the standard, one of those it leaves to users.
enum class LasClass : uint8_t {
  unclassified = 1,
  moving = 64,  ///< other sweeps saw through it
};

struct LasPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m
  Nanoseconds time{0};
  uint16_t intensity = 0;
  LasClass classification = LasClass::unclassified;
  uint16_t source = 0;    ///< "point source ID": the session
  uint16_t ring = 0;      ///< extra bytes
  uint32_t keyframe = 0;  ///< extra bytes
};

/// What a LAS file says of itself.
struct LasHeading {
  std::string software{};                            ///< up to 32 characters
  std::string wkt{};                                 ///< OGC WKT 1; empty: not georeferenced
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< m; points within 2000 km of it
  /// Stamps are UNIX times: written as adjusted standard GPS time. Otherwise as they are, s.
  bool unix_times = false;
};

/// Whether a stamp can be UNIX time: from 2000 to 2100.
bool is_unix_time(Nanoseconds stamp);
/// UNIX time as adjusted standard GPS time (GPS seconds less 1e9), s, with the leap seconds of its
/// date.
double adjusted_gps_time(Nanoseconds unix_time);

/// Writes a cloud of any length as LAS 1.4, point format 6, as the points come: coordinates in
/// millimetres, ring and keyframe as extra bytes. Same points, same bytes: the date in the header
/// is that of the first point, or 0. Throws OutputError, also for a point too far from the offset.
class LasWriter {
 public:
  LasWriter(std::filesystem::path path, LasHeading heading);

  void write(std::span<const LasPoint> points);
  void close();  ///< must be called for the file to be whole; the destructor cannot report

  uint64_t count() const { return count_; }

 private:
  std::string header() const;

  LasHeading heading_;
  OutputFile file_;
  std::string records_;  ///< of the VLRs
  uint32_t record_count_ = 0;
  uint64_t count_ = 0;
  std::optional<Nanoseconds> first_;
  std::array<int32_t, 3> lowest_{};
  std::array<int32_t, 3> highest_{};
};

}  // namespace adit
