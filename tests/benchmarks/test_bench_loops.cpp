// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/benchmarks/command_bench_slam.hpp"
#include "adit/benchmarks/slam/slam_loops_report.hpp"
#include "adit/benchmarks/slam/slam_sequences.hpp"
#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_evaluate.hpp"
#include "adit/tools/evaluation/loop_table.hpp"
#include "adit/tools/evaluation/true_keyframes.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/simulator/range_sensor.hpp"
#include "adit/tools/simulator/scene.hpp"

namespace adit::bench {
namespace {

namespace fs = std::filesystem;

/// Once round the room and half round again.
const SlamEntry kRound{.name = "round",
                       .scene = "room",
                       .sensor = "VLP-16",
                       .trajectory = "drive",
                       .duration = 16.0,
                       .seed = 501,
                       .speed = 2.0};

TEST(LoopCatalogue, NamesWhatTheSimulatorKnowsAndSharesRecordings) {
  const std::vector<SlamEntry> catalogue = loop_catalogue();
  std::set<std::string> names;
  std::set<std::string> scenes;
  std::size_t quick = 0;
  std::size_t shared = 0;
  const std::vector<std::string> known = scene_names();
  for (const SlamEntry& entry : catalogue) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_NO_THROW(motion_named(entry.trajectory)) << entry.name;
    EXPECT_NO_THROW(range_sensor_named(entry.sensor)) << entry.name;
    EXPECT_EQ(std::ranges::count(known, entry.scene), 1) << entry.name;
    scenes.insert(entry.scene);
    quick += entry.quick ? 1U : 0U;
    if (!entry.recording.empty()) {
      ++shared;
      const auto other = std::ranges::find(catalogue, entry.recording, &SlamEntry::name);
      ASSERT_NE(other, catalogue.end()) << entry.name;
      EXPECT_EQ(entry.scene + entry.sensor + entry.trajectory,
                other->scene + other->sensor + other->trajectory);
      EXPECT_EQ(std::pair(entry.duration, entry.seed), std::pair(other->duration, other->seed));
      EXPECT_FALSE(entry.settings.empty()) << "or it is the same sequence";
      EXPECT_EQ(with_seed(entry, 502).recording, with_seed(*other, 502).name);
    }
  }
  EXPECT_EQ(scenes, (std::set<std::string>{"city", "equal_houses", "forest", "mine", "office",
                                           "repeated_wing", "ring_tunnel"}));
  EXPECT_EQ(quick, 1U);
  EXPECT_EQ(shared, 7U);
}

/// A system that closes one loop rightly and one 2 m off: the truth where it has corrected, 1.1
/// times as long where it has not.
void write_system(const fs::path& folder, const SlamSequence& sequence) {
  fs::create_directories(folder);
  const Trajectory truth = truth_of(sequence);
  write_trajectory(folder / "round.tum", TrajectoryFormat::tum, truth.poses);
  std::vector<StampedPose> drifted = truth.poses;
  for (StampedPose& pose : drifted) {
    pose.pose.translation() *= 1.1;
  }
  write_trajectory(folder / "round.odometry.tum", TrajectoryFormat::tum, drifted);
  std::ofstream table(folder / "round.loops.csv");
  table.precision(18);
  table << "time_a_s,time_b_s,x,y,z,qx,qy,qz,qw\n";
  const TrueLoop pair = read_true_loops(*sequence.loops).front();
  for (const double off : {0.0, 2.0}) {
    const Eigen::Isometry3d T_a_b =
        pose_at(truth, pair.earlier)->inverse() * *pose_at(truth, pair.later);
    const Eigen::Quaterniond q(T_a_b.linear());
    const Eigen::Vector3d t = T_a_b.translation();
    table << seconds(pair.earlier) << "," << seconds(pair.later) << "," << t.x() + off << ","
          << t.y() << "," << t.z() << "," << q.x() << "," << q.y() << "," << q.z() << "," << q.w()
          << "\n";
  }
}

TEST(BenchLoops, CountsWhatEvaluateCounts) {
  const test::TemporaryFolder folder;
  const SlamSequence sequence = simulated_sequence(kRound, folder / "data", {});
  ASSERT_TRUE(sequence.loops);
  write_system(folder / "others/closer", sequence);
  const test::Ran outcome = test::ran(bench_slam_command, {.loops = true,
                                                           .recordings = folder / "data",
                                                           .trajectories = folder / "others",
                                                           .variants = {"open:mapping.loops=false"},
                                                           .output = folder / "out",
                                                           .json = folder / "a.json",
                                                           .html = folder / "a.html"});
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  const nlohmann::json report = test::json_of(folder / "a.json");
  const auto& results = report.at("sequences")[0].at("results");
  ASSERT_EQ(results.size(), 3U);
  const auto& ours = results[0].at("loops");
  EXPECT_GE(ours.at("accepted"), 3);
  EXPECT_EQ(ours.at("false"), 0);
  EXPECT_EQ(ours.at("revisits"), 1);
  EXPECT_EQ(ours.at("found"), 1);
  EXPECT_EQ(ours.at("recall_percent"), 100.0);
  EXPECT_LT(ours.at("span_path_m"), ours.at("path_m"));
  EXPECT_GT(ours.at("span_path_m"), 15.0) << "the room's route has 22 m";
  EXPECT_GT(ours.at("candidates_per_s"), 0.0);
  EXPECT_GT(ours.at("keyframe_ms"), 0.0);
  EXPECT_GT(ours.at("longest_wait_s"), 0.0);
  double ends = ours.at("accepted");
  for (const auto& [reason, count] : ours.at("removed").items()) {
    ends += count.get<double>();
  }
  EXPECT_EQ(ends, ours.at("offered")) << "each candidate is accepted or removed by something";

  const test::Ran evaluated =
      test::ran(evaluate_command, {.estimates = {folder / "out/runs/adit/round"},
                                   .truth = sequence.truth,
                                   .json = true,
                                   .loops = sequence.loops});
  ASSERT_EQ(evaluated.code, 0) << evaluated.err;
  const auto loops = nlohmann::json::parse(evaluated.out).at("loops");
  for (const char* key : {"accepted", "false", "offered", "ate_odometry_m", "ate_map_m"}) {
    EXPECT_EQ(ours.at(key), loops.at(key)) << key;
  }
  EXPECT_EQ(ours.at("removed"), loops.at("removed"));
  EXPECT_EQ(ours.at("span_ate_map_m"), loops.at("span").at("ate_map_m"));
  EXPECT_EQ(ours.at("span_ate_odometry_m"), loops.at("span").at("ate_odometry_m"));
  EXPECT_EQ(ours.at("span_path_m"), loops.at("span").at("path_m"));

  const auto& open = results[1].at("loops");
  EXPECT_EQ(open.at("accepted"), 0);
  EXPECT_EQ(open.at("found"), 0);
  EXPECT_TRUE(open.at("span_ate_map_m").is_null());
  EXPECT_TRUE(open.at("span_path_m").is_null());
  EXPECT_TRUE(open.at("candidates_per_s").is_null());

  const auto& closer = results[2].at("loops");
  EXPECT_EQ(closer.at("accepted"), 2);
  EXPECT_EQ(closer.at("false"), 1);
  EXPECT_TRUE(closer.at("recall_percent").is_null());
  EXPECT_LT(closer.at("ate_map_m"), 1e-6);
  EXPECT_GT(closer.at("ate_odometry_m"), 0.1);
  EXPECT_LT(closer.at("span_ate_map_m"), 1e-6);

  EXPECT_NE(outcome.out.find("recall %"), std::string::npos) << outcome.out;
  EXPECT_NE(test::content(folder / "a.html").find("<h2>Loops</h2>"), std::string::npos);
}

TEST(BenchLoops, WithoutItNoMapIsMade) {
  const test::TemporaryFolder folder;
  SlamEntry tiny = kRound;
  tiny.duration = 3.0;
  simulated_sequence(tiny, folder / "data", {});
  const test::Ran outcome = test::ran(
      bench_slam_command,
      {.recordings = folder / "data", .output = folder / "out", .json = folder / "a.json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_FALSE(fs::exists(folder / "out/runs/adit/round/map.adit"));
  const nlohmann::json report = test::json_of(folder / "a.json");
  EXPECT_TRUE(report.at("sequences")[0].at("results")[0].at("loops").is_null());
  EXPECT_TRUE(report.at("loop_families").empty());
}

/// Of a sequence of a family: so many loops, so many false, and an error of the map (m).
SlamRow row_of(const std::string& family, std::size_t accepted, std::size_t false_ones,
               double error) {
  return {.sequence = family + "@1",
          .family = family,
          .results = {{.verdict = SlamVerdict::good,
                       .errors = SlamErrors{.ate = error, .path = 100.0},
                       .loops = SlamLoops{.accepted = accepted, .false_ones = false_ones}}}};
}

TEST(BenchLoops, SeedsAreSummedUpByMedianAndWorst) {
  SlamReport report{.systems = {{.name = "adit"}}};
  report.rows = {row_of("mine", 30, 0, 0.2), row_of("mine", 10, 4, 0.1),
                 row_of("office", 5, 0, 0.4), row_of("mine", 20, 1, 0.3)};
  report.rows.push_back(
      {.sequence = "mine@4", .family = "mine", .results = {{.verdict = SlamVerdict::failed}}});
  const std::vector<LoopSpread> spreads = loop_spreads(report);
  ASSERT_EQ(spreads.size(), 2U);
  EXPECT_EQ(spreads[0].family, "mine");
  EXPECT_EQ(spreads[0].runs, 4U);
  EXPECT_EQ(spreads[0].counted, 3U) << "one has no trajectory";
  const auto at = [&](std::string_view key) {
    return static_cast<std::size_t>(std::ranges::find(loop_columns(), key, &LoopColumn::key) -
                                    loop_columns().begin());
  };
  EXPECT_EQ(spreads[0].median[at("accepted")], 20.0);
  EXPECT_EQ(spreads[0].worst[at("accepted")], 10.0) << "few loops are worse";
  EXPECT_EQ(spreads[0].worst[at("false")], 4.0);
  EXPECT_EQ(spreads[0].median[at("ate_map_m")], 0.2);
  EXPECT_EQ(spreads[0].worst[at("ate_map_m")], 0.3);
  EXPECT_EQ(spreads[0].worst[at("path_m")], std::nullopt) << "no path is worse than another";
  EXPECT_EQ(spreads[0].median[at("candidates_per_s")], std::nullopt);
  std::ostringstream text;
  print_loop_spreads(report, text);
  EXPECT_NE(text.str().find("median of 3 of 4"), std::string::npos) << text.str();
  EXPECT_EQ(text.str().find("office"), std::string::npos)
      << "of one run there is nothing to sum up";
  EXPECT_EQ(loop_spreads_to_json(report)[0].at("worst").at("accepted"), 10.0);
}

TEST(BenchLoops, HasACatalogueOfItsOwn) {
  const auto listed = [](bool loops, bool quick) {
    return test::ran(bench_slam_command, {.quick = quick, .list = true, .loops = loops}).out;
  };
  EXPECT_NE(listed(true, false).find("city-vlp16-reverse"), std::string::npos);
  EXPECT_NE(listed(true, false).find("imu.use=false"), std::string::npos);
  EXPECT_EQ(listed(false, false).find("city-vlp16-reverse"), std::string::npos);
  EXPECT_EQ(test::count(listed(true, true), "\n"), 1U) << "one is quick";
}

}  // namespace
}  // namespace adit::bench
