// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What an alignment says it does not know: a smooth tunnel, one with boxes, a room.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/registration/batch_aligner.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using test::World;

constexpr size_t kPairs = 16;
constexpr double kSigmaTranslation = 0.05;  // m, of the initial guesses
constexpr double kSigmaRotation = 0.01;     // rad

World room() {
  return {.blocks = {{{-10, -8, 0}, {-9, 8, 4}},
                     {{9, -8, 0}, {10, 8, 4}},
                     {{-9, -8, 0}, {9, -7, 4}},
                     {{-9, 7, 0}, {9, 8, 4}},
                     {{-10, -8, 4}, {10, 8, 5}},
                     {{-5, -3, 0}, {-4, -2, 1.5}},
                     {{3, 2, 0}, {4.5, 3, 2}},
                     {{1, -5, 0}, {2, -4, 1}},
                     {{-6, 4, 0}, {-4.5, 5.5, 2.5}},
                     {{5, -6, 0}, {7, -5, 1.2}}},
          .poles = {}};
}

/// 5 m wide and 4 m high along x; a box of 0.4 x 0.6 x 1 m every 4 m.
World tunnel(bool boxes) {
  World world{.blocks = {{{-200, -3.5, 0}, {200, -2.5, 4}},
                         {{-200, 2.5, 0}, {200, 3.5, 4}},
                         {{-200, -3.5, 4}, {200, 3.5, 5}}},
              .poles = {}};
  for (int i = -25; boxes && i < 25; ++i) {
    const double y = i % 2 == 0 ? -2.5 : 1.9;
    world.blocks.push_back({{4.0 * i, y, 0}, {4.0 * i + 0.4, y + 0.6, 1}});
  }
  return world;
}

class LocalizabilityTest : public test::DeviceTest {
 protected:
  struct Trial {
    RegistrationResult result;
    Vector6d error;            ///< truth (-) result, right perturbation
    double along = 0.0;        ///< error along the world's x axis, m
    double guess_along = 0.0;  ///< the same for the initial guess
  };

  /// Pairs of sweeps of the world with 2 cm of range noise, aligned from guesses with known errors,
  /// which the priors state.
  static std::vector<Trial> run(const World& world, bool resolve_weak, int neighbours = 7) {
    test::Lidar lidar{.beams = 64, .columns = 700, .lowest = -0.5, .highest = 0.5};
    lidar.range_noise = 0.02;
    PreprocessConfig preprocessing;
    preprocessing.r_input = 0.1;
    preprocessing.beam_spacing = lidar.beam_spacing();
    preprocessing.surface_size = 0.625;  // smaller than the boxes
    AlignmentClouds maker(context(), preprocessing);
    Random random(77);
    const auto cloud = [&](const Eigen::Isometry3d& pose, int stamp) {
      std::vector<Point> points =
          test::scan(world, {.stamp = Nanoseconds(stamp), .pose = pose}, lidar, 3).points;
      std::erase_if(points, [](const Point& p) { return p.x == 0.0F && p.y == 0.0F; });
      return maker.make_cloud(points);
    };
    Vector6d sigma;
    sigma << Eigen::Vector3d::Constant(kSigmaTranslation),
        Eigen::Vector3d::Constant(kSigmaRotation);
    std::vector<SurfaceCloud> sources;
    std::vector<AlignmentTarget> targets;
    std::vector<Eigen::Isometry3d> starts;  // T_world_target
    std::vector<Eigen::Isometry3d> truths;
    std::vector<AlignmentPair> pairs(kPairs);
    for (size_t i = 0; i < kPairs; ++i) {
      Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
      start.translation() << random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 1.5;
      Vector6d motion;
      motion << random.uniform(-0.4, 0.4), random.uniform(-0.2, 0.2), 0.05, 0.0, 0.0,
          random.uniform(-0.1, 0.1);
      starts.push_back(start);
      truths.push_back(se3_exp(motion));
      targets.push_back(maker.make_target(cloud(start, static_cast<int>(2 * i + 1)),
                                          RegistrationMethod::vgicp, std::vector{0.5}));
      sources.push_back(cloud(start * truths.back(), static_cast<int>(2 * i + 2)));
    }
    for (size_t i = 0; i < kPairs; ++i) {
      Vector6d error;
      for (int k = 0; k < 6; ++k) {
        error(k) = sigma(k) * random.gaussian();
      }
      pairs[i].source = &sources[i];
      pairs[i].target = &targets[i];
      pairs[i].T_target_source = retract(truths[i], error);
      pairs[i].prior_information = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
    }
    AlignmentSettings settings;
    settings.neighbours = neighbours;
    settings.d_max = 0.75;
    settings.max_iterations = 50;
    settings.resolve_weak = resolve_weak;
    const std::vector<RegistrationResult> results = BatchAligner(context(), settings).align(pairs);
    std::vector<Trial> trials;
    for (size_t i = 0; i < kPairs; ++i) {
      Trial trial{.result = results[i], .error = {}};
      const Eigen::Isometry3d off = results[i].T_target_source.inverse() * truths[i];
      trial.error << off.translation(), so3_log(off.linear());
      const auto along = [&](const Eigen::Isometry3d& pose) {
        return (starts[i] * pose).translation().x() - (starts[i] * truths[i]).translation().x();
      };
      trial.along = along(results[i].T_target_source);
      trial.guess_along = along(pairs[i].T_target_source);
      trials.push_back(trial);
    }
    return trials;
  }

  static double rms(const std::vector<Trial>& trials, double Trial::*value) {
    double sum = 0.0;
    for (const Trial& trial : trials) {
      sum += trial.*value * (trial.*value);
    }
    return std::sqrt(sum / static_cast<double>(trials.size()));
  }
};

// 1/m^2: what is known of moving along the axis when everything else may give way.
double marginal_information(const Matrix6d& information, const Eigen::Vector3d& axis) {
  const Matrix6d regular = information + 1e-9 * information.trace() * Matrix6d::Identity();
  Vector6d along = Vector6d::Zero();
  along.head<3>() = axis;
  return 1.0 / along.dot(regular.ldlt().solve(along));
}

TEST_F(LocalizabilityTest, ARoomHoldsEveryDirectionAndItsCovarianceIsHonest) {
  double nees = 0.0;
  for (const Trial& trial : run(room(), true)) {
    EXPECT_EQ(trial.result.status, RegistrationStatus::converged);
    EXPECT_FALSE(trial.result.used_prior);
    for (const auto* directions : {&trial.result.translation, &trial.result.rotation}) {
      for (const ObservedDirection& direction : *directions) {
        EXPECT_EQ(direction.localizability, Localizability::full);
      }
    }
    const Matrix6d sigma = covariance(trial.result, CovarianceModel{});
    nees += trial.error.dot(sigma.ldlt().solve(trial.error)) / 6.0 / kPairs;
  }
  RecordProperty("NEES / 6", std::to_string(nees));
  EXPECT_GT(nees, 0.5);
  EXPECT_LT(nees, 2.0);
}

TEST_F(LocalizabilityTest, InASmoothTunnelThePriorDecidesAlongTheAxis) {
  const std::vector<Trial> trials = run(tunnel(false), true);
  const std::vector<Trial> raw = run(tunnel(false), false);
  for (const Trial& trial : trials) {
    EXPECT_EQ(trial.result.status, RegistrationStatus::degenerate);
    EXPECT_TRUE(trial.result.used_prior);
    const ObservedDirection& weakest = trial.result.translation[0];
    EXPECT_EQ(weakest.localizability, Localizability::none);
    EXPECT_LT(marginal_information(trial.result.information, weakest.axis), 1.0);
    EXPECT_NEAR(trial.along, trial.guess_along, 0.01);
    EXPECT_EQ(trial.result.translation[1].localizability, Localizability::full);
    EXPECT_EQ(trial.result.translation[2].localizability, Localizability::full);
  }
  RecordProperty("error along the axis, m", std::to_string(rms(trials, &Trial::along)));
  RecordProperty("of the prior, m", std::to_string(rms(trials, &Trial::guess_along)));
  RecordProperty("without the prior, m", std::to_string(rms(raw, &Trial::along)));
  EXPECT_GT(rms(raw, &Trial::along), 1.5 * rms(trials, &Trial::along));
}

TEST_F(LocalizabilityTest, AFewBoxesHoldTheAxisInPart) {
  const std::vector<Trial> trials = run(tunnel(true), true, 1);
  const std::vector<Trial> raw = run(tunnel(true), false, 1);
  size_t none = 0;
  for (const Trial& trial : trials) {
    EXPECT_TRUE(is_usable(trial.result.status)) << to_string(trial.result.status);
    const ObservedDirection& weakest = trial.result.translation[0];
    none += weakest.localizability == Localizability::none ? 1U : 0U;
    EXPECT_GT(weakest.support, 10.0);
  }
  EXPECT_LE(none, kPairs / 4);
  RecordProperty("pairs whose axis is held by none", std::to_string(none));
  RecordProperty("error along the axis, m", std::to_string(rms(trials, &Trial::along)));
  RecordProperty("of the prior, m", std::to_string(rms(trials, &Trial::guess_along)));
  RecordProperty("without the prior, m", std::to_string(rms(raw, &Trial::along)));
  EXPECT_LT(rms(trials, &Trial::along), 0.75 * rms(raw, &Trial::along));
}

}  // namespace
}  // namespace adit
