// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/mapper.hpp"

#include <map>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "adit/engine/error.hpp"
#include "adit/slam/executor/slam.hpp"
#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/submap_support.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"

namespace adit {
namespace {

constexpr std::size_t kMappedSweeps = 40;

const test::SubmapDrive& drive() {
  static const test::SubmapDrive street = test::submap_drive(kMappedSweeps, 0.4);
  return street;
}

class MapperTest : public test::DeviceTest {
 protected:
  struct Run {
    std::vector<SweepPlaced> sweeps;
    std::optional<MapReport> report;
  };

  static Run run(const std::vector<Sweep>& sweeps, const Config& config, test::TemporaryMap* map) {
    const auto slam = make_slam(context(), config,
                                {.inertial = false,
                                 .map = map == nullptr ? nullptr : &map->store(),
                                 .session = map == nullptr ? 0 : map->session()});
    Run run;
    const auto drain = [&] {
      while (auto result = slam->next()) {
        run.sweeps.push_back(std::get<SweepPlaced>(std::move(*result)));
      }
    };
    for (const Sweep& sweep : sweeps) {
      slam->add(sweep);
      drain();
    }
    slam->flush();
    drain();
    run.report = slam->finish_map();
    return run;
  }
};

TEST_F(MapperTest, EverySweepBelongsToExactlyOneKeyframe) {
  std::vector<Sweep> sweeps = drive().sweeps;
  for (std::size_t i = 20; i < 23; ++i) {
    sweeps[i].points.clear();  // the odometry coasts
  }
  test::TemporaryMap map;
  const Run mapped = run(sweeps, test::submap_config(), &map);
  std::map<Nanoseconds, NodeId> owner;
  std::size_t unbelieved = 0;
  for (const MapKeyframe& keyframe : map.store().keyframes()) {
    const KeyframeSubmap submap = decode(map.store().submap(keyframe.id));
    EXPECT_EQ(submap.sweeps.front().stamp, keyframe.stamp);
    EXPECT_GT(submap.points.size(), 500U);
    for (const SubmapSweep& sweep : submap.sweeps) {
      EXPECT_TRUE(owner.emplace(sweep.stamp, keyframe.id).second) << "in two submaps";
      unbelieved += sweep.merged ? 0U : 1U;
    }
  }
  EXPECT_EQ(unbelieved, 3U);
  ASSERT_EQ(owner.size(), kMappedSweeps);
  for (const SweepPlaced& placed : mapped.sweeps) {
    EXPECT_EQ(owner.at(placed.result.stamp), placed.mapped->keyframe);
  }
  EXPECT_EQ(mapped.report->sweeps, kMappedSweeps);
  EXPECT_EQ(mapped.report->keyframes, map.store().keyframes().size());
  EXPECT_GT(mapped.report->keyframes, 8U);
  EXPECT_LT(mapped.report->keyframes, 20U);
  EXPECT_GT(mapped.report->longest_wait_s, 0.0);
  EXPECT_LT(mapped.report->longest_wait_s, mapped.report->waited_s) << "of one sweep among many";
  double waited_ms = 0.0;
  for (const SweepPlaced& placed : mapped.sweeps) {
    waited_ms += placed.map_ms;
  }
  EXPECT_LE(mapped.report->waited_s, 1e-3 * waited_ms) << "the map's end is no sweep's wait";
}

TEST_F(MapperTest, TheOdometryIsTheSameWithAndWithoutAMap) {
  test::TemporaryMap map;
  const Run mapped = run(drive().sweeps, test::submap_config(), &map);
  const Run alone = run(drive().sweeps, test::submap_config(), nullptr);
  EXPECT_FALSE(alone.report);
  ASSERT_EQ(mapped.sweeps.size(), alone.sweeps.size());
  for (std::size_t i = 0; i < kMappedSweeps; ++i) {
    EXPECT_FALSE(alone.sweeps[i].mapped);
    EXPECT_EQ(mapped.sweeps[i].result.T_map_lidar.matrix(),
              alone.sweeps[i].result.T_map_lidar.matrix());
    EXPECT_EQ(mapped.sweeps[i].result.uncertainty.in_map(),
              alone.sweeps[i].result.uncertainty.in_map());
  }
}

TEST_F(MapperTest, ASweepIsToldOnceItIsInTheMap) {
  test::TemporaryMap map;
  const auto slam = make_slam(context(), test::submap_config(),
                              {.inertial = false, .map = &map.store(), .session = map.session()});
  for (std::size_t i = 0; i < 3; ++i) {
    slam->add(drive().sweeps[i]);
    std::size_t told = 0;
    const auto drain = [&] {
      while (auto result = slam->next()) {
        ++told;
        EXPECT_TRUE(std::get<SweepPlaced>(*result).mapped);
      }
    };
    drain();
    EXPECT_LE(told, 1U);
    slam->settle();
    drain();
    EXPECT_EQ(told, 1U) << "sweep " << i;
  }
}

TEST_F(MapperTest, AMapThatIsNotBesideTheOdometryHasNoMoreThanWasGiven) {
  test::TemporaryMap map;
  const auto slam = make_slam(
      context(), test::submap_config(),
      {.inertial = false, .map = &map.store(), .session = map.session(), .map_beside = false});
  for (const Sweep& sweep : drive().sweeps) {
    slam->add(sweep);
  }
  slam->flush();  // all are due
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(slam->next());
  }
  EXPECT_EQ(slam->finish_map()->sweeps, 3U);
}

TEST_F(MapperTest, ConsecutiveKeyframesAreTiedWhereTheyReallyAre) {
  test::TemporaryMap map;
  const Run mapped = run(drive().sweeps, test::submap_config(), &map);
  const PoseGraph graph = map.store().graph();
  ASSERT_EQ(graph.edges().size() + 1, graph.nodes().size());
  EXPECT_EQ(mapped.report->edges, graph.edges().size());
  EXPECT_EQ(mapped.report->aligned_edges, graph.edges().size());
  EXPECT_EQ(mapped.report->components, 1U);
  const Eigen::Isometry3d T_world_map = drive().truth.front().pose;
  std::map<Nanoseconds, Eigen::Isometry3d> truth;
  for (const StampedPose& pose : drive().truth) {
    truth[pose.stamp] = pose.pose;
  }
  std::vector<Eigen::Isometry3d> T_world_keyframe;
  for (const MapKeyframe& keyframe : map.store().keyframes()) {
    const KeyframeSubmap submap = decode(map.store().submap(keyframe.id));
    EXPECT_EQ(submap.vertical, Vertical::ground);
    T_world_keyframe.push_back(truth.at(keyframe.stamp) *
                               submap.sweeps.front().T_keyframe_lidar.inverse());
    const Eigen::Isometry3d off =
        T_world_keyframe.back().inverse() * (T_world_map * keyframe.T_map_keyframe);
    EXPECT_LT(off.translation().norm(), 0.1);
  }
  for (const PoseEdge& edge : graph.edges()) {
    EXPECT_EQ(edge.to, edge.from + 1);
    const auto from = static_cast<std::size_t>(edge.from);
    const Eigen::Isometry3d off =
        edge.T_from_to.inverse() * (T_world_keyframe[from].inverse() * T_world_keyframe[from + 1]);
    EXPECT_LT(off.translation().norm(), 0.03);
    EXPECT_LT(rotation_angle(off.linear()), 0.004);
    const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(edge.information);
    EXPECT_GT(eigen.eigenvalues()(0), 100.0) << "1/m^2: something is known in every direction";
    EXPECT_LT(eigen.eigenvalues()(5), 1e9);
  }
}

TEST_F(MapperTest, WorkTakesEffectAfterTheDelayAndTheMapIsTheSameInTheEnd) {
  std::map<int, std::string> dumps;
  std::map<int, std::vector<Eigen::Isometry3d>> known;
  for (const int delay : {0, 3, 1000}) {
    Config config = test::submap_config();
    config.mapping.delay = delay;
    test::TemporaryMap map;
    const Run mapped = run(drive().sweeps, config, &map);
    dumps[delay] = map.dump();
    for (const SweepPlaced& placed : mapped.sweeps) {
      known[delay].push_back(placed.mapped->T_map_lidar);
      if (delay == 1000 || placed.mapped->keyframe <= delay + 1) {
        EXPECT_EQ(placed.mapped->T_map_lidar.matrix(), placed.result.T_map_lidar.matrix())
            << "nothing has had an effect yet";
      }
    }
    EXPECT_FALSE(delay < 1000 &&
                 known[delay].back().isApprox(mapped.sweeps.back().result.T_map_lidar, 1e-12))
        << "what was worked out moves the map";
  }
  EXPECT_EQ(dumps[0], dumps[3]);
  EXPECT_EQ(dumps[0], dumps[1000]);
}

TEST_F(MapperTest, TheSameBytesTwice) {
  test::TemporaryMap first;
  test::TemporaryMap second;
  run(drive().sweeps, test::submap_config(), &first);
  run(drive().sweeps, test::submap_config(), &second);
  EXPECT_EQ(first.dump(), second.dump());
}

TEST_F(MapperTest, AnOdometryThatStartsAnewBeginsAnotherComponent) {
  std::vector<Sweep> sweeps = drive().sweeps;
  sweeps.resize(16);
  // Somewhere else, where nothing can be aligned with.
  const test::World elsewhere = test::make_street(300.0, 77);
  for (std::size_t i = 16; i < 28; ++i) {
    StampedPose pose = drive().truth[i];
    pose.pose.translation() += Eigen::Vector3d(200.0, 40.0, 12.0);
    sweeps.push_back(test::scan(elsewhere, pose, test::small_lidar()));
  }
  Config config = test::submap_config();
  config.recovery.max_coasting = 2;
  test::TemporaryMap map;
  const Run mapped = run(sweeps, config, &map);
  std::size_t restarts = 0;
  for (const SweepPlaced& placed : mapped.sweeps) {
    restarts += placed.result.state == OdometryState::restarted ? 1U : 0U;
  }
  ASSERT_GT(restarts, 0U);
  EXPECT_EQ(mapped.report->components, 1 + restarts);
  EXPECT_EQ(mapped.report->edges + 1 + restarts, mapped.report->keyframes);
  const std::vector<std::size_t> parts = map_parts(map.store(), "map.adit");
  ASSERT_EQ(parts.size(), restarts);
  EXPECT_EQ(mapped.sweeps[parts.front()].result.state, OdometryState::restarted);
  EXPECT_TRUE(map.store().check().empty());
}

TEST_F(MapperTest, NoSubmapSpansASilenceAndTheEdgeOverItHasWhatIsKnown) {
  std::vector<Sweep> sweeps = drive().sweeps;
  sweeps.erase(sweeps.begin() + 16, sweeps.begin() + 30);  // of 1.5 s
  test::TemporaryMap map;
  const Run mapped = run(sweeps, test::submap_config(), &map);
  ASSERT_GT(mapped.sweeps[16].result.silence, 1.0);
  ASSERT_EQ(mapped.sweeps[16].result.state, OdometryState::tracking);
  EXPECT_EQ(mapped.report->components, 1U);
  const NodeId after = mapped.sweeps[16].mapped->keyframe;
  EXPECT_EQ(mapped.sweeps[15].mapped->keyframe + 1, after);
  const PoseGraph graph = map.store().graph();
  std::size_t over_it = 0;
  for (const PoseEdge& edge : graph.edges()) {
    const double sigma = std::sqrt(symmetric_inverse(edge.information)(0, 0));
    if (edge.to == after) {
      EXPECT_GT(sigma, 0.07);
      ++over_it;
    } else {
      EXPECT_LT(sigma, 0.05) << edge.to;
    }
  }
  EXPECT_EQ(over_it, 1U);
}

TEST_F(MapperTest, AfterALongSilenceAnotherPartBegins) {
  std::vector<Sweep> sweeps = drive().sweeps;
  for (std::size_t i = 16; i < sweeps.size(); ++i) {
    sweeps[i].stamp += std::chrono::seconds(600);
  }
  test::TemporaryMap map;
  const Run mapped = run(sweeps, test::submap_config(), &map);
  EXPECT_EQ(mapped.sweeps[16].result.state, OdometryState::restarted);
  EXPECT_EQ(mapped.report->components, 2U);
}

/// Hands everything on to a map until its device is lost.
class LosingStore final : public MapStore {
 public:
  LosingStore(MapStore& map, int keyframes) : map_(&map), left_(keyframes) {}

  SessionId add_session(const MapSession& session) override { return map_->add_session(session); }
  void store(const KeyframeRecord& record) override {
    if (left_ <= 0) {
      throw engine::DeviceLost("the device was lost");
    }
    --left_;
    map_->store(record);
  }
  void revise(const MapRevision& revision) override { map_->revise(revision); }
  void begin_end(Nanoseconds last_sweep) override { map_->begin_end(last_sweep); }
  std::vector<MapSession> sessions() const override { return map_->sessions(); }
  std::vector<MapKeyframe> keyframes() const override { return map_->keyframes(); }
  PoseGraph graph() const override { return map_->graph(); }
  std::vector<LoopCandidate> candidates() const override { return map_->candidates(); }
  std::vector<MapFix> fixes() const override { return map_->fixes(); }
  std::optional<Georeference> georeference() const override { return map_->georeference(); }
  MapSubmap submap(NodeId keyframe) const override { return map_->submap(keyframe); }
  std::vector<std::byte> chunk(NodeId keyframe, std::size_t number) const override {
    return map_->chunk(keyframe, number);
  }
  std::vector<NodeId> submaps_within(const Eigen::Vector3d& lower,
                                     const Eigen::Vector3d& upper) const override {
    return map_->submaps_within(lower, upper);
  }

 private:
  MapStore* map_;
  int left_;
};

TEST_F(MapperTest, ADeviceThatIsLostLeavesTheKeyframesThatWereStored) {
  const std::vector<Sweep> sweeps(drive().sweeps.begin(), drive().sweeps.begin() + 16);
  test::TemporaryMap whole;
  run(sweeps, test::submap_config(), &whole);
  const std::vector<MapKeyframe> all = whole.store().keyframes();
  ASSERT_GT(all.size(), 4U);
  test::TemporaryMap map;
  LosingStore losing(map.store(), 3);
  const auto slam = make_slam(context(), test::submap_config(),
                              {.inertial = false, .map = &losing, .session = map.session()});
  const auto all_of_it = [&] {
    for (const Sweep& sweep : sweeps) {
      slam->add(sweep);
    }
    slam->flush();
    while (slam->next()) {
    }
  };
  EXPECT_THROW(all_of_it(), engine::DeviceLost);
  static_cast<void>(slam->finish_map());  // what is known without the device goes into the map
  EXPECT_TRUE(map.store().check().empty());
  const std::vector<MapKeyframe> stored = map.store().keyframes();
  ASSERT_EQ(stored.size(), 3U);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    EXPECT_EQ(stored[i].stamp, all[i].stamp);
    EXPECT_EQ(map.store().submap(stored[i].id).chunks, whole.store().submap(all[i].id).chunks);
  }
  EXPECT_EQ(map.store().graph().edges().size(), 2U);
}

}  // namespace
}  // namespace adit
