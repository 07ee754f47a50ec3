// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A recorded drive whose INS serves as a receiver: KITTI raw 2011-09-26 drive 0001, 70 m.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/executor/slam.hpp"
#include "adit/tests/mapping/submap_support.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/shared_data.hpp"
#include "adit/tests/support/shared_data_sweeps.hpp"

namespace adit {
namespace {

// The INS in the lidar's axes, m (KITTI's calibration of that day).
const Eigen::Vector3d kIns(-0.8087, 0.3196, -0.7997);

struct InsReading {
  Geodetic place;
  double yaw = 0.0;  ///< rad, from east to north
};

std::vector<InsReading> read_ins(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  std::vector<InsReading> readings;
  while (std::getline(in, line)) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream words(line);
    std::array<double, 8> v{};  // frame, time, latitude, longitude, altitude, roll, pitch, yaw
    for (double& value : v) {
      words >> value;
    }
    readings.push_back(
        {.place = {.latitude = v[2], .longitude = v[3], .altitude = v[4]}, .yaw = v[7]});
  }
  return readings;
}

class RecordedFixesTest : public test::DeviceTest {
 protected:
  struct Mapped {
    std::vector<std::size_t> outliers;  ///< indices of fixes
    std::size_t used = 0;
    double error = 0.0;      ///< m, rms of where the map has the INS in the world
    double yaw_error = 0.0;  ///< rad
  };

  /// `shifts` is added to each fix, m, east north up. By lidar alone: ins.csv has no readings.
  Mapped map(const std::filesystem::path& data, const std::vector<Eigen::Vector3d>& shifts) {
    const test::RecordedDrive drive(data);
    const std::vector<InsReading> ins = read_ins(data / "ins.csv");
    const WorldFrame frame(ins.front().place);
    Config config;
    config.gnss.antenna = {{kIns.x(), kIns.y(), kIns.z()}};
    test::TemporaryMap map;
    const auto slam = make_slam(context(), config,
                                {.inertial = false, .map = &map.store(), .session = map.session()});
    for (std::size_t i = 0; i < drive.stamps.size(); ++i) {
      slam->add(drive.sweep(i));
      const Geodetic place = frame.place_of(frame.position_of(ins[i].place) + shifts[i]);
      slam->add(GnssFix{.stamp = drive.stamps[i],
                        .kind = GnssFixKind::ground_augmented,
                        .latitude = place.latitude,
                        .longitude = place.longitude,
                        .altitude = place.altitude,
                        .covariance = 0.05 * 0.05 * Eigen::Matrix3d::Identity()});
      while (slam->next()) {
      }
    }
    slam->flush();
    while (slam->next()) {
    }
    slam->finish_map();
    return judged(map.store(), drive, ins);
  }

 private:
  static Mapped judged(const MapDatabase& map, const test::RecordedDrive& drive,
                       const std::vector<InsReading>& ins) {
    Mapped mapped;
    const std::optional<Georeference> world = map.georeference();
    if (!world) {
      ADD_FAILURE() << "the map has no place in the world";
      return mapped;
    }
    const Eigen::Matrix3d R = world->T_world_map.linear();
    mapped.yaw_error =
        std::remainder(std::atan2(R(1, 0), R(0, 0)) - ins[0].yaw, 2.0 * std::numbers::pi);
    const WorldFrame frame(world->origin);
    const std::vector<MapKeyframe> keyframes = map.keyframes();
    const std::vector<MapFix> fixes = map.fixes();
    for (const MapFix& fix : fixes) {
      const auto i = static_cast<std::size_t>(std::ranges::find(drive.stamps, fix.stamp) -
                                              drive.stamps.begin());
      const auto keyframe = std::ranges::find(keyframes, fix.keyframe, &MapKeyframe::id);
      const Eigen::Vector3d there =
          world->T_world_map * (keyframe->T_map_keyframe * fix.p_keyframe_antenna);
      mapped.error += (there - frame.position_of(ins[i].place)).squaredNorm();
      mapped.used += fix.verdict == FixVerdict::used ? 1 : 0;
      if (fix.verdict == FixVerdict::outlier) {
        mapped.outliers.push_back(i);
      }
    }
    mapped.error = std::sqrt(mapped.error / static_cast<double>(fixes.size()));
    return mapped;
  }
};

constexpr std::size_t kSweeps = 60;
constexpr double kYaw = 0.01;    // rad: 0.6 degrees, over 70 m
constexpr double kError = 0.10;  // m: the odometry alone has 0.05, the INS a few hundredths

TEST_F(RecordedFixesTest, AnInsPlacesTheMap) {
  ADIT_SHARED_DATA_OR_SKIP(data, "kitti_0001");
  const Mapped mapped = map(data, std::vector<Eigen::Vector3d>(kSweeps, Eigen::Vector3d::Zero()));
  EXPECT_GE(mapped.used, 55U);
  EXPECT_TRUE(mapped.outliers.empty());
  EXPECT_LT(mapped.error, kError);
  EXPECT_LT(std::abs(mapped.yaw_error), kYaw);
}

TEST_F(RecordedFixesTest, AFifthOfTheFixesTensOfMetresOffAreJustThoseLeftOut) {
  ADIT_SHARED_DATA_OR_SKIP(data, "kitti_0001");
  std::mt19937 random(11);
  std::uniform_real_distribution<double> distance(10.0, 50.0);
  std::uniform_real_distribution<double> bearing(0.0, 2.0 * std::numbers::pi);
  std::vector<Eigen::Vector3d> shifts(kSweeps, Eigen::Vector3d::Zero());
  std::vector<std::size_t> wrong(kSweeps - 1);  // the last sweep's fix comes behind the map
  std::iota(wrong.begin(), wrong.end(), 0U);
  std::ranges::shuffle(wrong, random);
  wrong.resize(kSweeps / 5);
  std::ranges::sort(wrong);
  for (const std::size_t i : wrong) {
    const double angle = bearing(random);
    shifts[i] = distance(random) * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
  }
  const Mapped mapped = map(data, shifts);
  EXPECT_EQ(mapped.outliers, wrong);
  EXPECT_LT(mapped.error, kError);
  EXPECT_LT(std::abs(mapped.yaw_error), kYaw);
}

TEST_F(RecordedFixesTest, AJumpOfTheReceiverIsNotFollowed) {
  ADIT_SHARED_DATA_OR_SKIP(data, "kitti_0001");
  std::vector<Eigen::Vector3d> shifts(kSweeps, Eigen::Vector3d::Zero());
  std::fill(shifts.begin() + kSweeps / 2, shifts.end(), Eigen::Vector3d(4.0, 3.0, 0.0));
  const Mapped mapped = map(data, shifts);
  EXPECT_GE(mapped.used, 25U);
  EXPECT_GE(mapped.outliers.size(), 25U);
  EXPECT_TRUE(std::ranges::all_of(mapped.outliers, [](auto i) { return i >= kSweeps / 2; }));
  EXPECT_LT(mapped.error, 2.0 * kError);  // what lies behind the jump goes by the odometry
}

}  // namespace
}  // namespace adit
