// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/png_writer.hpp"

#include <png.h>

#include <new>
#include <string>

#include "adit/tools/support/output_file.hpp"

namespace adit {

namespace {

std::string bytes_of(int width, int height, png_uint_32 format, const void* pixels) {
  png_image head{};
  head.version = PNG_IMAGE_VERSION;
  head.width = static_cast<png_uint_32>(width);
  head.height = static_cast<png_uint_32>(height);
  head.format = format;
  // The whole picture fits into memory many times over; only there is a full disk reported well.
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(head), '\0');
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&head, bytes.data(), &size, 0, pixels, 0, nullptr) == 0) {
    throw std::bad_alloc();
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace

std::string png_bytes(const Image& image) {
  return bytes_of(image.width, image.height, PNG_FORMAT_RGB, image.pixels.data());
}

std::string png_bytes_with_alpha(int width, int height, std::span<const uint8_t> pixels) {
  return bytes_of(width, height, PNG_FORMAT_RGBA, pixels.data());
}

void write_png(const std::filesystem::path& file, const Image& image) {
  write_text_file(file, png_bytes(image));
}

}  // namespace adit
