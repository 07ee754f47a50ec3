// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/kitti_bin.hpp"

#include <bit>
#include <string>

#include "adit/tools/support/input_file.hpp"

namespace adit {

static_assert(std::endian::native == std::endian::little,
              "KITTI files are read as they lie in the file");

Sweep read_kitti_bin(const std::filesystem::path& file) {
  InputFile input(file);
  const std::size_t points = input.size() / sizeof(Point);
  const std::size_t surplus = input.size() % sizeof(Point);
  if (surplus != 0) {
    throw InputError(
        file, Place::byte(points * sizeof(Point)),
        "the file has " + std::to_string(input.size()) +
            " bytes, no multiple of 16 (x y z intensity as float32): " + std::to_string(surplus) +
            " are left over after " + std::to_string(points) + " points",
        "The file is cut off or is no KITTI sweep: copy it again");
  }
  Sweep sweep;
  sweep.source = file.string();
  sweep.points.resize(points);
  input.read(sweep.points.data(), input.size());
  return sweep;
}

}  // namespace adit
