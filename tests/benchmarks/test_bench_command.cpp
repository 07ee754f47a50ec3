// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <fstream>
#include <initializer_list>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/benchmarks/command_bench.hpp"
#include "adit/benchmarks/kernels/cases.hpp"
#include "adit/benchmarks/kernels/report.hpp"
#include "adit/benchmarks/verify/cases.hpp"
#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/commands/program.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit::bench {
namespace {

TEST(BenchCases, HaveNamesOfTheirOwnAndPeersThatExistOrAreLibraries) {
  const std::vector<Case> cases = all_cases();
  std::set<std::string> names;
  for (const Case& one : cases) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    if (!one.peer.empty() && !one.peer.starts_with("pcl/")) {
      EXPECT_NE(find_case(cases, one.peer), nullptr) << one.peer;
    }
  }
}

// Every case of the list is verified before it is timed: this runs the verifications.
TEST(BenchCommand, EveryCaseIsRightOnASmallSweep) {
  const test::TemporaryFolder folder;
  const test::Ran outcome = test::ran(bench_command, {.sizes = {20'000},
                                                      .batches = {3},
                                                      .seconds = 0.0,
                                                      .json = folder.path() / "a.json",
                                                      .html = folder.path() / "a.html"});
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_EQ(outcome.out.find("WRONG"), std::string::npos) << outcome.out;
  const Report report = read_report(folder.path() / "a.json");
  EXPECT_EQ(report.rows.size(), all_cases().size());
  for (const Row& row : report.rows) {
    EXPECT_TRUE(row.problem.empty()) << row.name << ": " << row.problem;
    EXPECT_FALSE(row.verified_by.empty()) << row.name;
    EXPECT_GT(row.items, 0U) << row.name;
    EXPECT_GE(row.timing.runs, 5) << row.name;
    EXPECT_GT(row.timing.best().median, 0.0) << row.name;
    EXPECT_EQ(row.timing.device.has_value(),
              row.kind == CaseKind::kernel || row.name == "sweep/odometry")
        << row.name;
  }
  EXPECT_GT(report.limits.copy_bytes, 0.0);
  EXPECT_GT(report.limits.flop, 0.0);
  EXPECT_GT(report.limits.near_reads, 0.0);
  EXPECT_GT(report.limits.atomics, 0.0);
  EXPECT_GT(report.limits.submission_s, 0.0);
}

TEST(BenchCommand, AReportIsThatOfJsonWithTheDevice) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "report.json";
  const test::Ran outcome = test::ran(
      bench_command, {.cases = {"deskew"}, .sizes = {5000}, .seconds = 0.0, .report = file});
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find(file.string()), std::string::npos);
  EXPECT_EQ(read_report(file).rows.size(), 1U) << "for --compare";
  std::ifstream in(file);
  const auto json = nlohmann::json::parse(in);
  EXPECT_EQ(json.at("device").at("verdict"), "usable");
  EXPECT_GT(json.at("device").at("self_test").size(), 10U);
  EXPECT_GT(json.at("self_test_s"), 0.0);
  const auto& compiled = json.at("compiled");
  EXPECT_TRUE(compiled.contains("problem") || compiled.at("kernels").size() > 10U) << compiled;
}

TEST(BenchCommand, TakesACloudOfTheUser) {
  const test::TemporaryFolder folder;
  std::string bytes;
  const std::vector<Point> points = test::street_sweep(20'000).raw;
  for (const Point& p : points) {
    bytes += test::bytes_of_all(p.x, p.y, p.z, p.intensity);
  }
  write_text_file(folder.path() / "a.pcd", test::pcd_header(points.size(), "binary") + bytes);
  const test::Ran outcome =
      test::ran(bench_command, {.cases = {"downsample", "linearize/vgicp-7", "align/vgicp"},
                                .seconds = 0.0,
                                .input = {folder.path() / "a.pcd"},
                                .json = folder.path() / "a.json"});
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  const Report report = read_report(folder.path() / "a.json");
  ASSERT_EQ(report.rows.size(), 4U) << outcome.out;
  EXPECT_EQ(report.setting.input, "a.pcd");
  EXPECT_EQ(report.rows.front().size, static_cast<int>(points.size()));
  EXPECT_LT(report.rows.back().figures.at("error mm"), 5.0);
}

TEST(BenchCommand, RefusesWhatIsNotThere) {
  const test::Ran unknown = test::ran(bench_command, {.cases = {"linearise"}});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.err.find("there is no case 'linearise'"), std::string::npos) << unknown.err;
  const test::Ran missing =
      test::ran(bench_command, {.cases = {"surfaces"}, .input = {"/no/such/cloud.pcd"}});
  EXPECT_EQ(missing.code, 1);
  EXPECT_NE(missing.err.find("/no/such/cloud.pcd"), std::string::npos) << missing.err;
  const test::Ran report =
      test::ran(bench_command, {.compare = {"/no/such/a.json", "/no/such/b.json"}});
  EXPECT_EQ(report.code, 1);
  EXPECT_NE(report.err.find("/no/such/a.json"), std::string::npos) << report.err;
}

TEST(BenchCommand, RefusesOptionsThatWouldHaveNoEffect) {
  const std::array<AddCommand, 1> more = {add_bench_command};
  struct Refused {
    std::vector<const char*> words;
    const char* part;
  };
  for (Refused one : std::initializer_list<Refused>{
           {{"--device", "nonsense", "--json", "a.json", "slam", "--list"}, "stands before slam"},
           {{"--list", "consistency", "--runs", "1"}, "--list: stands before consistency"},
           {{"--seeds", "2", "slam", "--list"}, "--seeds: stands before slam"},
           {{"--compare", "a.json", "b.json", "--html", "c.html"}, "--html: is of no use with"},
           {{"--compile", "NAVI21", "--html", "c.html"}, "--html: is of no use with --compile"},
           {{"--r-input", "0.5"}, "--r-input: needs --input"},
           {{"--sizes", "5000", "--input", "a.pcd"}, "--sizes: is of simulated sweeps"}}) {
    one.words.insert(one.words.begin(), {"adit", "bench"});
    testing::internal::CaptureStderr();
    EXPECT_EQ(program(static_cast<int>(one.words.size()), one.words.data(), more), 2) << one.part;
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find(one.part), std::string::npos) << said;
  }
  const test::Ran nothing =
      test::ran(bench_command, {.cases = {"sweep/odometry"}, .sizes = {5000}, .seconds = 0.0});
  EXPECT_EQ(nothing.code, 2);
  EXPECT_NE(nothing.err.find("sweep/odometry takes 20000 to"), std::string::npos) << nothing.err;
}

TEST(BenchCommand, ListsWithoutADevice) {
  const test::Ran outcome = test::ran(bench_command, {.cases = {"align"}, .list = true});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out.find("linearize"), std::string::npos);
  EXPECT_NE(outcome.out.find("align/ndt  (registration)"), std::string::npos) << outcome.out;
}

}  // namespace
}  // namespace adit::bench
