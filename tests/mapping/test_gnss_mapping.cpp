// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// GNSS fixes among the sweeps of a run, by the door that programs use.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "adit/slam/executor/slam.hpp"
#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/submap_support.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

constexpr std::size_t kStreetSweeps = 60;  // 24 m
constexpr std::size_t kWeavingSweeps = 120;
const Geodetic kStreetCorner{.latitude = -33.86, .longitude = 151.21, .altitude = 40.0};
const Eigen::Vector3d kAntenna(-0.6, 0.25, 0.9);  // m, in the lidar's axes

Eigen::Isometry3d T_world_street() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(2.1, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(120.0, -45.0, 2.0);
  return T;
}

class GnssMappingTest : public test::DeviceTest {
 protected:
  static const test::SubmapDrive& drive() {
    static const test::SubmapDrive street = test::submap_drive(kStreetSweeps, 0.4);
    return street;
  }

  /// To and fro between the sides of the street, faster and slower.
  static const test::SubmapDrive& weaving_drive() {
    static const test::SubmapDrive street = [] {
      test::SubmapDrive drive{.truth = test::steady_drive(kWeavingSweeps, test::twist(0.4)),
                              .sweeps = {}};
      Eigen::Isometry3d pose = drive.truth.front().pose;
      for (std::size_t i = 0; i < drive.truth.size(); ++i) {
        drive.truth[i].pose = pose;
        const double t = 0.1 * static_cast<double>(i);  // s
        pose = orthonormalized(
            pose * se3_exp(test::twist(0.4 + 0.15 * std::sin(0.8 * t), 0.045 * std::cos(1.1 * t))));
      }
      drive.sweeps = test::scan_all(test::make_street(60.0), drive.truth, test::small_lidar());
      return drive;
    }();
    return street;
  }

  /// Two fixes a sweep with a centimetre of noise, one of them between sweeps.
  static std::vector<GnssFix> fixes(unsigned seed, const test::SubmapDrive& along = drive()) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, 0.01);
    const WorldFrame frame(kStreetCorner);
    std::vector<GnssFix> fixes;
    for (std::size_t i = 0; i + 1 < along.truth.size(); ++i) {
      const StampedPose& from = along.truth[i];
      const StampedPose& to = along.truth[i + 1];
      for (const double part : {0.0, 0.4}) {
        const Eigen::Isometry3d pose =
            from.pose * se3_exp(part * se3_log(from.pose.inverse() * to.pose));
        const Eigen::Vector3d error(noise(random), noise(random), 2.0 * noise(random));
        const Geodetic place = frame.place_of(T_world_street() * (pose * kAntenna) + error);
        fixes.push_back({.stamp = from.stamp + nanoseconds(part * seconds(to.stamp - from.stamp)),
                         .kind = GnssFixKind::ground_augmented,
                         .latitude = place.latitude,
                         .longitude = place.longitude,
                         .altitude = place.altitude,
                         .covariance = 1e-4 * Eigen::Vector3d(1.0, 1.0, 4.0).asDiagonal()});
      }
    }
    return fixes;
  }

  struct Mapped {
    MapReport report;
    std::string dump;
    double error = 0.0;  ///< m, rms of where keyframes lie in the world
  };

  Mapped run(const GnssConfig& gnss, const std::vector<GnssFix>& fixes,
             const test::SubmapDrive& along = drive()) {
    Config config = test::submap_config();
    config.gnss = gnss;
    test::TemporaryMap map;
    const auto slam = make_slam(context(), config,
                                {.inertial = false, .map = &map.store(), .session = map.session()});
    auto fix = fixes.begin();
    for (const Sweep& sweep : along.sweeps) {
      slam->add(sweep);
      for (; fix != fixes.end() && fix->stamp <= sweep.stamp; ++fix) {
        slam->add(*fix);
      }
      while (slam->next()) {
      }
    }
    slam->flush();
    while (slam->next()) {
    }
    Mapped mapped{.report = slam->finish_map().value(), .dump = map.dump()};
    const std::optional<Georeference> world = map.store().georeference();
    if (world) {
      mapped.error = world_error(map.store(), *world, along);
    }
    return mapped;
  }

 private:
  static double world_error(const MapDatabase& map, const Georeference& world,
                            const test::SubmapDrive& drive) {
    const WorldFrame truth(kStreetCorner);
    const WorldFrame frame(world.origin);
    double sum = 0.0;
    const std::vector<MapKeyframe> keyframes = map.keyframes();
    for (const MapKeyframe& keyframe : keyframes) {
      const auto at =
          std::ranges::find(drive.truth, keyframe.stamp, [](const auto& p) { return p.stamp; });
      const Eigen::Isometry3d T_keyframe_lidar =
          decode(map.submap(keyframe.id)).sweeps.front().T_keyframe_lidar;
      const Eigen::Vector3d stored =
          world.T_world_map * (keyframe.T_map_keyframe * T_keyframe_lidar.translation());
      const Eigen::Vector3d right =
          frame.position_of(truth.place_of(T_world_street() * at->pose.translation()));
      sum += (stored - right).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(keyframes.size()));
  }
};

TEST_F(GnssMappingTest, FixesPlaceTheMapInTheWorld) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Mapped mapped = run(
        {.antenna = {{kAntenna.x(), kAntenna.y(), kAntenna.z()}}, .correlation = 0.1}, fixes(seed));
    ASSERT_TRUE(mapped.report.gnss.georeference) << seed;
    EXPECT_LT(mapped.error, 0.03) << seed;
    EXPECT_GE(mapped.report.gnss.verdicts[static_cast<std::size_t>(FixVerdict::used)], 18U)
        << "one each half second or metre";
    EXPECT_EQ(mapped.report.gnss.verdicts[static_cast<std::size_t>(FixVerdict::outlier)], 0U);
    EXPECT_EQ(mapped.report.gnss.fixes + mapped.report.gnss.outside, 2 * (kStreetSweeps - 1));
  }
}

TEST_F(GnssMappingTest, AnAntennaThatNobodyToldOfIsSeenInTheError) {
  const Mapped mapped = run({.correlation = 0.1}, fixes(6));
  ASSERT_TRUE(mapped.report.gnss.georeference);
  EXPECT_NEAR(mapped.error, kAntenna.norm(), 0.05);
}

TEST_F(GnssMappingTest, AReceiverThatReportsLateIsSetRight) {
  std::vector<GnssFix> late = fixes(7);
  for (GnssFix& fix : late) {
    fix.stamp += nanoseconds(0.3);
  }
  const std::optional<std::array<double, 3>> antenna{{kAntenna.x(), kAntenna.y(), kAntenna.z()}};
  EXPECT_GT(run({.antenna = antenna, .correlation = 0.1}, late).error, 0.3);
  EXPECT_LT(run({.antenna = antenna, .correlation = 0.1, .time_offset = -0.3}, late).error, 0.03);
}

TEST_F(GnssMappingTest, AWrongAntennaAndALateReceiverAreFoundAndSetRight) {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    // As if fixes were 0.15 s late.
    const Mapped mapped = run(
        {.antenna = {{kAntenna.x() - 0.4, kAntenna.y() + 0.2, kAntenna.z()}}, .time_offset = 0.15},
        fixes(seed, weaving_drive()), weaving_drive());
    const AntennaReport& antenna = mapped.report.gnss.antenna;
    EXPECT_TRUE(antenna.corrected) << seed;
    EXPECT_LT((antenna.p_lidar_antenna - kAntenna).head<2>().norm(), 0.08) << seed;
    EXPECT_NEAR(antenna.time_offset, 0.0, 0.01) << seed;
    EXPECT_LT(mapped.error, 0.06) << seed;
  }
}

TEST_F(GnssMappingTest, NothingIsFoundWhereTheAntennaIsRight) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Mapped mapped = run({.antenna = {{kAntenna.x(), kAntenna.y(), kAntenna.z()}}},
                              fixes(seed, weaving_drive()), weaving_drive());
    EXPECT_TRUE(mapped.report.gnss.antenna.estimated) << seed;
    EXPECT_FALSE(mapped.report.gnss.antenna.any_significant()) << seed;
    EXPECT_FALSE(mapped.report.gnss.antenna.corrected) << seed;
    EXPECT_LT(mapped.error, 0.03) << seed;
  }
}

TEST_F(GnssMappingTest, WithoutFixesOrWithThemLeftAloneTheMapIsTheSame) {
  const Mapped none = run({}, {});
  const Mapped unused = run({.use = false}, fixes(8));
  EXPECT_FALSE(unused.report.gnss.any());
  EXPECT_EQ(none.dump, unused.dump);
}

TEST_F(GnssMappingTest, TheSameBytesTwice) {
  EXPECT_EQ(run({.correlation = 0.1}, fixes(9)).dump, run({.correlation = 0.1}, fixes(9)).dump);
}

}  // namespace
}  // namespace adit
