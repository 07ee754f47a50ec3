// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What LAS files (ASPRS LAS 1.4 R15) consist of, for those that write them: LAS, LAZ and COPC.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "adit/slam/core/types.hpp"

namespace adit {

/// Classes of points (LAS 1.4 R15, table 17), and one of those it leaves to users.
enum class LasClass : uint8_t {
  unclassified = 1,
  ground = 2,
  low_noise = 7,    ///< below the ground
  high_noise = 18,  ///< anywhere else
  moving = 64,      ///< other sweeps saw through it
  mixed = 65,       ///< a beam on an edge measured between two surfaces
  carrier = 66,     ///< a part of what carries the sensor
};

struct LasPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m
  Nanoseconds time{0};
  uint16_t intensity = 0;
  LasClass classification = LasClass::unclassified;
  uint16_t source = 0;    ///< "point source ID": the session
  uint16_t ring = 0;      ///< extra bytes
  uint32_t keyframe = 0;  ///< extra bytes
  /// Red, green, blue. Only files with colours have them.
  std::array<uint8_t, 3> color{};
};

/// What a LAS file says of itself.
struct LasHeading {
  std::string software{};                            ///< up to 32 characters
  std::string wkt{};                                 ///< OGC WKT 1; empty: not georeferenced
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< m; points within 2000 km of it
  /// Stamps are UNIX times: written as adjusted standard GPS time. Otherwise as they are, s.
  bool unix_times = false;
  bool colored = false;  ///< points are of format 7, which has colours, and not of format 6
};

/// Whether a stamp can be UNIX time: from 2000 to 2100.
bool is_unix_time(Nanoseconds stamp);
/// UNIX time as adjusted standard GPS time (GPS seconds less 1e9), s, with the leap seconds of its
/// date.
double adjusted_gps_time(Nanoseconds unix_time);

inline constexpr double kLasScale = 0.001;  ///< m, of a step of coordinates
inline constexpr uint16_t kLasHeaderBytes = 375;
/// Bytes of a point of format 6, without extra bytes.
inline constexpr std::size_t kLas6Bytes = 30;
/// Bytes that format 7 adds to it: 16 bits each of red, green and blue.
inline constexpr std::size_t kLasColorBytes = 6;

/// The parts of a point's record, in this order: format 6, the colour, extra bytes.
struct LasPointLayout {
  bool colored = false;
  std::size_t extra_bytes = 0;

  constexpr std::size_t extra_at() const { return kLas6Bytes + (colored ? kLasColorBytes : 0); }
  constexpr std::size_t bytes() const { return extra_at() + extra_bytes; }
};
/// That of the points of such a file. Extra bytes are ring and keyframe.
LasPointLayout las_point_layout(const LasHeading& heading);

/// What a header says of the points, gathered as they come.
struct LasExtent {
  uint64_t points = 0;
  std::optional<Nanoseconds> first{};  ///< stamp of the first point
  std::array<int32_t, 3> lowest{};     ///< steps
  std::array<int32_t, 3> highest{};
  double earliest = std::numeric_limits<double>::infinity();  ///< s, as the file has times
  double latest = -std::numeric_limits<double>::infinity();
};

/// Appends a point's bytes and counts it. Throws OutputError of `file` for a point too far from the
/// offset.
void append_las_point(std::string& bytes, LasExtent& extent, const LasPoint& point,
                      const LasHeading& heading, const std::filesystem::path& file);

/// Variable length records.
struct LasRecords {
  std::string bytes{};
  uint32_t count = 0;

  void add(std::string_view user, uint16_t id, std::string_view description,
           std::string_view content);
};
/// Those of every file: coordinate system, extra bytes, names of classes.
void add_las_records(LasRecords& records, const LasHeading& heading);

/// What a header says besides what the heading and the points do.
struct LasFraming {
  uint64_t record_bytes = 0;  ///< of all variable length records
  uint32_t records = 0;
  bool packed = false;          ///< LAZ
  uint64_t extended_begin = 0;  ///< byte of the first extended record
  uint32_t extended = 0;        ///< records behind the points
};
std::string las_header(const LasHeading& heading, const LasExtent& extent,
                       const LasFraming& framing);

/// Appends up to `size` bytes of a text, and zeros up to there.
void append_padded(std::string& bytes, std::string_view text, std::size_t size);

}  // namespace adit
