// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/benchmarks/command_bench.hpp"
#include "adit/benchmarks/command_bench_slam.hpp"
#include "adit/benchmarks/slam/slam_families.hpp"
#include "adit/benchmarks/slam/slam_report.hpp"
#include "adit/benchmarks/slam/slam_run.hpp"
#include "adit/benchmarks/slam/slam_sequences.hpp"
#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/program.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/simulator/range_sensor.hpp"
#include "adit/tools/simulator/scene.hpp"

namespace adit::bench {
namespace {

namespace fs = std::filesystem;

const SlamEntry kTiny{.name = "tiny",
                      .scene = "room",
                      .sensor = "VLP-16",
                      .trajectory = "drive",
                      .duration = 4.0,
                      .begin = 2.0};

/// The truth as another system would give it: in a frame of its own, and `scale` times as long.
void write_estimate(const fs::path& file, const fs::path& truth, double scale) {
  fs::create_directories(file.parent_path());
  std::vector<StampedPose> poses = read_trajectory(truth).poses;
  const Eigen::Isometry3d T_any_world(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()));
  for (StampedPose& pose : poses) {
    pose.pose.translation() *= scale;
    pose.pose = T_any_world * pose.pose;
  }
  write_trajectory(file, TrajectoryFormat::tum, poses);
}

TEST(SlamCatalogue, NamesWhatTheSimulatorKnows) {
  std::set<std::string> names;
  std::set<std::string> scenes;
  std::set<std::string> sensors;
  std::size_t quick = 0;
  for (const SlamEntry& entry : slam_catalogue()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_NO_THROW(motion_named(entry.trajectory)) << entry.name;
    EXPECT_NO_THROW(range_sensor_named(entry.sensor)) << entry.name;
    scenes.insert(entry.scene);
    sensors.insert(entry.sensor);
    quick += entry.quick ? 1U : 0U;
  }
  EXPECT_GE(names.size(), 10U);
  const std::vector<std::string> known = scene_names();
  EXPECT_EQ(scenes, std::set<std::string>(known.begin(), known.end()));
  EXPECT_GE(sensors.size(), 5U);
  EXPECT_GE(quick, 2U);
}

TEST(BenchSlam, SimulatesOnceMapsAndJudges) {
  const test::TemporaryFolder folder;
  std::size_t simulated = 0;
  const auto count = [&](std::size_t, std::size_t) { ++simulated; };
  const SlamSequence sequence = simulated_sequence(kTiny, folder.path(), count);
  EXPECT_EQ(simulated, 40U);
  EXPECT_EQ(simulated_sequence(kTiny, folder.path(), count).recording, sequence.recording);
  EXPECT_EQ(simulated, 40U) << "it is there already";
  const SlamResult good =
      judged(map_sequence(sequence, {}, {}, folder.path() / "run"), SlamLimits{});
  EXPECT_EQ(good.verdict, SlamVerdict::good) << good.why;
  ASSERT_TRUE(good.effort);
  EXPECT_EQ(good.effort->sweeps, 40U);
  EXPECT_EQ(good.effort->placed, 40U);
  EXPECT_GT(good.effort->ms_a_sweep, 0.0);
  ASSERT_TRUE(good.errors);
  EXPECT_LT(good.errors->ate, 0.05);
  EXPECT_GT(good.errors->path, 1.0);
  EXPECT_FALSE(good.errors->drift) << "too short for a stretch of 10 m";

  // A setting that leaves no points: each sweep is lost, and that is said.
  SlamVariant blind{.name = "blind", .config = {}};
  blind.config.overrides = {"preprocess.c_max=0.6"};
  const SlamResult bad =
      judged(map_sequence(sequence, blind, {}, folder.path() / "blind"), SlamLimits{});
  EXPECT_EQ(bad.verdict, SlamVerdict::failed);
  EXPECT_NE(bad.why.find("not one sweep could be aligned"), std::string::npos) << bad.why;

  SlamSequence by_lidar = sequence;
  by_lidar.settings = {"imu.use=false"};
  SlamVariant fused{.name = "imu", .config = {}};
  fused.config.overrides = {"imu.use=true"};
  map_sequence(by_lidar, fused, {}, folder.path() / "imu");
  EXPECT_EQ(test::json_of(folder / "imu/summary.json")["configuration"]["imu"]["use"], true)
      << "a variant has the last word";

  SlamEntry other = kTiny;
  other.seed = 2;
  simulated_sequence(other, folder.path(), count);
  EXPECT_EQ(simulated, 80U) << "another seed is another recording";
}

TEST(BenchSlam, PutsRecordingsOfTheUserBesideOtherSystems) {
  const test::TemporaryFolder folder;
  const SlamSequence made = simulated_sequence(kTiny, folder / "data", {});
  write_estimate(folder / "others/true/tiny.tum", made.truth, 1.0);
  write_estimate(folder / "others/wrong/tiny.tum", made.truth, 2.0);
  folder.write("others/absent/another.tum", "");
  folder.write("others/broken/tiny.tum", "not a pose\n");
  const test::Ran outcome =
      test::ran(bench_slam_command, {.recordings = folder / "data",
                                     .trajectories = folder / "others",
                                     .variants = {"coarse:preprocess.r_input=0.5"},
                                     .output = folder / "out",
                                     .json = folder / "a.json",
                                     .html = folder / "a.html"});
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  const nlohmann::json report = test::json_of(folder / "a.json");
  ASSERT_EQ(report.at("sequences").size(), 1U);
  EXPECT_EQ(report.at("sequences")[0].at("name"), "tiny");
  const auto& results = report.at("sequences")[0].at("results");
  const std::array<std::pair<const char*, const char*>, 6> expected{{{"adit", "good"},
                                                                     {"coarse", "good"},
                                                                     {"absent", "missing"},
                                                                     {"broken", "failed"},
                                                                     {"true", "good"},
                                                                     {"wrong", "failed"}}};
  ASSERT_EQ(results.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(results[i].at("system"), expected[i].first);
    EXPECT_EQ(results[i].at("verdict"), expected[i].second) << results[i].dump();
  }
  EXPECT_NE(results[0].at("errors").at("ate_rmse_m"), results[1].at("errors").at("ate_rmse_m"));
  EXPECT_LT(results[4].at("errors").at("ate_rmse_m"), 1e-6);
  EXPECT_TRUE(results[2].at("errors").is_null());
  EXPECT_NE(results[5].at("why").get<std::string>().find("% of the path"), std::string::npos);
  EXPECT_NE(outcome.out.find("*0.000"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("FAILED: " + (folder / "others/broken/tiny.tum").string()),
            std::string::npos)
      << outcome.out;
  const std::string page = test::content(folder / "a.html");
  EXPECT_NE(page.find("<summary>tiny, wrong</summary>"), std::string::npos);
  EXPECT_EQ(page.find("<?xml"), std::string::npos) << "drawings are inside of the page";
}

TEST(BenchSlam, FailsByErrorLossOrCoverage) {
  const SlamResult good{.errors = SlamErrors{.ate = 0.5, .path = 100.0, .covered = 99.0},
                        .effort = SlamEffort{.sweeps = 100, .placed = 95}};
  EXPECT_EQ(judged(good, {}).verdict, SlamVerdict::good);
  SlamResult bad = good;
  bad.errors->ate = 1.2;
  EXPECT_EQ(judged(bad, {}).why, "an error of 1.20 m, 1.2 % of the path");
  bad.errors = SlamErrors{.ate = 0.09, .path = 2.0, .covered = 2.0};
  EXPECT_EQ(judged(bad, {}).verdict, SlamVerdict::good) << "centimetres are no failure";
  bad = good;
  bad.effort->placed = 80;
  EXPECT_EQ(judged(bad, {}).why, "20 of 100 sweeps could not be placed");
  bad = good;
  bad.errors->covered = 60.0;
  EXPECT_EQ(judged(bad, {}).why, "it covers 60.0 of 100.0 m");
  EXPECT_EQ(judged(bad, {}).verdict, SlamVerdict::failed);
  EXPECT_EQ(judged({}, {}).verdict, SlamVerdict::missing);
}

TEST(BenchSlam, MeansAreOverWhatEverySystemMastered) {
  const auto result = [](SlamVerdict verdict, double ate) {
    return SlamResult{.verdict = verdict, .errors = SlamErrors{.ate = ate}};
  };
  SlamReport report;
  report.systems = {{.name = "a"}, {.name = "b"}};
  report.rows = {{.results = {result(SlamVerdict::good, 1.0), result(SlamVerdict::good, 0.5)}},
                 {.results = {result(SlamVerdict::good, 7.0), result(SlamVerdict::failed, 0.1)}},
                 {.results = {result(SlamVerdict::good, 2.0), result(SlamVerdict::good, 4.0)}}};
  const SlamTotals totals = totals_of(report);
  EXPECT_EQ(totals.mastered_by_all, 2U);
  EXPECT_EQ(totals.failures, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(totals.mean_ate, (std::vector<double>{1.5, 2.25}));
  EXPECT_EQ(best_of(report.rows[0]), 1U);
  EXPECT_EQ(best_of(report.rows[1]), 0U);
}

/// A run of a family with its error (m; none: no trajectory) on 100 m and what it said of itself.
SlamRow row_of(const std::string& family, std::optional<double> error, const std::string& trust) {
  SlamResult result{.trust = trust};
  if (error) {
    result.errors = SlamErrors{.ate = *error, .path = 100.0, .covered = 100.0};
    result = judged(result, {});
  } else {
    result.verdict = SlamVerdict::failed;
  }
  return {.sequence = family + "@1", .family = family, .results = {result}};
}

TEST(BenchSlam, FamiliesAreSummedUpByMedianWorstAndFailures) {
  SlamReport report{.systems = {{.name = "adit"}}};
  report.rows = {row_of("mine", 0.3, "reliable"), row_of("field", 0.2, "reliable"),
                 row_of("mine", 0.1, "reliable"), row_of("mine", 5.0, "lost"),
                 row_of("field", std::nullopt, "doubtful")};
  const std::vector<SlamFamily> families = families_of(report);
  ASSERT_EQ(families.size(), 2U);
  EXPECT_EQ(families[0].name, "mine");
  const SlamSpread& mine = families[0].systems[0];
  EXPECT_EQ(mine.runs, 3U);
  EXPECT_EQ(mine.failed, 1U);
  EXPECT_DOUBLE_EQ(mine.median, 0.3);
  EXPECT_DOUBLE_EQ(mine.worst, 5.0);
  EXPECT_DOUBLE_EQ(mine.path, 100.0);
  EXPECT_TRUE(std::isinf(families[1].systems[0].worst)) << "one has no trajectory";
  const SlamConfusion confusion = confusion_of(report, 0);
  EXPECT_EQ(confusion.counts[0][0], 3U) << "within the limits and reliable";
  EXPECT_EQ(confusion.counts[1][1], 1U);
  EXPECT_EQ(confusion.counts[1][2], 1U);
  std::ostringstream text;
  print_families(report, text);
  EXPECT_NE(text.str().find("1 of 3"), std::string::npos) << text.str();
}

TEST(SlamCatalogue, ASeedIsAnotherWorldAndAnotherBeginning) {
  const SlamEntry entry = slam_catalogue().front();
  const SlamEntry second = with_seed(entry, 2);
  const SlamEntry third = with_seed(entry, 3);
  EXPECT_EQ(second.name, entry.name + "@2");
  EXPECT_EQ(second.seed, 2U);
  EXPECT_EQ(third.begin - second.begin, kBetweenBeginnings);
  EXPECT_EQ(with_seed(entry, 3, 120.0).begin - with_seed(entry, 2, 120.0).begin, 120.0);
}

TEST(BenchSlam, RefusesWhatMakesNoSense) {
  const test::TemporaryFolder folder;
  const auto refused = [&](BenchSlamOptions options, int code, const std::string& part) {
    options.output = folder / "out";
    const test::Ran outcome = test::ran(bench_slam_command, options);
    EXPECT_EQ(outcome.code, code) << outcome.out;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "out"));
  };
  refused({.only = {"mine-vlp16-driev"}}, 2, "'mine-vlp16-drive'");
  refused({.variants = {"preprocess.deskew=2"}}, 2, "must be NAME:section.key=value");
  refused({.variants = {"a:preprocess.deskwe=2"}}, 2, "'preprocess.deskew'");
  refused({.trajectories = folder / "none"}, 1, "it is no folder");
  refused({.recordings = folder.path()}, 1, "no recording with its truth");
  refused({.quick = true, .recordings = folder.path()}, 2, "leave one of them out");
  refused({.apart = 10.0, .recordings = folder.path()}, 2, "leave one of them out");
}

TEST(BenchSlam, TheFolderOfRecordingsMayBeADot) {
  const test::TemporaryFolder folder;
  folder.write("drive/truth.tum", "");
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  const std::vector<SlamSequence> found = recorded_sequences(".");
  fs::current_path(before);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].name, "drive");
}

TEST(BenchSlam, IsACommandOfItsOwn) {
  const std::array<AddCommand, 1> more = {add_bench_command};
  const auto call = [&](std::vector<const char*> words) {
    words.insert(words.begin(), {"adit", "bench", "slam"});
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = program(static_cast<int>(words.size()), words.data(), more);
    const std::string out = testing::internal::GetCapturedStdout();
    return test::Ran{code, out, testing::internal::GetCapturedStderr()};
  };
  const test::Ran list = call({"--list", "--only", "mine", "city"});
  EXPECT_EQ(list.code, 0) << list.err;
  EXPECT_NE(list.out.find("mine-vlp16-drive"), std::string::npos) << list.out;
  EXPECT_EQ(list.out.find("room"), std::string::npos) << list.out;
  EXPECT_EQ(list.out.find("downsample"), std::string::npos) << "cases of `adit bench`";
  const test::Ran seed = call({"--list", "--only", "mine", "--first-seed", "801"});
  EXPECT_NE(seed.out.find("mine-vlp16-drive@801"), std::string::npos) << seed.out;
  for (const char* wrong : {"-1", "0", "1001", "nan"}) {
    EXPECT_NE(call({"--list", "--seeds", wrong}).err.find("from 1 to 1000"), std::string::npos);
  }
  EXPECT_EQ(call({"--list", "--apart", "nan"}).code, 2);
  const test::Ran unknown = call({"--quik"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.err.find("adit bench slam: there is no option '--quik'. The nearest valid name "
                             "is '--quick'"),
            std::string::npos)
      << unknown.err;
}

}  // namespace
}  // namespace adit::bench
