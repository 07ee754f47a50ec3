// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_export.hpp"

#include <iostream>
#include <memory>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/clouds/pcd_writer.hpp"
#include "adit/tools/clouds/ply_writer.hpp"
#include "adit/tools/commands/command_guard.hpp"
#include "adit/tools/commands/command_line.hpp"
#include "adit/tools/maps/g2o_file.hpp"
#include "adit/tools/maps/map_database.hpp"
#include "adit/tools/maps/map_trajectory.hpp"
#include "adit/tools/results/map_thinning.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

void check_options(const ExportCommandOptions& options) {
  const int wanted = static_cast<int>(!options.trajectory.empty()) +
                     static_cast<int>(!options.graph.empty()) +
                     static_cast<int>(!options.cloud.empty()) + static_cast<int>(options.dump);
  if (wanted != 1) {
    throw UsageError("say what to export: one of --trajectory, --graph, --cloud and --dump.");
  }
  if (!options.dump && !options.output) {
    throw UsageError("say where to: -o FILE.");
  }
  if (options.resolution && options.cloud.empty()) {
    throw UsageError("--resolution needs --cloud.");
  }
  if (options.resolution && !(*options.resolution >= 1e-3 && *options.resolution <= 1e3)) {
    throw UsageError("--resolution: must be between 0.001 and 1000 m.");
  }
  std::error_code ignored;
  if (options.output && fs::equivalent(*options.output, options.map, ignored)) {
    throw UsageError("the map cannot be written over. Name another file with -o.");
  }
}

/// Every sweep with its keyframe.
std::size_t write_table(const MapDatabase& map, const ExportCommandOptions& options) {
  OutputFile file(*options.output);
  file.write("session,keyframe,stamp,x,y,z,qx,qy,qz,qw,merged\n");
  std::size_t rows = 0;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    for (const SubmapSweep& sweep : load_sweeps(map, keyframe.id, options.map).sweeps) {
      std::string line = std::to_string(keyframe.session) + "," + std::to_string(keyframe.id) + ",";
      append_stamp(line, sweep.stamp);
      for (const double number : numbers_of(keyframe.T_map_keyframe * sweep.T_keyframe_lidar)) {
        line += ',';
        append_number(line, number);
      }
      file.write(line + (sweep.merged ? ",1\n" : ",0\n"));
      ++rows;
    }
  }
  file.close();
  return rows;
}

std::size_t write_poses(const MapDatabase& map, const ExportCommandOptions& options) {
  if (options.trajectory == "csv") {
    return write_table(map, options);
  }
  const std::vector<StampedPose> poses = map_trajectory(map, options.map);
  write_trajectory(*options.output,
                   options.trajectory == "tum" ? TrajectoryFormat::tum : TrajectoryFormat::kitti,
                   poses);
  return poses.size();
}

/// Submap by submap: memory holds one of them, and with a resolution the voxels that are taken.
template <class Writer>
uint64_t write_cloud(const MapDatabase& map, const ExportCommandOptions& options) {
  Writer writer(*options.output);
  std::optional<MapThinning> thinning;
  if (options.resolution) {
    thinning.emplace(*options.resolution);
  }
  std::vector<Point> points;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    points.clear();
    for (const SubmapPoint& point : load_submap(map, keyframe.id, options.map).points) {
      const Eigen::Vector3d p = keyframe.T_map_keyframe * point.position();
      if (!thinning || thinning->take(p)) {
        const Eigen::Vector3f single = p.cast<float>();
        points.push_back({.x = single.x(), .y = single.y(), .z = single.z()});
      }
    }
    writer.write(points);
  }
  writer.close();
  return writer.count();
}

std::size_t write_dump(const MapDatabase& map, const fs::path& path) {
  OutputFile file(path);
  std::size_t lines = 0;
  map.dump([&](std::string_view line) {
    file.write(line);
    file.write("\n");
    ++lines;
  });
  file.close();
  return lines;
}

int run(const ExportCommandOptions& options, std::ostream& out) {
  check_options(options);
  const MapDatabase map(options.map, MapAccess::read);
  std::string wrote;
  if (options.dump && !options.output) {
    map.dump([&](std::string_view line) { out << line << "\n"; });
    return 0;
  }
  if (options.dump) {
    wrote = fmt::format("{} lines", write_dump(map, *options.output));
  } else if (!options.trajectory.empty()) {
    wrote = fmt::format("{} poses", write_poses(map, options));
  } else if (!options.graph.empty()) {
    const PoseGraph graph = map.graph();
    write_g2o(*options.output, graph);
    wrote = fmt::format("{} nodes, {} edges", graph.nodes().size(), graph.edges().size());
  } else {
    const uint64_t points = options.cloud == "ply" ? write_cloud<PlyWriter>(map, options)
                                                   : write_cloud<PcdWriter>(map, options);
    wrote = fmt::format("{} points", points);
  }
  out << "wrote  " << options.output->string() << " (" << wrote << ")\n";
  return 0;
}

}  // namespace

int export_command(const ExportCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit export", out, err, [&] { return run(options, out); });
}

void add_export_command(Command app, std::function<void(int)> done) {
  const Command command = app.add_command("export", "Write what a map holds in another format");
  const auto options = std::make_shared<ExportCommandOptions>();
  command.footer(
      "MAP is what `adit run` leaves as OUT/map.adit. Points and poses are in the map's frame, m.\n"
      "\nExamples:\n"
      "  adit export out/map.adit --trajectory tum -o trajectory.tum\n"
      "  adit export out/map.adit --graph g2o -o graph.g2o\n"
      "  adit export out/map.adit --cloud pcd --resolution 0.1 -o cloud.pcd\n"
      "  adit export out/map.adit --dump | sha256sum\n\n"
      "Exit codes: 0 done, 1 the map cannot be read or the file not written, 2 usage.");
  command.option("map", options->map, "The map").required().value_name("MAP");
  command.option("-o,--output", options->output, "The file to write").value_name("FILE");
  command.option("--trajectory", options->trajectory, "The pose of every sweep: tum, kitti, csv")
      .one_of({"tum", "kitti", "csv"})
      .value_name("FORMAT");
  command.option("--graph", options->graph, "Keyframes and edges: g2o")
      .one_of({"g2o"})
      .value_name("FORMAT");
  command.option("--cloud", options->cloud, "The points of all submaps: ply, pcd")
      .one_of({"ply", "pcd"})
      .value_name("FORMAT");
  command.option("--resolution", options->resolution, "One point of the cloud a voxel of this (m)")
      .value_name("M");
  command.flag("--dump", options->dump,
               "All content as text, for comparing; to the standard output without -o");
  command.action(
      [options, done = std::move(done)] { done(export_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
