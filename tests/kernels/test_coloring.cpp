// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Depth images, sightings and colours beside the twin.
#include <array>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/coloring.hpp"
#include "adit/benchmarks/verify/transfer.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/layout.hpp"

namespace adit {
namespace {

using test::expect_layout;

class ColoringKernels : public test::DeviceTest {};

TEST(KernelLayouts, ColoringStructsAreTheSameInCppAndGlsl) {
  using gpu::ViewSurface;
  expect_layout<ViewSurface>("ViewSurface", {{"p", offsetof(ViewSurface, p)},
                                             {"surface", offsetof(ViewSurface, surface)}});
  using gpu::ColorSighting;
  expect_layout<ColorSighting>("ColorSighting", {{"color", offsetof(ColorSighting, color)},
                                                 {"weight", offsetof(ColorSighting, weight)}});
  using gpu::DepthPush;
  expect_layout<DepthPush>("DepthPush", {{"camera", offsetof(DepthPush, camera)},
                                         {"surface_count", offsetof(DepthPush, surface_count)},
                                         {"depth_width", offsetof(DepthPush, depth_width)},
                                         {"depth_height", offsetof(DepthPush, depth_height)},
                                         {"pixels", offsetof(DepthPush, pixels)},
                                         {"radius", offsetof(DepthPush, radius)}});
  using gpu::SightPush;
  expect_layout<SightPush>("SightPush", {{"camera", offsetof(SightPush, camera)},
                                         {"point_count", offsetof(SightPush, point_count)},
                                         {"depth_width", offsetof(SightPush, depth_width)},
                                         {"depth_height", offsetof(SightPush, depth_height)},
                                         {"pixels", offsetof(SightPush, pixels)},
                                         {"tolerance", offsetof(SightPush, tolerance)},
                                         {"gain", offsetof(SightPush, gain)}});
  expect_layout<gpu::MeanPush>("MeanPush", {{"point_count", offsetof(gpu::MeanPush, point_count)}});
  using gpu::ViewCamera;
  expect_layout<ViewCamera>("ViewCamera", {{"T_camera_local", offsetof(ViewCamera, T_camera_local)},
                                           {"fx", offsetof(ViewCamera, fx)},
                                           {"fy", offsetof(ViewCamera, fy)},
                                           {"cx", offsetof(ViewCamera, cx)},
                                           {"cy", offsetof(ViewCamera, cy)},
                                           {"p1", offsetof(ViewCamera, p1)},
                                           {"p2", offsetof(ViewCamera, p2)},
                                           {"widest", offsetof(ViewCamera, widest)},
                                           {"width", offsetof(ViewCamera, width)},
                                           {"height", offsetof(ViewCamera, height)}});
}

TEST_F(ColoringKernels, AViewIsTheTwins) {
  for (const CameraModel& model : {test::perspective_camera(), test::fisheye_camera()}) {
    const test::ColoringCase made = test::coloring_case(model, 6000, 5000);
    test::ColoringRun run(context(), made);
    std::vector<uint32_t> first;
    for (int repeat = 0; repeat < 2; ++repeat) {
      run.run();
      const std::vector<uint32_t> depth = run.depth();
      const test::Verdict depths = test::verify_depth(made, depth);
      EXPECT_TRUE(depths.passed()) << depths.text();
      EXPECT_GT(depths.worst.at("pixels that see something"),
                0.15 * static_cast<double>(depth.size()));
      EXPECT_LT(depths.worst.at("pixels that rounding decides"),
                0.01 * static_cast<double>(depth.size()));
      const test::Verdict sightings = test::verify_sightings(made, depth, run.sightings());
      EXPECT_TRUE(sightings.passed()) << sightings.text();
      EXPECT_GT(sightings.worst.at("points seen"), 300.0);
      EXPECT_GT(sightings.worst.at("points not seen"), 500.0);
      const test::Verdict colors = test::verify_colors(run.sightings(), run.colors());
      EXPECT_TRUE(colors.passed()) << colors.text();
      if (repeat == 0) {
        first = run.colors();
      }
      EXPECT_EQ(first, run.colors()) << "the same bytes again";
    }
  }
}

TEST_F(ColoringKernels, SizesAtTheEdges) {
  for (const uint32_t count : {0U, 1U, 65U, 129U}) {
    const test::ColoringCase made = test::coloring_case(test::perspective_camera(), count, count);
    test::ColoringRun run(context(), made);
    run.run();
    const test::Verdict depths = test::verify_depth(made, run.depth());
    EXPECT_TRUE(depths.passed()) << count << ": " << depths.text();
    if (count > 0) {
      const test::Verdict sightings = test::verify_sightings(made, run.depth(), run.sightings());
      EXPECT_TRUE(sightings.passed()) << count << ": " << sightings.text();
    }
  }
}

TEST_F(ColoringKernels, AWallHidesWhatIsBehindIt) {
  test::ColoringCase made = test::coloring_case(test::perspective_camera(), 0, 0);
  // 6 m ahead, across the whole image, a surface every 10 cm.
  for (int y = -80; y <= 80; ++y) {
    for (int z = -80; z <= 80; ++z) {
      made.surfaces.push_back(
          {{6.3F, 0.1F * static_cast<float>(y), 1.1F + 0.1F * static_cast<float>(z)}, 0});
    }
  }
  made.points = {{6.3F, 0.3F, 1.2F}, {4.0F, 0.3F, 1.2F}, {7.0F, 0.3F, 1.2F}, {-6.0F, 0.3F, 1.2F}};
  test::ColoringRun run(context(), made);
  run.run();
  const std::vector<uint32_t> colors = run.colors();
  EXPECT_EQ(colors[0] >> 24U, 1U) << "on the wall";
  EXPECT_EQ(colors[1] >> 24U, 1U) << "before it, where the map has nothing";
  EXPECT_EQ(colors[2], 0U) << "behind it";
  EXPECT_EQ(colors[3], 0U) << "behind the camera";
}

TEST_F(ColoringKernels, ColorsAreWhatMostAgreeOn) {
  std::mt19937 engine(3);
  const auto random = [&] { return static_cast<uint32_t>(engine()); };
  std::vector<gpu::ColorSighting> sightings;
  for (uint32_t point = 0; point < 3000; ++point) {
    for (uint32_t k = 0; k < gpu::kMostSightings; ++k) {
      const uint32_t color = random() & (point % 2 == 0 ? 0x030303U : 0xffffffU);
      // Weights that are sums of few bits: which half is taken does not depend on rounding.
      sightings.push_back({.color = color,
                           .weight = k < point % (gpu::kMostSightings + 1)
                                         ? static_cast<float>(1 + random() % 64)
                                         : 0.0F});
    }
  }
  // A pedestrian in two of eight images.
  for (uint32_t k = 0; k < gpu::kMostSightings; ++k) {
    sightings.push_back({.color = k < 2 ? 0x0000ffU : 0x20c040U, .weight = k < 2 ? 30.0F : 20.0F});
  }
  const auto count = static_cast<uint32_t>(sightings.size() / gpu::kMostSightings);
  const engine::Buffer given = test::upload(context(), sightings, "sightings");
  const engine::Buffer colors =
      context().make_buffer(count * sizeof(uint32_t), engine::Memory::device, "colours");
  const engine::Coloring kernels(context());
  test::run_and_wait(context(), [&](engine::Recorder& recorder) {
    kernels.record_mean(recorder, given, count, colors);
  });
  const std::vector<uint32_t> found = test::download<uint32_t>(context(), colors);
  const test::Verdict verdict = test::verify_colors(sightings, found);
  EXPECT_TRUE(verdict.passed()) << verdict.text();
  EXPECT_EQ(found.back(), 0x0820c040U);
}

}  // namespace
}  // namespace adit
