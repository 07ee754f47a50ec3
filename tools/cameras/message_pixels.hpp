// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the messages of images show.
#pragma once

#include <string_view>

#include "adit/tools/cameras/color_image.hpp"
#include "adit/tools/recordings/ros_messages.hpp"

namespace adit::ros {

/// What the pixels of an encoding are.
enum class PixelKind {
  none,    ///< not read: depths, more than 8 bits a channel, an unknown word
  grey,    ///< one brightness a pixel
  colors,  ///< red, green and blue, interleaved, by a Bayer filter or as luma and chroma
};

/// Of sensor_msgs/Image::encoding: rgb8, bgr8, rgba8, bgra8, 8UC3 and 8UC4 (as OpenCV orders them,
/// blue first), mono8, 8UC1, bayer_{rggb,bggr,gbrg,grbg}8, and 4:2:2 as uyvy (yuv422) or yuyv
/// (yuv422_yuy2).
PixelKind kind_of_pixels(std::string_view encoding);

/// The colours of an image; greys give three equal ones. Bayer filters are interpolated
/// bilinearly; luma and chroma are those of ITU-R BT.601, 16 to 235. Throws ImageError where the
/// encoding is not read, or the message has fewer bytes than its size promises.
ColorImage to_color(const Image& image);

/// The colours of a JPEG or PNG. Throws ImageError as decode_image() does.
ColorImage to_color(const CompressedImage& image);

/// True for images of depths, which image_transport packs into the same message.
bool is_depth(const CompressedImage& image);

}  // namespace adit::ros
