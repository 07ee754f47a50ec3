// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit export --find-moving`: what one submap saw and the others saw through.
#include <algorithm>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/map_database/map_database.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::Ran;
using test::ran;

/// A wall 12 m in front of five keyframes; before the middle one something stands in between.
class MovingProducts : public testing::Test {
 protected:
  MovingProducts() {
    MapDatabase map(map_, MapAccess::write);
    const SessionId session = map.add_session({.name = "wall"});
    for (NodeId id = 0; id < 5; ++id) {
      KeyframeSubmap submap;
      submap.r_submap = 0.25;
      submap.vertical = Vertical::gravity;
      submap.sweeps = {{.stamp = std::chrono::seconds(id), .merged = true}};
      add_plane(submap, 12.0, 8.0, 3.0);
      wall_ += submap.points.size();
      if (id == 2) {
        const std::size_t before = submap.points.size();
        add_plane(submap, 6.0, 0.6, 0.8);
        passing_ = submap.points.size() - before;
      }
      std::ranges::sort(submap.points, {}, &SubmapPoint::place);
      KeyframeRecord record{
          .keyframe = {.id = id, .session = session, .stamp = std::chrono::seconds(id)},
          .submap = encode(submap)};
      record.keyframe.T_map_keyframe.translation().y() = 0.05 * static_cast<double>(id);
      if (id > 0) {
        record.edges.push_back({.from = id - 1, .to = id});
        record.edges.back().T_from_to.translation().y() = 0.05;
      }
      map.store(record);
    }
  }

  static void add_plane(KeyframeSubmap& submap, double x, double half_width, double half_height) {
    const auto at = [](double metres) { return static_cast<int32_t>(metres * kSubmapSteps); };
    for (double y = -half_width; y < half_width; y += 0.1) {
      for (double z = -half_height; z < half_height; z += 0.1) {
        submap.points.push_back({.place = {at(x), at(y), at(z)}});
      }
    }
  }

  Ran run(ExportCommandOptions options) {
    options.map = map_;
    options.output = folder_ / "out.las";
    return ran(export_command, options);
  }

  /// Points of a LAS file, and those of class 64.
  std::pair<uint64_t, uint64_t> counted() const {
    const std::string bytes = test::content(folder_ / "out.las");
    uint32_t begin = 0;
    uint16_t size = 0;
    std::memcpy(&begin, bytes.data() + 96, sizeof(begin));
    std::memcpy(&size, bytes.data() + 105, sizeof(size));
    std::pair<uint64_t, uint64_t> count;
    for (std::size_t point = begin; point + size <= bytes.size(); point += size) {
      ++count.first;
      count.second += static_cast<unsigned char>(bytes[point + 16]) == 64 ? 1U : 0U;
    }
    return count;
  }

  test::TemporaryFolder folder_;
  fs::path map_ = folder_ / "map.adit";
  std::size_t wall_ = 0;
  std::size_t passing_ = 0;
};

TEST_F(MovingProducts, AreClassedAndLeftOutWhereThatIsWanted) {
  ASSERT_EQ(run({.cloud = "las"}).code, 0);
  EXPECT_EQ(counted(), std::pair(uint64_t{wall_ + passing_}, uint64_t{0})) << "not looked for";
  const Ran found = run({.cloud = "las", .find_moving = true});
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_NE(found.out.find("voxels of 0.25 m hold what other submaps saw through"),
            std::string::npos)
      << found.out;
  EXPECT_EQ(counted(), std::pair(uint64_t{wall_ + passing_}, uint64_t{passing_}));
  ASSERT_EQ(run({.cloud = "las", .without_moving = true, .find_moving = true}).code, 0);
  EXPECT_EQ(counted(), std::pair(uint64_t{wall_}, uint64_t{0}));
}

TEST_F(MovingProducts, AreTheSameBytesTwice) {
  ASSERT_EQ(run({.cloud = "las", .find_moving = true}).code, 0);
  const std::string once = test::content(folder_ / "out.las");
  ASSERT_EQ(run({.cloud = "las", .find_moving = true}).code, 0);
  EXPECT_EQ(test::content(folder_ / "out.las"), once);
}

TEST_F(MovingProducts, StandInNobodysWay) {
  const auto occupied = [&](bool find) {
    ExportCommandOptions options{.map = map_, .output = folder_ / "grid.yaml"};
    options.find_moving = find;
    options.grid = true;
    options.cell = 0.1;
    options.heights = "-0.5,0.5";
    EXPECT_EQ(ran(export_command, options).code, 0);
    const std::string picture = test::content(folder_ / "grid.pgm");
    return std::ranges::count(picture.substr(picture.size() / 10), '\0');
  };
  const auto all = occupied(false);
  const auto standing = occupied(true);
  EXPECT_GE(all - standing, 10) << "cells of what passed by";
  EXPECT_GT(standing, 100) << "the wall";
}

TEST_F(MovingProducts, SayHowManyThereAreInTheReport) {
  ExportCommandOptions options{.map = map_, .output = folder_ / "report.html"};
  options.report = true;
  options.find_moving = true;
  ASSERT_EQ(ran(export_command, options).code, 0);
  const std::string page = test::content(folder_ / "report.html");
  EXPECT_NE(page.find("of which " + std::to_string(passing_) + " moved"), std::string::npos);
}

TEST_F(MovingProducts, NeedADevice) {
  ExportCommandOptions options{.cloud = "las", .find_moving = true};
  options.device.device = "no such device";
  const Ran done = run(options);
  EXPECT_EQ(done.code, 2);
  EXPECT_NE(done.err.find("no such device"), std::string::npos) << done.err;
  options.find_moving = false;
  EXPECT_EQ(run(options).code, 2) << "a device that nothing is done on";
  EXPECT_FALSE(fs::exists(folder_ / "out.las"));
}

}  // namespace
}  // namespace adit
