// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/continued_map.hpp"

#include <string>

#include <gtest/gtest.h>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::dump_of;

constexpr NodeId kContinuedKeyframes = 6;

/// The fix of a keyframe, whose antenna the end of a run may move.
MapFix fix_of(NodeId keyframe, double antenna = 0.5) {
  return {.id = keyframe + 1,
          .keyframe = keyframe,
          .stamp = Nanoseconds(1000 * keyframe),
          .kind = GnssFixKind::single,
          .place = {41.65, -0.88, 200.0},
          .covariance = Eigen::Matrix3d::Identity(),
          .p_keyframe_antenna = {antenna, 0.0, 0.0}};
}

/// A keyframe of so many sweeps, a second each ten of them.
KeyframeRecord short_record(NodeId id, SessionId session, int sweeps = 10) {
  KeyframeRecord record = test::record(id, session);
  KeyframeSubmap submap;
  submap.r_submap = 0.25;
  for (int i = 0; i < sweeps; ++i) {
    submap.sweeps.push_back({.stamp = Nanoseconds(1000 * id + 100 * i), .merged = true});
  }
  for (int32_t i = 0; i < 50; ++i) {
    submap.points.push_back({.place = {i, static_cast<int32_t>(id), 7}});
  }
  record.keyframe.stamp = submap.sweeps.front().stamp;
  record.submap = encode(submap);
  record.fixes = {fix_of(id)};
  return record;
}

/// What a run does to its map: keyframes with their edges, then candidates, an edge that is taken
/// back, and an end that moves all poses and the last antenna and adds a last keyframe.
void run_up_to(MapStore& store, SessionId session, NodeId keyframes) {
  for (NodeId id = 0; id < keyframes; ++id) {
    store.store(short_record(id, session));
    LoopCandidate candidate;
    candidate.id = id + 1;
    candidate.to = id;
    store.revise({.candidates = {candidate}});
  }
}

void end_run(MapStore& store, SessionId session, NodeId keyframes, int sweeps = 10) {
  store.begin_end(Nanoseconds(1000 * keyframes + 100 * (sweeps - 1)));
  store.store(short_record(keyframes, session, sweeps));
  LoopCandidate judged;
  judged.id = 1;
  judged.verdict = CandidateVerdict::rejected;
  judged.reason = "nobody agrees";
  MapRevision revision{.candidates = {judged}, .statuses = {{1, EdgeStatus::revoked}}};
  for (NodeId id = 0; id <= keyframes; ++id) {
    revision.poses.push_back(
        {.id = id, .T_map_node = test::step(10.0 * static_cast<double>(id), 0.5)});
  }
  revision.fixes = {fix_of(keyframes > 0 ? keyframes - 1 : 0, 0.9)};
  store.revise(revision);
}

class ContinuedMapTest : public testing::Test {
 protected:
  ContinuedMapTest() {
    MapDatabase map(folder_ / "whole.adit", MapAccess::write);
    const SessionId session = test::add_session(map);
    map.begin_run(session);
    run_up_to(map, session, kContinuedKeyframes);
    end_run(map, session, kContinuedKeyframes);
    whole_ = dump_of(map);
    steps_ = map.progress(session).steps;
  }

  /// A map whose run has stored so many keyframes, and has ended by itself or was killed.
  fs::path begun(NodeId keyframes, bool ended, int sweeps = 4) {
    fs::path file = folder_ / ("begun" + std::to_string(keyframes) + (ended ? "e" : "") + ".adit");
    MapDatabase map(file, MapAccess::write);
    const SessionId session = test::add_session(map);
    map.begin_run(session);
    run_up_to(map, session, keyframes);
    if (ended) {
      end_run(map, session, keyframes, sweeps);
    }
    return file;
  }

  const test::TemporaryFolder folder_;
  std::string whole_;
  int64_t steps_ = 0;
};

TEST_F(ContinuedMapTest, EndsAsAnUndisturbedRunDoes) {
  EXPECT_EQ(steps_, 2 * kContinuedKeyframes) << "what the end does is no step";
  for (const bool ended : {false, true}) {
    for (NodeId stored = 0; stored <= kContinuedKeyframes; ++stored) {
      MapDatabase map(begun(stored, ended), MapAccess::write);
      EXPECT_EQ(map.progress(1).ending, ended);
      ContinuedMap continued(map, 1);
      EXPECT_EQ(continued.caught_up(), stored == 0);
      run_up_to(continued, 1, kContinuedKeyframes);
      EXPECT_TRUE(continued.caught_up());
      end_run(continued, 1, kContinuedKeyframes);
      EXPECT_EQ(dump_of(map), whole_) << stored << (ended ? ", ended" : ", killed");
      EXPECT_EQ(map.progress(1).steps, steps_);
      EXPECT_FALSE(map.progress(1).edited);
      EXPECT_TRUE(map.check().empty());
      EXPECT_EQ(map.submaps_within({-1e3, -1e3, -1e3}, {1e3, 1e3, 1e3}).size(),
                kContinuedKeyframes + 1U);
    }
  }
}

TEST_F(ContinuedMapTest, StaysAsItIsWhereTheSecondRunEndsBeforeTheFirstDid) {
  for (const bool ended : {false, true}) {
    MapDatabase map(begun(4, ended), MapAccess::write);
    const std::string before = dump_of(map);
    ContinuedMap continued(map, 1);
    run_up_to(continued, 1, 2);
    end_run(continued, 1, 2);
    EXPECT_EQ(dump_of(map), before);
    EXPECT_EQ(map.progress(1).steps, 8);
  }
}

// Steps are coarser than sweeps: all steps may have come again, and not all sweeps.
TEST_F(ContinuedMapTest, AnEndStaysUntilItsLastSweepHasComeAgain) {
  for (const NodeId stored : {0, 3}) {
    const fs::path file = begun(stored, true, 7);
    {
      MapDatabase map(file, MapAccess::write);
      const std::string before = dump_of(map);
      ContinuedMap continued(map, 1);
      run_up_to(continued, 1, stored);
      ASSERT_TRUE(continued.caught_up());
      end_run(continued, 1, stored, 6);  // a sweep less than the first run
      EXPECT_EQ(dump_of(map), before) << stored;
    }
    MapDatabase map(file, MapAccess::write);
    ContinuedMap continued(map, 1);
    run_up_to(continued, 1, stored);
    end_run(continued, 1, stored, 8);
    const std::vector<MapKeyframe> keyframes = map.keyframes();
    ASSERT_EQ(keyframes.size(), static_cast<std::size_t>(stored) + 1);
    EXPECT_EQ(decode(map.submap(stored)).sweeps.size(), 8U);
    EXPECT_TRUE(map.check().empty());
  }
}

TEST_F(ContinuedMapTest, AnEndIsTakenBackTogetherWithTheFirstNewStep) {
  MapDatabase map(begun(3, true), MapAccess::write);
  const std::string before = dump_of(map);
  ContinuedMap continued(map, 1);
  run_up_to(continued, 1, 3);
  EXPECT_THROW(continued.store(short_record(2, 1)), FileError)
      << "there is a keyframe of that number";
  EXPECT_EQ(dump_of(map), before);
  EXPECT_TRUE(map.progress(1).ending);
}

TEST_F(ContinuedMapTest, WhatIsRefusedLastLeavesTheMapToo) {
  MapDatabase map(begun(4, true), MapAccess::write);
  const std::string before = dump_of(map);
  ContinuedMap continued(map, 1);
  run_up_to(continued, 1, 3);
  KeyframeRecord other = short_record(3, 1);
  other.keyframe.stamp += Nanoseconds(1);
  EXPECT_THROW(continued.store(other), InputError);
  end_run(continued, 1, 4);
  EXPECT_EQ(dump_of(map), before);
}

TEST_F(ContinuedMapTest, RefusesWhatTheFirstRunHasNotMade) {
  MapDatabase map(begun(4, true), MapAccess::write);
  const std::string before = dump_of(map);
  const auto refused = [&](const KeyframeRecord& other) {
    ContinuedMap continued(map, 1);
    run_up_to(continued, 1, 1);
    try {
      continued.store(other);
    } catch (const InputError& error) {
      return error.place() == "keyframe 1";
    }
    return false;
  };
  EXPECT_FALSE(refused(short_record(1, 1)));
  KeyframeRecord other = short_record(1, 1);
  other.submap.chunks.back().back() ^= std::byte{1};
  EXPECT_TRUE(refused(other));
  other = short_record(1, 1);
  other.keyframe.stamp += Nanoseconds(1);
  EXPECT_TRUE(refused(other));
  other = short_record(1, 1);
  other.keyframe.covariance(2, 2) += 1e-12;
  EXPECT_TRUE(refused(other));
  EXPECT_EQ(dump_of(map), before);
}

TEST_F(ContinuedMapTest, AnEditOfTheMapIsKnown) {
  const fs::path file = begun(4, true);
  EXPECT_FALSE(MapDatabase(file, MapAccess::read).progress(1).edited);
  MapDatabase(file, MapAccess::write).revise({.statuses = {{0, EdgeStatus::revoked}}});
  EXPECT_TRUE(MapDatabase(file, MapAccess::read).progress(1).edited);
  EXPECT_THROW(static_cast<void>(MapDatabase(file, MapAccess::read).progress(7)), InputError);
}

}  // namespace
}  // namespace adit
