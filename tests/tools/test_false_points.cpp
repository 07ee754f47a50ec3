// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Points that are of no surface: mixed pixels, images in panes of glass, what carries the sensor.
#include <cmath>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"
#include "adit/tests/plans/mapped_house.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/map_products/carrier_space.hpp"
#include "adit/tools/map_products/mirror_space.hpp"
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

/// A corridor along x with a wall at y = -2 m and one at y = 2 m, which is a pane for x in 3 to 6
/// m; a wall at y = 5 m is behind it, and a box of 0.6 m before the wall at y = -2 m.
class Corridor : public testing::Test {
 protected:
  void write(bool pane, const std::vector<Vector3d>& images) {
    std::vector<Vector3d> sensors;
    for (int step = 0; step < 8; ++step) {
      sensors.emplace_back(0.8 + step, 0.0, 0.0);
    }
    test::write_house(map_, sensors, [&](KeyframeSubmap& submap, const Vector3d& sensor, NodeId) {
      const auto add = [&](const Vector3d& point, const Vector3d& normal) {
        test::add_point(submap, sensor, point, normal);
      };
      for (double x = 0.05; x < 9.0; x += 0.1) {
        for (double z = -0.95; z < 1.0; z += 0.1) {
          add({x, x > 4.0 && x < 4.6 ? -1.4 : -2.0, z}, Vector3d::UnitY());
          const bool glass = pane && x > 3.0 && x < 6.0;
          // Of the pane a point in four returns.
          if (!glass || std::lround(10.0 * (x + z)) % 4 == 0) {
            add({x, 2.0, z}, -Vector3d::UnitY());
          }
          if (glass) {
            add({x, 5.0, z}, -Vector3d::UnitY());
          }
        }
      }
      for (const Vector3d& image : images) {
        add(image, -Vector3d::UnitY());
      }
    });
  }

  MirrorSpace found() const {
    const MapDatabase map(map_, MapAccess::read);
    return find_mirror_space(map, uint64_t{64} << 20U, [](std::size_t, std::size_t) {});
  }

  test::TemporaryFolder folder_;
  std::filesystem::path map_ = folder_ / "map.adit";
};

TEST_F(Corridor, ImagesInAPaneAreFoundAndWhatIsBehindItStays) {
  // The box's image is 3.4 m behind the pane; the wall's, at y = 6 m, is behind the wall.
  write(true, {{4.1, 5.4, 0.1}, {4.3, 5.4, 0.3}, {4.5, 6.0, 0.5}});
  const MirrorSpace mirrors = found();
  EXPECT_EQ(mirrors.panes, 1U);
  EXPECT_TRUE(mirrors.contains({4.1, 5.4, 0.1}));
  EXPECT_TRUE(mirrors.contains({4.3, 5.4, 0.3}));
  for (double x = 0.05; x < 9.0; x += 0.1) {
    EXPECT_FALSE(mirrors.contains({x, 2.0, 0.05})) << "the pane and the walls beside it";
    EXPECT_FALSE(mirrors.contains({x, x > 4.0 && x < 4.6 ? -1.4 : -2.0, 0.05}));
    EXPECT_FALSE(mirrors.contains({x, 5.0, 0.05})) << "a wall that mirrors nothing";
  }
}

TEST_F(Corridor, AWallIsNoMirror) {
  write(false, {{4.1, 5.4, 0.1}});
  const MirrorSpace mirrors = found();
  EXPECT_EQ(mirrors.panes, 0U);
  EXPECT_EQ(mirrors.voxels(), 0U);
}

TEST_F(Corridor, AMapWithoutKeyframesHasNoMirrors) {
  { MapDatabase map(map_, MapAccess::write); }
  EXPECT_EQ(found().voxels(), 0U);
}

}  // namespace
}  // namespace adit
