// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/depth_png.hpp"

#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <string>

namespace adit {
namespace {

constexpr png_uint_32 kMostPixels = 4096;     // in each direction
constexpr std::size_t kMostInflation = 1100;  // DEFLATE makes 1032 bytes from one at most

/// What libpng's callbacks share.
struct Source {
  const char* data = nullptr;
  std::size_t size = 0;
  std::size_t at = 0;
  std::array<char, 100> message{};
};

void read_bytes(png_structp png, png_bytep into, std::size_t size) {
  auto& source = *static_cast<Source*>(png_get_io_ptr(png));
  if (size > source.size - source.at) {
    png_error(png, "it ends in the middle of the image");
  }
  std::memcpy(into, source.data + source.at, size);
  source.at += size;
}

/// libpng leaves by longjmp: nothing with a destructor may live between there and here.
[[noreturn]] void leave(png_structp png, png_const_charp message) {
  auto& source = *static_cast<Source*>(png_get_error_ptr(png));
  std::strncpy(source.message.data(), message, source.message.size() - 1);
  png_longjmp(png, 1);
}

void ignore(png_structp, png_const_charp) {}

/// A decoder, freed at the end.
class Png {
 public:
  explicit Png(Source& source)
      : png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, leave, ignore)),
        info_(png_ == nullptr ? nullptr : png_create_info_struct(png_)) {
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_user_limits(png_, kMostPixels, kMostPixels);
    png_set_read_fn(png_, &source, read_bytes);
  }
  ~Png() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Png(const Png&) = delete;
  Png& operator=(const Png&) = delete;

  bool read_header() {
    if (setjmp(png_jmpbuf(png_)) != 0) {
      return false;
    }
    png_read_info(png_, info_);
    return true;
  }

  bool is_grey16() const {
    return png_get_bit_depth(png_, info_) == 16 &&
           png_get_color_type(png_, info_) == PNG_COLOR_TYPE_GRAY;
  }
  std::size_t width() const { return png_get_image_width(png_, info_); }
  std::size_t height() const { return png_get_image_height(png_, info_); }

  bool read_rows(uint16_t* into) {
    if (setjmp(png_jmpbuf(png_)) != 0) {
      return false;
    }
    if constexpr (std::endian::native == std::endian::little) {
      png_set_swap(png_);
    }
    const int passes = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    for (int pass = 0; pass < passes; ++pass) {
      for (std::size_t row = 0; row < height(); ++row) {
        png_read_row(png_, reinterpret_cast<png_bytep>(into + row * width()), nullptr);
      }
    }
    png_read_end(png_, nullptr);
    return true;
  }

 private:
  png_structp png_;
  png_infop info_;
};

}  // namespace

DepthPng parse_depth_png(const std::filesystem::path& file, std::string_view content) {
  Source source{.data = content.data(), .size = content.size()};
  const auto fail = [&](const std::string& found) {
    throw InputError(file, Place::byte(source.at), found,
                     "The image is damaged or cut off: copy it again");
  };
  Png png(source);
  if (!png.read_header()) {
    fail(std::string("it is no PNG that can be read: ") + source.message.data());
  }
  if (!png.is_grey16()) {
    throw InputError(file, {}, "it is a PNG of another kind",
                     "Depth images have one channel of 16 bits");
  }
  DepthPng image{.width = png.width(), .height = png.height(), .values = {}};
  const std::size_t pixels = image.width * image.height;
  if (2 * pixels > kMostInflation * content.size()) {
    fail("it promises " + std::to_string(image.width) + " x " + std::to_string(image.height) +
         " pixels, which " + std::to_string(content.size()) + " bytes cannot hold");
  }
  image.values.resize(pixels);
  if (!png.read_rows(image.values.data())) {
    fail(std::string("its pixels cannot be read: ") + source.message.data());
  }
  return image;
}

}  // namespace adit
