// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit run` on a drive of which one reading of the IMU is damaged: the trajectory is as good as
// without, and the summary counts it.
#include <cmath>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/moving_rig.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_inspect.hpp"
#include "adit/tools/commands/command_run.hpp"

namespace adit {
namespace {

using test::MovingRig;
using test::Recorded;

class DamagedReadingsOfADrive : public test::DeviceTest {
 protected:
  struct Mapped {
    double error = 0.0;  ///< m, root mean square
    nlohmann::json dropped;
    std::string told;
  };

  Mapped map(const std::vector<Recorded>& events) {
    const test::TemporaryFolder folder;
    std::ostringstream told;
    RunCommandOptions options;
    options.recording = test::write_mcap(folder / "drive.mcap", events);
    options.output = folder / "out";
    options.overwrite = true;
    options.device.opened = &context();
    EXPECT_EQ(run_command(options, told, told), 0) << told.str();
    Mapped mapped{.dropped = test::json_of(options.output / "summary.json")["imu"]["irregular"],
                  .told = told.str()};
    const Trajectory trajectory = read_trajectory(options.output / "trajectory.tum");
    const Eigen::Isometry3d to_first = trajectory.poses.front().pose * rig_.pose(0.0).inverse();
    for (const StampedPose& pose : trajectory.poses) {
      const double t = std::chrono::duration<double>(pose.stamp - MovingRig::kBegin).count();
      const Eigen::Vector3d truth = to_first * rig_.pose(t).translation();
      mapped.error += (pose.pose.translation() - truth).squaredNorm();
    }
    mapped.error = std::sqrt(mapped.error / static_cast<double>(trajectory.poses.size()));
    return mapped;
  }

  MovingRig rig_{.tenths = 40};
};

TEST_F(DamagedReadingsOfADrive, LeaveTheTrajectoryAsItIsAndAreCounted) {
  const std::vector<Recorded> events = rig_.record();
  const double clean = map(events).error;
  const auto damaged = [&](std::size_t reading, const std::function<void(ImuSample&)>& change) {
    std::vector<Recorded> copy = events;
    for (Recorded& event : copy) {
      if (auto* sample = std::get_if<ImuSample>(&event.value); sample && reading-- == 0) {
        change(*sample);
      }
    }
    return map(copy);
  };
  const auto turn = [](double value) {
    return [=](ImuSample& sample) { sample.angular_velocity.y() = value; };
  };
  const auto push = [](double value) {
    return [=](ImuSample& sample) { sample.linear_acceleration.x() = value; };
  };
  for (const auto& change : {turn(1e200), turn(-7e3)}) {
    const Mapped mapped = damaged(450, change);
    EXPECT_LE(mapped.error, 1.3 * clean) << mapped.told;
    EXPECT_EQ(mapped.dropped["impossible"], 1) << mapped.told;
    EXPECT_NE(mapped.told.find("1 impossible reading dropped"), std::string::npos) << mapped.told;
  }
  for (const auto& change : {push(1e10), push(600.0), push(-200.0)}) {
    const Mapped mapped = damaged(450, change);
    EXPECT_LE(mapped.error, 1.3 * clean) << mapped.told;
    EXPECT_EQ(mapped.dropped["impossible"].get<int>() + mapped.dropped["spike"].get<int>(), 1);
  }
  const Mapped spiked = damaged(613, turn(20.0));
  EXPECT_LE(spiked.error, 1.3 * clean) << spiked.told;
  EXPECT_EQ(spiked.dropped["spike"], 1);
  EXPECT_NE(spiked.told.find("1 spike dropped of 800"), std::string::npos) << spiked.told;
}

TEST_F(DamagedReadingsOfADrive, AreFoundByInspect) {
  std::vector<Recorded> events = rig_.record();
  std::size_t readings = 0;
  for (Recorded& event : events) {
    if (auto* sample = std::get_if<ImuSample>(&event.value); sample && ++readings % 100 == 50) {
      sample->angular_velocity.z() += readings % 200 == 50 ? 9.0 : -15.0;
    }
  }
  const test::TemporaryFolder folder;
  std::ostringstream told;
  InspectCommandOptions options;
  options.recording = test::write_mcap(folder / "drive.mcap", events);
  options.device.opened = &context();
  EXPECT_EQ(inspect_command(options, told, told), 0)
      << "one in a hundred is left out, no harm done";
  EXPECT_NE(told.str().find("8 of 800 samples are spikes"), std::string::npos) << told.str();
  EXPECT_NE(told.str().find("handled automatically: they are left out"), std::string::npos);
  EXPECT_EQ(told.str().find("sensor_offset"), std::string::npos) << told.str();
}

}  // namespace
}  // namespace adit
