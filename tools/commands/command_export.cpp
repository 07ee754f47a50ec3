// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_export.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/clouds/pcd_writer.hpp"
#include "adit/tools/clouds/ply_writer.hpp"
#include "adit/tools/commands/command_guard.hpp"
#include "adit/tools/commands/command_line.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/drawing/map_picture.hpp"
#include "adit/tools/maps/dense_cloud.hpp"
#include "adit/tools/maps/g2o_file.hpp"
#include "adit/tools/maps/map_database.hpp"
#include "adit/tools/maps/map_trajectory.hpp"
#include "adit/tools/maps/tiled_cloud.hpp"
#include "adit/tools/recordings/tolerant_recording.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/run/config_file.hpp"
#include "adit/tools/run/configured_recording.hpp"
#include "adit/tools/run/memory_limit.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

void check_options(const ExportCommandOptions& options) {
  const int wanted =
      static_cast<int>(!options.trajectory.empty()) + static_cast<int>(!options.graph.empty()) +
      static_cast<int>(!options.cloud.empty()) + static_cast<int>(!options.dense.empty()) +
      static_cast<int>(options.picture) + static_cast<int>(options.dump);
  if (wanted != 1) {
    throw UsageError(
        "say what to export: one of --trajectory, --graph, --cloud, --dense, --picture and "
        "--dump.");
  }
  if (!options.dump && !options.output) {
    throw UsageError("say where to: -o FILE.");
  }
  if (options.resolution && options.cloud.empty()) {
    throw UsageError("--resolution needs --cloud.");
  }
  if (options.picture && options.output->extension() != ".svg" &&
      options.output->extension() != ".png") {
    throw UsageError("-o " + options.output->string() +
                     ": pictures are SVG or PNG files; name it *.svg or *.png.");
  }
  if (options.resolution && !(*options.resolution >= 1e-3 && *options.resolution <= 1e3)) {
    throw UsageError("--resolution: must be between 0.001 and 1000 m.");
  }
  if (options.recording && options.dense.empty()) {
    throw UsageError("--recording needs --dense.");
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
  // The last keyframes of a run that has not ended have no edge yet, and are no parts.
  const std::vector<MapSession> sessions = map.sessions();
  const bool ended = std::ranges::all_of(
      sessions, [&](const MapSession& session) { return map.progress(session.id).ending; });
  write_trajectory(*options.output,
                   options.trajectory == "tum" ? TrajectoryFormat::tum : TrajectoryFormat::kitti,
                   poses, ended ? map_parts(map, options.map) : std::vector<std::size_t>());
  return poses.size();
}

// What an export needs besides the program: the voxels of a tile, a submap, a sweep.
constexpr uint64_t kWorkingBytes = uint64_t{96} << 20U;

void require_within(const MemoryLimit& memory, const fs::path& output) {
  if (memory.exceeded()) {
    throw OutputError(output, output.string() + ": not completed: " + memory.text() +
                                  ". Allow more, or choose a coarser --resolution.");
  }
}

/// Submap by submap, or tile by tile: memory does not grow with the map.
template <class Writer>
uint64_t write_cloud(const MapDatabase& map, const ExportCommandOptions& options,
                     const MemoryLimit& memory) {
  Writer writer(*options.output);
  if (options.resolution) {
    visit_thinned_cloud(map, *options.resolution, memory.submap_bytes(),
                        [&](std::span<const Point> points) {
                          writer.write(points);
                          require_within(memory, *options.output);
                        });
  } else {
    std::vector<Point> points;
    for (const MapKeyframe& keyframe : map.keyframes()) {
      points.clear();
      for (const SubmapPoint& point : load_submap(map, keyframe.id, options.map).points) {
        const Eigen::Vector3f p = (keyframe.T_map_keyframe * point.position()).cast<float>();
        points.push_back({.x = p.x(), .y = p.y(), .z = p.z()});
      }
      writer.write(points);
      require_within(memory, *options.output);
    }
  }
  writer.close();
  return writer.count();
}

/// What a session's provenance tells under a name.
std::optional<std::string> provenance(const MapSession& session, const std::string& name) {
  for (const auto& [key, value] : session.provenance) {
    if (key == name) {
      return value;
    }
  }
  return std::nullopt;
}

/// What was written of a recording.
struct DenseCloud {
  uint64_t points = 0;
  std::size_t sweeps = 0;
  std::size_t without_pose = 0;
  std::size_t damaged = 0;
};

/// Sweep by sweep: memory holds one of them.
template <class Writer>
DenseCloud write_dense(const MapDatabase& map, const ExportCommandOptions& options,
                       const MemoryLimit& memory, std::ostream& err) {
  const std::vector<MapSession> sessions = map.sessions();
  if (sessions.size() != 1) {
    throw InputError(options.map, {}, "it holds " + std::to_string(sessions.size()) + " sessions",
                     "A dense cloud is made of a map of one recording");
  }
  const RecordingConfig settings =
      parse_config(sessions.front().configuration, options.map).recording;
  const fs::path path = options.recording
                            ? *options.recording
                            : fs::path(provenance(sessions.front(), "recording").value_or(""));
  const std::unique_ptr<Recording> recording = open_recording(path, settings);
  const std::optional<std::string> named = provenance(sessions.front(), "topic");
  const std::size_t topic = sweep_topic(*recording, path, named ? named : settings.sweep_topic);
  std::vector<StampedPose> poses = map_trajectory(map, options.map);
  Progress progress(err, progress_style_of_stderr(), "export", poses.size());
  const SensorPath sensor(std::move(poses));
  DenseCloud cloud;
  const auto whole = pass_over_damage(*recording, [&](const InputError&) { ++cloud.damaged; });
  const auto stream = whole->events({.topics = {topic}});
  std::optional<Writer> writer;  // of another recording nothing is written
  while (const std::optional<Event> event = stream->next()) {
    const auto& sweep = std::get<Sweep>(event->value);
    if (const auto stretch = sensor.from(sweep.stamp)) {
      if (!writer) {
        writer.emplace(*options.output);
      }
      writer->write(placed_points(sweep, *stretch));
      ++cloud.sweeps;
      progress.update(cloud.sweeps, 0);
      require_within(memory, *options.output);
    } else {
      ++cloud.without_pose;
    }
  }
  progress.finish();
  if (!writer) {
    throw InputError(path, {}, "none of its sweeps is in the map",
                     "Name the recording that the map is of: --recording REC");
  }
  writer->close();
  cloud.points = writer->count();
  return cloud;
}

std::string written(const DenseCloud& cloud) {
  std::string text = fmt::format("{} points of {} sweeps", cloud.points, cloud.sweeps);
  if (cloud.without_pose > 0) {
    text += fmt::format("; {} sweeps have no pose in the map", cloud.without_pose);
  }
  if (cloud.damaged > 0) {
    text += fmt::format("; {} places of the recording are damaged", cloud.damaged);
  }
  return text;
}

// Voxels of a picture: finer than its cells, of which there are a few hundred a side.
constexpr double kFinestOfPicture = 0.1;  // m
constexpr double kVoxelsAPicture = 1000.0;

/// The points of all submaps, thinned, with sweeps and loops over them. Returns the keyframes.
std::size_t write_picture(const MapDatabase& map, const ExportCommandOptions& options,
                          PictureFormat format, const MemoryLimit& memory) {
  std::vector<Point> points;
  PictureGraph drawn;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    drawn.keyframes.emplace_back(keyframe.T_map_keyframe.translation().head<2>());
  }
  Eigen::AlignedBox3d extent;
  for (const auto& [id, box] : map.boxes()) {
    extent.extend(box);
  }
  const double widest = extent.isEmpty() ? 0.0 : extent.sizes().head<2>().maxCoeff();
  visit_thinned_cloud(map, std::max(kFinestOfPicture, widest / kVoxelsAPicture),
                      memory.submap_bytes(), [&](std::span<const Point> tile) {
                        points.insert(points.end(), tile.begin(), tile.end());
                        require_within(memory, *options.output);
                      });
  const PoseGraph graph = map.graph();
  const auto place = [&](NodeId id) -> Eigen::Vector2d {
    return graph.nodes()[graph.index_of(id)].T_map_node.translation().head<2>();
  };
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind == EdgeKind::loop) {
      drawn.loops.push_back({.from = place(edge.from),
                             .to = place(edge.to),
                             .revoked = edge.status == EdgeStatus::revoked});
    }
  }
  write_text_file(*options.output, map_picture(points, map_trajectory(map, options.map),
                                               options.map.filename().string(), drawn, format));
  return drawn.keyframes.size();
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

PictureFormat picture_format(const fs::path& output) {
  return output.extension() == ".png" ? PictureFormat::png : PictureFormat::svg;
}

/// Writes what is asked for and says what that was.
std::string write(const MapDatabase& map, const ExportCommandOptions& options,
                  PictureFormat picture, const MemoryLimit& memory, std::ostream& err) {
  if (options.dump) {
    return fmt::format("{} lines", write_dump(map, *options.output));
  }
  if (!options.dense.empty()) {
    return written(options.dense == "ply" ? write_dense<TimedPlyWriter>(map, options, memory, err)
                                          : write_dense<TimedPcdWriter>(map, options, memory, err));
  }
  if (options.picture) {
    return fmt::format("{} keyframes", write_picture(map, options, picture, memory));
  }
  if (!options.trajectory.empty()) {
    return fmt::format("{} poses", write_poses(map, options));
  }
  if (!options.graph.empty()) {
    const PoseGraph graph = map.graph();
    write_g2o(*options.output, graph);
    return fmt::format("{} nodes, {} edges", graph.nodes().size(), graph.edges().size());
  }
  return fmt::format("{} points", options.cloud == "ply"
                                      ? write_cloud<PlyWriter>(map, options, memory)
                                      : write_cloud<PcdWriter>(map, options, memory));
}

int run(const ExportCommandOptions& options, std::ostream& out, std::ostream& err) {
  check_options(options);
  const MemoryLimit memory(options.max_ram_bytes, kWorkingBytes);
  const MapDatabase map(options.map, MapAccess::read);
  if (options.dump && !options.output) {
    map.dump([&](std::string_view line) { out << line << "\n"; });
    return 0;
  }
  // What cannot be completed leaves what was there; devices and pipes have no place to take.
  std::error_code ignored;
  std::optional<Draft> draft;
  if (!fs::exists(*options.output, ignored) || fs::is_regular_file(*options.output, ignored)) {
    draft.emplace(*options.output);
  }
  ExportCommandOptions drafted = options;
  drafted.output = draft ? draft->path() : *options.output;
  const std::string wrote = write(map, drafted, picture_format(*options.output), memory, err);
  if (draft) {
    draft->take_its_place();
  }
  out << "wrote  " << options.output->string() << " (" << wrote << ")\n";
  return 0;
}

}  // namespace

int export_command(const ExportCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit export", out, err, [&] { return run(options, out, err); });
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
      "  adit export out/map.adit --dense ply -o dense.ply\n"
      "  adit export out/map.adit --picture -o map.png\n"
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
  command
      .option("--dense", options->dense,
              "Every return of the recording with intensity, time and ring: ply, pcd")
      .one_of({"ply", "pcd"})
      .value_name("FORMAT");
  command
      .option("--recording", options->recording,
              "Where the recording of a dense cloud is, if not where it was mapped")
      .value_name("REC");
  command.option("--resolution", options->resolution, "One point of the cloud a voxel of this (m)")
      .value_name("M");
  add_max_ram_option(command, options->max_ram_bytes);
  command.flag(
      "--picture", options->picture,
      "The map from above with its graph, path, scale and legend: SVG, or PNG by FILE's end");
  command.flag("--dump", options->dump,
               "All content as text, for comparing; to the standard output without -o");
  command.action(
      [options, done = std::move(done)] { done(export_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
