// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Wheels: what they measure of a motion that is known, and what their faults do to it.
#include "adit/tools/simulator/wheel_model.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/simulator/faults.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

SplineTrajectory drive(double duration) {
  return make_trajectory(make_scene("mine", 1), motion_named("drive"), duration);
}

TEST(Wheels, MeasureTheMotionOfTheirFrame) {
  const SplineTrajectory trajectory = drive(60.0);
  const Eigen::Isometry3d mount = wheel_mount();
  WheelSimulator wheels(50, trajectory, mount, 1);
  double squared_difference = 0.0;
  Vector3d squared_error = Vector3d::Zero();
  Vector3d expected = Vector3d::Zero();
  double driven = 0.0;
  double measured = 0.0;
  constexpr int kCount = 2900;
  for (int i = 0; i < kCount; ++i) {
    const SimulatedWheels one = wheels.next();
    EXPECT_EQ(one.velocity.stamp.count(), 20'000'000LL * i + 10'000'000);
    EXPECT_EQ(one.received.count(), 20'000'000LL * (i + 1));
    // The pose of the frame, differentiated.
    const double time = 1e-9 * static_cast<double>(one.velocity.stamp.count());
    constexpr double kStep = 1e-3;
    const auto at = [&](double t) { return trajectory.pose(t) * mount; };
    const Vector3d true_velocity =
        at(time).linear().transpose() *
        (at(time + kStep).translation() - at(time - kStep).translation()) / (2.0 * kStep);
    squared_difference += (one.truth - true_velocity).squaredNorm();
    const Vector3d error = one.velocity.linear - one.truth;
    squared_error += error.cwiseAbs2();
    expected += one.velocity.covariance.value().diagonal();
    driven += 0.02 * one.truth.x();
    measured += 0.02 * one.velocity.linear.x();
    const double ticks = one.velocity.linear.x() * 0.02 / 0.0005;
    EXPECT_NEAR(ticks, std::floor(ticks + 0.5), 1e-6) << "a whole number of them in each period";
  }
  EXPECT_LT(std::sqrt(squared_difference / kCount), 1e-4);
  ASSERT_GT(driven, 50.0);
  EXPECT_NEAR(measured / driven, wheels.next().scale, 2e-3);
  EXPECT_NE(wheels.next().scale, 1.0);
  // What is stated is what is true, or a little more.
  for (const double ratio : (squared_error.cwiseQuotient(expected)).eval()) {
    EXPECT_GT(ratio, 0.1);
    EXPECT_LT(ratio, 1.5);
  }
}

TEST(Wheels, CountNothingAtRest) {
  const SplineTrajectory trajectory = drive(3.0);
  WheelSimulator wheels(50, trajectory, wheel_mount(), 1);
  for (int i = 0; i < 45; ++i) {
    EXPECT_EQ(wheels.next().velocity.linear, Vector3d::Zero());
  }
}

TEST(Wheels, HaveAScaleThatDependsOnTheSeedAndIsAboutAPerCent) {
  const SplineTrajectory trajectory = drive(1.0);
  double squared = 0.0;
  constexpr int kSeeds = 200;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const double off = WheelSimulator(50, trajectory, wheel_mount(), seed).next().scale - 1.0;
    squared += off * off;
  }
  EXPECT_NEAR(std::sqrt(squared / kSeeds), 0.01, 0.0015);
}

class WheelRecordings : public testing::Test {
 protected:
  SimulationOptions options(const std::vector<std::string>& faults, double duration) const {
    SimulationOptions options;
    options.scene = "room";
    options.trajectory = "moving-start";
    options.duration = duration;
    options.wheels = true;
    options.faults = faults;
    options.picture = false;
    options.output = folder_.path() / ("x" + (faults.empty() ? "" : faults[0]) + ".mcap");
    return options;
  }

  /// What is on /wheels.
  std::vector<BodyVelocity> read(const std::vector<std::string>& faults,
                                 double duration = 1.0) const {
    const SimulationOptions wanted = options(faults, duration);
    const SimulationSummary summary = simulate(wanted, {});
    std::vector<BodyVelocity> velocities;
    const auto recording = open_recording(wanted.output);
    const auto events = recording->events({});
    while (const auto event = events->next()) {
      if (const auto* velocity = std::get_if<BodyVelocity>(&event->value)) {
        EXPECT_EQ(recording->topics()[event->topic].name, "/wheels");
        EXPECT_EQ(velocity->frame, "wheels");
        velocities.push_back(*velocity);
      }
    }
    EXPECT_EQ(summary.wheel_velocities, velocities.size());
    return velocities;
  }

  test::TemporaryFolder folder_;
};

TEST_F(WheelRecordings, HaveTheirTopicTheirMountingAndTheirTruth) {
  const std::vector<BodyVelocity> good = read({});
  ASSERT_EQ(good.size(), 49U) << "what is counted by the end of the last sweep";
  EXPECT_EQ(good[0].stamp, kSimulationEpoch + std::chrono::milliseconds(10));
  EXPECT_GT(good[0].linear.x(), 0.3);
  ASSERT_TRUE(good[0].covariance);
  const auto recording = open_recording(folder_.path() / "x.mcap");
  std::set<std::string> mounted;
  const auto events = recording->events({});
  while (const auto event = events->next()) {
    if (const auto* mount = std::get_if<StaticTransform>(&event->value)) {
      mounted.insert(mount->child);
      if (mount->child == "wheels") {
        EXPECT_TRUE(mount->T_parent_child.isApprox(wheel_mount()));
      }
    }
  }
  EXPECT_EQ(mounted, (std::set<std::string>{"lidar", "wheels"}));
  std::ifstream truth(SimulationFiles(folder_.path() / "x.mcap").wheels);
  std::string line;
  std::getline(truth, line);
  EXPECT_EQ(line, "t_s,vx_m_s,vy_m_s,vz_m_s,scale");
  std::size_t lines = 0;
  while (std::getline(truth, line)) {
    ++lines;
  }
  EXPECT_EQ(lines, good.size());
}

TEST_F(WheelRecordings, ChangeNothingOfTheOthersMessages) {
  const auto rest_of = [&](bool wheels) {
    SimulationOptions wanted = options({}, 0.5);
    wanted.wheels = wheels;
    wanted.gnss = "rtk";
    simulate(wanted, {});
    std::vector<std::pair<std::string, Nanoseconds>> received;
    const auto recording = open_recording(wanted.output);
    const auto events = recording->events({});
    while (const auto event = events->next()) {
      if (!std::holds_alternative<BodyVelocity>(event->value) &&
          !std::holds_alternative<StaticTransform>(event->value)) {
        received.emplace_back(recording->topics()[event->topic].name, event->received);
      }
    }
    return received;
  };
  EXPECT_EQ(rest_of(true), rest_of(false));
}

TEST_F(WheelRecordings, FaultsDoWhatTheirNamesSay) {
  const std::vector<BodyVelocity> good = read({});
  const auto each = [&](const char* fault, const auto& check) {
    const std::vector<BodyVelocity> bad = read({fault});
    ASSERT_EQ(bad.size(), good.size()) << fault;
    for (std::size_t i = 0; i < bad.size(); ++i) {
      check(bad[i], good[i]);
    }
  };
  each("wheel-scale", [](const BodyVelocity& bad, const BodyVelocity& one) {
    EXPECT_NEAR(bad.linear.x(), 1.05 * one.linear.x(), 1e-12);
  });
  each("wheel-stuck", [](const BodyVelocity& bad, const BodyVelocity&) {
    EXPECT_EQ(bad.linear, Vector3d::Zero());
  });
  each("wheel-units", [](const BodyVelocity& bad, const BodyVelocity& one) {
    EXPECT_NEAR(bad.linear.x(), 3.6 * one.linear.x(), 1e-12);
  });
  each("wheel-reversed", [](const BodyVelocity& bad, const BodyVelocity& one) {
    EXPECT_EQ(bad.linear.x(), -one.linear.x());
  });
  each("wheel-axes", [](const BodyVelocity& bad, const BodyVelocity& one) {
    EXPECT_EQ(bad.linear.y(), one.linear.x());
    EXPECT_EQ(bad.linear.x(), 0.0);
  });
  each("wheel-late", [](const BodyVelocity& bad, const BodyVelocity& one) {
    EXPECT_EQ(bad.stamp - one.stamp, std::chrono::milliseconds(50));
    EXPECT_EQ(bad.linear, one.linear);
  });
  for (const char* fault : {"wheel-zero-covariance", "wheel-negative-covariance"}) {
    each(fault, [](const BodyVelocity& bad, const BodyVelocity& one) {
      EXPECT_FALSE(bad.covariance) << "which no reader takes for one";
      EXPECT_EQ(bad.linear, one.linear);
    });
  }
}

TEST_F(WheelRecordings, SlipComesInBurstsOfTwoSeconds) {
  const std::vector<BodyVelocity> good = read({}, 20.0);
  const std::vector<BodyVelocity> bad = read({"wheel-slip"}, 20.0);
  ASSERT_EQ(good.size(), bad.size());
  std::size_t slipped = 0;
  std::size_t bursts = 0;
  bool slips = false;
  for (std::size_t i = 0; i < good.size(); ++i) {
    const bool now = bad[i].linear != good[i].linear;
    if (now) {
      EXPECT_NEAR(bad[i].linear.x(), 1.1 * good[i].linear.x(), 1e-12);
    }
    slipped += now ? 1U : 0U;
    bursts += now && !slips ? 1U : 0U;
    slips = now;
  }
  EXPECT_EQ(bursts, 2U);
  EXPECT_NEAR(static_cast<double>(slipped), 200.0, 2.0);
}

TEST_F(WheelRecordings, TheSameSeedGivesTheSameBytes) {
  const auto bytes_of = [&](uint64_t seed) {
    SimulationOptions wanted = options({"wheel-slip"}, 0.5);
    wanted.seed = seed;
    simulate(wanted, {});
    std::ifstream file(wanted.output, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string first = bytes_of(3);
  EXPECT_EQ(first, bytes_of(3));
  EXPECT_NE(first, bytes_of(4));
}

TEST_F(WheelRecordings, AreRefusedWhereTheyMakeNoSense) {
  const auto error_of = [](const SimulationOptions& wanted) -> std::string {
    try {
      simulate(wanted, {});
    } catch (const UsageError& error) {
      return error.what();
    }
    return "none";
  };
  SimulationOptions walk = options({}, 1.0);
  walk.trajectory = "handheld";
  EXPECT_EQ(error_of(walk),
            "--wheels: handheld is on foot, and has no wheels. Choose drive, stop-and-go or "
            "moving-start.");
  SimulationOptions none = options({"wheel-slip"}, 1.0);
  none.wheels = false;
  EXPECT_EQ(
      error_of(none),
      "--fault: wheel-slip is one of the wheels, and there are none. --wheels, or use in [wheels] "
      "of a scene file, adds them.");
  SimulationOptions fast = options({}, 1.0);
  fast.wheel_rate = 3000;
  EXPECT_NE(error_of(fast).find("--wheels: is 3000 Hz"), std::string::npos);
}

}  // namespace
}  // namespace adit
