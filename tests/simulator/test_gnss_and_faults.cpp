// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "adit/tests/simulator/trajectories.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/simulator/faults.hpp"
#include "adit/tools/simulator/gnss_model.hpp"
#include "adit/tools/simulator/heading_model.hpp"
#include "adit/tools/simulator/imu_model.hpp"
#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

/// A fix in the world frame by the ellipsoid's radii at the origin: another way than the
/// simulator's, good to a millimetre within a hundred metres.
Vector3d world_of(const GnssFix& fix) {
  const double degree = std::acos(-1.0) / 180.0;
  const double a = 6378137.0;
  const double e2 = 6.69437999014e-3;
  const double sine = std::sin(kOriginLatitude * degree);
  const double w = std::sqrt(1.0 - e2 * sine * sine);
  const double meridian = a * (1.0 - e2) / (w * w * w) + kOriginAltitude;
  const double normal = a / w + kOriginAltitude;
  return {(fix.longitude - kOriginLongitude) * degree * normal * std::cos(kOriginLatitude * degree),
          (fix.latitude - kOriginLatitude) * degree * meridian, fix.altitude - kOriginAltitude};
}

struct Statistics {
  Vector3d rms = Vector3d::Zero();
  double correlation = 0.0;  ///< correlation of errors 60 s apart
};

Statistics statistics_of(const char* model, int count) {
  const SplineTrajectory rest = test::at_rest();
  const RayScene nothing(Mesh{});
  GnssSimulator receiver(gnss_named(model), 1, rest, antenna_mount(), nothing, 3);
  std::vector<Vector3d> errors;
  Statistics statistics;
  for (int i = 0; i < count; ++i) {
    const SimulatedFix fix = receiver.next();
    errors.push_back(world_of(fix.fix) - fix.p_world_antenna);
    statistics.rms += errors.back().cwiseAbs2() / count;
  }
  for (std::size_t i = 60; i < errors.size(); ++i) {
    statistics.correlation += errors[i].x() * errors[i - 60].x() / count / statistics.rms.x();
  }
  statistics.rms = statistics.rms.cwiseSqrt();
  return statistics;
}

TEST(Gnss, ErrorsHaveTheStatedSizeAndCorrelation) {
  // Errors are correlated over a minute: 100 000 s hold some 800 independent ones.
  const Statistics rtk = statistics_of("rtk", 100000);
  EXPECT_NEAR(rtk.rms.x(), 0.012, 0.0012);
  EXPECT_NEAR(rtk.rms.y(), 0.012, 0.0012);
  EXPECT_NEAR(rtk.rms.z(), 0.024, 0.0024);
  EXPECT_NEAR(rtk.correlation, 0.9 * std::exp(-1.0), 0.1);
  const Statistics single = statistics_of("single", 100000);
  EXPECT_NEAR(single.rms.x(), 1.5, 0.15);
  EXPECT_NEAR(single.rms.z(), 3.0, 0.3);
}

TEST(Gnss, StatedCovarianceIsHonestUnlessItIsNot) {
  const SplineTrajectory rest = test::at_rest();
  const RayScene nothing(Mesh{});
  for (const auto& [name, stated] : {std::pair{"rtk", 0.012}, {"overconfident", 0.0012}}) {
    GnssSimulator receiver(gnss_named(name), 5, rest, antenna_mount(), nothing, 1);
    const SimulatedFix fix = receiver.next();
    ASSERT_TRUE(fix.fix.covariance);
    EXPECT_NEAR(std::sqrt((*fix.fix.covariance)(0, 0)), stated, 1e-9);
    EXPECT_NEAR(std::sqrt((*fix.fix.covariance)(2, 2)), 2.0 * stated, 1e-9);
  }
}

TEST(Gnss, TheSkyDecidesOnTheFix) {
  const SplineTrajectory rest = test::at_rest();
  const auto kind_under = [&](double half_roof) {
    Mesh mesh;
    if (half_roof > 0.0) {
      add_block(mesh, {-half_roof, -half_roof, 4.0}, {half_roof, half_roof, 4.2},
                Material::concrete);
    }
    const RayScene scene(mesh);
    GnssSimulator receiver(gnss_named("rtk"), 1, rest, antenna_mount(), scene, 1);
    return receiver.next().fix.kind;
  };
  EXPECT_EQ(kind_under(0.0), GnssFixKind::ground_augmented);
  EXPECT_EQ(kind_under(3.5), GnssFixKind::satellite_augmented);
  EXPECT_EQ(kind_under(6.5), GnssFixKind::single);
  EXPECT_EQ(kind_under(100.0), GnssFixKind::none);
}

TEST(Gnss, OutliersComeWhereTheSkyIsHidden) {
  const SplineTrajectory rest = test::at_rest();
  Mesh mesh;
  add_block(mesh, {-6.5, -6.5, 4.0}, {6.5, 6.5, 4.2}, Material::concrete);
  const RayScene scene(mesh);
  GnssSimulator receiver(gnss_named("rtk"), 1, rest, antenna_mount(), scene, 1);
  int outliers = 0;
  constexpr int kCount = 5000;
  for (int i = 0; i < kCount; ++i) {
    const SimulatedFix fix = receiver.next();
    const Vector3d error = world_of(fix.fix) - fix.p_world_antenna;
    outliers += fix.outlier ? 1 : 0;
    if (!fix.outlier) {
      EXPECT_LT(error.head<2>().norm(), 6.0 * 1.5);
    }
  }
  const double expected = 2.0 * 0.05 * (1.0 - receiver.next().sky);
  EXPECT_NEAR(static_cast<double>(outliers) / kCount, expected, 0.02);
}

TEST(SimulatedHeadings, ErrByWhatIsAskedForAgainstTrueNorth) {
  const SplineTrajectory rest = test::at_rest();
  const auto yaws = [&](const HeadingErrors& errors, int count) {
    HeadingSimulator source(errors, 1, rest, antenna_mount(), 3);
    std::vector<double> all;
    for (int i = 0; i < count; ++i) {
      all.push_back(source.next().yaw);
    }
    return all;
  };
  const Vector3d axis = rest.pose(0.0).linear().col(0);
  const double exact = yaws({.sigma = 0.0}, 1).front();
  EXPECT_NEAR(exact, std::atan2(axis.y(), axis.x()), 1e-6) << "at the origin north is y";
  EXPECT_NEAR(yaws({.sigma = 0.0, .offset = 5.0}, 1).front() - exact, std::acos(-1.0) / 36.0, 1e-9);
  double squares = 0.0;
  const std::vector<double> noisy = yaws({.sigma = 2.0}, 50000);
  for (const double yaw : noisy) {
    squares += (yaw - exact) * (yaw - exact) / 50000.0;
  }
  EXPECT_NEAR(std::sqrt(squares) * 180.0 / std::acos(-1.0), 2.0, 0.25) << "800 independent ones";
  EXPECT_THROW(require_heading_errors({.sigma = -1.0}), UsageError);
  EXPECT_THROW(require_heading_errors({.offset = 181.0}), UsageError);
}

TEST(SimulatedHeadings, FaultsChangeThem) {
  const auto yaw_with = [](Fault fault, int64_t ns) {
    Heading heading{.stamp = Nanoseconds(ns), .yaw = 1.0};
    FaultMaker({fault}, 10.0, 5).distort(heading, 0.25);
    return heading.yaw;
  };
  const double right_angle = std::acos(0.0);
  EXPECT_NEAR(yaw_with(Fault::heading_off_90, 7), 1.0 + right_angle, 1e-12);
  EXPECT_NEAR(yaw_with(Fault::heading_off_180, 7), 1.0 + 2.0 * right_angle, 1e-12);
  EXPECT_EQ(yaw_with(Fault::heading_stuck, 7), 0.25);
  EXPECT_NE(yaw_with(Fault::heading_noisy, 7), yaw_with(Fault::heading_noisy, 8));
  int outliers = 0;
  for (int64_t i = 0; i < 2000; ++i) {
    outliers += yaw_with(Fault::heading_outliers, 200000000 * i) != 1.0 ? 1 : 0;
  }
  EXPECT_NEAR(outliers, 200, 60);
  EXPECT_THROW(require_seen({"heading-stuck"}, 10.0, {}), UsageError);
  EXPECT_NO_THROW(require_seen({"heading-stuck"}, 10.0, {.heading = true}));
}

class FaultTest : public testing::Test {
 protected:
  struct Read {
    std::vector<Sweep> sweeps;
    std::vector<ImuSample> imu;
    bool damaged = false;
  };

  Read read(const std::vector<std::string>& faults, double duration = 1.0) const {
    SimulationOptions options;
    options.scene = "room";
    options.trajectory = "moving-start";
    options.duration = duration;
    options.imu = "perfect";
    options.faults = faults;
    options.picture = false;
    options.output = folder_.path() / ("x" + (faults.empty() ? "" : faults[0]) + ".mcap");
    simulate(options, {});
    Read result;
    const auto recording = open_recording(options.output);
    const auto events = recording->events({});
    for (bool more = true; more;) {
      try {
        auto event = events->next();
        more = event.has_value();
        if (event) {
          if (auto* sweep = std::get_if<Sweep>(&event->value)) {
            result.sweeps.push_back(std::move(*sweep));
          } else if (auto* sample = std::get_if<ImuSample>(&event->value)) {
            result.imu.push_back(*sample);
          }
        }
      } catch (const InputError&) {
        result.damaged = true;
      }
    }
    return result;
  }

  test::TemporaryFolder folder_;
};

TEST_F(FaultTest, ClocksAreOff) {
  const Read good = read({});
  const Read offset = read({"clock-offset"});
  ASSERT_EQ(good.imu.size(), 200U);
  EXPECT_EQ(offset.imu[0].stamp - good.imu[0].stamp, std::chrono::milliseconds(50));
  EXPECT_EQ(offset.imu[0].angular_velocity, good.imu[0].angular_velocity);
  const Read drift = read({"clock-drift"});
  EXPECT_EQ((drift.imu[199].stamp - good.imu[199].stamp).count(), 995000000 / 5000);
}

TEST_F(FaultTest, MessagesAreMissingTwiceThereOrOutOfOrder) {
  const Read gap = read({"gap"}, 4.0);
  std::size_t steps = 0;
  for (std::size_t i = 1; i < gap.imu.size(); ++i) {
    steps += gap.imu[i].stamp - gap.imu[i - 1].stamp > std::chrono::milliseconds(1990) ? 1U : 0U;
  }
  EXPECT_EQ(steps, 1U);
  EXPECT_EQ(gap.sweeps.size(), 20U);
  const Read twice = read({"duplicates"}, 4.0);
  EXPECT_GT(twice.imu.size(), 803U);
  EXPECT_LT(twice.imu.size(), 835U);
  const Read late = read({"reordering"}, 4.0);
  EXPECT_GE(late.imu.size() + 1, 800U);
  std::size_t backwards = 0;
  for (std::size_t i = 1; i < late.imu.size(); ++i) {
    backwards += late.imu[i].stamp < late.imu[i - 1].stamp ? 1U : 0U;
  }
  EXPECT_GT(backwards, 4U);
  EXPECT_LT(backwards, 40U);
}

TEST_F(FaultTest, SomeReadingsAreSpikesAndSomeTimesAreSilent) {
  const Read good = read({}, 8.0);
  const auto spiked = [&](const char* name) {
    const Read bad = read({name}, 8.0);
    EXPECT_EQ(bad.imu.size(), good.imu.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < bad.imu.size(); ++i) {
      const bool turns = bad.imu[i].angular_velocity != good.imu[i].angular_velocity;
      const bool pushes = bad.imu[i].linear_acceleration != good.imu[i].linear_acceleration;
      EXPECT_FALSE(turns && pushes);
      count += turns || pushes ? 1U : 0U;
    }
    return static_cast<double>(count) / static_cast<double>(bad.imu.size());
  };
  EXPECT_NEAR(spiked("many-spikes"), 0.05, 0.02);
  EXPECT_NEAR(spiked("spikes"), 0.01, 0.006);
  EXPECT_LT(spiked("rare-spikes"), 0.004);
  const Read gaps = read({"gaps"}, 8.0);
  std::size_t silences = 0;
  for (std::size_t i = 1; i < gaps.imu.size(); ++i) {
    const auto silence = gaps.imu[i].stamp - gaps.imu[i - 1].stamp;
    silences += silence > std::chrono::milliseconds(50) ? 1U : 0U;
    EXPECT_LT(silence, std::chrono::milliseconds(310));
  }
  EXPECT_GE(silences, 7U);
  EXPECT_LE(silences, 8U);
  EXPECT_EQ(gaps.sweeps.size(), good.sweeps.size());
}

TEST_F(FaultTest, ReadingsAreInOtherUnitsAndAxes) {
  const Read good = read({});
  const Read units = read({"wrong-units"});
  EXPECT_NEAR(units.imu[50].linear_acceleration.norm() * kStandardGravity,
              good.imu[50].linear_acceleration.norm(), 1e-9);
  const Read axes = read({"swapped-axes"});
  EXPECT_EQ(axes.imu[50].linear_acceleration.x(), good.imu[50].linear_acceleration.y());
  EXPECT_EQ(axes.imu[50].angular_velocity.y(), -good.imu[50].angular_velocity.x());
}

/// The mount is hit every 4 s and comes to rest where it was.
TEST(Faults, ShockRingsAndLeavesNoVelocity) {
  const FaultMaker faults({fault_named("shock")}, 12.0, 1);
  constexpr double kStep = 1e-4;  // s
  Vector3d velocity = Vector3d::Zero();
  Vector3d turned = Vector3d::Zero();
  double hardest = 0.0;
  double fastest = 0.0;
  for (int i = 0; i < 120'000; ++i) {
    ImuSample sample;
    sample.stamp = std::chrono::microseconds(100 * i);
    faults.distort(sample);
    const double time = kStep * i;
    if (time < 3.0 || (time > 3.5 && time < 7.0)) {
      EXPECT_LT(sample.linear_acceleration.norm(), 1e-6) << time;
    }
    velocity += kStep * sample.linear_acceleration;
    turned += kStep * sample.angular_velocity;
    hardest = std::max(hardest, sample.linear_acceleration.norm());
    fastest = std::max(fastest, sample.angular_velocity.norm());
  }
  EXPECT_GT(hardest, 80.0);
  EXPECT_LT(hardest, 120.0);
  EXPECT_GT(fastest, 0.5);
  EXPECT_LT(fastest, 1.5);
  EXPECT_LT(velocity.norm(), 1e-4);
  EXPECT_LT(turned.norm(), 1e-5);
}

TEST(Faults, RainScattersPulsesBackAndHidesWhatIsFar) {
  const FaultMaker faults({fault_named("rain")}, 1.0, 1);
  RangeSweep sweep{.start = 0, .firings = {}, .returns = {}};
  sweep.firings.resize(40'000);
  sweep.returns.assign(40'000, {.range = 30.0, .intensity = 50.0F});
  faults.distort(sweep);
  const auto share = [&](auto&& which) {
    return static_cast<double>(std::ranges::count_if(sweep.returns, which)) / 40'000.0;
  };
  const double drops = share([](const Return& r) { return r.range > 0.0 && r.range < 30.0; });
  EXPECT_NEAR(drops, 1.0 - std::exp(-0.003 * 20.0), 0.005);
  EXPECT_NEAR(share([](const Return& r) { return r.range == 0.0; }),
              (1.0 - drops) * (1.0 - std::exp(-0.004 * 30.0)), 0.006);
  for (const Return& back : sweep.returns) {
    EXPECT_TRUE(back.range == 30.0 || back.intensity < 3.0F) << "drops are faint";
  }
}

TEST_F(FaultTest, ReturnsAreLostOrNotANumber) {
  const Read good = read({});
  const Read nan = read({"nan"});
  std::size_t count = 0;
  for (const Point& point : nan.sweeps[3].points) {
    count += std::isnan(point.x) ? 1U : 0U;
  }
  EXPECT_EQ(nan.sweeps[3].points.size(), good.sweeps[3].points.size());
  EXPECT_NEAR(static_cast<double>(count) / static_cast<double>(good.sweeps[3].points.size()), 0.05,
              0.006);
  const auto behind = [](const Read& recording) {
    return std::ranges::count_if(recording.sweeps[3].points, [](const Point& p) {
      const double azimuth = std::atan2(p.y, p.x);
      return azimuth > 2.0945 && azimuth < 3.1415;
    });
  };
  EXPECT_GT(behind(good), 3000);
  EXPECT_EQ(behind(read({"blocked-sector"})), 0);
}

TEST_F(FaultTest, TheOwnCarrierIsInViewWhereItIsMounted) {
  const auto at_post = [](const Read& recording) {
    return std::ranges::count_if(recording.sweeps.front().points, [](const Point& point) {
      return std::abs(std::hypot(point.x + 0.5, point.y - 0.7) - 0.04) < 0.1;
    });
  };
  EXPECT_EQ(at_post(read({})), 0);
  EXPECT_GT(at_post(read({"own-carrier"})), 16 * 20);
}

TEST_F(FaultTest, ATruncatedFileIsReadUpToItsEnd) {
  const Read cut = read({"truncated"});
  EXPECT_GE(cut.sweeps.size(), 7U);
  EXPECT_LE(cut.sweeps.size(), 8U);
  EXPECT_THROW(fault_named("snow"), UsageError);
}

TEST_F(FaultTest, MovingObjectsAreLabelledPointByPoint) {
  SimulationOptions options;
  options.scene = "city";
  options.duration = 0.3;
  options.gnss = "rtk";
  options.picture = false;
  options.output = folder_.path() / "city.mcap";
  const SimulationSummary summary = simulate(options, {});
  const SimulationFiles files(options.output);
  EXPECT_EQ(std::filesystem::file_size(files.labels), 2 * summary.points);
  EXPECT_EQ(summary.gnss_fixes, 2U);
  EXPECT_TRUE(std::filesystem::exists(files.antenna));
}

}  // namespace
}  // namespace adit
