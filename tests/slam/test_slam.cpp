// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/executor/slam.hpp"

#include <algorithm>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/slam/odometry_fixture.hpp"
#include "adit/tests/support/moving_drive.hpp"

namespace adit {
namespace {

constexpr std::size_t kSweeps = 24;

Eigen::Isometry3d T_imu_lidar() {
  Vector6d xi;
  xi << 0.05, -0.02, 0.1, 0.0, 0.1, 0.7;
  return se3_exp(xi);
}

const test::MovingDrive& drive() {
  static const test::MovingDrive walk =
      test::moving_drive(test::make_street(30.0), test::walk(1.5, 0.3), T_imu_lidar(),
                         {.beams = 16, .columns = 360}, kSweeps);
  return walk;
}

/// As a recorder stores them: a sweep when it has ended, among the readings.
std::vector<Measurement> arrivals() {
  std::vector<Measurement> stored(drive().readings.begin(), drive().readings.end());
  for (const Sweep& sweep : drive().sweeps) {
    stored.emplace_back(sweep);
  }
  const auto stored_at = [](const Measurement& measurement) {
    const bool whole = std::holds_alternative<Sweep>(measurement);
    return stamp_of(measurement) + std::chrono::milliseconds(whole ? 100 : 0);
  };
  std::ranges::stable_sort(stored, {}, stored_at);
  return stored;
}

class SlamFacade : public test::DeviceTest {
 protected:
  /// What comes of the measurements; sets mounting_.
  std::vector<SlamResult> run(const std::vector<Measurement>& measurements,
                              const SlamOptions& options = {},
                              const Config& config = test::street_config()) {
    const auto slam = make_slam(context(), config, options);
    slam->add(StaticTransform{"imu", "lidar", T_imu_lidar()});
    std::vector<SlamResult> results;
    const auto drain = [&] {
      while (auto result = slam->next()) {
        results.push_back(std::move(*result));
      }
    };
    for (const Measurement& measurement : measurements) {
      slam->add(measurement, std::holds_alternative<Sweep>(measurement) ? "lidar" : "imu");
      drain();
    }
    slam->flush();
    drain();
    mounting_ = slam->mounting();
    return results;
  }

  static std::vector<SweepPlaced> sweeps(const std::vector<SlamResult>& results) {
    std::vector<SweepPlaced> placed;
    for (const SlamResult& result : results) {
      if (const auto* sweep = std::get_if<SweepPlaced>(&result)) {
        placed.push_back(*sweep);
      }
    }
    return placed;
  }

  std::optional<Mounting> mounting_;
};

TEST_F(SlamFacade, EverySweepIsPlacedInItsOrderAndEveryReadingTaken) {
  const std::vector<SlamResult> results = run(arrivals());
  const std::vector<SweepPlaced> placed = sweeps(results);
  ASSERT_EQ(placed.size(), kSweeps);
  EXPECT_EQ(results.size() - placed.size(), drive().readings.size());
  for (std::size_t i = 0; i < kSweeps; ++i) {
    EXPECT_EQ(placed[i].result.stamp, drive().sweeps[i].stamp);
    EXPECT_EQ(placed[i].sweep.points.size(), drive().sweeps[i].points.size());
    test::expect_sane(placed[i].result);
  }
  EXPECT_EQ(placed.back().result.inertial.state, InertialState::fused);
}

TEST_F(SlamFacade, AnyOrderOfArrivalGivesTheSameBytes) {
  const std::vector<SweepPlaced> expected = sweeps(run(arrivals()));
  for (const unsigned seed : {1U, 2U}) {
    std::vector<Measurement> shuffled = arrivals();
    std::mt19937 random(seed);
    for (std::size_t i = 0; i < shuffled.size(); i += 30) {
      std::shuffle(shuffled.begin() + static_cast<long>(i),
                   shuffled.begin() + static_cast<long>(std::min(i + 30, shuffled.size())), random);
    }
    const std::vector<SweepPlaced> placed = sweeps(run(shuffled));
    ASSERT_EQ(placed.size(), expected.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
      EXPECT_EQ(placed[i].result.T_map_lidar.matrix(), expected[i].result.T_map_lidar.matrix())
          << "seed " << seed << ", sweep " << i;
    }
  }
}

TEST_F(SlamFacade, TheMountingComesFromTheSettingsElseFromTransformsElseItIsAssumed) {
  std::vector<Measurement> first = arrivals();
  first.resize(60);
  run(first);
  ASSERT_TRUE(mounting_);
  EXPECT_EQ(mounting_->source, MountingSource::transforms);
  EXPECT_TRUE(mounting_->T_imu_lidar.isApprox(T_imu_lidar(), 1e-12));

  Config config = test::street_config();
  config.imu.T_imu_lidar = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0};
  run(first, {}, config);
  ASSERT_TRUE(mounting_);
  EXPECT_EQ(mounting_->source, MountingSource::configured) << "identity can be meant";
  EXPECT_TRUE(mounting_->T_imu_lidar.isApprox(Eigen::Isometry3d::Identity()));

  const auto nameless = make_slam(context(), test::street_config());
  nameless->add(StaticTransform{"imu", "lidar", T_imu_lidar()});
  nameless->add(drive().readings.front());
  nameless->add(drive().sweeps.front());
  nameless->flush();
  while (nameless->next()) {
  }
  ASSERT_TRUE(nameless->mounting());
  EXPECT_EQ(nameless->mounting()->source, MountingSource::assumed);
}

/// A drive whose IMU's axes are far from the lidar's: with another mounting it cannot be fused.
TEST_F(SlamFacade, TheMountingIsLookedUpWhenTheFirstReadingArrives) {
  const Nanoseconds late = drive().sweeps[6].stamp;
  std::vector<Measurement> measurements = arrivals();
  std::erase_if(measurements, [&](const Measurement& one) {
    return std::holds_alternative<ImuSample>(one) && stamp_of(one) < late;
  });
  const std::vector<SweepPlaced> placed = sweeps(run(measurements));
  ASSERT_TRUE(mounting_);
  EXPECT_EQ(mounting_->source, MountingSource::transforms);
  EXPECT_TRUE(mounting_->T_imu_lidar.isApprox(T_imu_lidar(), 1e-12));
  EXPECT_EQ(placed.back().result.inertial.state, InertialState::fused);
}

TEST_F(SlamFacade, ATransformThatComesLateIsUsedFromThenOn) {
  const auto slam = make_slam(context(), test::street_config());
  std::size_t placed = 0;
  InertialState last = InertialState::absent;
  for (const Measurement& measurement : arrivals()) {
    slam->add(measurement, std::holds_alternative<Sweep>(measurement) ? "lidar" : "imu");
    while (const auto result = slam->next()) {
      if (const auto* sweep = std::get_if<SweepPlaced>(&*result)) {
        last = sweep->result.inertial.state;
        if (++placed == 4) {
          EXPECT_EQ(slam->mounting()->source, MountingSource::assumed);
          slam->add(StaticTransform{"imu", "lidar", T_imu_lidar()});
        }
      }
    }
  }
  ASSERT_GT(placed, 15U);
  EXPECT_EQ(slam->mounting()->source, MountingSource::transforms);
  EXPECT_EQ(last, InertialState::fused);
}

TEST_F(SlamFacade, WithoutAnInertialSensorNothingWaits) {
  const auto slam = make_slam(context(), test::street_config(), {.inertial = false});
  slam->add(drive().sweeps.front());
  const auto result = slam->next();
  ASSERT_TRUE(result);
  EXPECT_TRUE(std::holds_alternative<SweepPlaced>(*result));
  EXPECT_FALSE(slam->next());
  EXPECT_FALSE(slam->mounting());
}

TEST_F(SlamFacade, ASweepWhoseTimeDoesNotRiseIsLeftOut) {
  const auto slam = make_slam(context(), test::street_config(), {.inertial = false});
  Sweep sweep = drive().sweeps.front();
  slam->add(sweep);
  ASSERT_TRUE(slam->next());
  for (const int earlier_ms : {0, 50}) {
    Sweep late = sweep;
    late.stamp -= std::chrono::milliseconds(earlier_ms);
    slam->add(late);
    const auto result = slam->next();
    ASSERT_TRUE(result);
    const auto* left_out = std::get_if<SweepLeftOut>(&*result);
    ASSERT_NE(left_out, nullptr);
    EXPECT_EQ(left_out->sweep.stamp, late.stamp);
    EXPECT_EQ(left_out->last, sweep.stamp);
  }
}

/// Takes some keyframes, then fails as a disk that is full.
class FullStore : public MapStore {
 public:
  explicit FullStore(std::size_t room) : room_(room) {}
  SessionId add_session(const MapSession&) override { return 1; }
  void store(const KeyframeRecord&) override {
    if (room_ == 0) {
      throw std::runtime_error("no space left on device");
    }
    --room_;
  }
  void revise(const MapRevision&) override {}
  void begin_end(Nanoseconds) override {}
  std::vector<MapSession> sessions() const override { return {}; }
  std::vector<MapKeyframe> keyframes() const override { return {}; }
  PoseGraph graph() const override { return PoseGraph{}; }
  std::vector<LoopCandidate> candidates() const override { return {}; }
  std::vector<MapFix> fixes() const override { return {}; }
  std::optional<Georeference> georeference() const override { return std::nullopt; }
  MapSubmap submap(NodeId) const override { return {}; }
  std::vector<std::byte> chunk(NodeId, std::size_t) const override { return {}; }
  std::vector<NodeId> submaps_within(const Eigen::Vector3d&,
                                     const Eigen::Vector3d&) const override {
    return {};
  }

 private:
  std::size_t room_;
};

TEST_F(SlamFacade, WhereTheMapFailsAllSweepsThatWerePlacedComeBeforeItsError) {
  for (const std::size_t room : {0U, 1U}) {
    FullStore store(room);
    const auto slam = make_slam(context(), test::street_config(),
                                {.inertial = false, .map = &store, .session = 1});
    for (const Sweep& sweep : drive().sweeps) {
      slam->add(sweep);
    }
    slam->flush();
    std::size_t placed = 0;
    std::size_t mapped = 0;
    std::string error;
    const auto drain = [&] {
      try {
        while (const auto result = slam->next()) {
          const auto& sweep = std::get<SweepPlaced>(*result);
          EXPECT_EQ(sweep.result.stamp, drive().sweeps[placed].stamp);
          ++placed;
          mapped += sweep.mapped ? 1U : 0U;
        }
      } catch (const std::runtime_error& failure) {
        error = failure.what();
      }
    };
    drain();
    EXPECT_EQ(error, "no space left on device");
    EXPECT_GT(placed, mapped) << "the odometry is ahead of the map";
    EXPECT_GT(mapped, 0U);
    EXPECT_FALSE(slam->finish_map()) << "there is no whole map";
    error.clear();
    drain();
    EXPECT_EQ(error, "") << "it is thrown once";
  }
}

TEST_F(SlamFacade, HighRateOdometryComesWithTheReadings) {
  std::size_t motions = 0;
  Nanoseconds last = Nanoseconds::min();
  for (const SlamResult& result : run(arrivals(), {.high_rate_smoothing = 0.0})) {
    const auto* taken = std::get_if<ReadingTaken>(&result);
    if (taken != nullptr && taken->motion) {
      EXPECT_GT(taken->motion->stamp, last);
      last = taken->motion->stamp;
      ++motions;
    }
  }
  EXPECT_GT(motions, 100U);
}

TEST_F(SlamFacade, AStepInTwoHalvesIsTheStepAndReadingsMayComeBetweenThem) {
  Config config = test::street_config();
  Odometry whole(context(), config);
  Odometry halves(context(), config);
  whole.mount(T_imu_lidar());
  halves.mount(T_imu_lidar());
  std::size_t fed = 0;
  for (const Sweep& sweep : drive().sweeps) {
    std::vector<ImuSample> due;
    const Nanoseconds end = sweep.stamp + std::chrono::milliseconds(105);
    for (; fed < drive().readings.size() && drive().readings[fed].stamp <= end; ++fed) {
      due.push_back(drive().readings[fed]);
      whole.add(due.back());
      halves.add(due.back());
    }
    const SweepResult expected = whole.step(sweep);
    halves.begin(sweep);
    const SweepResult result = halves.finish();
    ASSERT_EQ(result.T_map_lidar.matrix(), expected.T_map_lidar.matrix());
    ASSERT_EQ(result.uncertainty.local, expected.uncertainty.local);
  }
}

}  // namespace
}  // namespace adit
