// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/png_writer.hpp"

#include <algorithm>
#include <span>
#include <string>

#include "adit/tools/containers/crc32.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

void append_big_endian(std::string& bytes, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes += static_cast<char>(value >> static_cast<unsigned>(shift) & 0xffU);
  }
}

void append_chunk(std::string& file, const std::string& type, const std::string& data) {
  append_big_endian(file, static_cast<uint32_t>(data.size()));
  const std::string summed = type + data;
  file += summed;
  append_big_endian(file, crc32(std::as_bytes(std::span(summed))));
}

/// zlib's format with stored blocks (RFC 1950 and 1951).
std::string stored(const std::string& data) {
  constexpr std::size_t kBlock = 65535;
  std::string packed = "\x78\x01";
  for (std::size_t at = 0; at < data.size(); at += kBlock) {
    const std::size_t size = std::min(kBlock, data.size() - at);
    packed += at + size == data.size() ? '\1' : '\0';
    for (const std::size_t value : {size, ~size}) {
      packed += static_cast<char>(value & 0xffU);
      packed += static_cast<char>(value >> 8U & 0xffU);
    }
    packed.append(data, at, size);
  }
  uint32_t a = 1;
  uint32_t b = 0;
  for (const char c : data) {
    a = (a + static_cast<uint8_t>(c)) % 65521U;
    b = (b + a) % 65521U;
  }
  append_big_endian(packed, b << 16U | a);
  return packed;
}

}  // namespace

void write_png(const std::filesystem::path& file, const Image& image) {
  std::string rows;
  for (int y = 0; y < image.height; ++y) {
    rows += '\0';  // no filter
    for (int x = 0; x < image.width; ++x) {
      for (const uint8_t part : image.pixels[static_cast<std::size_t>(y * image.width + x)]) {
        rows += static_cast<char>(part);
      }
    }
  }
  std::string bytes = "\x89PNG\r\n\x1a\n";
  std::string head;
  append_big_endian(head, static_cast<uint32_t>(image.width));
  append_big_endian(head, static_cast<uint32_t>(image.height));
  head += std::string("\x08\x02\x00\x00\x00", 5);  // 8 bits of red, green and blue
  append_chunk(bytes, "IHDR", head);
  append_chunk(bytes, "IDAT", stored(rows));
  append_chunk(bytes, "IEND", "");
  write_text_file(file, bytes);
}

}  // namespace adit
