// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/verdict.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace adit {
namespace {

using std::chrono::milliseconds;

/// Sweeps at 10 Hz along x, a metre each unless it stands.
class Ride {
 public:
  SweepResult next(double step = 1.0) {
    SweepResult result;
    result.stamp = milliseconds(100) * count_;
    x_ += count_ == 0 ? 0.0 : step;
    result.T_map_lidar.translation().x() = x_;
    result.state = count_ == 0 ? OdometryState::initializing : OdometryState::tracking;
    result.registration.status = RegistrationStatus::converged;
    for (int k = 0; k < 3; ++k) {
      const ObservedDirection held{.axis = Eigen::Vector3d::Unit(k),
                                   .localizability = Localizability::full};
      result.registration.translation[static_cast<size_t>(k)] = held;
      result.registration.rotation[static_cast<size_t>(k)] = held;
    }
    ++count_;
    return result;
  }
  static SweepResult unheld(SweepResult result) {
    result.registration.translation[0].localizability = Localizability::none;
    return result;
  }
  static SweepResult fused(SweepResult result, double innovation = 1.0) {
    result.inertial.nav = NavState{};
    result.inertial.innovation.degrees = 6;
    result.inertial.innovation.nis = 6.0 * innovation;
    return result;
  }
  static SweepResult coasting(SweepResult result) {
    result.state = OdometryState::coasting;
    result.registration.status = RegistrationStatus::too_little_overlap;
    return result;
  }

 private:
  int count_ = 0;
  double x_ = 0.0;
};

TEST(Verdict, ARunWhereEverythingIsHeldIsReliable) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 100; ++i) {
    assessor.add(run.next());
  }
  EXPECT_EQ(assessor.verdict().trust, Trust::reliable);
  EXPECT_TRUE(assessor.verdict().stretches.empty());
}

// Rings of the ground that hold a direction a little hold it wrongly.
TEST(Verdict, AWeakDirectionThatIsVagueIsNotHeldWithoutAnImu) {
  const auto trust = [](double sigma, bool inertial) {
    Ride run;
    RunAssessor assessor;
    for (int i = 0; i < 30; ++i) {
      SweepResult result = inertial ? Ride::fused(run.next(0.1)) : run.next(0.1);
      result.registration.translation[0].localizability = Localizability::partial;
      result.uncertainty.local(0, 0) = sigma * sigma;
      assessor.add(result);
    }
    return assessor.verdict().trust;
  };
  EXPECT_EQ(trust(0.08, false), Trust::doubtful);
  EXPECT_EQ(trust(0.03, false), Trust::reliable);
  EXPECT_EQ(trust(0.08, true), Trust::reliable);
}

TEST(Verdict, ATunnelByLidarAloneIsDoubtfulWhereItIsAndLostWhereItIsLong) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 30; ++i) {
    assessor.add(run.next(0.5));
  }
  for (int i = 0; i < 10; ++i) {
    assessor.add(Ride::unheld(run.next(0.5)));
  }
  ASSERT_EQ(assessor.verdict().stretches.size(), 1U);
  const DoubtfulStretch brief = assessor.verdict().stretches[0];
  EXPECT_EQ(assessor.verdict().trust, Trust::doubtful);
  EXPECT_EQ(brief.cause, DoubtCause::unheld);
  EXPECT_GE(brief.first, 24U);
  EXPECT_EQ(brief.last, 39U);
  EXPECT_EQ(brief.end, milliseconds(3900));
  EXPECT_NEAR(std::abs(brief.direction.x()), 1.0, 1e-12);
  EXPECT_FALSE(brief.inertial());
  EXPECT_NEAR(brief.alone, brief.distance, 1e-12);
  for (int i = 0; i < 30; ++i) {
    assessor.add(Ride::unheld(run.next(0.5)));
  }
  const Verdict longer = assessor.verdict();
  ASSERT_EQ(longer.stretches.size(), 1U) << "one tunnel is one stretch";
  EXPECT_EQ(longer.trust, Trust::lost);
  EXPECT_NEAR(longer.stretches[0].distance, 20.0, 3.0);
}

TEST(Verdict, WhereVelocitiesLedBeforeTheStartItIsDoubtfulHoweverFar) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 60; ++i) {
    SweepResult result = Ride::unheld(run.next(0.5));
    result.displacement_measured = true;
    assessor.add(result);
  }
  const Verdict verdict = assessor.verdict();
  ASSERT_EQ(verdict.stretches.size(), 1U);
  EXPECT_EQ(verdict.trust, Trust::doubtful);
  EXPECT_TRUE(verdict.stretches[0].by_velocities());
  EXPECT_FALSE(verdict.stretches[0].inertial());
}

// A velocity counts where it is fused, along the direction that it measures, with a known scale.
TEST(Verdict, AMeasuredWayHoldsWhatNoMatchHolds) {
  const auto trust = [](const auto& change) {
    Ride run;
    RunAssessor assessor;
    for (int i = 0; i < 100; ++i) {
      SweepResult result = Ride::fused(i < 30 ? run.next(0.5) : Ride::unheld(run.next(0.5)));
      result.inertial.nav_covariance = 1e-6 * StateMatrix::Identity();
      result.uncertainty.drift(0, 0) = 0.01 * i;  // inertia alone does not carry it
      VelocityReport velocity{.innovation = {.predicted = {5.0, 0.0, 0.0}},
                              .covariance = 0.01 * Eigen::Matrix3d::Identity()};
      change(result, velocity);
      result.inertial.velocities.push_back(velocity);
      assessor.add(result);
    }
    return assessor.verdict().trust;
  };
  EXPECT_EQ(trust([](auto&, auto&) {}), Trust::reliable);
  EXPECT_NE(trust([](auto&, auto& velocity) { velocity.on_trial = true; }), Trust::reliable);
  EXPECT_NE(trust([](auto&, auto& velocity) { velocity.refused = true; }), Trust::reliable);
  EXPECT_NE(trust([](auto&, auto& velocity) { velocity.covariance(0, 0) = 4.0; }), Trust::reliable);
  EXPECT_EQ(trust([](auto&, auto& velocity) { velocity.covariance(1, 1) = 4.0; }), Trust::reliable);
  const auto with_scale = [&](VelocitySource source) {
    return trust([source](SweepResult& result, VelocityReport& velocity) {
      result.inertial.nav_covariance(kScaleAt, kScaleAt) = 0.05 * 0.05;
      velocity.source = source;
    });
  };
  EXPECT_NE(with_scale(VelocitySource::sensor), Trust::reliable);
  EXPECT_EQ(with_scale(VelocitySource::doppler), Trust::reliable);
}

TEST(Verdict, AtRestNothingNeedsToBeHeld) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 60; ++i) {
    assessor.add(Ride::unheld(run.next(0.01)));
  }
  EXPECT_EQ(assessor.verdict().trust, Trust::reliable);
}

// Set off within a smooth tunnel: what is estimated stays where it was, its covariance does not.
TEST(Verdict, WhoMayHaveMovedIsNotAtRest) {
  const auto trust = [](bool inertial) {
    Ride run;
    RunAssessor assessor;
    for (int i = 0; i < 60; ++i) {
      SweepResult sweep = Ride::unheld(run.next(0.01));
      sweep.uncertainty.drift(0, 0) = i < 30 ? 0.0 : 0.01 * (i - 30);
      assessor.add(inertial ? Ride::fused(sweep) : sweep);
    }
    return assessor.verdict().trust;
  };
  EXPECT_EQ(trust(false), Trust::doubtful);
  EXPECT_EQ(trust(true), Trust::reliable) << "an IMU tells rest";
}

// While the sensor is started nothing tells that it does not move. Then the readings do.
TEST(Verdict, WhoRestedWhileTheSensorWasStartedIsNotInDoubt) {
  const auto trust = [](bool rested) {
    Ride run;
    RunAssessor assessor;
    for (int i = 0; i < 200; ++i) {
      SweepResult sweep = i < 20 ? Ride::unheld(run.next(0.001)) : run.next();
      const bool starting = i <= 12;
      sweep.uncertainty.drift(0, 0) = starting ? 0.01 * i * i : 0.0;
      sweep.rested = rested && i == 13;
      assessor.add(starting ? sweep : Ride::fused(sweep));
      if (i == 12) {
        EXPECT_EQ(assessor.verdict().trust, Trust::doubtful) << "it may have moved";
      }
    }
    return assessor.verdict().trust;
  };
  EXPECT_EQ(trust(true), Trust::reliable);
  EXPECT_EQ(trust(false), Trust::doubtful);
}

TEST(Verdict, InertiaCarriesOverWhatIsBriefAndNotOverASecondOfIt) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 100; ++i) {
    const SweepResult sweep = Ride::fused(run.next());
    assessor.add(i % 10 < 8 ? Ride::unheld(sweep) : sweep);
  }
  EXPECT_EQ(assessor.verdict().trust, Trust::reliable);
  for (int i = 0; i < 12; ++i) {
    SweepResult sweep = Ride::fused(Ride::unheld(run.next()));
    sweep.uncertainty.drift(0, 0) = 0.01 * i * i;
    assessor.add(sweep);
  }
  const Verdict verdict = assessor.verdict();
  EXPECT_EQ(verdict.trust, Trust::doubtful);
  ASSERT_EQ(verdict.stretches.size(), 1U);
  EXPECT_TRUE(verdict.stretches[0].inertial());
  EXPECT_EQ(verdict.stretches[0].alone, 0.0);
  EXPECT_NEAR(verdict.stretches[0].sigma, 1.1, 0.1);
}

// A stretch without a way has none without an inertial sensor either.
TEST(Verdict, WhereTheSensorStandsNobodyCarriesItWithoutAnImu) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 20; ++i) {
    assessor.add(run.next(0.0));
  }
  for (int i = 0; i < 15; ++i) {
    assessor.add(Ride::coasting(run.next(0.0)));
  }
  const Verdict verdict = assessor.verdict();
  ASSERT_EQ(verdict.stretches.size(), 1U);
  EXPECT_EQ(verdict.stretches[0].cause, DoubtCause::predicted);
  EXPECT_FALSE(verdict.stretches[0].inertial());
}

// What inertia carried counts by how well it did, over the whole way.
TEST(Verdict, WhatInertiaCarriedWellIsNotInDoubt) {
  const auto trust = [](double sigma, int sweeps, int fused_from = 0) {
    Ride run;
    RunAssessor assessor;
    for (int i = 0; i < sweeps; ++i) {
      const bool tunnel = i >= 50 && i < 90;
      SweepResult sweep = tunnel ? Ride::unheld(run.next(0.5)) : run.next(0.5);
      sweep.uncertainty.drift(0, 0) = sigma * sigma * std::clamp(i - 50, 0, 40) / 40.0;
      assessor.add(i < fused_from ? sweep : Ride::fused(sweep));
    }
    return assessor.verdict().trust;
  };
  EXPECT_EQ(trust(0.1, 100), Trust::reliable);
  EXPECT_EQ(trust(0.3, 100), Trust::doubtful);
  EXPECT_EQ(trust(0.3, 250), Trust::reliable) << "it ends as a small share of the way";
  EXPECT_EQ(trust(0.1, 100, 52), Trust::doubtful) << "a metre of it is a guess";
}

TEST(Verdict, ASweepOrTwoThatCannotBeAlignedAreBridged) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 60; ++i) {
    const SweepResult sweep = run.next();
    assessor.add(i % 20 > 17 ? Ride::coasting(sweep) : sweep);
  }
  EXPECT_EQ(assessor.verdict().trust, Trust::reliable);
}

TEST(Verdict, LongerWithoutAnAlignmentIsDoubtfulAndLostWhereItEndsSo) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 20; ++i) {
    assessor.add(run.next());
  }
  for (int i = 0; i < 15; ++i) {
    assessor.add(Ride::coasting(run.next()));
  }
  EXPECT_EQ(assessor.verdict().trust, Trust::lost) << "it was not found again";
  assessor.add(run.next());
  const Verdict found = assessor.verdict();
  EXPECT_EQ(found.trust, Trust::doubtful);
  ASSERT_EQ(found.stretches.size(), 1U);
  EXPECT_EQ(found.stretches[0].cause, DoubtCause::predicted);
  EXPECT_EQ(found.stretches[0].first, 20U);
  EXPECT_EQ(found.stretches[0].last, 34U);
}

/// Twenty sweeps, five that coast, and one that starts anew, by inertia or not.
Verdict verdict_of_a_new_start(bool by_inertia) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 20; ++i) {
    assessor.add(run.next());
  }
  for (int i = 0; i < 5; ++i) {
    assessor.add(Ride::coasting(run.next()));
  }
  SweepResult again = Ride::coasting(run.next());
  again.renewed = by_inertia;
  again.state = by_inertia ? OdometryState::coasting : OdometryState::restarted;
  assessor.add(again);
  assessor.add(run.next());
  return assessor.verdict();
}

// The first sweep after it fits, which is all that speaks for it.
TEST(Verdict, ASilenceIsInDoubtAlthoughTheFirstSweepAfterItFits) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 20; ++i) {
    assessor.add(run.next());
  }
  SweepResult after = run.next();
  after.silence = 3.0;
  assessor.add(after);
  for (int i = 0; i < 10; ++i) {
    assessor.add(run.next());
  }
  const Verdict verdict = assessor.verdict();
  EXPECT_EQ(verdict.trust, Trust::doubtful);
  ASSERT_EQ(verdict.stretches.size(), 1U);
  EXPECT_EQ(verdict.stretches[0].cause, DoubtCause::silence);
  EXPECT_EQ(verdict.stretches[0].first, 19U);
  EXPECT_EQ(verdict.stretches[0].last, 20U);
  EXPECT_EQ(verdict.stretches[0].silence, 3.0);
}

TEST(Verdict, ASilenceBeginsWithTheLastSweepThatWasAligned) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 20; ++i) {
    assessor.add(run.next());
  }
  for (int i = 0; i < 3; ++i) {
    SweepResult coasting = Ride::coasting(run.next());
    coasting.silence = 2.0;
    assessor.add(coasting);
  }
  SweepResult after = run.next();
  after.silence = 2.3;
  assessor.add(after);
  ASSERT_EQ(assessor.verdict().stretches.size(), 1U);
  EXPECT_EQ(assessor.verdict().stretches[0].first, 19U);
  EXPECT_EQ(assessor.verdict().stretches[0].last, 23U);
}

TEST(Verdict, ANewStartIsLost) {
  const Verdict verdict = verdict_of_a_new_start(false);
  EXPECT_EQ(verdict.trust, Trust::lost);
  ASSERT_EQ(verdict.stretches.size(), 1U);
  EXPECT_EQ(verdict.stretches[0].cause, DoubtCause::new_start);
  EXPECT_EQ(verdict.stretches[0].first, 20U);
  EXPECT_EQ(verdict.stretches[0].last, 25U);
}

TEST(Verdict, ANewStartThatInertiaTiesIsDoubtful) {
  const Verdict verdict = verdict_of_a_new_start(true);
  EXPECT_EQ(verdict.trust, Trust::doubtful);
  ASSERT_EQ(verdict.stretches.size(), 1U);
  EXPECT_EQ(verdict.stretches[0].cause, DoubtCause::new_start);
  EXPECT_EQ(verdict.stretches[0].last, 25U);
}

TEST(Verdict, AlignmentsAndInertiaThatContradictEachOtherAreTold) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 30; ++i) {
    assessor.add(Ride::fused(run.next(), i % 10 == 0 ? 300.0 : 2.0));  // outliers are no pattern
  }
  EXPECT_EQ(assessor.verdict().trust, Trust::reliable);
  for (int i = 0; i < 20; ++i) {
    assessor.add(Ride::fused(run.next(), 40.0));
  }
  const Verdict verdict = assessor.verdict();
  EXPECT_EQ(verdict.trust, Trust::doubtful);
  ASSERT_EQ(verdict.stretches.size(), 1U);
  EXPECT_EQ(verdict.stretches[0].cause, DoubtCause::contradicted);
  EXPECT_NEAR(verdict.stretches[0].innovation, 40.0, 1e-9);
}

TEST(Verdict, StepsThatNoSensorMakesAreTold) {
  Ride run;
  RunAssessor assessor;
  for (int i = 0; i < 60; ++i) {
    SweepResult result = run.next();
    result.leapt = i == 10 || i == 40 || i == 43;
    assessor.add(result);
    EXPECT_EQ(assessor.verdict().trust, i < 43 ? Trust::reliable : Trust::doubtful) << i;
  }
  ASSERT_EQ(assessor.verdict().stretches.size(), 1U);
  const DoubtfulStretch stretch = assessor.verdict().stretches.front();
  EXPECT_EQ(stretch.cause, DoubtCause::contradicted);
  EXPECT_FALSE(stretch.inertial());
  EXPECT_GE(stretch.last, 43U);
}

TEST(Verdict, WhereNoSweepCouldBeAlignedAllIsLost) {
  Ride run;
  RunAssessor assessor;
  assessor.add(run.next());
  EXPECT_EQ(assessor.verdict().trust, Trust::reliable) << "one sweep is where it is";
  assessor.add(Ride::coasting(run.next()));
  EXPECT_EQ(assessor.verdict().trust, Trust::lost);
}

}  // namespace
}  // namespace adit
