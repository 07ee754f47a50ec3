// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Colours of points out of images: how far away so many surfaces are in a view, what its image
// shows of so many points, and the colours that the sightings of so many agree on.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "adit/benchmarks/kernels/cases.hpp"
#include "adit/benchmarks/kernels/inputs.hpp"
#include "adit/benchmarks/kernels/kernel_work.hpp"
#include "adit/benchmarks/verify/coloring.hpp"
#include "adit/benchmarks/verify/transfer.hpp"
#include "adit/slam/submaps/keyframe_submap.hpp"

namespace adit::bench {
namespace {

constexpr uint32_t kVerifiedSurfaces = 20'000;  // the twin looks at every pixel around each
constexpr uint32_t kSurfacesInView = 2000;  // of a case of points: with more, few of them are seen
constexpr double kWord = sizeof(uint32_t);

/// What a view has to look at.
struct InView {
  double seen = 0.0;    ///< whose middle is in the image
  double pixels = 0.0;  ///< of the depth image, that they cover
};

/// A disc of area A covers fx fy A (n . p) / z^3 pixels of a perspective image, n its normal and p
/// its middle; distortion is left out.
InView surfaces_in_view(const test::ColoringCase& made) {
  const CameraProjection projection(made.model);
  const Eigen::Isometry3d T_camera_map = made.T_map_camera.inverse();
  const double pixels = depth_grid(made.model).pixels;
  const auto radius = static_cast<double>(made.radius);
  const double scale =
      std::numbers::pi * radius * radius * made.model.fx * made.model.fy / (pixels * pixels);
  InView view;
  for (const gpu::ViewSurface& surface : made.surfaces) {
    const Eigen::Vector3d p = T_camera_map * Eigen::Vector3d(surface.p.x, surface.p.y, surface.p.z);
    const auto pixel = projection.pixel(p);
    if (!pixel || !(p.norm() > radius) || std::min(pixel->x(), pixel->y()) < -0.5 ||
        pixel->x() > static_cast<double>(made.model.width) - 0.5 ||
        pixel->y() > static_cast<double>(made.model.height) - 0.5) {
      continue;
    }
    const double facing =
        is_plane(surface.surface)
            ? std::abs((T_camera_map.linear() * surface_direction(surface.surface)).dot(p))
            : p.norm();
    view.seen += 1.0;
    view.pixels += std::max(1.0, scale * facing / (p.z() * p.z() * p.z()));
  }
  return view;
}

Work view_depth(Bench& bench, int surfaces) {
  const auto count = static_cast<uint32_t>(surfaces);
  const CameraModel camera = test::perspective_camera();
  const test::ColoringCase some =
      test::coloring_case(camera, std::min(count, kVerifiedSurfaces), 0);
  test::ColoringRun few(bench.context(), some);
  few.run();
  Work work{.problem = first_problem(test::verify_depth(some, few.depth())),
            .verified_by =
                "double-precision twin, on " + std::to_string(some.surfaces.size()) + " of them",
            .items = count};
  const test::ColoringCase made = test::coloring_case(camera, count, 0);
  const auto run = std::make_shared<test::ColoringRun>(bench.context(), made);
  work.run = [run] { return sample_of(run->run(), "depth of a view"); };
  // Moved 18, its range 6, its direction and pixel 45. One that is seen: its normal 25, two pixels
  // of its edge 130; a pixel that looks at it: where, and how far from the middle, 24.
  const InView view = surfaces_in_view(made);
  const DepthGrid grid = depth_grid(camera);
  const auto all = static_cast<double>(count);
  work.cost = {.bytes = sizeof(gpu::ViewSurface) * all +
                        (sizeof(gpu::vec3) + kWord) * static_cast<double>(grid.rays.size()),
               .flop = 69.0 * all + 155.0 * view.seen + 24.0 * view.pixels,
               .reads = view.seen,
               .atomics = view.pixels,
               .dispatches = 1.0};
  work.figures["surfaces in view"] = view.seen;
  work.figures["pixels covered"] = view.pixels;
  return work;
}

Work view_sightings(Bench& bench, int points) {
  const test::ColoringCase made = test::coloring_case(test::perspective_camera(), kSurfacesInView,
                                                      static_cast<uint32_t>(points));
  const auto run = std::make_shared<test::ColoringRun>(bench.context(), made);
  run->run();
  const std::vector<uint32_t> depth = run->depth();
  const std::vector<gpu::ColorSighting> sightings = run->sightings();
  Work work{.problem = first_problem(test::verify_sightings(made, depth, sightings)),
            .verified_by = "double-precision twin",
            .items = made.points.size()};
  work.run = [run] { return sample_of(run->run(), "sightings"); };
  const auto all = static_cast<double>(made.points.size());
  const auto seen = static_cast<double>(std::ranges::count_if(
      sightings, [](const gpu::ColorSighting& one) { return one.weight > 0.0F; }));
  // Moved 18, its range 6, its direction and pixel 45. One that is seen: between four depths 25,
  // between four colours 35, its weight 3; two rows of depths and two of pixels, and its sightings.
  work.cost = {.bytes = sizeof(gpu::vec3) * all +
                        sizeof(gpu::ColorSighting) * (gpu::kMostSightings + 1) * seen +
                        kWord * static_cast<double>(depth.size() + made.image.size()),
               .flop = 69.0 * all + 63.0 * seen,
               .reads = 4.0 * seen,
               .dispatches = 1.0};
  work.figures["points seen"] = seen;
  return work;
}

/// Sightings as those of a wall: alike, but for what stood in the way in two of eight images.
std::vector<gpu::ColorSighting> some_sightings(std::size_t points) {
  std::mt19937 random(5);
  const auto below = [&](uint32_t bound) { return static_cast<uint32_t>(random() % bound); };
  std::vector<gpu::ColorSighting> sightings;
  for (std::size_t i = 0; i < points; ++i) {
    const uint32_t wall = below(1U << 24U) & 0x7f7f7fU;
    for (uint32_t k = 0; k < gpu::kMostSightings; ++k) {
      const uint32_t light = below(16);
      const uint32_t color = k < 2 ? below(1U << 24U) : wall + (light | light << 8U | light << 16U);
      // Sums of these are exact: whether it is half of the weight does not depend on rounding.
      sightings.push_back({.color = color, .weight = static_cast<float>(1U + below(64))});
    }
  }
  return sightings;
}

struct MeanRun {
  MeanRun(engine::Context& device, const std::vector<gpu::ColorSighting>& given)
      : context(&device),
        kernels(device),
        count(static_cast<uint32_t>(given.size() / gpu::kMostSightings)),
        sightings(test::upload(device, given, "sightings")),
        colors(device.make_buffer(count * sizeof(uint32_t), engine::Memory::device, "colours")) {}

  test::Times run() const {
    return test::run_and_wait(*context, [this](engine::Recorder& recorder) {
      kernels.record_mean(recorder, sightings, count, colors);
    });
  }

  engine::Context* context;
  engine::Coloring kernels;
  uint32_t count;
  engine::Buffer sightings;
  engine::Buffer colors;
};

Work view_colors(Bench& bench, int points) {
  const std::vector<gpu::ColorSighting> sightings =
      some_sightings(static_cast<std::size_t>(points));
  const auto run = std::make_shared<MeanRun>(bench.context(), sightings);
  run->run();
  Work work{.problem = first_problem(test::verify_colors(
                sightings, test::download<uint32_t>(bench.context(), run->colors))),
            .verified_by = "double-precision twin",
            .items = run->count};
  work.run = [run] { return sample_of(run->run(), "colours"); };
  // Each sighting by its weight from each other 2; half of them summed up 7, and divided 6.
  const auto all = static_cast<double>(run->count);
  constexpr double kEach = gpu::kMostSightings;
  work.cost = {.bytes = (sizeof(gpu::ColorSighting) * kEach + kWord) * all,
               .flop = (2.0 * kEach * kEach + 3.5 * kEach + 6.0) * all,
               .dispatches = 1.0};
  return work;
}

}  // namespace

std::vector<Case> coloring_cases() {
  return {{.name = "coloring/depth", .item = "surface", .make = view_depth},
          {.name = "coloring/sightings", .make = view_sightings},
          {.name = "coloring/colors", .make = view_colors}};
}

}  // namespace adit::bench
