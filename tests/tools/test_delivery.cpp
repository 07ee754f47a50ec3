// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit deliver`: a folder with all that a client gets of a map.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_deliver.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::Ran;
using test::ran;

std::string preset_refusal(const std::string& text) {
  try {
    parse_delivery(text, "ours.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(DeliveryPreset, TheBuiltInOneHasProductsOfDifferentNames) {
  const auto products = parse_delivery(default_delivery(), "built-in");
  EXPECT_GE(products.size(), 8U);
  for (const DeliveryProduct& product : products) {
    EXPECT_FALSE(product.about.empty()) << product.file;
  }
}

TEST(DeliveryPreset, MistakesAreNamedWithTheirLine) {
  for (const auto& [text, part] :
       {std::pair("", "it has no [[product]]"), std::pair("a = ", "line 1: it is no TOML"),
        std::pair("[[product]]\nfile = \"../a\"\nexport = \"--dump\"",
                  "'../a' is no name of a file"),
        std::pair("[[product]]\nfile = \"a\"", "a has no export"),
        std::pair("[[product]]\nfile = \"a\"\nexport = 3", "line 3: export is no text"),
        std::pair("[[product]]\nfile = \"a\"\nexprt = \"--dump\"",
                  "line 3: a product has no exprt"),
        std::pair("[[product]]\nfile = \"a\"\nexport = \"--dump\"\nneeds = \"luck\"",
                  "needs is 'luck': place, recording, cameras or content"),
        std::pair("[[product]]\nfile = \"a\"\nexport = \"--dump\"\n"
                  "[[product]]\nfile = \"a\"\nexport = \"--dump\"",
                  "a stands twice"),
        std::pair("[[product]]\nfile = \"a\"\nexport = \"--dump -o b\"",
                  "'-o' cannot be in export"),
        std::pair("[[product]]\nfile = \"README.md\"\nexport = \"--dump\"",
                  "'README.md' is no name of a file"),
        std::pair("[[product]]\nfile = \"a\"\nexport = \"--dump\"\nabout = \"a|b\"",
                  "about is one line without '|'"),
        std::pair("product = 3", "line 1: product is written [[product]]"),
        std::pair("[products]", "a preset has no products: product")}) {
    EXPECT_NE(preset_refusal(text).find(part), std::string::npos) << text << preset_refusal(text);
  }
}

TEST(DeliveryPlaceWords, EachProductGetsWhatItHasAUseFor) {
  const DeliveryPlace place{.origin = "1,2,3", .crs = "EPSG:25830", .recording = "drive.mcap"};
  const auto words = [&](std::vector<std::string> options) {
    std::string text;
    for (const std::string& word : export_words({.options = std::move(options)}, place)) {
      text += word + ' ';
    }
    return text;
  };
  EXPECT_EQ(words({"--cloud", "laz"}), "--cloud laz --origin 1,2,3 --crs EPSG:25830 ");
  EXPECT_EQ(words({"--trajectory", "kml"}), "--trajectory kml --origin 1,2,3 ");
  EXPECT_EQ(words({"--picture"}), "--picture ");
  EXPECT_EQ(words({"--raster", "intensity"}),
            "--raster intensity --recording drive.mcap --origin 1,2,3 --crs EPSG:25830 ");
}

TEST(DeliveryPlaceWords, FilesThatDoNotStateASystemGetUtmWhereTheMapIsOnTheEarth) {
  const DeliveryPlace place{.on_earth = true, .geoid = "egm.pgm"};
  const auto words = [&](std::vector<std::string> options) {
    std::string text;
    for (const std::string& word : export_words({.options = std::move(options)}, place)) {
      text += word + ' ';
    }
    return text;
  };
  EXPECT_EQ(words({"--cloud", "ply"}), "--cloud ply --frame utm --geoid egm.pgm ");
  EXPECT_EQ(words({"--trajectory", "gpkg"}), "--trajectory gpkg --frame utm --geoid egm.pgm ");
  EXPECT_EQ(words({"--trajectory", "geojson"}), "--trajectory geojson ");
  EXPECT_EQ(words({"--cloud", "copc"}), "--cloud copc --geoid egm.pgm ");
  EXPECT_EQ(words({"--cloud", "pcd", "--frame", "map"}),
            "--cloud pcd --frame map --geoid egm.pgm ");
  EXPECT_EQ(coordinates_of_product({.options = {"--grid"}}, "UTM"), "the map's frame");
  EXPECT_EQ(coordinates_of_product({.options = {"--cloud", "copc"}}, "UTM"), "UTM");
}

TEST(DeliveryPlaceWords, ColorsGetTheRecordingAndTheCamerasFile) {
  const DeliveryPlace place{.recording = "drive.mcap", .calibration = "cameras.toml"};
  const DeliveryProduct cloud{.options = {"--cloud", "laz", "--colorize"}};
  EXPECT_TRUE(wants_colors(cloud));
  EXPECT_EQ(export_words(cloud, place),
            (std::vector<std::string>{"--cloud", "laz", "--colorize", "--recording", "drive.mcap",
                                      "--calibration", "cameras.toml"}));
  EXPECT_TRUE(wants_colors({.options = {"--raster", "color"}}));
  EXPECT_FALSE(wants_colors({.options = {"--raster", "height"}}));
  EXPECT_EQ(export_words(without_colors(cloud), place),
            (std::vector<std::string>{"--cloud", "laz"}));
}

/// A map of a floor that two keyframes saw.
class DeliverCommand : public testing::Test {
 protected:
  DeliverCommand() {
    MapDatabase map(map_, MapAccess::write);
    const SessionId session = map.add_session({.name = "floor"});
    for (NodeId id = 0; id < 2; ++id) {
      KeyframeSubmap submap;
      submap.r_submap = 0.25;
      submap.vertical = Vertical::gravity;
      submap.sweeps = {{.stamp = std::chrono::seconds(id), .merged = true}};
      const auto at = [](double metres) { return static_cast<int32_t>(metres * kSubmapSteps); };
      for (int i = 0; i < 400; ++i) {
        submap.points.push_back({.place = {at(0.5 * (i % 20)), at(0.1 * i), at(-1.0)}});
      }
      std::ranges::sort(submap.points, {}, &SubmapPoint::place);
      KeyframeRecord record{
          .keyframe = {.id = id, .session = session, .stamp = std::chrono::seconds(id)},
          .submap = encode(submap)};
      record.keyframe.T_map_keyframe.translation().x() = static_cast<double>(id);
      if (id > 0) {
        record.edges.push_back({.from = id - 1, .to = id});
        record.edges.back().T_from_to.translation().x() = 1.0;
      }
      map.store(record);
    }
  }

  Ran deliver(const std::string& preset) const {
    const DeliverCommandOptions options{
        .map = map_, .folder = folder_ / "out", .preset = folder_.write("preset.toml", preset)};
    return ran(deliver_command, options);
  }

  test::TemporaryFolder folder_;
  fs::path map_ = folder_ / "map.adit";
};

TEST_F(DeliverCommand, WhatIsThereIsKeptUntilItIsAskedForOtherwise) {
  const std::string preset =
      "[[product]]\nfile = \"a.copc.laz\"\nexport = \"--cloud copc\"\nabout = \"All points.\"\n"
      "[[product]]\nfile = \"path.kml\"\nexport = \"--trajectory kml\"\nneeds = \"place\"\n";
  const Ran first = deliver(preset);
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_NE(first.err.find("left out  path.kml"), std::string::npos) << first.err;
  EXPECT_EQ(first.out.find("kept"), std::string::npos) << first.out;
  EXPECT_TRUE(fs::exists(folder_ / "out" / "a.copc.laz"));
  const std::string page = test::content(folder_ / "out" / "README.md");
  EXPECT_NE(page.find("| `a.copc.laz` |"), std::string::npos) << page;
  EXPECT_NE(page.find("All points."), std::string::npos) << page;
  EXPECT_EQ(page.find("path.kml"), std::string::npos) << page;

  EXPECT_NE(deliver(preset).out.find("kept"), std::string::npos);
  fs::remove(folder_ / "out" / "a.copc.laz");
  EXPECT_EQ(deliver(preset).out.find("kept"), std::string::npos);
  EXPECT_EQ(
      deliver("[[product]]\nfile = \"a.copc.laz\"\nexport = \"--cloud laz\"\n").out.find("kept"),
      std::string::npos);
}

TEST_F(DeliverCommand, WithoutCamerasCloudsHaveNoColorsAndThatIsSaid) {
  const Ran one = deliver(
      "[[product]]\nfile = \"a.laz\"\nexport = \"--cloud laz --colorize\"\n"
      "[[product]]\nfile = \"o.tif\"\nexport = \"--raster color\"\nneeds = \"cameras\"\n");
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_NE(one.err.find("note: clouds have no colours ("), std::string::npos) << one.err;
  EXPECT_NE(one.err.find("left out  o.tif (there are no colours"), std::string::npos) << one.err;
  EXPECT_TRUE(fs::exists(folder_ / "out" / "a.laz"));
  const std::string page = test::content(folder_ / "out" / "README.md");
  EXPECT_NE(page.find("The points of the clouds have no colours."), std::string::npos) << page;
}

TEST_F(DeliverCommand, OneFileThatFailsDoesNotStopTheOthers) {
  const Ran one = deliver(
      "[[product]]\nfile = \"a.tif\"\nexport = \"--raster height --cell 1e9\"\n"
      "[[product]]\nfile = \"b.laz\"\nexport = \"--cloud laz\"\n");
  EXPECT_EQ(one.code, 1);
  const Ran left_out = deliver(
      "[[product]]\nfile = \"a.tif\"\nexport = \"--raster height --cell 1e9\"\nneeds = "
      "\"content\"\n"
      "[[product]]\nfile = \"b.laz\"\nexport = \"--cloud laz\"\n");
  EXPECT_EQ(left_out.code, 0);
  EXPECT_NE(left_out.err.find("left out  a.tif"), std::string::npos) << left_out.err;
  EXPECT_NE(one.err.find("1 of 2 files could not be written"), std::string::npos) << one.err;
  EXPECT_TRUE(fs::exists(folder_ / "out" / "b.laz"));
  EXPECT_EQ(test::content(folder_ / "out" / "README.md").find("a.tif"), std::string::npos);
}

TEST_F(DeliverCommand, APageOfSomebodyElseStays) {
  fs::create_directories(folder_ / "out");
  folder_.write("out/README.md", "mine");
  const Ran refused = deliver("[[product]]\nfile = \"a.laz\"\nexport = \"--cloud laz\"\n");
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("is not one of a delivery"), std::string::npos) << refused.err;
  EXPECT_EQ(test::content(folder_ / "out" / "README.md"), "mine");
}

TEST_F(DeliverCommand, NeedsAMapAndAFolder) {
  EXPECT_EQ(ran(deliver_command, DeliverCommandOptions{.map = map_}).code, 2);
  EXPECT_EQ(ran(deliver_command, DeliverCommandOptions{.map = "nowhere", .folder = "x"}).code, 1);
  const Ran preset = ran(deliver_command, DeliverCommandOptions{.print_preset = true});
  EXPECT_EQ(preset.code, 0);
  EXPECT_EQ(preset.out, default_delivery());
}

}  // namespace
}  // namespace adit
