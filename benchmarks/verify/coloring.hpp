// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Colours of points in one view, on the device and by the twin.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "adit/benchmarks/reference/coloring.hpp"
#include "adit/benchmarks/verify/device_runs.hpp"
#include "adit/benchmarks/verify/verify.hpp"
#include "adit/engine/kernels/coloring.hpp"
#include "adit/slam/coloring/view_coloring.hpp"

namespace adit::test {

/// A wall with a hole in it, a floor and balls before them; points on and behind them, and an image
/// of stripes. Map frame, m.
struct ColoringCase {
  CameraModel model;
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  std::vector<gpu::ViewSurface> surfaces{};
  std::vector<gpu::vec3> points{};
  std::vector<uint32_t> image{};  ///< a pixel each, red in the low byte
  float radius = 0.12F;           ///< of surfaces, m
  float tolerance = 0.1F;         ///< m
  gpu::vec3 gain = {1.125F, 0.875F, 1.25F};
};
ColoringCase coloring_case(const CameraModel& model, uint32_t surfaces, uint32_t points);
/// Mildly distorted: one lens of each kind, 320 pixels wide.
CameraModel perspective_camera();
CameraModel fisheye_camera();

/// The view on the device.
class ColoringRun {
 public:
  ColoringRun(engine::Context& context, const ColoringCase& made);

  Times run();  ///< all three, from an empty depth image and no sightings on
  std::vector<uint32_t> depth() const;
  std::vector<gpu::ColorSighting> sightings() const;
  std::vector<uint32_t> colors() const;

 private:
  engine::Context* context_;
  engine::Coloring kernels_;
  gpu::ViewCamera camera_;
  DepthGrid grid_;
  float radius_;
  float tolerance_;
  gpu::vec3 gain_;
  uint32_t surface_count_;
  uint32_t point_count_;
  engine::Buffer radii_;
  engine::Buffer rays_;
  engine::Buffer surfaces_;
  engine::Buffer points_;
  engine::Buffer image_;
  engine::Buffer depth_;
  engine::Buffer sightings_;
  engine::Buffer colors_;
};

/// Each pixel's distance between those of discs a thousandth larger and smaller, within 1e-3 of it.
Verdict verify_depth(const ColoringCase& made, std::span<const uint32_t> depth);
/// Seen by the same points, but for those within 2 mm or a thousandth of a pixel of what decides;
/// colours within 1.5 of 255: half for rounding, the rest where a stripe's edge magnifies a float32
/// pixel. `depth`: the device's own.
Verdict verify_sightings(const ColoringCase& made, std::span<const uint32_t> depth,
                         std::span<const gpu::ColorSighting> sightings);
/// Colours within 0.51 of 255, `sightings` of gpu::kMostSightings a point.
Verdict verify_colors(std::span<const gpu::ColorSighting> sightings,
                      std::span<const uint32_t> colors);

}  // namespace adit::test
