// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/clouds/timed_point.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {

/// Writes a cloud of any length as a binary little-endian PLY, as the points come: float x y z
/// intensity, of TimedPoints also double time and ushort ring, of points with a colour also uchar
/// red, green and blue, of classified points also uchar classification. The file is a valid PLY of
/// the points so far after the constructor, flush() and close(). Throws OutputError.
template <class P>
class BasicPlyWriter {
 public:
  /// `comments` stand in the header, a line each.
  explicit BasicPlyWriter(std::filesystem::path path,
                          const std::vector<std::string>& comments = {});

  void write(std::span<const P> points);
  void flush();  ///< brings the file's vertex count up to date
  void close();  ///< must be called for the file to be whole; the destructor cannot report

  uint64_t count() const { return count_; }
  const std::filesystem::path& path() const { return file_.path(); }

 private:
  void write_count();

  OutputFile file_;
  uint64_t count_offset_ = 0;
  uint64_t count_ = 0;
};

extern template class BasicPlyWriter<Point>;
extern template class BasicPlyWriter<TimedPoint>;
extern template class BasicPlyWriter<Classified<Point>>;
extern template class BasicPlyWriter<Classified<TimedPoint>>;
extern template class BasicPlyWriter<Colored<Point, PlyColor>>;
extern template class BasicPlyWriter<Colored<TimedPoint, PlyColor>>;
extern template class BasicPlyWriter<Classified<Colored<Point, PlyColor>>>;
extern template class BasicPlyWriter<Classified<Colored<TimedPoint, PlyColor>>>;
using PlyWriter = BasicPlyWriter<Point>;
using TimedPlyWriter = BasicPlyWriter<TimedPoint>;

}  // namespace adit
