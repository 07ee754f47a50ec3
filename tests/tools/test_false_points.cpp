// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Points that are of no surface of the place: mixed pixels, and what carries the sensor.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "adit/slam/core/units.hpp"
#include "adit/tools/map_products/carrier_space.hpp"
#include "adit/tools/map_products/mixed_pixels.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

/// A ring whose range (m) is a function of the azimuth in steps of 0.2 degrees, with an error that
/// alternates by 1 cm.
template <class Range>
Sweep ring_of(int returns, const Range& range) {
  Sweep sweep;
  for (int i = 0; i < returns; ++i) {
    const double azimuth = 0.2 * kDegree * i;
    const double r = range(i, azimuth) + (i % 2 == 0 ? 0.005 : -0.005);
    sweep.points.push_back({.x = static_cast<float>(r * std::cos(azimuth)),
                            .y = static_cast<float>(r * std::sin(azimuth)),
                            .z = 0.0F});
    sweep.rings.push_back(0);
  }
  return sweep;
}

TEST(MixedPixels, AReturnBetweenTwoWallsIsMixedAndNoneOfTheWalls) {
  // Walls at x = 5 m and x = 5.6 m; return 60 is between them.
  const Sweep sweep = ring_of(120, [](int i, double azimuth) {
    return (i < 60 ? 5.0 : i == 60 ? 5.3 : 5.6) / std::cos(azimuth);
  });
  const std::vector<bool> mixed = mixed_pixels(sweep);
  ASSERT_EQ(mixed.size(), 120U);
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    EXPECT_EQ(mixed[i], i == 60) << i;
  }
}

TEST(MixedPixels, EdgesAndWallsAtASlantAreNotMixed) {
  const auto none = [](const Sweep& sweep) {
    const std::vector<bool> mixed = mixed_pixels(sweep);
    return std::ranges::count(mixed, true) == 0;
  };
  EXPECT_TRUE(none(ring_of(
      120, [](int i, double azimuth) { return (i < 60 ? 5.0 : 5.6) / std::cos(azimuth); })));
  // A wall that is seen at 6 degrees: ranges of neighbours differ by 0.2 m and more.
  EXPECT_TRUE(none(
      ring_of(60, [](int, double azimuth) { return 0.7 / std::sin(azimuth + 6.0 * kDegree); })));
  // Surfaces farther apart than a pulse is long do not melt.
  EXPECT_TRUE(none(ring_of(120, [](int i, double azimuth) {
    return (i < 60 ? 5.0 : i == 60 ? 6.0 : 7.0) / std::cos(azimuth);
  })));
}

TEST(MixedPixels, SweepsWithoutRingsOrReturnsHaveNone) {
  Sweep sweep = ring_of(120, [](int i, double) { return i == 60 ? 5.3 : i < 60 ? 5.0 : 5.6; });
  sweep.rings.clear();
  EXPECT_EQ(mixed_pixels(sweep), std::vector<bool>(120, false));
  EXPECT_TRUE(mixed_pixels({}).empty());
  sweep = ring_of(3, [](int, double) { return 5.0; });
  sweep.points[1] = {};
  EXPECT_EQ(mixed_pixels(sweep), std::vector<bool>(2, false));
}

TEST(CarrierSpace, WhatStaysInTheSensorsFrameAndIsSeenThroughIsTheCarrier) {
  const Vector3d post(-0.55, 0.75, 0.05);
  const Vector3d ground(1.55, 0.05, -0.95);
  const Vector3d passing(2.05, 2.05, 0.05);
  CarrierSearch search;
  for (NodeId keyframe = 0; keyframe < 10; ++keyframe) {
    search.add_keyframe(keyframe);
    for (int sweep = 0; sweep < 5; ++sweep) {
      search.add(post, sweep > 0, keyframe);
      search.add(ground, false, keyframe);
      if (keyframe < 4) {
        search.add(passing, true, keyframe);
      }
    }
  }
  const CarrierSpace carrier = search.found();
  EXPECT_TRUE(carrier.contains(post));
  EXPECT_FALSE(carrier.contains(ground)) << "in the same cell from everywhere, but there";
  EXPECT_FALSE(carrier.contains(passing)) << "seen through, but from few places";
  EXPECT_FALSE(CarrierSearch().found().contains(post));
}

}  // namespace
}  // namespace adit
