// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tests/commands/map_cases.hpp"

#include <array>
#include <sstream>
#include <stdexcept>
#include <string>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/commands/small_room.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tools/commands/command_changes.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/commands/command_info.hpp"
#include "adit/tools/commands/command_loops.hpp"
#include "adit/tools/commands/command_merge.hpp"
#include "adit/tools/commands/command_optimize.hpp"
#include "adit/tools/commands/command_recover.hpp"
#include "adit/tools/commands/command_split.hpp"

namespace adit::test {
namespace {

namespace fs = std::filesystem;

/// 200 points, 3 m to the left.
KeyframeSubmap wall(Nanoseconds stamp) {
  KeyframeSubmap submap;
  submap.r_submap = 0.25;
  submap.sweeps.push_back({.stamp = stamp, .merged = true});
  for (int i = 0; i < 200; ++i) {
    submap.points.push_back({.place = {20 * i, 6144, 10 * i}});
  }
  return submap;
}

/// No command ends with it: a complaint.
constexpr int kNoCode = -1;

/// What `adit check` calls whole holds what was stored.
int checked(const InfoCommandOptions& options, const fs::path& map, const fs::path& healthy,
            std::ostream& told) {
  const int code = check_command(options, told, told);
  if (code == 0 && dump_of(MapDatabase(map, MapAccess::read)) !=
                       dump_of(MapDatabase(healthy, MapAccess::read))) {
    told << "it holds something else than was stored\n";
    return kNoCode;
  }
  return code;
}

int info(const fs::path& map, const fs::path& healthy, Dice& dice, std::ostream& told) {
  const InfoCommandOptions options{.map = dice.one_in(4) ? map.parent_path() : map,
                                   .json = dice.one_in(2)};
  return dice.one_in(3) ? info_command(options, told, told) : checked(options, map, healthy, told);
}

int loops(const fs::path& map, const fs::path& out, engine::Context& context, Dice& dice,
          std::ostream& told) {
  LoopsCommandOptions options{.map = map};
  options.json = dice.one_in(2);
  options.device.opened = &context;
  if (dice.one_in(3)) {
    options.html = out / "loops.html";
  }
  switch (dice.below(4)) {
    case 0:
      options.revoke = 1;
      break;
    case 1:
      options.restore = 1;
      break;
    case 2:
      options.add = {0, 4};
      if (dice.one_in(2)) {
        options.guess = {39.0, 0.1, 0.0, 1.0};
      }
      break;
    default:
      break;
  }
  return loops_command(options, told, told);
}

int exported(const fs::path& map, const fs::path& out, engine::Context& context, Dice& dice,
             std::ostream& told) {
  ExportCommandOptions options{.map = map};
  options.device.opened = &context;
  const std::array<std::string, 6> trajectories = {"tum", "kitti", "csv", "geojson", "kml", "gpkg"};
  const std::array<std::string, 3> clouds = {"ply", "pcd", "las"};
  switch (dice.below(8)) {
    case 0:
      options.trajectory = trajectories[dice.below(trajectories.size())];
      options.output = out / ("trajectory." + options.trajectory);
      if (dice.one_in(2)) {
        options.origin = "47.0,8.0,400,30";
      }
      break;
    case 1:
      options.cloud = clouds[dice.below(clouds.size())];
      options.output = out / ("cloud." + options.cloud);
      options.find_moving = dice.one_in(3);
      options.without_moving = options.find_moving;
      break;
    case 2:
      options.graph = "g2o";
      options.output = out / "graph.g2o";
      break;
    case 3:
      options.raster = dice.one_in(2) ? "height" : "intensity";
      options.output = out / "raster.tif";
      break;
    case 4:
      options.grid = true;
      options.output = out / "grid.yaml";
      break;
    case 5:
      options.picture = true;
      options.output = out / "map.png";
      break;
    case 6:
      options.report = true;
      options.output = out / "report.html";
      break;
    default:
      options.dump = true;
      options.output = out / "dump.txt";
  }
  return export_command(options, told, told);
}

int optimized(OptimizeCommandOptions options, Dice& dice, std::ostream& told) {
  constexpr std::array kInitial = {InitialPoses::better, InitialPoses::file, InitialPoses::tree,
                                   InitialPoses::chordal};
  options.json = dice.one_in(2);
  options.direct = dice.one_in(2);
  options.max_iterations = 20;
  if (dice.one_in(2)) {
    options.initial = kInitial[dice.below(kInitial.size())];
  }
  return optimize_command(options, told, told);
}

int merged(const fs::path& map, const fs::path& healthy, const fs::path& out,
           engine::Context& context, std::ostream& told) {
  MergeCommandOptions options{.maps = {map, healthy}, .output = out / "merged.adit", .quiet = true};
  options.device.opened = &context;
  std::ostringstream said;
  const int code = merge_command(options, said, said);
  told << said.str();
  // Without damage the two are one map, which is refused as it should be.
  return said.str().find("it holds the same as") != std::string::npos ? 0 : code;
}

int split(const fs::path& map, const fs::path& out, Dice& dice, std::ostream& told) {
  const SplitCommandOptions options{.map = map,
                                    .sessions = {1 + static_cast<int64_t>(dice.below(2))},
                                    .output = out / "split.adit",
                                    .json = dice.one_in(2)};
  return split_command(options, told, told);
}

int changes(const fs::path& map, const fs::path& out, Dice& dice, std::ostream& told) {
  const ChangesCommandOptions options{
      .maps = {map}, .output = out / "changes.geojson", .quiet = true, .json = dice.one_in(2)};
  return changes_command(options, told, told);
}

}  // namespace

void write_healthy_map(const fs::path& folder) {
  fs::create_directories(folder);
  {
    MapDatabase map(folder / "map.adit", MapAccess::write);
    const SessionId first = add_session(map);
    const SessionId second = map.add_session({.name = "second"});
    for (NodeId id = 0; id < 6; ++id) {
      KeyframeRecord keyframe = record(id, id < 3 ? first : second);
      keyframe.submap = encode(wall(keyframe.keyframe.stamp));
      map.store(keyframe);
    }
    map.revise(loops_of_six());
  }
  std::ostringstream told;
  const ExportCommandOptions options{
      .map = folder / "map.adit", .output = folder / "graph.g2o", .graph = "g2o"};
  if (export_command(options, told, told) != 0) {
    throw std::runtime_error("the healthy map's graph could not be written: " + told.str());
  }
}

void damage_row(const fs::path& map, Dice& dice) {
  struct Column {
    const char* table;
    const char* name;
    std::size_t bytes;
  };
  constexpr std::array kColumns = {
      Column{"keyframes", "pose", 96},  Column{"keyframes", "covariance", 288},
      Column{"edges", "pose", 96},      Column{"edges", "information", 288},
      Column{"candidates", "pose", 96}, Column{"submaps", "box", 48},
      Column{"chunks", "zstd", 20}};
  // The upper byte of a double makes it tiny, huge or none.
  constexpr std::array kBytes = {"x'00'", "x'01'", "x'3f'", "x'7f'", "x'80'", "x'ff'"};
  const Column& column = kColumns[dice.below(kColumns.size())];
  const std::size_t at = dice.below(column.bytes);
  const std::string row = std::to_string(dice.below(6));
  const std::string name = column.name;
  if (dice.is_harmless()) {
    return;
  }
  SqliteDatabase(map, SqliteDatabase::Mode::update)
      .execute(std::string("UPDATE ") + column.table + " SET " + name + " = CAST(substr(" + name +
               ", 1, " + std::to_string(at) + ") || " + kBytes[dice.below(kBytes.size())] +
               " || substr(" + name + ", " + std::to_string(at + 2) +
               ") AS BLOB) WHERE rowid = (SELECT rowid FROM " + column.table + " LIMIT 1 OFFSET " +
               row + ")");
}

int call_on_map(const fs::path& map, const fs::path& healthy, const fs::path& folder,
                engine::Context& context, Dice& dice, std::ostream& told) {
  const fs::path out = folder / "out";
  fs::create_directories(out);
  switch (dice.below(8)) {
    case 0:
      return info(map, healthy, dice, told);
    case 1:
      return loops(map, out, context, dice, told);
    case 2:
      return exported(map, out, context, dice, told);
    case 3:
      return optimized({.input = map}, dice, told);
    case 4:
      return merged(map, healthy, out, context, told);
    case 5:
      return split(map, out, dice, told);
    case 6:
      return changes(map, out, dice, told);
    default:
      return recover_command({.map = map, .output = out / "recovered.adit"}, told, told);
  }
}

int call_on_graph(const fs::path& graph, const fs::path& folder, Dice& dice, std::ostream& told) {
  fs::create_directories(folder / "out");
  return optimized({.input = graph, .output = folder / "out" / "graph.g2o"}, dice, told);
}

}  // namespace adit::test
