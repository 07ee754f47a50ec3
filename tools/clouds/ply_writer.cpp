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
std::string count_text(uint64_t count) {
  std::string digits = std::to_string(count);
  return std::string(20 - digits.size(), ' ') + digits;
}

}  // namespace

PlyWriter::PlyWriter(std::filesystem::path path) : file_(std::move(path)) {
  const std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  count_offset_ = head.size();
  file_.write(head);
  file_.write(count_text(0));
  file_.write(
      "\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "intensity\nend_header\n");
  file_.flush();
}

void PlyWriter::write(std::span<const Point> points) {
  file_.write(points.data(), points.size_bytes());
  count_ += points.size();
}

void PlyWriter::write_count() {
  file_.overwrite(count_offset_, count_text(count_));
}

void PlyWriter::flush() {
  file_.flush();  // the points first: a count must never promise more than the file holds
  write_count();
  file_.flush();
}

void PlyWriter::close() {
  flush();
  file_.close();
}

}  // namespace adit
