// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/verify/coloring.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <string>

#include "adit/benchmarks/verify/transfer.hpp"
#include "adit/slam/submaps/keyframe_submap.hpp"

namespace adit::test {
namespace {

constexpr double kSlack = 1e-3;

/// A plane with this normal, packed (shaders/include/surface.glsl) by turning one that is known.
uint32_t plane_facing(const Eigen::Vector3d& normal) {
  // Octahedral middle: (0, 0, 1).
  constexpr uint32_t kUp = (1U << 30U) | (16383U << 15U) | 16383U;
  return turned_surface(
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal).toRotationMatrix(), kUp);
}

std::vector<uint32_t> stripes(const CameraModel& model) {
  std::vector<uint32_t> image;
  for (uint32_t v = 0; v < model.height; ++v) {
    for (uint32_t u = 0; u < model.width; ++u) {
      const uint32_t red = (u * 7 + v) % 256;
      const uint32_t green = (v * 3) % 256;
      const uint32_t blue = (u / 16 + v / 16) % 2 == 0 ? 40 : 200;
      image.push_back(red | green << 8U | blue << 16U);
    }
  }
  return image;
}

void complain(Verdict& verdict, const std::string& what) {
  if (verdict.problems.size() < 5) {
    verdict.problems.push_back(what);
  }
}

reference::DepthCameraTwin twin_of(const ColoringCase& made) {
  const DepthGrid grid = depth_grid(made.model);
  return reference::depth_camera(made.model, grid.pixels, grid.width, grid.height);
}

}  // namespace

CameraModel perspective_camera() {
  return {.width = 320,
          .height = 240,
          .fx = 210.0,
          .fy = 205.0,
          .cx = 163.0,
          .cy = 117.5,
          .distortion = {-0.12, 0.03, 5e-4, -4e-4, -0.002, 0.0, 0.0, 0.0}};
}

CameraModel fisheye_camera() {
  return {.width = 320,
          .height = 320,
          .fx = 100.0,
          .fy = 101.0,
          .cx = 158.0,
          .cy = 161.0,
          .distortion = {0.02, -0.005, 1e-3, -2e-4, 0.0, 0.0, 0.0, 0.0},
          .lens = Lens::fisheye};
}

ColoringCase coloring_case(const CameraModel& model, uint32_t surfaces, uint32_t points) {
  ColoringCase made{.model = model};
  // The camera looks along the map's x axis.
  made.T_map_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  made.T_map_camera.translation() = Eigen::Vector3d(0.3, -0.2, 1.1);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto between = [&](double low, double high) { return low + (high - low) * unit(random); };
  const Eigen::Vector3d toward = Eigen::Vector3d(-1.0, 0.2, 0.1).normalized();
  const uint32_t wall = plane_facing(toward);
  const uint32_t floor = plane_facing(Eigen::Vector3d(0.02, -0.01, 1.0).normalized());
  const auto add = [&](const Eigen::Vector3d& p, uint32_t surface) {
    const Eigen::Vector3f at = p.cast<float>();
    made.surfaces.push_back({{at.x(), at.y(), at.z()}, surface});
  };
  while (made.surfaces.size() < surfaces) {
    const double y = between(-8.0, 8.0);
    const double z = between(0.0, 5.0);
    switch (made.surfaces.size() % 3) {
      case 0:
        if (std::abs(y) > 1.0 || std::abs(z - 1.5) > 1.0) {
          add({8.0 + 0.2 * y + 0.1 * z, y, z}, wall);
        }
        [[fallthrough]];
      case 1:
        add({between(2.0, 12.0), y, 0.0}, floor);
        break;
      default:
        add({between(4.0, 6.0), 0.5 * y, z}, 0);  // of no direction
    }
  }
  made.surfaces.resize(surfaces);
  for (uint32_t i = 0; i < points; ++i) {
    const Eigen::Vector3f at =
        Eigen::Vector3d(between(-2.0, 14.0), between(-9.0, 9.0), between(-0.2, 5.0)).cast<float>();
    const bool on = i % 2 == 0 && !made.surfaces.empty();
    made.points.push_back(on ? made.surfaces[i % made.surfaces.size()].p
                             : gpu::vec3{at.x(), at.y(), at.z()});
  }
  made.image = stripes(model);
  return made;
}

ColoringRun::ColoringRun(engine::Context& context, const ColoringCase& made)
    : context_(&context),
      kernels_(context),
      camera_(
          placed_camera(lens_table(made.model).camera, made.T_map_camera, Eigen::Vector3d::Zero())),
      grid_(depth_grid(made.model)),
      radius_(made.radius),
      tolerance_(made.tolerance),
      gain_(made.gain),
      surface_count_(static_cast<uint32_t>(made.surfaces.size())),
      point_count_(static_cast<uint32_t>(made.points.size())),
      radii_(upload(context, lens_table(made.model).radii, "a lens")),
      rays_(upload(context, grid_.rays, "rays")),
      surfaces_(upload(context, made.surfaces, "surfaces")),
      points_(upload(context, made.points, "points")),
      image_(upload(context, made.image, "an image")),
      depth_(context.make_buffer(sizeof(uint32_t) * grid_.rays.size(), engine::Memory::device,
                                 "depths")),
      sightings_(context.make_buffer(
          std::max<uint64_t>(1, point_count_) * gpu::kMostSightings * sizeof(gpu::ColorSighting),
          engine::Memory::device, "sightings")),
      colors_(context.make_buffer(std::max<uint64_t>(1, point_count_) * sizeof(uint32_t),
                                  engine::Memory::device, "colours")) {}

Times ColoringRun::run() {
  const engine::DepthImage depth{.depths = depth_,
                                 .width = grid_.width,
                                 .height = grid_.height,
                                 .pixels = static_cast<float>(grid_.pixels)};
  return run_and_wait(*context_, [&](engine::Recorder& recorder) {
    kernels_.record_clear(recorder, depth);
    kernels_.record_depth(recorder, camera_, depth, surfaces_, surface_count_, radius_, radii_,
                          rays_);
    recorder.fill(sightings_, 0);
    recorder.barrier();
    kernels_.record_sight(recorder, camera_, depth, points_, point_count_, tolerance_, gain_,
                          radii_, image_, sightings_);
    kernels_.record_mean(recorder, sightings_, point_count_, colors_);
  });
}

std::vector<uint32_t> ColoringRun::depth() const {
  return download<uint32_t>(*context_, depth_);
}

std::vector<gpu::ColorSighting> ColoringRun::sightings() const {
  return download<gpu::ColorSighting>(*context_, sightings_);
}

std::vector<uint32_t> ColoringRun::colors() const {
  return download<uint32_t>(*context_, colors_);
}

Verdict verify_depth(const ColoringCase& made, std::span<const uint32_t> depth) {
  const reference::DepthCameraTwin camera = twin_of(made);
  const Eigen::Isometry3d T_camera_map = made.T_map_camera.inverse();
  std::vector<reference::Disc> discs;
  for (const gpu::ViewSurface& surface : made.surfaces) {
    reference::Disc& disc = discs.emplace_back();
    disc.p = T_camera_map * Eigen::Vector3d(surface.p.x, surface.p.y, surface.p.z);
    if (surface.surface >> 30U == 1U) {
      disc.normal = T_camera_map.linear() * surface_direction(surface.surface);
    }
  }
  const auto radius = static_cast<double>(made.radius);
  const std::vector<double> nearest = reference::depths(camera, discs, radius, kSlack);
  const std::vector<double> farthest = reference::depths(camera, discs, radius, -kSlack);
  Verdict verdict;
  double seen = 0.0;
  double loose = 0.0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const bool none = depth[i] == gpu::kNoDepth;
    const double found = none ? std::numeric_limits<double>::infinity()
                              : static_cast<double>(std::bit_cast<float>(depth[i]));
    constexpr double kShare = 1e-3;
    if (!(found >= nearest[i] * (1.0 - kShare)) || !(found <= farthest[i] * (1.0 + kShare))) {
      complain(verdict, "pixel " + std::to_string(i) + ": expected " + std::to_string(nearest[i]) +
                            " to " + std::to_string(farthest[i]) + " m, found " +
                            std::to_string(found));
    }
    seen += none ? 0.0 : 1.0;
    loose += farthest[i] > nearest[i] * 1.01 ? 1.0 : 0.0;
  }
  verdict.worst["pixels that see something"] = seen;
  verdict.worst["pixels that rounding decides"] = loose;
  return verdict;
}

Verdict verify_sightings(const ColoringCase& made, std::span<const uint32_t> depth,
                         std::span<const gpu::ColorSighting> sightings) {
  const reference::DepthCameraTwin camera = twin_of(made);
  const reference::PackedImage image{.width = static_cast<uint32_t>(made.model.width),
                                     .height = static_cast<uint32_t>(made.model.height),
                                     .pixels = made.image};
  const Eigen::Isometry3d T_camera_map = made.T_map_camera.inverse();
  Verdict verdict;
  double seen = 0.0;
  double hidden = 0.0;
  for (std::size_t i = 0; i < made.points.size(); ++i) {
    const gpu::vec3& point = made.points[i];
    const reference::Look twin = reference::look(
        camera, depth, image, T_camera_map * Eigen::Vector3d(point.x, point.y, point.z),
        static_cast<double>(made.tolerance),
        {static_cast<double>(made.gain.x), static_cast<double>(made.gain.y),
         static_cast<double>(made.gain.z)});
    const gpu::ColorSighting& one = sightings[i * gpu::kMostSightings];
    const double weight = static_cast<double>(one.weight);
    constexpr double kUndecided = 2e-3;
    if ((weight > 0.0) != (twin.weight > 0.0)) {
      if (twin.margin > kUndecided) {
        complain(verdict, "point " + std::to_string(i) + ": expected weight " +
                              std::to_string(twin.weight) + ", found " + std::to_string(weight));
      }
      continue;
    }
    (weight > 0.0 ? seen : hidden) += 1.0;
    if (weight > 0.0) {
      for (uint32_t k = 0; k < 3; ++k) {
        const double error = std::abs(((one.color >> (8 * k)) & 255U) - twin.color[k]);
        verdict.worst["colour"] = std::max(verdict.worst["colour"], error);
        if (!(error <= 1.5)) {
          complain(verdict, "point " + std::to_string(i) + ": expected colour " +
                                std::to_string(twin.color[k]) + ", found " +
                                std::to_string((one.color >> (8 * k)) & 255U));
        }
      }
      if (!(std::abs(weight - twin.weight) <= 1e-4 * twin.weight) && twin.margin > kUndecided) {
        complain(verdict, "point " + std::to_string(i) + ": expected weight " +
                              std::to_string(twin.weight) + ", found " + std::to_string(weight));
      }
    }
  }
  verdict.worst["points seen"] = seen;
  verdict.worst["points not seen"] = hidden;
  return verdict;
}

Verdict verify_colors(std::span<const gpu::ColorSighting> sightings,
                      std::span<const uint32_t> colors) {
  Verdict verdict;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const auto of_point = sightings.subspan(i * gpu::kMostSightings, gpu::kMostSightings);
    const std::array<double, 3> twin = reference::agreed_color(of_point);
    const auto count = static_cast<uint32_t>(std::ranges::count_if(
        of_point, [](const gpu::ColorSighting& one) { return one.weight > 0.0F; }));
    if (colors[i] >> 24U != count) {
      complain(verdict, "point " + std::to_string(i) + ": expected " + std::to_string(count) +
                            " sightings, found " + std::to_string(colors[i] >> 24U));
    }
    for (uint32_t k = 0; k < 3; ++k) {
      const double error = std::abs(((colors[i] >> (8 * k)) & 255U) - twin[k]);
      verdict.worst["colour"] = std::max(verdict.worst["colour"], error);
      if (!(error <= 0.51)) {
        complain(verdict, "point " + std::to_string(i) + ": expected colour " +
                              std::to_string(twin[k]) + ", found " +
                              std::to_string((colors[i] >> (8 * k)) & 255U));
      }
    }
  }
  verdict.worst["points"] = static_cast<double>(colors.size());
  return verdict;
}

}  // namespace adit::test
