// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Point files put together byte by byte, for tests of the readers.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace adit::test {

/// The bytes of a number as it lies in memory, or reversed.
template <class T>
std::string bytes_of(T value, bool reversed = false) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (reversed) {
    std::reverse(bytes.begin(), bytes.end());
  }
  return bytes;
}

/// Several numbers, one after the other.
template <class... Ts>
std::string bytes_of_all(Ts... values) {
  std::string all;
  (all.append(bytes_of(values)), ...);
  return all;
}

/// Overwrites the bytes from `at` on.
template <class T>
void put_at(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

/// Two points, (1.5, -2, 0.25) and (4, 5, 6) m, half a second apart where the format has times.
inline std::string las_file(uint8_t format, uint8_t minor, std::size_t point_bytes,
                            std::size_t time_at) {
  const std::size_t header = minor >= 4 ? 375 : 227;
  std::string bytes(header + 2 * point_bytes, '\0');
  std::memcpy(bytes.data(), "LASF", 4);
  put_at(bytes, 24, uint8_t{1});
  put_at(bytes, 25, minor);
  put_at(bytes, 96, static_cast<uint32_t>(header));
  put_at(bytes, 104, format);
  put_at(bytes, 105, static_cast<uint16_t>(point_bytes));
  put_at(bytes, 107, uint32_t{2});
  if (minor >= 4) {
    put_at(bytes, 247, uint64_t{2});
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put_at(bytes, 131 + 8 * axis, 0.001);
    put_at(bytes, 155 + 8 * axis, 1.0);
  }
  const int32_t points[2][3] = {{500, -3000, -750}, {3000, 4000, 5000}};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t at = header + i * point_bytes;
    std::memcpy(bytes.data() + at, points[i], sizeof points[i]);
    put_at(bytes, at + 12, static_cast<uint16_t>(100 + i));
    if (time_at > 0) {
      put_at(bytes, at + time_at, 300000.0 + 0.5 * static_cast<double>(i));
    }
  }
  return bytes;
}

/// LZF compression: a reference wherever three bytes repeat within reach, literals elsewhere. The
/// obvious search; for small inputs.
inline std::string lzf_compress(std::string_view data) {
  std::string packed;
  std::string literals;
  const auto flush = [&] {
    for (std::size_t at = 0; at < literals.size(); at += 32) {
      const std::string run = literals.substr(at, 32);
      packed += static_cast<char>(run.size() - 1);
      packed += run;
    }
    literals.clear();
  };
  std::size_t at = 0;
  while (at < data.size()) {
    std::size_t best_length = 0;
    std::size_t best_distance = 0;
    for (std::size_t distance = 1; distance <= std::min<std::size_t>(at, 8192); ++distance) {
      std::size_t length = 0;
      while (length < 264 && at + length < data.size() &&
             data[at + length] == data[at + length - distance]) {
        ++length;
      }
      if (length > best_length) {
        best_length = length;
        best_distance = distance;
      }
    }
    if (best_length < 3) {
      literals += data[at++];
      continue;
    }
    flush();
    const std::size_t offset = best_distance - 1;
    const std::size_t code = best_length - 2;
    packed += static_cast<char>((std::min<std::size_t>(code, 7) << 5U) | (offset >> 8U));
    if (code >= 7) {
      packed += static_cast<char>(code - 7);
    }
    packed += static_cast<char>(offset & 0xffU);
    at += best_length;
  }
  flush();
  return packed;
}

/// The body of a binary_compressed PCD file: two sizes and the packed bytes.
inline std::string pcd_compressed_body(std::string_view data) {
  const std::string packed = lzf_compress(data);
  return bytes_of(static_cast<uint32_t>(packed.size())) +
         bytes_of(static_cast<uint32_t>(data.size())) + packed;
}

/// A PCD header with the fields x y z intensity as float32.
inline std::string pcd_header(std::size_t points, std::string_view data) {
  const std::string n = std::to_string(points);
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 "
         "4 4 4\nTYPE F F F F\n"
         "COUNT 1 1 1 1\nWIDTH " +
         n + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA " + std::string(data) +
         "\n";
}

}  // namespace adit::test
