// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "adit/slam/odometry/aligner.hpp"
#include "adit/slam/odometry/submap.hpp"
#include "adit/slam/registration/front_end.hpp"
#include "adit/tests/slam/odometry_fixture.hpp"

namespace adit {
namespace {

constexpr int kSteps = 30;

/// Two sweeps, one of them the submap, and alignments that end only where steps are used up.
struct Scene {
  Scene(engine::Context& context, Config given)
      : config(given),
        front_end(context, config.preprocess),
        submap(context, config),
        aligner(context, config.registration) {}

  Config config;
  FrontEnd front_end;
  Submap submap;
  Aligner aligner;
  engine::Slice cloud{};
};

struct Aligned {
  RegistrationResult result;
  int submissions = 0;
};

class AlignerTest : public test::DeviceTest {
 protected:
  static Config endless() {
    Config config = with_lengths(test::street_config());
    config.registration.translation_epsilon = 0.0;
    config.registration.rotation_epsilon = 0.0;
    config.registration.max_iterations = kSteps;
    return config;
  }

  static void prepare(Scene& scene, const Sweep& sweep) {
    scene.front_end.upload(sweep);
    scene.cloud = scene.submap.next_cloud(scene.front_end.capacity());
    run([&](engine::Recorder& recorder) {
      scene.submap.record_update(recorder);
      scene.front_end.record(recorder, scene.cloud);
    });
  }

  static void prepare(Scene& scene, const Sweep& first, const Sweep& second) {
    prepare(scene, first);
    scene.submap.push(scene.front_end.read_counters().cloud_points, Eigen::Isometry3d::Identity());
    prepare(scene, second);
  }

  static Aligned align(Scene& scene, const Prediction& prediction) {
    Aligned aligned{.result = {}, .submissions = 1};
    run([&](engine::Recorder& recorder) {
      scene.aligner.record(recorder, prediction, {}, scene.cloud, scene.front_end.counters(),
                           scene.front_end.points(), scene.submap);
    });
    for (; scene.aligner.unfinished(); ++aligned.submissions) {
      run([&](engine::Recorder& recorder) {
        scene.aligner.record_rest(recorder, scene.cloud, scene.submap);
      });
    }
    const auto points = static_cast<int>(scene.front_end.read_counters().cloud_points);
    aligned.result = scene.aligner.read_result(points, scene.submap);
    return aligned;
  }

  static Prediction some_prediction() {
    Prediction prediction;
    prediction.T_map_lidar = se3_exp(test::twist(0.3, 0.01));
    prediction.sigma = Vector6d::Constant(0.1);
    prediction.trusted = true;
    return prediction;
  }

  static void expect_same(const RegistrationResult& a, const RegistrationResult& b) {
    EXPECT_EQ(a.T_target_source.matrix(), b.T_target_source.matrix());
    EXPECT_EQ(a.hessian, b.hessian);
    EXPECT_EQ(a.information, b.information);
    EXPECT_EQ(a.status, b.status);
    EXPECT_EQ(a.iterations, b.iterations);
    EXPECT_EQ(a.used_prior, b.used_prior);
  }
};

// The first alignment is recorded for few steps and cut; the ones behind it for as many as it took.
TEST_F(AlignerTest, StepsInSeveralSubmissionsAreTheSameBits) {
  const test::Drive drive = test::make_drive(2, 0.5);
  Scene scene(context(), endless());
  prepare(scene, drive.sweeps[0], drive.sweeps[1]);
  const Aligned cut = align(scene, some_prediction());
  const Aligned whole = align(scene, some_prediction());
  EXPECT_GT(cut.submissions, 1);
  EXPECT_EQ(whole.submissions, 1);
  EXPECT_EQ(cut.result.iterations, kSteps);
  EXPECT_FALSE(cut.result.used_prior);
  expect_same(cut.result, whole.result);
}

/// Is weighed against the matches by this much in every direction.
Prediction weighed_prediction(const Eigen::Isometry3d& T_map_lidar, double information) {
  Prediction prediction;
  prediction.T_map_lidar = T_map_lidar;
  prediction.trusted = true;
  Vector6d diagonal;
  diagonal << Eigen::Vector3d::Constant(information), Eigen::Vector3d::Constant(information);
  prediction.information = Matrix6d(diagonal.asDiagonal());
  return prediction;
}

// The pose is where the matches' pull and the prior's balance; and what the matches themselves
// say, which the graph takes, is what they say without a prior.
TEST_F(AlignerTest, APriorIsWeighedAgainstTheMatches) {
  const test::Drive drive = test::make_drive(2, 0.5);
  Config config = endless();
  Scene scene(context(), config);
  prepare(scene, drive.sweeps[0], drive.sweeps[1]);
  const RegistrationResult alone = align(scene, some_prediction()).result;
  ASSERT_FALSE(alone.used_prior);
  const double strong = 0.5 * alone.information.topLeftCorner<3, 3>().trace();
  const Eigen::Isometry3d guess = alone.T_target_source * se3_exp(test::twist(0.02, 0.001));
  const RegistrationResult weighed = align(scene, weighed_prediction(guess, strong)).result;
  ASSERT_TRUE(weighed.used_prior);
  EXPECT_EQ(weighed.status, alone.status);
  const Vector6d from_guess = se3_log(guess.inverse() * weighed.T_target_source);
  const Vector6d from_alone = se3_log(alone.T_target_source.inverse() * weighed.T_target_source);
  EXPECT_GT(from_guess.norm(), 1e-3) << "the matches count";
  EXPECT_GT(from_alone.norm(), 1e-3) << "the prior counts";
  EXPECT_LT((weighed.pull + strong * from_guess).norm(), 0.02 * strong * from_guess.norm());
  const Vector6d to_optimum = -weighed.information.ldlt().solve(weighed.pull);
  const Eigen::Isometry3d optimum = weighed.T_target_source * se3_exp(to_optimum);
  const double left = se3_log(alone.T_target_source.inverse() * optimum).norm();
  EXPECT_LT(left, 0.3 * from_alone.norm()) << "the matches' own optimum depends on the prior";
}

TEST_F(AlignerTest, WeighedStepsInSeveralSubmissionsAreTheSameBits) {
  const test::Drive drive = test::make_drive(2, 0.5);
  Scene scene(context(), endless());
  prepare(scene, drive.sweeps[0], drive.sweeps[1]);
  const Prediction prediction = weighed_prediction(se3_exp(test::twist(0.3, 0.01)), 1e4);
  const Aligned cut = align(scene, prediction);
  const Aligned whole = align(scene, prediction);
  EXPECT_GT(cut.submissions, 1);
  EXPECT_EQ(whole.submissions, 1);
  EXPECT_EQ(cut.result.iterations, kSteps);
  EXPECT_TRUE(cut.result.used_prior);
  EXPECT_EQ(cut.result.pull, whole.result.pull);
  expect_same(cut.result, whole.result);
}

// On open ground no match holds the way along it, nor the heading: the first steps are followed by
// as many without these directions, and a cut may be among either.
TEST_F(AlignerTest, ConstrainedStepsInSeveralSubmissionsAreTheSameBits) {
  Random random(7);
  std::vector<Sweep> sweeps(2);
  for (Sweep& sweep : sweeps) {
    for (int i = 0; i < 20'000; ++i) {
      sweep.points.push_back({static_cast<float>(random.uniform(-20.0, 20.0)),
                              static_cast<float>(random.uniform(-20.0, 20.0)), -1.8F, 1.0F});
    }
  }
  Scene scene(context(), endless());
  prepare(scene, sweeps[0], sweeps[1]);
  const Aligned cut = align(scene, some_prediction());
  EXPECT_GT(cut.submissions, 2);
  EXPECT_TRUE(cut.result.used_prior);
  EXPECT_EQ(cut.result.iterations, kSteps) << "every constrained step was taken";
  const Aligned less_cut = align(scene, some_prediction());
  EXPECT_LT(less_cut.submissions, cut.submissions);
  expect_same(cut.result, less_cut.result);
}

// Where kernels do not read the host's memory themselves, a cloud is copied back for as many points
// as the sweep before had, and the others are fetched when they are asked for.
TEST(FrontEndOfGpus, ACloudThatGrowsIsReadWhole) {
  engine::ContextOptions options = test::test_options();
  engine::Context plain(options);
  options.gpu_shapes = true;
  engine::Context shaped(options);
  std::vector<std::vector<Point>> clouds;
  for (engine::Context* context : {&plain, &shaped}) {
    const Config config = with_lengths(test::street_config());
    FrontEnd front_end(*context, config.preprocess);
    Submap submap(*context, config);
    for (const Sweep& sweep : {test::noise(Nanoseconds(1), 500), test::noise(Nanoseconds(2))}) {
      front_end.upload(sweep);
      const engine::Slice surfaces = submap.next_cloud(front_end.capacity());
      engine::Recorder recorder = context->make_recorder();
      front_end.record(recorder, surfaces);
      context->submit(std::move(recorder)).wait();
      clouds.push_back(front_end.read_cloud());
    }
  }
  ASSERT_GT(clouds[1].size(), 5000U);
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_EQ(clouds[i].size(), clouds[i + 2].size());
    for (std::size_t k = 0; k < clouds[i].size(); ++k) {
      EXPECT_EQ(clouds[i][k].x, clouds[i + 2][k].x);
      EXPECT_EQ(clouds[i][k].z, clouds[i + 2][k].z);
    }
  }
}

// Sums in another order: the same to rounding.
TEST(OdometryOfGpus, ShapesOfGpusPlaceSweepsWhereOthersDo) {
  const test::Drive drive = test::make_drive(6, 0.4, 0.02);
  engine::ContextOptions options = test::test_options();
  engine::Context plain(options);
  options.gpu_shapes = true;
  engine::Context shaped(options);
  const std::vector<SweepResult> a = test::run_odometry(plain, drive.sweeps);
  const std::vector<SweepResult> b = test::run_odometry(shaped, drive.sweeps);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_LT((a[i].T_map_lidar.translation() - b[i].T_map_lidar.translation()).norm(), 1e-4);
    EXPECT_EQ(a[i].cloud.size(), b[i].cloud.size());
  }
  EXPECT_TRUE(shaped.validation_messages().empty());
}

}  // namespace
}  // namespace adit
