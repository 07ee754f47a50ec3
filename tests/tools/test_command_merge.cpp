// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit merge` of maps of simulated streets.
#include "adit/tools/commands/command_merge.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/mapping/street_maps.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/map_merge/merge_report.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::Ran;

/// Three drives along one street, which have different stretches of it, and one along another.
const std::map<std::string, test::StreetDrive>& drives() {
  static const std::map<std::string, test::StreetDrive> drives = {
      {"long", {.sweeps = 56}},
      {"middle", {.from = 3.0, .aside = 0.4, .sweeps = 48}},
      {"late", {.from = 6.0, .aside = -0.4, .sweeps = 44}},
      {"elsewhere", {.street = 77, .sweeps = 46}},
      {"short", {.sweeps = 20}},
      {"brief", {.from = 1.0, .aside = 0.4, .sweeps = 18}}};
  return drives;
}

class CommandMerge : public test::DeviceTest {
 protected:
  /// Made once, for all tests.
  static const fs::path& maps() {
    static const test::TemporaryFolder folder;
    static const bool made = [] {
      for (const auto& [name, drive] : drives()) {
        test::write_street_map(context(), folder / (name + ".adit"), drive);
      }
      return true;
    }();
    static_cast<void>(made);
    return folder.path();
  }

  Ran merged(const std::vector<std::string>& names, const std::string& to) {
    MergeCommandOptions options{.output = folder_ / to, .quiet = true, .json = true};
    options.device.opened = &context();
    for (const std::string& name : names) {
      options.maps.push_back(fs::path(name).is_absolute() ? fs::path(name)
                                                          : maps() / (name + ".adit"));
    }
    return test::ran(merge_command, options);
  }
  std::string content(const std::string& file) { return read_text_file(folder_ / file); }
  static std::string dump(const fs::path& file) {
    return test::dump_of(MapDatabase(file, MapAccess::read));
  }

  test::TemporaryFolder folder_;
};

TEST_F(CommandMerge, AnyOrderGivesTheSameBytesInOneFrame) {
  const std::vector<std::string> before = {dump(maps() / "long.adit"), dump(maps() / "late.adit")};
  const Ran first = merged({"long", "middle", "late"}, "first.adit");
  ASSERT_EQ(first.code, 0) << first.err << first.out;
  EXPECT_EQ(merged({"late", "middle", "long"}, "second.adit").code, 0);
  EXPECT_TRUE(content("first.adit") == content("second.adit"));
  EXPECT_EQ(dump(maps() / "long.adit"), before[0]);
  EXPECT_EQ(dump(maps() / "late.adit"), before[1]);

  const auto report = nlohmann::json::parse(first.out);
  EXPECT_EQ(report.at("schema"), "merge/1");
  ASSERT_EQ(report.at("sessions").size(), 3U);
  EXPECT_EQ(report.at("components"), 1);
  EXPECT_TRUE(report.at("apart").empty());
  EXPECT_GE(report.at("ties").size(), 2U);
  for (const auto& tie : report.at("ties")) {
    EXPECT_GE(tie.at("edges"), 4);
    EXPECT_LT(tie.at("median_residual_m"), 0.1);
  }
  const MapDatabase map(folder_ / "first.adit", MapAccess::read);
  EXPECT_TRUE(map.check().empty());
  const Eigen::Isometry3d T_map_world =
      test::street_drive(drives().at("long")).truth.front().pose.inverse();
  for (const MapSession& session : map.sessions()) {
    EXPECT_TRUE(map.progress(session.id).complete);
    const test::SubmapDrive drive = test::street_drive(drives().at(session.name));
    for (const MapKeyframe& keyframe : map.keyframes()) {
      if (keyframe.session != session.id) {
        continue;
      }
      const auto truth = std::ranges::find(drive.truth, keyframe.stamp, &StampedPose::stamp);
      ASSERT_NE(truth, drive.truth.end());
      const Eigen::Vector3d off =
          (T_map_world * truth->pose).translation() - keyframe.T_map_keyframe.translation();
      EXPECT_LT(off.norm(), 0.2) << session.name << ", keyframe " << keyframe.id;
    }
  }
}

/// With a place in the world, `error` east of the true one (m).
fs::path placed_copy(const fs::path& map, const fs::path& copy, double error) {
  fs::copy_file(map, copy);
  MapDatabase store(copy, MapAccess::write);
  Eigen::Isometry3d T_world_map =
      test::street_drive(drives().at(map.stem().string())).truth.front().pose;
  T_world_map.pretranslate(Eigen::Vector3d(error, 0.0, 0.0));
  const Georeference georeference{
      .origin = {.latitude = 48.0, .longitude = 11.0, .altitude = 500.0},
      .T_world_map = T_world_map,
      .covariance = 0.01 * Matrix6d::Identity()};
  store.revise({.georeference = georeference});
  return copy;
}

TEST_F(CommandMerge, PlacesInTheWorldTieWhatLooksAloneDoNot) {
  const Ran alone = merged({"short", "brief"}, "alone.adit");
  EXPECT_EQ(alone.code, 1) << "a few metres of street could be of many streets: " << alone.out;
  const std::string first = placed_copy(maps() / "short.adit", folder_ / "short.adit", 0.0);
  const std::string second = placed_copy(maps() / "brief.adit", folder_ / "brief.adit", 0.7);
  const Ran placed = merged({first, second}, "placed.adit");
  ASSERT_EQ(placed.code, 0) << placed.out;
  const MapDatabase map(folder_ / "placed.adit", MapAccess::read);
  EXPECT_EQ(connected_components(map.graph()).components.size(), 1U);
  EXPECT_TRUE(std::ranges::none_of(map.graph().edges(), [](const PoseEdge& edge) {
    return edge.kind == EdgeKind::start;
  })) << "what was expected is no measurement";
}

TEST_F(CommandMerge, MapsWhosePlacesInTheWorldAreWrongAreTiedByTheirLooksOrNotAtAll) {
  const std::string first = placed_copy(maps() / "long.adit", folder_ / "long.adit", 0.0);
  const std::string second = placed_copy(maps() / "middle.adit", folder_ / "middle.adit", 50.0);
  const Ran off = merged({first, second}, "off.adit");
  ASSERT_EQ(off.code, 0) << off.out;
  const auto tie = nlohmann::json::parse(off.out).at("ties")[0];
  EXPECT_LT(tie.at("median_residual_m"), 0.1);
  const std::string third = placed_copy(maps() / "elsewhere.adit", folder_ / "elsewhere.adit", 0.0);
  EXPECT_EQ(merged({first, third}, "wrong.adit").code, 1);
}

TEST(MergeReport, TheTableHasSessionsTiesAndMapsApart) {
  MergeOutcome outcome{.sessions = {{.id = 1, .name = "a", .from = "a.adit", .keyframes = 12},
                                    {.id = 2, .name = "b", .from = "b.adit", .sigma = 0.0312}},
                       .ties = {{.one = 1, .other = 2, .edges = 7, .metres = 0.004}},
                       .apart = {{.file = "c.adit", .candidates = 9, .verified = 4}}};
  const auto contains = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  outcome.apart.front().reason = reason_apart(outcome.apart.front(), 0);
  const std::string text = describe({.output = "m.adit"}, outcome);
  EXPECT_TRUE(contains(text, "      2          0         0.031 m  b.adit (b)")) << text;
  EXPECT_TRUE(contains(text, "     1-2      7  0.004 m, 0.00 deg")) << text;
  EXPECT_TRUE(contains(text, "apart     c.adit: of 9 pairs of keyframes that look alike, 4 fit"));
  EXPECT_TRUE(contains(text, "wrote     m.adit"));
  EXPECT_TRUE(contains(reason_apart({.candidates = 9, .log_odds = 2.0}, 0), "7.39 to 1"));
  EXPECT_TRUE(contains(reason_apart({.candidates = 9, .log_odds = -2.0}, 0), "7.39 times"));
  EXPECT_TRUE(contains(reason_apart({.candidates = 9}, 3), "only 3 of its keyframes"));
  EXPECT_TRUE(contains(reason_apart({}, 0), "no place of it looks like"));
  EXPECT_TRUE(contains(describe({}, {}), "wrote     nothing"));
}

TEST_F(CommandMerge, AMapOfAnotherPlaceStaysApart) {
  const Ran some = merged({"elsewhere", "middle", "long"}, "some.adit");
  ASSERT_EQ(some.code, 0) << some.err;
  const auto report = nlohmann::json::parse(some.out);
  EXPECT_EQ(report.at("sessions").size(), 2U);
  ASSERT_EQ(report.at("apart").size(), 1U);
  EXPECT_EQ(report.at("apart")[0].at("map"), (maps() / "elsewhere.adit").string());
  EXPECT_FALSE(report.at("apart")[0].at("reason").get<std::string>().empty());
  const Ran none = merged({"elsewhere", "long"}, "none.adit");
  EXPECT_EQ(none.code, 1) << none.err;
  EXPECT_EQ(nlohmann::json::parse(none.out).at("apart").size(), 2U);
  EXPECT_FALSE(fs::exists(folder_ / "none.adit"));
  EXPECT_FALSE(fs::exists(folder_ / "none.adit.part"));
  EXPECT_FALSE(fs::exists(folder_ / "none.adit.lock"));
}

TEST_F(CommandMerge, WhatCannotBeMergedIsRefusedWithItsReason) {
  const auto refused = [&](const std::vector<std::string>& names, int code,
                           const std::string& reason, const std::string& to = "out.adit") {
    const Ran ran = merged(names, to);
    EXPECT_EQ(ran.code, code) << reason;
    EXPECT_NE(ran.err.find(reason), std::string::npos) << ran.err;
    EXPECT_FALSE(fs::exists(folder_ / "out.adit"));
  };
  refused({"long"}, 2, "name two maps or more");
  refused({"long", "long"}, 2, "is named twice");
  refused({"long", "nowhere"}, 1, "there is no such file");
  refused({"long", folder_.write("text.adit", "no map").string()}, 1, "text.adit");
  const fs::path copy = folder_ / "copy.adit";
  fs::copy_file(maps() / "long.adit", copy);
  refused({"long", copy.string()}, 1, "is of the same recording");
  refused({"long", "late"}, 2, "there is a file of that name", "copy.adit");
  refused({copy.string(), "late"}, 2, "it is one of the maps to merge", "copy.adit");
  { const MapDatabase empty(folder_ / "empty.adit", MapAccess::write); }
  refused({"long", (folder_ / "empty.adit").string()}, 1, "it holds no keyframe");
  const MapDatabase writer(copy, MapAccess::write);
  refused({"late", copy.string()}, 1, "is being written by");
}

TEST_F(CommandMerge, ACutOffMapIsRefusedOrMergedButNeverCrashes) {
  const std::string whole = read_text_file(maps() / "middle.adit");
  for (const double share : {0.01, 0.3, 0.7, 0.98}) {
    const auto size = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
    const fs::path cut = folder_.write("cut.adit", whole.substr(0, size));
    const Ran ran = merged({"long", cut.string()}, "cut-merged.adit");
    EXPECT_EQ(ran.code, 1) << share;
    EXPECT_FALSE(ran.err.empty());
    EXPECT_FALSE(fs::exists(folder_ / "cut-merged.adit"));
  }
}

TEST_F(CommandMerge, AMapWhoseRunHasNotEndedIsMergedAndNamed) {
  const fs::path open = folder_ / "open.adit";
  fs::copy_file(maps() / "middle.adit", open);
  SqliteDatabase(open, SqliteDatabase::Mode::update).execute("UPDATE sessions SET complete = 0");
  const Ran ran = merged({open.string(), "long"}, "merged.adit");
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto report = nlohmann::json::parse(ran.out);
  ASSERT_EQ(report.at("incomplete").size(), 1U);
  EXPECT_EQ(report.at("incomplete")[0], open.string());
}

}  // namespace
}  // namespace adit
