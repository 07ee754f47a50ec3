// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/pcd_writer.hpp"

#include <string>
#include <utility>

namespace adit {
namespace {

// Padded to a fixed width, so that it can be written over: numbers may begin with zeros.
std::string zero_padded(uint64_t count) {
  const std::string digits = std::to_string(count);
  return std::string(20 - digits.size(), '0') + digits;
}

}  // namespace

template <class P>
BasicPcdWriter<P>::BasicPcdWriter(std::filesystem::path path,
                                  const std::vector<std::string>& comments)
    : file_(std::move(path)) {
  std::string head = "# .PCD v0.7\n";
  for (const std::string& comment : comments) {
    head += "# " + comment + "\n";
  }
  const auto line = [&](const char* name, const char* of_all, const char* of_time,
                        const char* of_color, const char* of_class) {
    head += std::string(name) + of_all + (kHasTime<P> ? of_time : "") +
            (kHasColor<P> ? of_color : "") + (kHasClass<P> ? of_class : "") + "\n";
  };
  head += "VERSION 0.7\n";
  line("FIELDS", " x y z intensity", " time ring", " rgb", " classification");
  line("SIZE", " 4 4 4 4", " 8 2", " 4", " 1");
  line("TYPE", " F F F F", " F U", " F", " U");  // rgb: a float by name alone, as PCL has it
  line("COUNT", " 1 1 1 1", " 1 1", " 1", " 1");
  head += "WIDTH ";
  width_offset_ = head.size();
  head += zero_padded(0) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS ";
  points_offset_ = head.size();
  head += zero_padded(0) + "\nDATA binary\n";
  file_.write(head);
}

template <class P>
void BasicPcdWriter<P>::write(std::span<const P> points) {
  file_.write(points.data(), points.size_bytes());
  count_ += points.size();
}

template <class P>
void BasicPcdWriter<P>::close() {
  file_.flush();
  file_.overwrite(width_offset_, zero_padded(count_));
  file_.overwrite(points_offset_, zero_padded(count_));
  file_.close();
}

template class BasicPcdWriter<Point>;
template class BasicPcdWriter<TimedPoint>;
template class BasicPcdWriter<Classified<Point>>;
template class BasicPcdWriter<Classified<TimedPoint>>;
template class BasicPcdWriter<Colored<Point, PcdColor>>;
template class BasicPcdWriter<Colored<TimedPoint, PcdColor>>;
template class BasicPcdWriter<Classified<Colored<Point, PcdColor>>>;
template class BasicPcdWriter<Classified<Colored<TimedPoint, PcdColor>>>;

}  // namespace adit
