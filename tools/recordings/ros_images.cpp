// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/ros_images.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "adit/tools/recordings/ros_codec.hpp"

namespace adit::ros {
namespace {

constexpr uint32_t kMostPixels = 16384;  // in each direction

std::string size_text(std::size_t width, std::size_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

/// The number at these bytes, which may be in the other byte order.
template <class T>
T number_at(const std::byte* bytes, bool swap) {
  std::array<std::byte, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (swap) {
    std::ranges::reverse(raw);
  }
  return std::bit_cast<T>(raw);
}

/// The lens of the raw images, by the model's name.
void take_distortion(CameraModel& model, const CameraInfo& info) {
  const bool fisheye = info.distortion_model == "equidistant" || info.distortion_model == "fisheye";
  const bool perspective =
      info.distortion_model == "plumb_bob" || info.distortion_model == "rational_polynomial";
  model.lens = fisheye ? Lens::fisheye : Lens::perspective;
  if (std::ranges::all_of(info.d, [](double number) { return number == 0.0; })) {
    return;
  }
  if (!(fisheye && info.d.size() == 4) &&
      !(perspective && info.d.size() <= model.distortion.size())) {
    throw CodecError("the camera's distortion model '" + info.distortion_model + "' with " +
                     std::to_string(info.d.size()) +
                     " numbers is not known: plumb_bob, rational_polynomial and equidistant are; "
                     "rectified images need none");
  }
  std::ranges::copy(info.d, model.distortion.begin());
}

}  // namespace

bool is_depth(const Image& image) {
  return image.encoding == "16UC1" || image.encoding == "32FC1" || image.encoding == "mono16";
}

bool is_whole_depth(const Image& image) {
  const std::size_t pixel = image.encoding == "32FC1" ? sizeof(float) : sizeof(uint16_t);
  const std::size_t row = pixel * image.width;
  return is_depth(image) && image.width > 0 && image.height > 0 && image.step >= row &&
         image.data.size() >= std::size_t{image.step} * (image.height - 1) + row;
}

CameraModel to_camera(const CameraInfo& info, bool rectified) {
  CameraModel model;
  if (rectified) {
    model.fx = info.p[0];
    model.fy = info.p[5];
    model.cx = info.p[2];
    model.cy = info.p[6];
  } else {
    model.fx = info.k[0];
    model.fy = info.k[4];
    model.cx = info.k[2];
    model.cy = info.k[5];
    take_distortion(model, info);
  }
  const uint32_t across = std::max(info.binning_x, 1U);
  const uint32_t down = std::max(info.binning_y, 1U);
  model.width = (info.roi_width > 0 ? info.roi_width : info.width) / across;
  model.height = (info.roi_height > 0 ? info.roi_height : info.height) / down;
  model.fx /= across;
  model.fy /= down;
  model.cx = (model.cx - info.x_offset) / across;
  model.cy = (model.cy - info.y_offset) / down;
  const bool finite =
      std::isfinite(model.cx) && std::isfinite(model.cy) &&
      std::ranges::all_of(model.distortion, [](double number) { return std::isfinite(number); });
  if (!(model.fx > 0.1 && model.fx < 1e6 && model.fy > 0.1 && model.fy < 1e6) || !finite) {
    throw CodecError("the camera is not calibrated: its focal lengths are " +
                     std::to_string(model.fx) + " and " + std::to_string(model.fy) + " pixels");
  }
  if (model.width == 0 || model.height == 0 || model.width > kMostPixels ||
      model.height > kMostPixels) {
    throw CodecError("the camera has " + size_text(model.width, model.height) +
                     " pixels; expected 1 to 16384 in each direction");
  }
  return model;
}

Sweep to_sweep(const Image& image, const DepthCamera& camera, Nanoseconds stamp) {
  const CameraModel& model = camera.model();
  if (image.width != model.width || image.height != model.height) {
    throw CodecError("it has " + size_text(image.width, image.height) +
                     " pixels, its camera_info " + size_text(model.width, model.height));
  }
  if (!is_whole_depth(image)) {
    throw CodecError("its " + std::to_string(image.data.size()) + " bytes in rows of " +
                     std::to_string(image.step) + " are no " +
                     size_text(image.width, image.height) + " depth image of the encoding '" +
                     image.encoding + "'");
  }
  const bool metres = image.encoding == "32FC1";
  const std::size_t pixel = metres ? sizeof(float) : sizeof(uint16_t);
  const bool swap = (image.is_bigendian != 0) == (std::endian::native == std::endian::little);
  constexpr float kMillimetre = 1e-3F;
  std::vector<float> depths(model.width * model.height);
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const std::byte* at =
        image.data.data() + i / model.width * image.step + i % model.width * pixel;
    depths[i] = metres ? number_at<float>(at, swap)
                       : kMillimetre * static_cast<float>(number_at<uint16_t>(at, swap));
  }
  Sweep sweep;
  sweep.stamp = stamp;
  sweep.points = camera.points(depths);
  return sweep;
}

}  // namespace adit::ros
