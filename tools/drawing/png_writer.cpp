// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/png_writer.hpp"

#include <png.h>

#include <new>
#include <string>

#include "adit/tools/support/output_file.hpp"

namespace adit {

std::string png_bytes(const Image& image) {
  png_image head{};
  head.version = PNG_IMAGE_VERSION;
  head.width = static_cast<png_uint_32>(image.width);
  head.height = static_cast<png_uint_32>(image.height);
  head.format = PNG_FORMAT_RGB;
  // The whole picture fits into memory many times over; only there is a full disk reported well.
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(head), '\0');
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&head, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr) ==
      0) {
    throw std::bad_alloc();
  }
  bytes.resize(size);
  return bytes;
}

void write_png(const std::filesystem::path& file, const Image& image) {
  write_text_file(file, png_bytes(image));
}

}  // namespace adit
