// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/ply_visit.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "adit/tools/clouds/ply_header.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

constexpr std::size_t kLongestWrittenHeader = 65'536;  // bytes
constexpr std::size_t kPointsAtATime = 65'536;

bool is_laid_out_as_points(const PlyHeader& header) {
  constexpr std::array<std::string_view, 4> kNames = {"x", "y", "z", "intensity"};
  return header.format == PlyFormat::little_endian && header.elements.size() == 1 &&
         header.elements[0].name == "vertex" &&
         std::ranges::equal(header.elements[0].properties, kNames,
                            [](const PlyProperty& property, std::string_view name) {
                              return property.name == name && !property.list_count &&
                                     property.type == ScalarType::f32;
                            });
}

}  // namespace

WrittenPly::WrittenPly(std::filesystem::path file) : file_(std::move(file)) {
  std::ifstream stream(file_, std::ios::binary);
  std::string head(kLongestWrittenHeader, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  if (stream.gcount() == 0) {
    throw InputError(file_, {}, "it cannot be read, or is empty",
                     "Expected the map.ply that `adit run` writes");
  }
  head.resize(static_cast<std::size_t>(stream.gcount()));
  const PlyHeader header = parse_ply_header(file_, head);
  if (!is_laid_out_as_points(header)) {
    throw InputError(file_, {},
                     "its points are not float x y z intensity, binary and little-endian",
                     "Expected the map.ply that `adit run` writes");
  }
  begin_ = header.bytes;
  points_ = header.elements[0].count;
  const uint64_t size = std::filesystem::file_size(file_);
  if ((size - begin_) / sizeof(Point) < points_) {
    throw InputError(file_, {},
                     "it says that it holds " + std::to_string(points_) + " points, and has " +
                         std::to_string((size - begin_) / sizeof(Point)),
                     "It is cut off: run `adit run` again");
  }
}

void WrittenPly::visit(const std::function<void(std::span<const Point>)>& take) const {
  std::ifstream stream(file_, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(begin_));
  std::vector<Point> points;
  for (uint64_t left = points_; left > 0; left -= points.size()) {
    points.resize(std::min<uint64_t>(left, kPointsAtATime));
    stream.read(reinterpret_cast<char*>(points.data()),
                static_cast<std::streamsize>(points.size() * sizeof(Point)));
    if (!stream) {
      throw InputError(file_, {}, "its points cannot be read", "It has changed meanwhile");
    }
    take(points);
  }
}

}  // namespace adit
