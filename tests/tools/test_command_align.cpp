// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_align.hpp"

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/recordings/cloud_pairs.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

using test::Ran;

/// What a lidar sees from three places in a street, as a KITTI folder.
class AlignCommand : public test::DeviceTest {
 protected:
  AlignCommand() {
    const test::World world = test::make_street(30.0);
    for (int i = 0; i < 3; ++i) {
      const Sweep sweep = test::scan(world, {.stamp = Nanoseconds(i + 1), .pose = place(i)},
                                     test::Lidar{.beams = 64});
      const auto* bytes = reinterpret_cast<const char*>(sweep.points.data());
      folder_.write("drive/velodyne/00000" + std::to_string(i) + ".bin",
                    std::string_view(bytes, sweep.points.size() * sizeof(Point)));
    }
  }

  static Eigen::Isometry3d place(int i) {
    Eigen::Isometry3d pose(Eigen::AngleAxisd(65.0 * kDegree * i, Eigen::Vector3d::UnitZ()));
    pose.translation() << 10.0 + 1.5 * i, 0.5 - 0.5 * i, 1.8;
    return pose;
  }
  /// Of sweep 2, seen from sweep 0.
  static Eigen::Isometry3d truth() { return place(0).inverse() * place(2); }
  static double metres_off(const nlohmann::json& pair) {
    const auto numbers = pair.at("T_a_b").get<std::array<double, 7>>();
    return (pose_of(numbers).inverse() * truth()).translation().norm();
  }

  Ran ran(AlignCommandOptions options) const {
    options.device.opened = &context();
    return test::ran(align_command, options);
  }
  std::string sweep(int number) const { return drive_.string() + "@" + std::to_string(number); }
  AlignCommandOptions of(const std::string& a, const std::string& b) const {
    AlignCommandOptions options;
    options.clouds = {a, b};
    return options;
  }
  void expect_refused(AlignCommandOptions options, int code, const std::string& part) const {
    const Ran answer = ran(std::move(options));
    EXPECT_EQ(answer.code, code) << answer.err;
    EXPECT_NE(answer.err.find("adit align: "), std::string::npos) << answer.err;
    EXPECT_NE(answer.err.find(part), std::string::npos) << "no '" << part << "' in: " << answer.err;
    EXPECT_EQ(answer.out, "");
  }

  test::TemporaryFolder folder_;
  fs::path drive_ = folder_ / "drive";
};

TEST_F(AlignCommand, ReportsThePoseFromNothingAsTextAndAsJson) {
  AlignCommandOptions options = of(sweep(0), sweep(2));
  options.picture = folder_ / "both.png";
  const Ran text = ran(options);
  EXPECT_EQ(text.code, 0) << text.err << text.out;
  for (const char* part : {"verdict  usable", "T_a_b    3.", "sigma    0.", "held     ",
                           "overlap  ", "search   from nothing", "look at  "}) {
    EXPECT_NE(text.out.find(part), std::string::npos) << part << " in:\n" << text.out;
  }
  EXPECT_EQ(test::content(*options.picture).substr(1, 3), "PNG");

  options.json = true;
  const Ran answer = ran(options);
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(answer.out, ran(options).out) << "the same input gives the same bytes";
  const auto json = nlohmann::json::parse(answer.out);
  EXPECT_EQ(json["method"], "VGICP");
  EXPECT_EQ(json["usable"], 1);
  const auto& pair = json["pairs"].at(0);
  EXPECT_EQ(pair["a"], sweep(0));
  EXPECT_EQ(pair["usable"], true);
  EXPECT_TRUE(pair["refusal"].is_null());
  EXPECT_TRUE(pair["guess"].is_null());
  EXPECT_LT(metres_off(pair), 0.05);
  EXPECT_EQ(pair["covariance"].size(), 6U);
  EXPECT_EQ(pair["translation"].size(), 3U);
  EXPECT_GT(pair["overlap"], 0.4);
}

TEST_F(AlignCommand, CloudsInLargeCoordinatesAreAlignedLessAnOffset) {
  const Eigen::Vector3d utm(430000.0, 5400000.0, 300.0);
  const auto far = [&](int number) {
    const Sweep local = read_cloud(sweep(number));
    std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                        std::to_string(local.points.size()) +
                        "\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
    for (const Point& p : local.points) {
      bytes += test::bytes_of_all(utm.x() + p.x, utm.y() + p.y, utm.z() + p.z);
    }
    return folder_.write("far" + std::to_string(number) + ".ply", bytes).string();
  };
  AlignCommandOptions options = of(far(0), far(2));
  options.json = true;
  const Ran answer = ran(options);
  EXPECT_EQ(answer.code, 0) << answer.err;
  const auto pair = nlohmann::json::parse(answer.out)["pairs"].at(0);
  const auto offset = pair.at("offset_a_m").get<std::array<double, 3>>();
  EXPECT_EQ(pair.at("offset_b_m").get<decltype(offset)>(), offset) << "both have a's";
  const Eigen::Vector3d off = Eigen::Vector3d(offset[0], offset[1], offset[2]) - utm;
  EXPECT_LT(off.norm(), 100.0);
  const auto numbers = pair.at("T_a_b").get<std::array<double, 7>>();
  const Eigen::Isometry3d T_a_b =
      Eigen::Translation3d(off) * pose_of(numbers) * Eigen::Translation3d(-off);
  EXPECT_LT((T_a_b.inverse() * truth()).translation().norm(), 0.05);
  options.json = false;
  EXPECT_NE(ran(options).out.find("m is subtracted from b's coordinates"), std::string::npos);
}

TEST_F(AlignCommand, NamesThatAreNoTextAreReported) {
  const fs::path plain = drive_;
  drive_ = folder_ / "dr\xe9";
  fs::rename(plain, drive_);
  AlignCommandOptions options = of(sweep(0), sweep(2));
  options.json = true;
  const Ran answer = ran(options);
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.out.find("dr\xef\xbf\xbd@2"), std::string::npos) << answer.out;
}

TEST_F(AlignCommand, TakesAGuessAsYawOrAsQuaternion) {
  for (const std::vector<double>& guess :
       {std::vector<double>{2.5, -0.7, 0.1, 120.0}, {2.5, -0.7, 0.1, 0.0, 0.0, 1.75, 1.0}}) {
    AlignCommandOptions options = of(sweep(0), sweep(2));
    options.guess = guess;
    options.json = true;
    const Ran answer = ran(options);
    EXPECT_EQ(answer.code, 0) << answer.out;
    const auto pair = nlohmann::json::parse(answer.out)["pairs"].at(0);
    EXPECT_EQ(pair["starts"], 1);
    EXPECT_LT(metres_off(pair), 0.05);
    EXPECT_EQ(pair["guess"][0], 2.5);
  }
}

TEST_F(AlignCommand, AListGoesOnBehindWhatCannotBeReadOrUsed) {
  folder_.write("empty.bin", "");
  const std::string a = sweep(0);
  AlignCommandOptions options;
  options.pairs = folder_.write("pairs.txt", a + " " + sweep(1) + "\n" + a + " empty.bin\n" + a +
                                                 " missing.pcd\n" + a + " " + sweep(2) +
                                                 " 300 0 0 0\n" + a + " " + sweep(2) + "\n");
  const Ran text = ran(options);
  EXPECT_EQ(text.code, 1) << text.err;
  EXPECT_NE(text.out.find("5 pairs, 2 usable"), std::string::npos) << text.out;
  options.json = true;
  const auto json = nlohmann::json::parse(ran(options).out);
  const auto& pairs = json["pairs"];
  ASSERT_EQ(pairs.size(), 5U);
  EXPECT_EQ(pairs[0]["usable"], true);
  EXPECT_EQ(pairs[1]["refusal"], "unreadable");
  EXPECT_NE(pairs[1]["reason"].get<std::string>().find("empty.bin"), std::string::npos);
  EXPECT_EQ(pairs[2]["refusal"], "unreadable");
  EXPECT_EQ(pairs[3]["refusal"], "too_little_overlap");
  EXPECT_EQ(pairs[4]["usable"], true);
}

TEST_F(AlignCommand, AGuessThatLeadsNowhereIsRefusedWithTheReason) {
  AlignCommandOptions options = of(sweep(0), sweep(1));
  options.guess = {300.0, 0.0, 0.0, 0.0};
  const Ran answer = ran(options);
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.out.find("refused: too little overlap: 0 % of b's points lie on a"),
            std::string::npos)
      << answer.out;
  EXPECT_EQ(answer.out.find("T_a_b"), std::string::npos) << answer.out;
  EXPECT_EQ(answer.out.find("nan"), std::string::npos) << answer.out;
}

TEST_F(AlignCommand, WrongArgumentsAreUsageErrors) {
  expect_refused({}, 2, "name two clouds");
  AlignCommandOptions options;
  options.clouds = {sweep(0)};
  expect_refused(options, 2, "name two clouds");
  options = of(sweep(0), sweep(1));
  options.pairs = folder_ / "pairs.txt";
  expect_refused(options, 2, "name two clouds");
  options = of(sweep(0), sweep(1));
  options.guess = {1.0, 2.0, 3.0, 4.0, 5.0};
  expect_refused(options, 2, "--guess takes X Y Z YAW");
  options.guess = {1.0, 2.0, std::nan(""), 4.0};
  expect_refused(options, 2, "--guess takes X Y Z YAW");
  options = of(sweep(0), sweep(1));
  options.picture = folder_ / "both.jpg";
  expect_refused(options, 2, "name it *.png");  // also where no command line was read
}

TEST_F(AlignCommand, CloudsThatCannotBeReadAreErrors) {
  expect_refused(of((folder_ / "missing.pcd").string(), sweep(1)), 1, "missing.pcd");
  expect_refused(of(sweep(0), sweep(99)), 1, "no sweep number 99");
  const fs::path empty = folder_.write("empty.bin", "");
  expect_refused(of(sweep(0), empty.string()), 1, "no points");
  const fs::path damaged = folder_.write("damaged.pcd", "# .PCD v0.7\nFIELDS x y\nPOINTS -1\n");
  expect_refused(of(damaged.string(), sweep(0)), 1, "damaged.pcd");
  AlignCommandOptions options = of(sweep(0), sweep(1));
  options.picture = folder_ / "missing" / "both.png";
  const Ran answer = ran(options);
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.err.find("both.png"), std::string::npos) << answer.err;
}

}  // namespace
}  // namespace adit
