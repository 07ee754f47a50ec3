// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/coloring/view_coloring.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "adit/engine/context.hpp"
#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

// Of a depth image: 5 cm at 10 m, less than the submaps' points are apart there.
constexpr double kDepthPixel = 0.3 * kDegree;

engine::DepthImage depth_image(const ViewColoring::View& view) {
  return {.depths = view.depth,
          .width = view.camera->depth_width,
          .height = view.camera->depth_height,
          .pixels = static_cast<float>(view.camera->depth_pixels)};
}

template <class T>
engine::Buffer uploaded(engine::Context& context, std::span<const T> values, const char* name) {
  engine::Buffer buffer = context.make_buffer(values.size_bytes(), engine::Memory::upload, name);
  std::ranges::copy(values, buffer.as<T>().begin());
  return buffer;
}

}  // namespace

LensTable lens_table(const CameraModel& model) {
  const CameraProjection projection(model);
  const bool fisheye = model.lens == Lens::fisheye;
  const double widest = fisheye ? projection.widest() : std::atan(projection.widest());
  // u of an angle, and back: shaders/shared/coloring.h.
  const double u = std::sin(widest) / (std::sin(widest) + 1.0 + std::cos(widest));
  const double u_widest = widest < std::numbers::pi ? u : 1.0;
  const auto angle_of = [](double at) { return 2.0 * std::atan2(at, 1.0 - at); };
  CameraModel centred = model;
  centred.fx = 1.0;
  centred.fy = 1.0;
  centred.cx = 0.0;
  centred.cy = 0.0;
  if (!fisheye) {  // the kernels add the tangential part, which is not one of the radius
    centred.distortion[2] = 0.0;
    centred.distortion[3] = 0.0;
  }
  const CameraProjection radial(centred);
  LensTable table{.camera = {.T_camera_local = {},
                             .fx = static_cast<float>(model.fx),
                             .fy = static_cast<float>(model.fy),
                             .cx = static_cast<float>(model.cx),
                             .cy = static_cast<float>(model.cy),
                             .p1 = fisheye ? 0.0F : static_cast<float>(model.distortion[2]),
                             .p2 = fisheye ? 0.0F : static_cast<float>(model.distortion[3]),
                             .widest = static_cast<float>(u_widest),
                             .width = static_cast<uint32_t>(model.width),
                             .height = static_cast<uint32_t>(model.height)},
                  .radii = {}};
  for (uint32_t step = 0; step <= gpu::kLensSteps; ++step) {
    // Rounding must not lead past the widest angle.
    constexpr double kJustInside = 1.0 - 1e-9;
    const double at = angle_of(kJustInside * u_widest * step / gpu::kLensSteps);
    const auto pixel = radial.pixel({std::sin(at), 0.0, std::cos(at)});
    table.radii.push_back(pixel ? static_cast<float>(pixel->x()) : table.radii.back());
  }
  return table;
}

DepthGrid depth_grid(const CameraModel& camera) {
  DepthGrid grid;
  grid.pixels = std::max(1.0, kDepthPixel * std::max(camera.fx, camera.fy));
  const auto size = [&](std::size_t pixels) {
    return static_cast<uint32_t>(std::ceil(static_cast<double>(pixels) / grid.pixels));
  };
  grid.width = size(camera.width);
  grid.height = size(camera.height);
  const CameraProjection projection(camera);
  for (uint32_t v = 0; v < grid.height; ++v) {
    for (uint32_t u = 0; u < grid.width; ++u) {
      const Eigen::Vector3d ray =
          projection.ray({(u + 0.5) * grid.pixels - 0.5, (v + 0.5) * grid.pixels - 0.5})
              .value_or(Eigen::Vector3d::Zero());
      grid.rays.push_back(
          {static_cast<float>(ray.x()), static_cast<float>(ray.y()), static_cast<float>(ray.z())});
    }
  }
  return grid;
}

gpu::ViewCamera placed_camera(const gpu::ViewCamera& camera, const Eigen::Isometry3d& T_map_camera,
                              const Eigen::Vector3d& origin) {
  const Eigen::Matrix<float, 3, 4> T_camera_local =
      (T_map_camera.inverse() * Eigen::Translation3d(origin)).affine().cast<float>();
  gpu::ViewCamera placed = camera;
  for (int row = 0; row < 3; ++row) {
    placed.T_camera_local.rows[row] = {T_camera_local(row, 0), T_camera_local(row, 1),
                                       T_camera_local(row, 2), T_camera_local(row, 3)};
  }
  return placed;
}

ViewColoring::ViewColoring(engine::Context& context) : context_(&context), kernels_(context) {}

std::shared_ptr<const ViewColoring::Camera> ViewColoring::make_camera(
    const CameraModel& model) const {
  const LensTable lens = lens_table(model);
  const DepthGrid grid = depth_grid(model);
  return std::make_shared<const Camera>(
      Camera{.model = model,
             .lens = lens.camera,
             .depth_width = grid.width,
             .depth_height = grid.height,
             .depth_pixels = grid.pixels,
             .radii = uploaded<float>(*context_, lens.radii, "a lens"),
             .rays = uploaded<gpu::vec3>(*context_, grid.rays, "rays of a camera")});
}

std::shared_ptr<const ViewColoring::Surfaces> ViewColoring::make_surfaces(
    const Eigen::Vector3d& origin, std::span<const gpu::ViewSurface> elements) const {
  return std::make_shared<const Surfaces>(
      Surfaces{.origin = origin,
               .count = static_cast<uint32_t>(elements.size()),
               .elements = uploaded(*context_, elements, "surfaces in view")});
}

std::shared_ptr<const ViewColoring::View> ViewColoring::make_view(
    const std::shared_ptr<const Camera>& camera, const Eigen::Isometry3d& T_map_camera,
    std::span<const uint8_t> rgb, std::span<const std::shared_ptr<const Surfaces>> surfaces,
    double radius) const {
  const uint64_t depth_bytes =
      sizeof(uint32_t) * uint64_t{camera->depth_width} * camera->depth_height;
  auto view = std::make_shared<View>(
      View{.camera = camera,
           .image = image_on_device(*camera, rgb),
           .depth = context_->make_buffer(depth_bytes, engine::Memory::device, "depths")});
  const engine::DepthImage depth = depth_image(*view);
  engine::Recorder recorder = context_->make_recorder();
  kernels_.record_clear(recorder, depth);
  for (const std::shared_ptr<const Surfaces>& some : surfaces) {
    kernels_.record_depth(recorder, placed_camera(camera->lens, T_map_camera, some->origin), depth,
                          some->elements, some->count, static_cast<float>(radius), camera->radii,
                          camera->rays);
  }
  context_->submit(std::move(recorder)).wait();
  return view;
}

engine::Buffer ViewColoring::image_on_device(const Camera& camera,
                                             std::span<const uint8_t> rgb) const {
  const std::size_t pixels = camera.model.width * camera.model.height;
  if (rgb.size() != 3 * pixels) {
    throw std::logic_error("ViewColoring: expected " + std::to_string(3 * pixels) +
                           " bytes of an image, given " + std::to_string(rgb.size()));
  }
  const engine::Buffer staging =
      context_->make_buffer(pixels * sizeof(uint32_t), engine::Memory::upload, "an image up");
  const std::span<uint32_t> packed = staging.as<uint32_t>();
  for (std::size_t i = 0; i < pixels; ++i) {
    packed[i] = rgb[3 * i] | uint32_t{rgb[3 * i + 1]} << 8U | uint32_t{rgb[3 * i + 2]} << 16U;
  }
  engine::Buffer image = context_->make_buffer(staging.size(), engine::Memory::device, "an image");
  engine::Recorder recorder = context_->make_recorder();
  recorder.copy(staging, image);
  context_->submit(std::move(recorder)).wait();
  return image;
}

std::vector<SeenColor> ViewColoring::colors(std::span<const Eigen::Vector3d> points,
                                            const Eigen::Vector3d& origin,
                                            std::span<const Look> looks, double tolerance) const {
  constexpr std::size_t kMostAtOnce = std::size_t{1} << 20U;  // whose sightings take 64 MB
  std::vector<SeenColor> colors;
  colors.reserve(points.size());
  for (std::size_t begin = 0; begin < points.size() && !looks.empty(); begin += kMostAtOnce) {
    const auto some = points.subspan(begin, std::min(kMostAtOnce, points.size() - begin));
    const std::vector<SeenColor> seen = colors_at_once(some, origin, looks, tolerance);
    colors.insert(colors.end(), seen.begin(), seen.end());
  }
  colors.resize(points.size());
  return colors;
}

std::vector<SeenColor> ViewColoring::colors_at_once(std::span<const Eigen::Vector3d> points,
                                                    const Eigen::Vector3d& origin,
                                                    std::span<const Look> looks,
                                                    double tolerance) const {
  std::vector<SeenColor> colors(points.size());
  const auto count = static_cast<uint32_t>(points.size());
  const engine::Buffer local = context_->make_buffer(points.size() * sizeof(gpu::vec3),
                                                     engine::Memory::upload, "points in view");
  std::ranges::transform(points, local.as<gpu::vec3>().begin(), [&](const Eigen::Vector3d& point) {
    const Eigen::Vector3f from_origin = (point - origin).cast<float>();
    return gpu::vec3{from_origin.x(), from_origin.y(), from_origin.z()};
  });
  const engine::Buffer sightings =
      context_->make_buffer(points.size() * gpu::kMostSightings * sizeof(gpu::ColorSighting),
                            engine::Memory::device, "sightings");
  const engine::Buffer back =
      context_->make_buffer(points.size() * sizeof(uint32_t), engine::Memory::readback, "colours");
  engine::Recorder recorder = context_->make_recorder();
  recorder.fill(sightings, 0);
  recorder.barrier();
  for (const Look& look : looks) {
    const Camera& camera = *look.view->camera;
    kernels_.record_sight(recorder, placed_camera(camera.lens, look.T_map_camera, origin),
                          depth_image(*look.view), local, count, static_cast<float>(tolerance),
                          {look.gain[0], look.gain[1], look.gain[2]}, camera.radii,
                          look.view->image, sightings);
  }
  kernels_.record_mean(recorder, sightings, count, back);
  context_->submit(std::move(recorder)).wait();
  std::ranges::transform(back.as<uint32_t>(), colors.begin(), [](uint32_t packed) {
    return SeenColor{
        .color = {static_cast<uint8_t>(packed & 255U), static_cast<uint8_t>((packed >> 8U) & 255U),
                  static_cast<uint8_t>((packed >> 16U) & 255U)},
        .sightings = static_cast<uint8_t>(packed >> 24U)};
  });
  return colors;
}

}  // namespace adit
