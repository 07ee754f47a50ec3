// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Damaged readings stay out, whatever else moves; what a sensor really felt passes.
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/inertial/reading_gate.hpp"
#include "adit/tests/support/simulated_imu.hpp"

namespace adit {
namespace {

constexpr double kGateRate = 200.0;  // Hz
using Samples = std::vector<ImuSample>;

/// Readings of a sensor that is waved about, `pace` times as fast as by hand, with noise.
Samples waved(uint64_t seed, double pace = 1.0, double rest = -1.0) {
  test::WavyMotion motion = test::hand_held_motion();
  for (auto* waves : {&motion.position, &motion.angles}) {
    for (test::Wave& wave : *waves) {
      wave.frequency *= pace;
    }
  }
  if (rest >= 0.0) {
    motion.rest = rest;
  }
  Samples samples = test::readings(motion, 0.0, 20.0, kGateRate);
  std::mt19937_64 random(seed);
  test::add_noise(samples, {.gyro = 5e-4, .accel = 5e-3}, kGateRate, random);
  return samples;
}

struct Passed {
  Samples samples;
  Samples spikes;
  Samples impossible;
  std::size_t late = 0;  ///< that were waited with, after the first
};

constexpr std::size_t kFirstWait = 20;

Passed pass(const Samples& samples, const ReadingLimits& limits = {}) {
  ReadingGate gate(limits);
  Passed passed;
  std::size_t count = 0;
  for (const ImuSample& sample : samples) {
    const std::vector<GatedReading> known = gate.pass(sample);
    passed.late += ++count >= kFirstWait && known.empty() ? 1U : 0U;
    for (const GatedReading& one : known) {
      Samples& to = !one.dropped                             ? passed.samples
                    : *one.dropped == ImuArrival::impossible ? passed.impossible
                                                             : passed.spikes;
      to.push_back(one.sample);
    }
  }
  return passed;
}

bool same(const Samples& a, const Samples& b) {
  return std::ranges::equal(a, b, [](const ImuSample& one, const ImuSample& other) {
    return one.stamp == other.stamp && one.angular_velocity == other.angular_velocity &&
           one.linear_acceleration == other.linear_acceleration;
  });
}

TEST(ReadingGate, HealthyReadingsPassAtOnceHoweverTheyAreWaved) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    for (const double pace : {0.2, 1.0, 2.0, 4.0}) {
      const Samples samples = waved(seed, pace);
      const Passed passed = pass(samples);
      EXPECT_TRUE(same(passed.samples, samples)) << "seed " << seed << " pace " << pace;
      EXPECT_EQ(passed.late, 0U) << "seed " << seed << " pace " << pace;
    }
  }
}

TEST(ReadingGate, WhateverTheUnit) {
  Samples samples = waved(1);
  for (ImuSample& sample : samples) {
    sample.angular_velocity *= 180.0 / M_PI;
    sample.linear_acceleration /= kStandardGravity;
  }
  EXPECT_TRUE(same(pass(samples).samples, samples));
}

TEST(ReadingGate, StepsAndShocksPassInTheirOrder) {
  // Set off all at once; hit a kerb (half a sine of 25 ms, 60 m/s²).
  Samples samples = waved(3, 1.0, 5.0);
  for (std::size_t i = 0; i < 5; ++i) {
    const double phase = M_PI * (static_cast<double>(i) + 0.5) / 5.0;
    samples[400 + i].linear_acceleration.z() += 60.0 * std::sin(phase);
  }
  for (std::size_t i = 2000; i < samples.size(); ++i) {
    samples[i].angular_velocity.y() += 6.0;
  }
  EXPECT_TRUE(same(pass(samples).samples, samples));
}

// At five readings a period a ringing mount looks much like spikes: few of its readings are lost.
TEST(ReadingGate, OfAJoltThatRingsAtMostOneInTenIsLost) {
  Samples samples = waved(3, 1.0, 5.0);
  for (std::size_t i = 0; i < 40; ++i) {
    const double t = static_cast<double>(i) / kGateRate;
    samples[700 + i].linear_acceleration.x() +=
        50.0 * std::exp(-t / 0.03) * std::cos(2.0 * M_PI * 40.0 * t);
  }
  EXPECT_LE(pass(samples).spikes.size(), 4U);
}

// What a mount that is hit and swings at 40 Hz (`adit simulate --fault shock`) reads, x, y, z.
TEST(ReadingGate, OfABlowOnTheMountAtMostOneReadingIsLost) {
  const std::vector<Eigen::Vector3d> blow = {
      {-50.1, 37.6, -63.8}, {22.3, -17.3, 29.5},  {56.2, -42.9, 73.1}, {-8.7, 6.3, -10.6},
      {-48.3, 36.3, -61.6}, {-12.2, 8.8, -14.9},  {26.4, -20.3, 34.7}, {17.5, -13.6, 23.3},
      {-8.6, 6.2, -10.5},   {-13.8, 10.0, -17.0}, {-1.6, 0.8, -1.2},   {6.0, -4.9, 8.5},
      {2.8, -2.4, 4.2},     {-2.3, 1.3, -2.2},    {-2.8, 1.7, -2.8}};
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    for (const double size : {0.6, 1.0, 1.5}) {
      Samples samples = waved(seed, 1.0, 10.0);
      for (std::size_t i = 0; i < blow.size(); ++i) {
        samples[700 + 40 * seed + i].linear_acceleration += size * blow[i];
      }
      EXPECT_LE(pass(samples).spikes.size(), 1U) << "seed " << seed << " size " << size;
    }
  }
}

TEST(ReadingGate, NumbersBeyondAnySensorAreImpossible) {
  Samples samples = waved(1);
  samples[0].angular_velocity.x() = 1e200;
  samples[500].linear_acceleration.y() = -1e10;
  samples[501].angular_velocity.z() = 36.0;
  const Passed passed = pass(samples, {.rate = 35.0, .acceleration = 160.0});
  EXPECT_EQ(passed.impossible.size(), 3U);
  EXPECT_EQ(passed.samples.size(), samples.size() - 3);
  samples[7].linear_acceleration.x() = std::numeric_limits<double>::quiet_NaN();
  ReadingGate gate({});
  EXPECT_EQ(gate.pass(samples[7]).at(0).dropped, ImuArrival::not_finite);
}

/// One of the six numbers of this share of the readings is anything from `least` to `most` times
/// its sensor's full scale, of either sign.
Samples spiked(Samples samples, double share, double least, double most, uint64_t seed,
               Samples* spikes) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  for (ImuSample& sample : samples) {
    if (uniform(random) >= share) {
      continue;
    }
    const auto axis = static_cast<Eigen::Index>(6.0 * uniform(random));
    const double size =
        (least + (most - least) * uniform(random)) * (uniform(random) < 0.5 ? -1.0 : 1.0);
    if (axis < 3) {
      sample.angular_velocity(axis) = 35.0 * size;
    } else {
      sample.linear_acceleration(axis - 3) = 157.0 * size;
    }
    spikes->push_back(sample);
  }
  return samples;
}

TEST(ReadingGate, SpikesAreDroppedAndNothingElseIs) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    for (const double share : {0.001, 0.01, 0.05}) {
      Samples spikes;
      const Samples samples = spiked(waved(seed), share, 0.2, 2.0, seed, &spikes);
      const Passed passed = pass(samples);
      EXPECT_GE(passed.spikes.size(), spikes.size() - spikes.size() / 60)
          << "seed " << seed << " share " << share;
      EXPECT_LE(passed.spikes.size(), spikes.size()) << "seed " << seed << " share " << share;
      EXPECT_EQ(passed.samples.size() + passed.spikes.size(), samples.size());
    }
  }
}

// What is usual is not learned from them: one that passed would let others pass for seconds.
TEST(ReadingGate, ASpikeAmongTheFirstReadingsIsDroppedToo) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    for (const double rest : {0.0, 5.0}) {
      for (std::size_t at = 0; at < kFirstWait + 2; ++at) {
        Samples samples = waved(seed, 1.0, rest);
        samples[at].angular_velocity.y() = seed % 2 == 0 ? 20.0 : -4.0;
        samples[kFirstWait + 5].angular_velocity.z() = 2.0;
        const Passed passed = pass(samples);
        EXPECT_EQ(passed.spikes.size(), 2U) << "seed " << seed << " rest " << rest << " at " << at;
        EXPECT_EQ(passed.samples.size(), samples.size() - 2);
      }
    }
  }
}

TEST(ReadingGate, SpikesInARowAreNoEvidenceForEachOther) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    for (std::size_t length = 1; length <= 3; ++length) {
      for (int axis = 0; axis < 6; ++axis) {
        Samples samples = waved(seed);
        for (std::size_t i = 0; i < length; ++i) {
          const double size = seed % 2 == 0 ? 1.0 : -1.0 + 0.1 * static_cast<double>(i);
          ImuSample& sample = samples[900 + 7 * seed + i];
          if (axis < 3) {
            sample.angular_velocity(axis) = 20.0 * size;
          } else {
            sample.linear_acceleration(axis - 3) = 90.0 * size;
          }
        }
        const Passed passed = pass(samples);
        EXPECT_EQ(passed.spikes.size(), length) << "seed " << seed << " axis " << axis;
        EXPECT_LE(passed.late, length) << "seed " << seed << " axis " << axis;
      }
    }
  }
}

TEST(ReadingGate, SpikesInARowRightAfterAnotherAreDroppedToo) {
  for (std::size_t between = 1; between <= 3; ++between) {
    Samples samples = waved(3);
    samples[800].angular_velocity.y() = -6.3;
    samples[801 + between].linear_acceleration.x() = -51.0;
    samples[802 + between].linear_acceleration.x() = -136.0;
    EXPECT_EQ(pass(samples).spikes.size(), 3U) << between << " good readings between them";
  }
}

// As the simulator's 5 % of spikes once came.
TEST(ReadingGate, FourSpikesInARowOnTwoAxesAreDropped) {
  const Samples samples = waved(4);
  for (std::size_t at = 500; at < 3500; at += 100) {
    Samples damaged = samples;
    damaged[at].linear_acceleration.x() -= 199.5;
    damaged[at + 1].linear_acceleration.y() -= 186.5;
    damaged[at + 2].linear_acceleration.y() += 141.1;
    damaged[at + 3].linear_acceleration.x() -= 62.8;
    EXPECT_EQ(pass(damaged).spikes.size(), 4U) << at;
  }
}

// A ringing mount has the same number off.
TEST(ReadingGate, FourSwingsOfOneNumberAreAMotion) {
  Samples samples = waved(4);
  for (std::size_t i = 0; i < 4; ++i) {
    samples[1000 + i].linear_acceleration.z() += (i % 2 == 0 ? 30.0 : -30.0);
  }
  EXPECT_TRUE(pass(samples).spikes.empty());
}

// Whatever lasts longer, moves several axes, or is not there at once, the sensor felt.
TEST(ReadingGate, ABlowIsNoBurst) {
  Samples samples = waved(4, 1.0, 5.0);
  for (std::size_t i = 0; i < 4; ++i) {
    samples[500 + i].linear_acceleration.z() += 60.0;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    samples[700 + i].linear_acceleration += Eigen::Vector3d(12.0, 5.0, 40.0);
    samples[900 + i].angular_velocity += Eigen::Vector3d(0.0, 3.0, 0.0);
    samples[900 + i].linear_acceleration.z() -= 20.0;
  }
  EXPECT_TRUE(same(pass(samples).samples, samples));
}

TEST(ReadingGate, ASpikeThatComesTwiceIsNoEvidenceForItself) {
  Samples samples = waved(1);
  samples[300].angular_velocity.x() = 20.0;
  samples.insert(samples.begin() + 301, samples[300]);
  const Passed passed = pass(samples);
  EXPECT_EQ(passed.samples.size(), samples.size() - 2);
}

TEST(ReadingGate, AfterAGapOrWithAnotherClockReadingsPassAsTheyAre) {
  Samples samples = waved(2, 4.0);
  samples.erase(samples.begin() + 1000, samples.begin() + 1040);
  EXPECT_TRUE(same(pass(samples).samples, samples));
  for (std::size_t i = 2000; i < samples.size(); ++i) {
    samples[i].stamp -= std::chrono::hours(1);
  }
  EXPECT_TRUE(same(pass(samples).samples, samples));
}

}  // namespace
}  // namespace adit
