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

/// Writes a cloud of any length as a binary PCD 0.7, as the points come: float x y z intensity, of
/// TimedPoints also double time and uint16 ring, of points with a colour also rgb, of classified
/// points also uint8 classification. Throws OutputError.
template <class P>
class BasicPcdWriter {
 public:
  /// `comments` stand in the header, a line each.
  explicit BasicPcdWriter(std::filesystem::path path,
                          const std::vector<std::string>& comments = {});

  void write(std::span<const P> points);
  void close();  ///< must be called for the file to be whole; the destructor cannot report

  uint64_t count() const { return count_; }

 private:
  OutputFile file_;
  uint64_t width_offset_ = 0;
  uint64_t points_offset_ = 0;
  uint64_t count_ = 0;
};

extern template class BasicPcdWriter<Point>;
extern template class BasicPcdWriter<TimedPoint>;
extern template class BasicPcdWriter<Classified<Point>>;
extern template class BasicPcdWriter<Classified<TimedPoint>>;
extern template class BasicPcdWriter<Colored<Point, PcdColor>>;
extern template class BasicPcdWriter<Colored<TimedPoint, PcdColor>>;
extern template class BasicPcdWriter<Classified<Colored<Point, PcdColor>>>;
extern template class BasicPcdWriter<Classified<Colored<TimedPoint, PcdColor>>>;
using PcdWriter = BasicPcdWriter<Point>;
using TimedPcdWriter = BasicPcdWriter<TimedPoint>;

}  // namespace adit
