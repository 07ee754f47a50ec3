// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/self_test/self_test_coloring.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>
#include <string>
#include <utility>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/coloring.hpp"

namespace adit::engine {
namespace {

using Vector = std::array<double, 3>;  // m, optical frame

// A pinhole camera, and its depth image.
constexpr uint32_t kWidth = 64;
constexpr uint32_t kHeight = 48;
constexpr int kAcross = 32;
constexpr int kDown = 24;
constexpr double kPixels = 2.0;  // of the image, in one of the depth image
constexpr double kFocal = 32.0;
constexpr double kWidest = 0.384615;  // u: 64 degrees off the axis

constexpr double kWall = 4.0;                         // m ahead
constexpr Vector kBall = {18.0 / 32, 2.0 / 32, 2.0};  // in the middle of a depth image's pixel
constexpr double kRadius = 0.4;                       // m, of surfaces
constexpr double kTolerance = 0.1;                    // m
constexpr uint32_t kFacing = 1U << 30U | 16383U;      // a plane whose normal is -x of the points

constexpr double kDepthTolerance = 1e-4;   // m
constexpr double kWeightTolerance = 1e-4;  // of the weight

constexpr uint32_t packed(uint32_t red, uint32_t green, uint32_t blue) {
  return red | green << 8U | blue << 16U;
}
constexpr uint32_t kLeft = packed(200, 40, 20);  // of the image's halves
constexpr uint32_t kRight = packed(20, 60, 220);
constexpr uint32_t kBetween = packed(110, 50, 120);
constexpr uint32_t kEarlier = packed(1, 2, 3);  // of sightings that were there before

/// The points' x looks ahead, y to the left, z up; the camera is not at their origin.
constexpr gpu::mat3x4 kPlaceOfCamera = {
    {{0.0F, -1.0F, 0.0F, -0.25F}, {0.0F, 0.0F, -1.0F, 1.0F}, {1.0F, 0.0F, 0.0F, -0.5F}}};

gpu::vec3 local(const Vector& p) {
  return {static_cast<float>(p[2] + 0.5), static_cast<float>(-p[0] - 0.25),
          static_cast<float>(1.0 - p[1])};
}

/// x/z or y/z in the middle of a depth image's column or row, of so many.
double slope(int at, int count) {
  return (at + 0.5 - 0.5 * count) * kPixels / kFocal;
}

Vector ray(int x, int y) {
  const double length = std::hypot(slope(x, kAcross), slope(y, kDown), 1.0);
  return {slope(x, kAcross) / length, slope(y, kDown) / length, 1.0 / length};
}

/// m; the ball is a disc that faces the camera.
double known_depth(int x, int y) {
  const Vector d = ray(x, y);
  const double range = std::hypot(kBall[0], kBall[1], kBall[2]);
  const double along = range * range / (d[0] * kBall[0] + d[1] * kBall[1] + d[2] * kBall[2]);
  const double aside =
      std::hypot(along * d[0] - kBall[0], along * d[1] - kBall[1], along * d[2] - kBall[2]);
  return aside <= kRadius ? along : kWall / d[2];
}

gpu::ViewCamera known_camera() {
  return {.T_camera_local = kPlaceOfCamera,
          .fx = static_cast<float>(kFocal),
          .fy = static_cast<float>(kFocal),
          .cx = 0.5F * static_cast<float>(kWidth - 1),
          .cy = 0.5F * static_cast<float>(kHeight - 1),
          .p1 = 0.0F,
          .p2 = 0.0F,
          .widest = static_cast<float>(kWidest),
          .width = kWidth,
          .height = kHeight};
}

std::vector<float> known_lens() {
  std::vector<float> radii;
  for (uint32_t step = 0; step <= gpu::kLensSteps; ++step) {
    const double u = kWidest * step / gpu::kLensSteps;
    const double h = u / (1.0 - u);  // the tangent of half the angle
    radii.push_back(static_cast<float>(2.0 * h / (1.0 - h * h)));
  }
  return radii;
}

std::vector<gpu::vec3> known_rays() {
  std::vector<gpu::vec3> rays;
  for (int y = 0; y < kDown; ++y) {
    for (int x = 0; x < kAcross; ++x) {
      const Vector d = ray(x, y);
      rays.push_back(
          {static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])});
    }
  }
  return rays;
}

/// Of the wall one for every second pixel of the depth image each way: the others are seen between.
std::vector<gpu::ViewSurface> known_surfaces() {
  std::vector<gpu::ViewSurface> surfaces = {{local(kBall), 0}};
  for (int y = 0; y <= kDown; y += 2) {
    for (int x = 0; x <= kAcross; x += 2) {
      surfaces.push_back(
          {local({kWall * slope(x, kAcross), kWall * slope(y, kDown), kWall}), kFacing});
    }
  }
  return surfaces;
}

std::vector<uint32_t> known_image() {
  std::vector<uint32_t> image;
  for (uint32_t i = 0; i < kWidth * kHeight; ++i) {
    image.push_back(i % kWidth < kWidth / 2 ? kLeft : kRight);
  }
  return image;
}

struct KnownPoint {
  gpu::vec3 p{};
  double weight = 0.0;  ///< 0: not seen
  uint32_t color = 0;
};

/// Before the wall, on it, less behind it than the tolerance and more, and behind the camera; at
/// last on the wall where the halves of the image meet.
std::vector<KnownPoint> known_points() {
  std::vector<KnownPoint> points;
  const auto weight = [](double range) { return kFocal * kFocal / (range * range); };
  for (const double z : {3.0, kWall, 4.05, 4.5, -4.0}) {
    for (int y = 1; y < kDown - 1; ++y) {
      for (int x = 1; x < kAcross - 1; ++x) {
        const double range = z / ray(x, y)[2];
        const bool seen = z > 0.0 && range - kTolerance <= known_depth(x, y);
        points.push_back({.p = local({z * slope(x, kAcross), z * slope(y, kDown), z}),
                          .weight = seen ? weight(range) : 0.0,
                          .color = x < kAcross / 2 ? kLeft : kRight});
      }
    }
  }
  for (int y = 1; y < kDown - 1; ++y) {
    points.push_back({.p = local({0.0, kWall * slope(y, kDown), kWall}),
                      .weight = weight(kWall * std::hypot(slope(y, kDown), 1.0)),
                      .color = kBetween});
  }
  return points;
}

/// Every second point has as many as are kept, one of which is of little weight.
std::vector<gpu::ColorSighting> earlier_sightings(std::size_t points) {
  std::vector<gpu::ColorSighting> sightings(points * gpu::kMostSightings);
  for (uint32_t i = 0; i < sightings.size(); ++i) {
    const uint32_t slot = i % gpu::kMostSightings;
    if (i / gpu::kMostSightings % 2 == 1) {
      sightings[i] = {.color = kEarlier,
                      .weight = slot == 3 ? 1e-3F : 1e3F + static_cast<float>(slot)};
    }
  }
  return sightings;
}

template <class T>
Buffer uploaded(Context& context, const std::vector<T>& values) {
  Buffer buffer =
      context.make_buffer(values.size() * sizeof(T), Memory::upload, "self-test of colours");
  std::ranges::copy(values, buffer.as<T>().begin());
  return buffer;
}

SelfTestCase check_depth(std::span<const uint32_t> found) {
  double worst = 0.0;
  for (int y = 0; y < kDown; ++y) {
    for (int x = 0; x < kAcross; ++x) {
      const uint32_t bits = found[static_cast<std::size_t>(y * kAcross + x)];
      const double off =
          std::abs(static_cast<double>(std::bit_cast<float>(bits)) - known_depth(x, y));
      worst = std::isnan(off) || off > worst ? off : worst;  // kNoDepth is a NaN as well
    }
  }
  return {"view_depth", worst <= kDepthTolerance,
          "expected how far away a wall and a ball are in " + std::to_string(found.size()) +
              " pixels, found it within " + std::to_string(1e3 * worst) + " mm"};
}

SelfTestCase check_sightings(const std::vector<KnownPoint>& points,
                             std::span<const gpu::ColorSighting> found) {
  std::vector<gpu::ColorSighting> expected = earlier_sightings(points.size());
  std::size_t seen = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].weight > 0.0) {
      ++seen;
      expected[i * gpu::kMostSightings + (i % 2 == 0 ? 0U : 3U)] = {
          .color = points[i].color, .weight = static_cast<float>(points[i].weight)};
    }
  }
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto weight = static_cast<double>(expected[i].weight);
    const double off = std::abs(static_cast<double>(found[i].weight) - weight);
    wrong += found[i].color == expected[i].color && off <= kWeightTolerance * weight ? 0U : 1U;
  }
  return {"view_sight", wrong == 0,
          "expected " + std::to_string(seen) + " of " + std::to_string(points.size()) +
              " points to be seen, found " + std::to_string(wrong) + " sightings wrong"};
}

std::vector<SelfTestCase> test_view(Context& context, const Coloring& kernels) {
  const std::vector<KnownPoint> points = known_points();
  std::vector<gpu::vec3> places;
  std::ranges::transform(points, std::back_inserter(places), &KnownPoint::p);
  const std::vector<gpu::ViewSurface> surfaces = known_surfaces();
  const Buffer discs = uploaded(context, surfaces);
  const Buffer lens = uploaded(context, known_lens());
  const Buffer rays = uploaded(context, known_rays());
  const Buffer image = uploaded(context, known_image());
  const Buffer given = uploaded(context, places);
  const Buffer earlier = uploaded(context, earlier_sightings(points.size()));
  const Buffer depths =
      context.make_buffer(sizeof(uint32_t) * kAcross * kDown, Memory::device, "self-test's depths");
  const Buffer sightings =
      context.make_buffer(earlier.size(), Memory::device, "self-test's sightings");
  const Buffer depths_back =
      context.make_buffer(depths.size(), Memory::readback, "self-test's depths back");
  const Buffer sightings_back =
      context.make_buffer(sightings.size(), Memory::readback, "self-test's sightings back");
  const DepthImage depth{
      .depths = depths, .width = kAcross, .height = kDown, .pixels = static_cast<float>(kPixels)};
  const gpu::ViewCamera camera = known_camera();
  Recorder recorder = context.make_recorder();
  recorder.copy(earlier, sightings);
  kernels.record_clear(recorder, depth);
  kernels.record_depth(recorder, camera, depth, discs, static_cast<uint32_t>(surfaces.size()),
                       static_cast<float>(kRadius), lens, rays);
  recorder.barrier();
  kernels.record_sight(recorder, camera, depth, given, static_cast<uint32_t>(points.size()),
                       static_cast<float>(kTolerance), {1.0F, 1.0F, 1.0F}, lens, image, sightings);
  recorder.copy(depths, depths_back);
  recorder.copy(sightings, sightings_back);
  context.submit(std::move(recorder)).wait();
  return {check_depth(depths_back.as<uint32_t>()),
          check_sightings(points, sightings_back.as<gpu::ColorSighting>())};
}

/// Three sightings of one colour have less than half of the weight, three of a redder one make up
/// the rest, and two of what stood in the way count for nothing; every fifth point has none.
SelfTestCase test_mean(Context& context, const Coloring& kernels) {
  constexpr uint32_t kPoints = 200;
  std::vector<gpu::ColorSighting> sightings(kPoints * gpu::kMostSightings);
  std::vector<uint32_t> expected(kPoints, 0);
  for (uint32_t i = 0; i < kPoints; ++i) {
    if (i % 5 == 0) {
      continue;
    }
    const uint32_t red = 7 * i % 240;
    const uint32_t green = 5 * i % 150;
    const uint32_t blue = 3 * i % 150;
    for (uint32_t k = 0; k < gpu::kMostSightings; ++k) {
      gpu::ColorSighting& one = sightings[i * gpu::kMostSightings + (i + k) % gpu::kMostSightings];
      one = k < 3   ? gpu::ColorSighting{packed(red, green, blue), 2.0F}
            : k < 6 ? gpu::ColorSighting{packed(red + 8, green, blue), 1.0F}
                    : gpu::ColorSighting{packed(red, green + 100, blue + 100), 2.0F};
    }
    expected[i] = packed(red + 3, green, blue) | gpu::kMostSightings << 24U;  // 8 * 3 / 9
  }
  const Buffer given = uploaded(context, sightings);
  const Buffer colors =
      context.make_buffer(kPoints * sizeof(uint32_t), Memory::device, "self-test's colours");
  const Buffer back = context.make_buffer(colors.size(), Memory::readback, "colours back");
  Recorder recorder = context.make_recorder();
  kernels.record_mean(recorder, given, kPoints, colors);
  recorder.barrier();
  recorder.copy(colors, back);
  context.submit(std::move(recorder)).wait();
  const std::span<const uint32_t> found = back.as<uint32_t>();
  uint32_t wrong = 0;
  for (uint32_t i = 0; i < kPoints; ++i) {
    wrong += found[i] == expected[i] ? 0U : 1U;
  }
  return {"view_mean", wrong == 0,
          "expected the colours of " + std::to_string(kPoints) +
              " points that most of their sightings agree on, found " + std::to_string(wrong) +
              " wrong"};
}

}  // namespace

std::vector<SelfTestCase> test_coloring(Context& context) {
  const Coloring kernels(context);
  std::vector<SelfTestCase> cases = test_view(context, kernels);
  cases.push_back(test_mean(context, kernels));
  return cases;
}

}  // namespace adit::engine
