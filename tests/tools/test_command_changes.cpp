// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit changes` of maps of a simulated street in which a box is put and another one taken away.
#include "adit/tools/commands/command_changes.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/mapping/street_maps.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/commands/command_merge.hpp"
#include "adit/tools/map_changes/changes_report.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::Ran;

class CommandChanges : public test::DeviceTest {
 protected:
  /// Made once, for all tests: two drives along a street, another street, and the two merged.
  static const fs::path& maps() {
    static const test::TemporaryFolder folder;
    static const bool made = [] {
      const test::Block gone{{11.0, 1.9, 0.0}, {11.7, 2.6, 0.9}};
      const test::Block added{{15.0, -2.7, 0.0}, {15.7, -2.0, 0.9}};
      test::write_street_map(context(), folder / "before.adit", {.sweeps = 70, .more = {gone}});
      test::write_street_map(context(), folder / "after.adit",
                             {.from = 1.0,
                              .aside = 0.2,
                              .sweeps = 66,
                              .more = {added},
                              .later = std::chrono::hours(24)});
      test::write_street_map(context(), folder / "elsewhere.adit", {.street = 77, .sweeps = 40});
      MergeCommandOptions merge{.maps = {folder / "before.adit", folder / "after.adit"},
                                .output = folder / "both.adit",
                                .quiet = true};
      merge.device.opened = &context();
      return test::ran(merge_command, merge).code == 0;
    }();
    EXPECT_TRUE(made);
    return folder.path();
  }

  Ran compared(const std::vector<std::string>& names, const fs::path& output = {}) {
    ChangesCommandOptions options{.output = output, .quiet = true, .json = true};
    options.device.opened = &context();
    for (const std::string& name : names) {
      options.maps.push_back(fs::path(name).is_absolute() ? fs::path(name)
                                                          : maps() / (name + ".adit"));
    }
    return test::ran(changes_command, options);
  }

  /// The largest is gone and the next one new, or the other way round; the rest are slivers.
  static std::vector<nlohmann::json> largest_two(const nlohmann::json& report) {
    std::vector<nlohmann::json> changes = report.at("changes");
    double volume = 0.0;
    for (const auto& change : changes) {
      volume += change.at("volume_m3").get<double>();
    }
    EXPECT_GE(changes.size(), 2U) << report.dump(1);
    changes.resize(2);
    EXPECT_GT(changes[0].value("volume_m3", 0.0) + changes[1].value("volume_m3", 0.0),
              0.9 * volume);
    return changes;
  }

  /// One is gone and one is new, where they are (world of the drive `from` the map's origin, m).
  static void expect_both(const nlohmann::json& report, const Vector3d& origin) {
    const std::vector<nlohmann::json> changes = largest_two(report);
    for (const auto& change : changes) {
      const bool is_gone = change.at("change") == "gone";
      const Vector3d truth = is_gone ? Vector3d(11.35, 2.25, 0.45) : Vector3d(15.35, -2.35, 0.45);
      const auto& at = change.at("centre_m");
      const Vector3d centre(at[0].get<double>(), at[1].get<double>(), at[2].get<double>());
      EXPECT_LT((centre + origin - truth).norm(), 0.8) << change.dump();
      EXPECT_GT(change.at("volume_m3"), 0.05);
      EXPECT_LT(change.at("volume_m3"), 2.0);
      EXPECT_GE(change.at("points"), 8);
      EXPECT_GE(change.at("submaps_through"), 2);
      EXPECT_EQ(change.at("session"), is_gone ? 1 : 2);
      EXPECT_EQ(change.at("seen_through_in"), is_gone ? 2 : 1);
      EXPECT_TRUE(change.at("place").is_null());
    }
    EXPECT_NE(changes[0].at("change"), changes[1].at("change"));
  }

  test::TemporaryFolder folder_;
};

/// Points of an exported cloud within a box of the drive's world, and all of them.
std::pair<std::size_t, std::size_t> points_in(const fs::path& ply, const Vector3d& lower,
                                              const Vector3d& upper) {
  const Eigen::AlignedBox3d box(lower - Vector3d(0.0, 0.0, 1.8), upper - Vector3d(0.0, 0.0, 1.8));
  const std::vector<Point> points = read_ply(ply).sweep.points;
  const auto within = std::ranges::count_if(points, [&](const Point& point) {
    return box.contains(Vector3d(point.x, point.y, point.z));
  });
  return {static_cast<std::size_t>(within), points.size()};
}

TEST_F(CommandChanges, AnExportLeavesOutWhatIsGoneByThen) {
  const auto exported = [&](const std::string& name, bool without_gone,
                            std::optional<double> until = {}) {
    ExportCommandOptions options{.map = maps() / "both.adit",
                                 .output = folder_ / name,
                                 .cloud = "ply",
                                 .until = until,
                                 .without_gone = without_gone};
    const Ran ran = test::ran(export_command, options);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return folder_ / name;
  };
  const Vector3d lower(10.9, 1.8, 0.2);  // the box that is taken away, but for the ground below it
  const Vector3d upper(11.8, 2.7, 1.0);
  const auto [all_there, all] = points_in(exported("all.ply", false), lower, upper);
  const auto [left_there, left] = points_in(exported("now.ply", true), lower, upper);
  ASSERT_GT(all_there, 20U);
  EXPECT_LT(10 * left_there, all_there);
  EXPECT_LT(all - left - (all_there - left_there), all / 200) << "what is still there stays";
  const MapDatabase both(maps() / "both.adit", MapAccess::read);
  const std::vector<MapKeyframe> keyframes = both.keyframes();
  const auto second = std::ranges::max_element(keyframes, {}, &MapKeyframe::session);
  const double before = seconds(second->stamp) - 3600.0;
  const auto [then_there, then] = points_in(exported("then.ply", true, before), lower, upper);
  EXPECT_EQ(then_there, all_there) << "at that time it was there";
  EXPECT_LT(then, all);
}

TEST_F(CommandChanges, TheSessionsOfAMapAreComparedInTheOrderOfTime) {
  const Ran ran = compared({"both"}, folder_ / "changes.geojson");
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto report = nlohmann::json::parse(ran.out);
  EXPECT_EQ(report.at("schema"), "changes/1");
  ASSERT_EQ(report.at("sessions").size(), 2U);
  EXPECT_EQ(report.at("sessions")[0].at("name"), "before");
  expect_both(report, Vector3d(0.0, 0.0, 1.8));
  const auto geojson = nlohmann::json::parse(read_text_file(folder_ / "changes.geojson"));
  EXPECT_EQ(geojson.at("features").size(), report.at("changes").size());
  EXPECT_TRUE(geojson.contains("coordinates")) << "in the map's frame, and says so";
  for (const auto& feature : geojson.at("features")) {
    const auto& ring = feature.at("geometry").at("coordinates")[0];
    ASSERT_EQ(ring.size(), 5U);
    EXPECT_EQ(ring[0], ring[4]);
  }
  EXPECT_EQ(compared({"both"}).out, compared({"both"}).out);
}

TEST_F(CommandChanges, TwoMapsAreTiedFirstAndStayAsTheyAre) {
  const std::string before = test::dump_of(MapDatabase(maps() / "before.adit", MapAccess::read));
  const Ran ran = compared({"before", "after"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  expect_both(nlohmann::json::parse(ran.out), Vector3d(0.0, 0.0, 1.8));
  EXPECT_EQ(test::dump_of(MapDatabase(maps() / "before.adit", MapAccess::read)), before);
  // The other way round, in the frame of the map that is then the first.
  const auto back = nlohmann::json::parse(compared({"after", "before"}).out);
  for (const auto& change : largest_two(back)) {
    const bool is_new = change.at("change") == "new";
    EXPECT_NEAR(change.at("centre_m")[0].get<double>(), is_new ? 10.35 : 14.35, 0.8);
  }
}

TEST_F(CommandChanges, WhatCannotBeComparedIsRefusedWithItsReason) {
  const auto refused = [&](const std::vector<std::string>& names, int code,
                           const std::string& reason) {
    const Ran ran = compared(names, folder_ / "none.geojson");
    EXPECT_EQ(ran.code, code) << reason;
    EXPECT_NE(ran.err.find(reason), std::string::npos) << ran.err;
    EXPECT_FALSE(fs::exists(folder_ / "none.geojson"));
  };
  refused({}, 2, "name a map of several sessions, or two maps");
  refused({"before", "after", "elsewhere"}, 2, "name a map of several sessions, or two maps");
  refused({"before"}, 1, "it holds one session");
  refused({"before", "before"}, 2, "is named twice");
  refused({"before", "both"}, 1, "is of the same recording");
  refused({"nowhere"}, 1, "there is no such file");
  refused({"before", "elsewhere"}, 1, "it cannot be tied to");
  refused({folder_.write("text.adit", "no map").string()}, 1, "text.adit");
  const std::string whole = read_text_file(maps() / "both.adit");
  for (const double share : {0.02, 0.5, 0.95}) {
    const auto size = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
    const fs::path cut = folder_.write("cut.adit", whole.substr(0, size));
    refused({cut.string()}, 1, "cut.adit");
  }
  const fs::path untied = folder_ / "untied.adit";
  fs::copy_file(maps() / "both.adit", untied);
  SqliteDatabase(untied, SqliteDatabase::Mode::update)
      .execute("DELETE FROM edges WHERE kind = " +
               std::to_string(static_cast<int>(EdgeKind::loop)));
  refused({untied.string()}, 1, "its sessions are not tied to each other");
}

TEST(ChangesReport, TheTableHasSessionsAndObjects) {
  ChangesOutcome outcome{
      .sessions = {{.id = 1, .name = "a", .map = "m.adit", .keyframes = 12},
                   {.id = 2, .name = "b", .map = "m.adit", .period = 1, .keyframes = 9}},
      .objects = {{.change = ChangeOfSpace::appeared,
                   .period = 1,
                   .box = {.centre = {1.0, 2.0, 0.5}, .size = {2.0, 1.0, 1.0}},
                   .points = 40,
                   .through = 3}},
      .points = 1000};
  const std::string text = describe_changes({.output = "c.geojson"}, outcome);
  EXPECT_NE(text.find("new     1.00 2.00 0.50"), std::string::npos) << text;
  EXPECT_NE(text.find("2.00      40  3 submaps of session 1"), std::string::npos) << text;
  EXPECT_NE(text.find("0 gone, 1 new; 40 of 1000 points"), std::string::npos) << text;
  EXPECT_NE(text.find("metres of the map's frame"), std::string::npos) << text;
  outcome.objects.clear();
  EXPECT_EQ(describe_changes({}, outcome).find("change "), std::string::npos);
}

}  // namespace
}  // namespace adit
