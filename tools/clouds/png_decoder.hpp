// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// libpng with errors in place of its jumps.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

// libpng's own names of its states; its header is seen by the source alone.
struct png_struct_def;
struct png_info_def;

namespace adit {

/// What is wrong with the bytes of an image; the caller that knows the file adds the place.
class ImageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A PNG in memory, interlaced or not. Its pixels can be read once.
class PngDecoder {
 public:
  /// Reads the header. `content` must outlive it; images with more than `most_side` pixels in a
  /// direction are refused. Throws ImageError.
  PngDecoder(std::string_view content, std::size_t most_side);
  ~PngDecoder();
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;

  std::size_t width() const;
  std::size_t height() const;
  /// One channel of 16 bits.
  bool is_grey16() const;
  /// Bytes that were used up so far.
  std::size_t offset() const { return source_.at; }

  /// The values of an image that is_grey16(), row by row. Throws ImageError.
  std::vector<uint16_t> read_grey16();
  /// Any image as red, green and blue of 8 bits, row by row; what is transparent counts as opaque.
  /// Throws ImageError.
  std::vector<uint8_t> read_rgb8();

 private:
  /// What libpng's callbacks share.
  struct Source {
    const char* data = nullptr;
    std::size_t size = 0;
    std::size_t at = 0;
    std::array<char, 100> message{};
  };
  static void take_bytes(png_struct_def* png, unsigned char* into, std::size_t size);
  [[noreturn]] static void leave(png_struct_def* png, const char* message);

  bool read_header();
  bool set_up(bool as_rgb8);
  bool read_rows(unsigned char* into, std::size_t row_bytes);
  void require_plausible_size() const;
  [[noreturn]] void fail_in_pixels() const;

  Source source_;
  png_struct_def* png_ = nullptr;
  png_info_def* info_ = nullptr;
  int passes_ = 1;
};

}  // namespace adit
