// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_loops.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <vector>

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

using test::Ran;

/// Six keyframes 10 m apart by the odometry, the last of which a loop has 1 m nearer.
class LoopsCommand : public testing::Test {
 protected:
  void SetUp() override {
    MapDatabase map(map_, MapAccess::write);
    const SessionId session = test::add_session(map);
    for (NodeId id = 0; id < 6; ++id) {
      KeyframeRecord record = test::record(id, session);
      record.submap = encode(wall());
      map.store(record);
    }
    map.revise(test::loops_of_six());
  }

  static KeyframeSubmap wall() {
    KeyframeSubmap submap;
    submap.r_submap = 0.25;
    submap.sweeps.emplace_back();
    for (int i = 0; i < 200; ++i) {
      submap.points.push_back({.place = {20 * i, 3000, 10 * i}});
    }
    return submap;
  }

  Ran shown_on(const std::optional<fs::path>& page, const std::vector<int64_t>& show = {}) const {
    LoopsCommandOptions options;
    options.map = map_;
    options.html = page;
    options.show = show;
    return test::ran(loops_command, options);
  }

  double x_of_last() const {
    return MapDatabase(map_, MapAccess::read).keyframes().back().T_map_keyframe.translation().x();
  }

  test::TemporaryFolder folder_;
  fs::path map_ = folder_ / "map.adit";
};

TEST_F(LoopsCommand, ListsTheLedgerAsATableAndAsJson) {
  const Ran text = test::ran(loops_command, {.map = map_});
  EXPECT_EQ(text.code, 0) << text.err;
  for (const char* part :
       {"accepted", "rejected", "too_little_overlap 0.12", "0.82", "2 candidates, 1 accepted"}) {
    EXPECT_NE(text.out.find(part), std::string::npos) << part << "\n" << text.out;
  }
  const auto json =
      nlohmann::json::parse(test::ran(loops_command, {.map = map_, .json = true}).out);
  ASSERT_EQ(json.at("loops").size(), 2U);
  EXPECT_EQ(json.at("loops")[0].at("verdict"), "accepted");
  EXPECT_EQ(json.at("loops")[1].at("reason"), "too_little_overlap");
  EXPECT_EQ(json.at("loops")[1].at("figure"), 0.12);
}

TEST_F(LoopsCommand, TellsWhatFoundALoopItsVotesAndItsPose) {
  const LoopCandidate alike{.id = 3,
                            .from = 2,
                            .to = 5,
                            .source = LoopSource::appearance,
                            .score = 0.72,
                            .chi2 = 31.5,
                            .verdict = CandidateVerdict::rejected,
                            .reason = "beyond_gate",
                            .figure = 31.5};
  MapDatabase(map_, MapAccess::write).revise({.candidates = {alike}});
  const std::string text = test::ran(loops_command, {.map = map_}).out;
  for (const char* part : {"found by", "from graph before", "1.000 m   0.0 deg", "residual chi2",
                           "votes", "position", "appearance 0.72"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  const auto json =
      nlohmann::json::parse(test::ran(loops_command, {.map = map_, .json = true}).out);
  const auto& in = json.at("loops")[0];
  EXPECT_EQ(in.at("votes"), 3);
  EXPECT_EQ(in.at("T_from_to"), nlohmann::json({49.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}));
  EXPECT_NEAR(in.at("T_from_to_sigma_m")[0].get<double>(), 0.05, 1e-9) << "information of 400";
  EXPECT_EQ(in.at("T_from_to_sigma_rad").size(), 3U);
  EXPECT_NEAR(in.at("correction_m").get<double>(), 1.0, 1e-6) << "against the graph before it";
  EXPECT_GT(in.at("correction_chi2").get<double>(), 0.0);
  EXPECT_NEAR(in.at("path_m").get<double>(), 50.0, 1e-6);
  EXPECT_TRUE(in.at("residual_chi2").is_number());
  EXPECT_EQ(in.at("correction_from"), "graph");
  const auto& out = json.at("loops")[2];
  EXPECT_TRUE(out.at("votes").is_null());
  EXPECT_TRUE(out.at("T_from_to_sigma_m").is_null()) << "it has no edge";
  EXPECT_EQ(out.at("correction_chi2"), 31.5);
  EXPECT_TRUE(out.at("residual_chi2").is_null());
  EXPECT_EQ(out.at("correction_from"), "appearance");
}

TEST_F(LoopsCommand, AGuessThatIsNoPlaceIsAUsageError) {
  const double infinite = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& guess : {std::vector{std::nan(""), 0.0, 0.0, 0.0},
                                           {0.0, infinite, 0.0, 0.0},
                                           {0.0, 0.0, 1e300, 0.0},
                                           {0.0, 0.0, 0.0, -infinite}}) {
    const Ran wrong = test::ran(loops_command, {.map = map_, .add = {0, 4}, .guess = guess});
    EXPECT_EQ(wrong.code, 2) << wrong.err;
    EXPECT_NE(wrong.err.find("and takes a number from"), std::string::npos) << wrong.err;
  }
  const Ran named =
      test::ran(loops_command, {.map = map_, .add = {0, 4}, .guess = {0.0, 0.0, 1e300, 0.0}});
  EXPECT_NE(named.err.find("Z is 1e+300"), std::string::npos) << named.err;
}

TEST_F(LoopsCommand, ShowsTheLoopsThatAreAskedFor) {
  const fs::path page = folder_ / "loops.html";
  ASSERT_EQ(shown_on(page, {2}).code, 0);
  const std::string html = test::content(page);
  EXPECT_EQ(html.find("id=\"loop1\""), std::string::npos);
  EXPECT_NE(html.find("id=\"loop2\""), std::string::npos);
  EXPECT_EQ(shown_on(page, {9}).code, 2);
  EXPECT_EQ(shown_on(std::nullopt, {2}).code, 2) << "needs --html";
}

TEST_F(LoopsCommand, ALoopThatTheMapDoesNotFollowIsSeenToBeOff) {
  const fs::path page = folder_ / "loops.html";
  ASSERT_EQ(shown_on(page).code, 0);
  // Nobody has optimised the map: it lies as the odometry has it.
  std::string html = test::content(page);
  EXPECT_NE(html.find("the map is 1.000 m and 0.00° off it"), std::string::npos);
  EXPECT_NE(html.find("after: where the map has them"), std::string::npos);
  ASSERT_EQ(test::ran(loops_command, {.map = map_, .revoke = 1}).code, 0);
  ASSERT_EQ(test::ran(loops_command, {.map = map_, .restore = 1}).code, 0);
  ASSERT_EQ(shown_on(page).code, 0);
  html = test::content(page);
  EXPECT_EQ(html.find("the map is 1.000 m and 0.00° off it"), std::string::npos);
}

TEST_F(LoopsCommand, OfVeryManyTheDrawnOnesAreSaidToBeAChoice) {
  std::vector<LoopCandidate> many;
  for (int64_t id = 3; id < 73; ++id) {
    many.push_back({.id = id,
                    .from = 2,
                    .to = 5,
                    .verdict = CandidateVerdict::rejected,
                    .reason = "few_votes"});
  }
  MapDatabase(map_, MapAccess::write).revise({.candidates = many});
  const fs::path page = folder_ / "loops.html";
  ASSERT_EQ(shown_on(page).code, 0);
  const std::string html = test::content(page);
  EXPECT_NE(html.find("<h2>71 rejected</h2>\n<p>60 of them are drawn"), std::string::npos);
  EXPECT_EQ(test::count(html, "<h3 id="), 61U);
}

TEST_F(LoopsCommand, ShowsThemAsAPage) {
  const fs::path page = folder_ / "loops.html";
  const Ran shown = shown_on(page);
  EXPECT_EQ(shown.code, 0) << shown.err;
  EXPECT_NE(shown.out.find("look at  " + page.string()), std::string::npos) << shown.out;
  const std::string html = test::content(page);
  // The odometry alone has the two 50 m apart, the loop 49 m.
  for (const char* part :
       {"Loop 1: keyframes 0 and 5, accepted", "after 50 m the odometry alone is 1.000 m",
        "Loop 2: keyframes 1 and 5, rejected: too_little_overlap (0.12)", "1 accepted",
        "1 rejected", "where they were aligned", "data:image/png;base64,iVBORw0KGgo"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(html.find("nan"), std::string::npos);
  EXPECT_EQ(html.find("inf "), std::string::npos);
  const Ran nowhere = shown_on(folder_ / "missing" / "loops.html");
  EXPECT_EQ(nowhere.code, 1);
  EXPECT_NE(nowhere.err.find("loops.html"), std::string::npos) << nowhere.err;
  {
    MapDatabase map(map_, MapAccess::write);
    map.store(test::record(6, 1));
    LoopCandidate candidate;
    candidate.id = 3;
    candidate.to = 6;
    map.revise({.candidates = {candidate}});
  }
  const Ran spoiled = shown_on(page);
  EXPECT_EQ(spoiled.code, 1);
  EXPECT_NE(spoiled.err.find("a submap is damaged"), std::string::npos) << spoiled.err;
}

TEST_F(LoopsCommand, ALoopToAKeyframeThatIsMissingIsDamage) {
  LoopCandidate candidate;
  candidate.id = 3;
  candidate.to = 99;
  MapDatabase(map_, MapAccess::write).revise({.candidates = {candidate}});
  const Ran shown = shown_on(folder_ / "loops.html");
  EXPECT_EQ(shown.code, 1);
  EXPECT_NE(shown.err.find("loop 3 ties keyframes 0 and 99, and one of them is missing"),
            std::string::npos)
      << shown.err;
}

TEST_F(LoopsCommand, RevokesALoopAndRestoresIt) {
  const Ran revoked = test::ran(loops_command, {.map = map_, .revoke = 1});
  EXPECT_EQ(revoked.code, 0) << revoked.err;
  EXPECT_NE(revoked.out.find("revoked   loop 1; cost"), std::string::npos) << revoked.out;
  EXPECT_NE(revoked.out.find("by_hand"), std::string::npos) << revoked.out;
  EXPECT_NEAR(x_of_last(), 50.0, 1e-6) << "the odometry alone";
  {
    const MapDatabase map(map_, MapAccess::read);
    EXPECT_EQ(map.graph().edges().back().status, EdgeStatus::revoked);
    EXPECT_EQ(map.candidates().front().verdict, CandidateVerdict::revoked);
    EXPECT_TRUE(map.check().empty());
  }
  const Ran restored = test::ran(loops_command, {.map = map_, .restore = 1, .json = true});
  EXPECT_EQ(restored.code, 0) << restored.err;
  const auto json = nlohmann::json::parse(restored.out);
  EXPECT_EQ(json.at("changed").at("status"), "active");
  EXPECT_EQ(json.at("loops")[0].at("verdict"), "accepted");
  EXPECT_GT(json.at("loops")[0].at("chi2").get<double>(), 0.0);
  const double with_loop = x_of_last();
  EXPECT_LT(with_loop, 49.5);
  EXPECT_GT(with_loop, 49.0);
  EXPECT_EQ(test::ran(loops_command, {.map = map_, .revoke = 1}).code, 0) << "and again";
  EXPECT_EQ(test::ran(loops_command, {.map = map_, .restore = 1}).code, 0);
  EXPECT_NEAR(x_of_last(), with_loop, 1e-6);
}

TEST_F(LoopsCommand, WhatCannotBeShownOrWrittenChangesNothing) {
  const std::string before = test::dump_of(MapDatabase(map_, MapAccess::read));
  LoopsCommandOptions options{.map = map_, .revoke = 1};
  options.html = folder_ / "loops.html";
  options.show = {99};
  const Ran unknown = test::ran(loops_command, options);
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.err.find("--show: the map has no loop 99"), std::string::npos) << unknown.err;
  options.show.clear();
  options.html = folder_ / "none/loops.html";
  const Ran nowhere = test::ran(loops_command, options);
  EXPECT_EQ(nowhere.code, 1);
  EXPECT_NE(nowhere.err.find("loops.html"), std::string::npos) << nowhere.err;
  EXPECT_EQ(test::dump_of(MapDatabase(map_, MapAccess::read)), before);
}

TEST_F(LoopsCommand, RestoringGivesTheVotesBack) {
  EXPECT_EQ(test::ran(loops_command, {.map = map_, .revoke = 1}).code, 0);
  const auto json = nlohmann::json::parse(
      test::ran(loops_command, {.map = map_, .restore = 1, .json = true}).out);
  EXPECT_EQ(json.at("loops")[0].at("votes"), 3);
}

// A map whose frame leans, as one may that nothing has placed: what its verticals cost is nothing
// that a loop changes.
TEST_F(LoopsCommand, TheCostsAreThoseOfTheChange) {
  const auto leaning_map = [](const fs::path& file, double tilt) {
    const Eigen::Isometry3d lean(Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()));
    MapDatabase map(file, MapAccess::write);
    const SessionId session = test::add_session(map);
    for (NodeId id = 0; id < 6; ++id) {
      KeyframeRecord record = test::record(id, session);
      record.keyframe.T_map_keyframe = lean * record.keyframe.T_map_keyframe;
      record.keyframe.vertical = Vertical::gravity;
      map.store(record);
    }
    map.revise(test::loops_of_six());
    return file;
  };
  std::vector<double> costs;
  for (const double tilt : {0.0, 0.1}) {
    const fs::path file = leaning_map(folder_ / fmt::format("{}.adit", tilt), tilt);
    const auto json = nlohmann::json::parse(
        test::ran(loops_command, {.map = file, .revoke = 1, .json = true}).out);
    costs.push_back(json.at("changed").at("cost_before").get<double>());
  }
  EXPECT_GT(costs[0], 1.0);
  EXPECT_NEAR(costs[1], costs[0], 1e-3 * costs[0]);
}

TEST_F(LoopsCommand, WhatAReviewHasTakenBackComesInWithoutVotes) {
  {
    MapDatabase map(map_, MapAccess::write);
    std::vector<LoopCandidate> candidates = map.candidates();
    candidates.front().verdict = CandidateVerdict::revoked;
    candidates.front().reason = "review";
    candidates.front().figure = 35.2;
    const std::size_t edge = map.graph().edges().size() - 1;
    map.revise({.candidates = candidates, .statuses = {{edge, EdgeStatus::revoked}}});
  }
  const auto json = nlohmann::json::parse(
      test::ran(loops_command, {.map = map_, .restore = 1, .json = true}).out);
  EXPECT_TRUE(json.at("loops")[0].at("votes").is_null()) << json.at("loops")[0].dump();
}

TEST_F(LoopsCommand, SaysWhatCannotBeDone) {
  const Ran none = test::ran(loops_command, {.map = map_, .revoke = 7});
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("the map has no loop 7"), std::string::npos) << none.err;
  const Ran rejected = test::ran(loops_command, {.map = map_, .revoke = 2});
  EXPECT_EQ(rejected.code, 2);
  EXPECT_NE(rejected.err.find("loop 2 is rejected; only what is accepted can be revoked"),
            std::string::npos)
      << rejected.err;
  EXPECT_EQ(test::ran(loops_command, {.map = map_, .restore = 1}).code, 2) << "it is in";
  EXPECT_EQ(test::ran(loops_command, {.map = map_, .revoke = 1, .restore = 1}).code, 2);
  const Ran missing = test::ran(loops_command, {.map = folder_ / "none.adit", .revoke = 1});
  EXPECT_EQ(missing.code, 1);
  EXPECT_FALSE(fs::exists(folder_ / "none.adit")) << "nothing is made";
  const MapDatabase writer(map_, MapAccess::write);
  EXPECT_EQ(test::ran(loops_command, {.map = map_, .revoke = 1}).code, 1) << "another one writes";
  EXPECT_EQ(test::ran(loops_command, {.map = map_}).code, 0) << "a reader may";
}

TEST_F(LoopsCommand, WhatContradictsTheRestIsNotRestored) {
  PoseEdge wrong = test::edge(0, 4, test::step(20.0), 1.0);
  wrong.kind = EdgeKind::loop;
  wrong.status = EdgeStatus::revoked;
  LoopCandidate candidate;
  candidate.id = 3;
  candidate.to = 4;
  candidate.T_from_to = wrong.T_from_to;
  candidate.verdict = CandidateVerdict::revoked;
  candidate.reason = "review";
  MapDatabase(map_, MapAccess::write).revise({.edges = {wrong}, .candidates = {candidate}});
  const double before = x_of_last();
  const Ran restored = test::ran(loops_command, {.map = map_, .restore = 3});
  EXPECT_EQ(restored.code, 1);
  EXPECT_NE(restored.err.find("loop 3 contradicts the rest of the graph"), std::string::npos)
      << restored.err;
  EXPECT_EQ(x_of_last(), before);
}

TEST(LoopsCommandWithoutLoops, SaysThatThereAreNone) {
  const test::TemporaryFolder folder;
  { MapDatabase map(folder / "map.adit", MapAccess::write); }
  const Ran text = test::ran(loops_command, {.map = folder / "map.adit"});
  EXPECT_EQ(text.code, 0);
  EXPECT_NE(text.out.find("has no loops"), std::string::npos) << text.out;
}

}  // namespace
}  // namespace adit
