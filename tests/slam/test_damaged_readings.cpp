// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Readings that are damaged and readings that are missing leave the tracker where it would be, and
// fused; what has lasting causes is still reported (test_inertial_faults.cpp).
#include <algorithm>
#include <random>
#include <vector>

#include "adit/tests/slam/tracker_runs.hpp"

namespace adit {
namespace {

using test::Outcome;
using test::run_tracker;
using test::tracker_config;

/// Root mean square of the errors of all sweeps, m.
double rms(const Outcome& outcome) {
  double squares = 0.0;
  for (const double error : outcome.errors) {
    squares += error * error;
  }
  return std::sqrt(squares / static_cast<double>(outcome.errors.size()));
}

const Outcome& healthy() {
  static const Outcome outcome = run_tracker([](auto&) {}, 20.0);
  return outcome;
}

int count(const Outcome& outcome, InertialState state) {
  return static_cast<int>(std::ranges::count(outcome.reports, state, &InertialReport::state));
}

test::Fault at(std::size_t index, const std::function<void(ImuSample&)>& change) {
  return [=](std::vector<ImuSample>& samples) { change(samples.at(index)); };
}

TEST(DamagedReadings, OneOfThemLeavesNoTrace) {
  const std::vector<test::Fault> faults = {
      at(1003, [](ImuSample& sample) { sample.angular_velocity.x() = 1e200; }),
      at(1003, [](ImuSample& sample) { sample.linear_acceleration.y() = 1e10; }),
      at(1003, [](ImuSample& sample) { sample.linear_acceleration.z() = 600.0; }),
      at(1003, [](ImuSample& sample) { sample.angular_velocity.z() = -20.0; }),
      at(1003, [](ImuSample& sample) { sample.angular_velocity.setConstant(NAN); })};
  for (const test::Fault& fault : faults) {
    const Outcome outcome = run_tracker(fault, 20.0);
    EXPECT_EQ(count(outcome, InertialState::fused), count(healthy(), InertialState::fused))
        << outcome.events();
    EXPECT_LE(rms(outcome), 1.05 * rms(healthy())) << outcome.events();
  }
}

/// One number of a share of the readings, of any size up to twice the full scale.
test::Fault spiked(double share, uint64_t seed) {
  return [=](std::vector<ImuSample>& samples) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform;
    for (ImuSample& sample : samples) {
      if (uniform(random) < share) {
        const auto axis = static_cast<Eigen::Index>(6.0 * uniform(random));
        const double size = 4.0 * (uniform(random) - 0.5);
        if (axis < 3) {
          sample.angular_velocity(axis) += 35.0 * size;
        } else {
          sample.linear_acceleration(axis - 3) += 157.0 * size;
        }
      }
    }
  };
}

TEST(DamagedReadings, SpikesOfAnySizeLeaveThePosesWhereTheyAre) {
  for (const double share : {0.001, 0.01, 0.05}) {
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      const Outcome outcome = run_tracker(spiked(share, seed), 20.0);
      EXPECT_LE(rms(outcome), 1.3 * rms(healthy())) << "share " << share << " seed " << seed << "\n"
                                                    << outcome.events();
      EXPECT_EQ(count(outcome, InertialState::refused), 0) << outcome.events();
    }
  }
}

}  // namespace
}  // namespace adit
