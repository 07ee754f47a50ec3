// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Depth images and the calibration of the camera that took them.
#pragma once

#include "adit/slam/core/types.hpp"
#include "adit/tools/clouds/depth_camera.hpp"
#include "adit/tools/recordings/ros_messages.hpp"

namespace adit::ros {

/// True for images whose pixels are distances (REP 118): 16UC1, millimetres, and 32FC1, metres.
bool is_depth(const Image& image);

/// True where the image has the bytes that its size and encoding promise.
bool is_whole_depth(const Image& image);

/// The model of a camera's raw images, or of rectified ones, which have no distortion. Knows the
/// models plumb_bob, rational_polynomial and equidistant (also called fisheye), regions of interest
/// and binning. Throws CodecError for other models and where the numbers make no sense.
CameraModel to_camera(const CameraInfo& info, bool rectified);

/// The points that a depth image shows, in the camera's optical frame. Throws CodecError where it
/// has another size than the camera, or less data than it promises.
Sweep to_sweep(const Image& image, const DepthCamera& camera, Nanoseconds stamp);

}  // namespace adit::ros
