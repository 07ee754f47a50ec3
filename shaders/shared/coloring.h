// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What an image says of points: which of them its camera sees, and their colours.
#ifndef ADIT_SHADERS_SHARED_COLORING_H
#define ADIT_SHADERS_SHARED_COLORING_H
#include "adit/shaders/shared/prelude.h"
#ifdef __cplusplus
namespace adit::gpu {
#endif

const uint kLensSteps = 1024;      // of a lens's table
const uint kNoDepth = 0xffffffff;  // of a depth image's pixel: nothing is seen there
// Pixels of a depth image to either side that a surface covers at most: 19 degrees. Nearer than
// twice its width a surface leaves a rim out.
const int kMostSplat = 64;
const uint kMostSightings = 8;  // of a point, that are kept
// A channel above that may be saturated: such a sighting counts where there is no other.
const uint kBrightest = 250;
const float kSaturatedWorth = 0.0009765625;  // 1/1024

// A camera at one place. Directions are told by u = aside / (aside + length + z), which grows from
// 0 on the axis to 1/2 beside the lens and 1 behind it, so that nothing depends on a device's
// trigonometry; the lens's table gives the image's radius, for a focal length of 1, at
// kLensSteps + 1 values of u from 0 to widest.
struct ViewCamera {
  mat3x4 T_camera_local;  // maps the points' coordinates to the optical frame, m
  float fx, fy, cx, cy;   // pixels
  float p1, p2;           // tangential distortion
  float widest;           // u
  uint width, height;     // pixels of the image
};

// A point of the map with its surface (shaders/include/surface.glsl).
struct ViewSurface {
  vec3 p;  // m
  uint surface;
};

struct DepthPush {
  ViewCamera camera;
  uint surface_count;
  uint depth_width, depth_height;
  float pixels;  // of the image, in a pixel of the depth image
  float radius;  // m, of a surface
};

// One look at a point.
struct ColorSighting {
  uint color;    // red in the low byte, green, blue
  float weight;  // square of pixels a metre; 0: none
};

struct SightPush {
  ViewCamera camera;
  uint point_count;
  uint depth_width, depth_height;
  float pixels;
  float tolerance;  // m behind what is seen there that still is that
  vec3 gain;        // that the image's red, green and blue are multiplied by
};

struct MeanPush {
  uint point_count;
};

#ifdef __cplusplus
}  // namespace adit::gpu
#endif
#endif
