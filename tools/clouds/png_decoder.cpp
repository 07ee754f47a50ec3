// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/png_decoder.hpp"

#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstring>
#include <new>

namespace adit {
namespace {

constexpr std::size_t kMostInflation = 1100;  // DEFLATE makes 1032 bytes from one at most

void ignore(png_structp, png_const_charp) {}

}  // namespace

void PngDecoder::take_bytes(png_structp png, png_bytep into, std::size_t size) {
  auto& source = *static_cast<Source*>(png_get_io_ptr(png));
  if (size > source.size - source.at) {
    png_error(png, "it ends in the middle of the image");
  }
  std::memcpy(into, source.data + source.at, size);
  source.at += size;
}

/// libpng leaves by longjmp: nothing with a destructor may live between there and here.
void PngDecoder::leave(png_structp png, png_const_charp message) {
  auto& source = *static_cast<Source*>(png_get_error_ptr(png));
  std::strncpy(source.message.data(), message, source.message.size() - 1);
  png_longjmp(png, 1);
}

PngDecoder::PngDecoder(std::string_view content, std::size_t most_side)
    : source_{.data = content.data(), .size = content.size()},
      png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &source_, leave, ignore)),
      info_(png_ == nullptr ? nullptr : png_create_info_struct(png_)) {
  if (info_ == nullptr) {
    png_destroy_read_struct(&png_, nullptr, nullptr);
    throw std::bad_alloc();
  }
  png_set_user_limits(png_, static_cast<png_uint_32>(most_side),
                      static_cast<png_uint_32>(most_side));
  png_set_read_fn(png_, &source_, take_bytes);
  if (!read_header()) {
    png_destroy_read_struct(&png_, &info_, nullptr);
    throw ImageError(std::string("it is no PNG that can be read: ") + source_.message.data());
  }
}

PngDecoder::~PngDecoder() {
  png_destroy_read_struct(&png_, &info_, nullptr);
}

bool PngDecoder::read_header() {
  if (setjmp(png_jmpbuf(png_)) != 0) {
    return false;
  }
  png_read_info(png_, info_);
  return true;
}

std::size_t PngDecoder::width() const {
  return png_get_image_width(png_, info_);
}

std::size_t PngDecoder::height() const {
  return png_get_image_height(png_, info_);
}

bool PngDecoder::is_grey16() const {
  return png_get_bit_depth(png_, info_) == 16 &&
         png_get_color_type(png_, info_) == PNG_COLOR_TYPE_GRAY;
}

/// What the rows are turned into on the way.
bool PngDecoder::set_up(bool as_rgb8) {
  if (setjmp(png_jmpbuf(png_)) != 0) {
    return false;
  }
  if (as_rgb8) {
    png_set_expand(png_);
    png_set_scale_16(png_);
    png_set_gray_to_rgb(png_);
    png_set_strip_alpha(png_);
  } else if constexpr (std::endian::native == std::endian::little) {
    png_set_swap(png_);
  }
  passes_ = png_set_interlace_handling(png_);
  png_read_update_info(png_, info_);
  return true;
}

bool PngDecoder::read_rows(png_bytep into, std::size_t row_bytes) {
  if (setjmp(png_jmpbuf(png_)) != 0) {
    return false;
  }
  for (int pass = 0; pass < passes_; ++pass) {
    for (std::size_t row = 0; row < height(); ++row) {
      png_read_row(png_, into + row * row_bytes, nullptr);
    }
  }
  png_read_end(png_, nullptr);
  return true;
}

/// Before memory is taken for the pixels.
void PngDecoder::require_plausible_size() const {
  if (png_get_rowbytes(png_, info_) * height() > kMostInflation * source_.size) {
    throw ImageError("it promises " + std::to_string(width()) + " x " + std::to_string(height()) +
                     " pixels, which " + std::to_string(source_.size) + " bytes cannot hold");
  }
}

void PngDecoder::fail_in_pixels() const {
  throw ImageError(std::string("its pixels cannot be read: ") + source_.message.data());
}

std::vector<uint16_t> PngDecoder::read_grey16() {
  require_plausible_size();
  std::vector<uint16_t> values(width() * height());
  if (!set_up(false) || png_get_rowbytes(png_, info_) != width() * sizeof(uint16_t) ||
      !read_rows(reinterpret_cast<png_bytep>(values.data()), width() * sizeof(uint16_t))) {
    fail_in_pixels();
  }
  return values;
}

std::vector<uint8_t> PngDecoder::read_rgb8() {
  require_plausible_size();
  std::vector<uint8_t> rgb(3 * width() * height());
  if (!set_up(true) || png_get_rowbytes(png_, info_) != 3 * width() ||
      !read_rows(rgb.data(), 3 * width())) {
    fail_in_pixels();
  }
  return rgb;
}

}  // namespace adit
