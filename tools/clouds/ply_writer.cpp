// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/ply_writer.hpp"

#include <bit>
#include <string>
#include <utility>

namespace adit {
namespace {

static_assert(std::endian::native == std::endian::little,
              "points are written as they lie in memory");

// The count has a fixed width so that it can be written over: blanks before a number are allowed in
// a PLY header.
std::string space_padded(uint64_t count) {
  std::string digits = std::to_string(count);
  return std::string(20 - digits.size(), ' ') + digits;
}

}  // namespace

template <class P>
BasicPlyWriter<P>::BasicPlyWriter(std::filesystem::path path,
                                  const std::vector<std::string>& comments)
    : file_(std::move(path)) {
  std::string head = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : comments) {
    head += "comment " + comment + "\n";
  }
  head += "element vertex ";
  count_offset_ = head.size();
  file_.write(head);
  file_.write(space_padded(0));
  file_.write("\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\n");
  if constexpr (kHasTime<P>) {
    file_.write("property double time\nproperty ushort ring\n");
  }
  if constexpr (kHasColor<P>) {
    file_.write("property uchar red\nproperty uchar green\nproperty uchar blue\n");
  }
  if constexpr (kHasClass<P>) {
    file_.write("property uchar classification\n");
  }
  file_.write("end_header\n");
  file_.flush();
}

template <class P>
void BasicPlyWriter<P>::write(std::span<const P> points) {
  file_.write(points.data(), points.size_bytes());
  count_ += points.size();
}

template <class P>
void BasicPlyWriter<P>::write_count() {
  file_.overwrite(count_offset_, space_padded(count_));
}

template <class P>
void BasicPlyWriter<P>::flush() {
  file_.flush();  // the points first: a count must never promise more than the file holds
  write_count();
  file_.flush();
}

template <class P>
void BasicPlyWriter<P>::close() {
  flush();
  file_.close();
}

template class BasicPlyWriter<Point>;
template class BasicPlyWriter<TimedPoint>;
template class BasicPlyWriter<Classified<Point>>;
template class BasicPlyWriter<Classified<TimedPoint>>;
template class BasicPlyWriter<Colored<Point, PlyColor>>;
template class BasicPlyWriter<Colored<TimedPoint, PlyColor>>;
template class BasicPlyWriter<Classified<Colored<Point, PlyColor>>>;
template class BasicPlyWriter<Classified<Colored<TimedPoint, PlyColor>>>;

}  // namespace adit
