// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The entry that a fuzzer calls with bytes that might be an image (of depths, JPEG, PNG, or the
// pixels of a message behind a line with their encoding) or a file of cameras: it has all its
// pixels, or there is an error that adit reports.
#include <string>
#include <string_view>

#include "adit/tests/recordings/fuzz_support.hpp"
#include "adit/tools/cameras/camera_file.hpp"
#include "adit/tools/cameras/image_codec.hpp"
#include "adit/tools/cameras/message_pixels.hpp"
#include "adit/tools/clouds/depth_png.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size);

namespace {

/// Aborts where what was read is not whole.
template <class Read>
void require_whole_or_error(const Read& read) {
  try {
    if (!read()) {
      std::abort();
    }
  } catch (const adit::InputError&) {
    // the other right answer
  } catch (const adit::ImageError&) {
    // likewise
  }
}

bool is_whole(const adit::ColorImage& image) {
  return !image.rgb.empty() && image.rgb.size() == 3 * image.width * image.height;
}

bool are_sound(const std::vector<adit::ListedCamera>& cameras) {
  for (const adit::ListedCamera& camera : cameras) {
    if (camera.model && !adit::problem_of(*camera.model).empty()) {
      return false;
    }
  }
  return !cameras.empty();
}

/// Its last bytes are the width, the height and the step.
adit::ros::Image message_of(std::string_view content) {
  const std::size_t line = std::min(content.find('\n'), content.size());
  adit::ros::Image image;
  image.encoding = std::string(content.substr(0, line));
  content.remove_prefix(std::min(line + 1, content.size()));
  const auto byte = [&](std::size_t back) {
    return content.size() < back ? 2U : static_cast<unsigned char>(content[content.size() - back]);
  };
  image.width = byte(1) % 7U;
  image.height = byte(2) % 7U;
  image.step = byte(3) % 32U;
  image.data = std::as_bytes(std::span(content));
  return image;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const std::string_view content(reinterpret_cast<const char*>(data), size);
  const auto bytes = std::as_bytes(std::span(content));
  require_whole_or_error([&] {
    const adit::DepthPng image = adit::parse_depth_png("input", content);
    return !image.values.empty() && image.values.size() == image.width * image.height;
  });
  require_whole_or_error([&] { return is_whole(adit::decode_image(bytes)); });
  require_whole_or_error([&] { return is_whole(adit::ros::to_color(message_of(content))); });
  require_whole_or_error([&] { return are_sound(adit::parse_camera_yaml(content, "input")); });
  require_whole_or_error([&] { return are_sound(adit::parse_camera_toml(content, "input")); });
  return 0;
}
