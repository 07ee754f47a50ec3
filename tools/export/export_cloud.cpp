// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/export_cloud.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/export/cloud_classes.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_products/cloud_product.hpp"
#include "adit/tools/map_products/dense_cloud.hpp"
#include "adit/tools/map_products/tile_folder.hpp"
#include "adit/tools/map_products/tiled_cloud.hpp"
#include "adit/tools/map_products/trajectory_products.hpp"
#include "adit/tools/recordings/merged_sweeps.hpp"
#include "adit/tools/recordings/one_sensor.hpp"
#include "adit/tools/recordings/tolerant_recording.hpp"
#include "adit/tools/recordings/topic_survey.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/run/earlier_run.hpp"
#include "adit/tools/run/run_options.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/setup/configured_recording.hpp"
#include "adit/tools/setup/sensor_topics.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

bool has_unix_times(const MapDatabase& map) {
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  return !keyframes.empty() && std::ranges::all_of(keyframes, [](const MapKeyframe& keyframe) {
    return is_unix_time(keyframe.stamp);
  });
}

/// What LAS files say of times, which have to be in GPS time.
std::string times_of(CloudFormat format, const CloudHeading& heading) {
  return !is_las(format)      ? ""
         : heading.unix_times ? ", in adjusted standard GPS time"
                              : ", in the recording's own time";
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

/// The keyframe of each sweep, in the order of stamps.
std::vector<MapSweep> sweeps_by_stamp(const MapDatabase& map) {
  std::vector<MapSweep> sweeps = map_path(map, {}).sweeps;
  std::ranges::stable_sort(sweeps, {}, &MapSweep::stamp);
  return sweeps;
}

}  // namespace

std::string export_cloud(const ExportJob& job) {
  const ExportCommandOptions& options = *job.options;
  const CloudFormat format = cloud_format(options.cloud);
  const ProductCoordinates coordinates = coordinates_of(job, is_las(format));
  const CloudClasses classes = find_classes(job, coordinates);
  ClassFilter filter(classes);
  const CloudSelection selection = with_classes(selection_of(job, coordinates), classes);
  CloudHeading heading = heading_of(coordinates);
  heading.classified = classes.any();
  heading.unix_times = has_unix_times(*job.map);
  const std::unique_ptr<CloudProduct> product = make_cloud_product(job.file, format, heading);
  // Of a thinned cloud nobody knows how many pieces it comes in.
  std::optional<Progress> progress;
  if (!options.resolution) {
    progress.emplace(*job.err, progress_style_of_stderr(), "export", job.map->keyframes().size(),
                     Progress::Clock::now(), "keyframes");
  }
  std::size_t pieces = 0;
  const TakeCloud take = [&](std::span<const CloudPoint> points) {
    product->write(filter.pass(points));
    require_within(job);
    if (progress) {
      progress->update(++pieces, 0);
    }
  };
  if (options.resolution) {
    visit_thinned_cloud(*job.map, coordinates, selection, *options.resolution,
                        job.memory->submap_bytes(), take);
  } else {
    visit_cloud(*job.map, coordinates, selection, take);
  }
  if (progress) {
    progress->finish();
  }
  product->close();
  return fmt::format("{} points{}{}{}", product->count(), in_coordinates(coordinates),
                     times_of(format, heading), filter.text());
}

std::string visit_dense(const ExportJob& job, const ProductCoordinates& coordinates,
                        const CloudSelection& selection, const TakeCloud& take) {
  const ExportCommandOptions& options = *job.options;
  const std::vector<MapSession> sessions = job.map->sessions();
  if (sessions.size() != 1) {
    throw InputError(options.map, {}, "it holds " + std::to_string(sessions.size()) + " sessions",
                     "A dense cloud is made of a map of one recording");
  }
  Config settings = parse_config(sessions.front().configuration, options.map);
  settings.imu.use = false;  // sweeps alone are looked for
  settings.gnss.use = false;
  settings.velocity.use = false;
  std::vector<fs::path> paths = recordings_of(sessions.front());
  if (options.recording || paths.empty()) {
    paths = {options.recording.value_or(fs::path())};
  }
  const fs::path& path = paths.front();
  for (const fs::path& one : paths) {
    keep_input("-o", *options.output, one);
  }
  const std::unique_ptr<Recording> recording = open_recording(paths, settings.recording);
  const bool same = is_recording_of(sessions.front(), paths);
  if (!same && !options.recording) {
    throw InputError(path, {}, "it is not what the map was made of any more, by its content",
                     "Name the recording that it was made of: --recording REC");
  }
  const std::optional<std::string> named = provenance(sessions.front(), "topic");
  const std::size_t topic =
      sweep_topic(*recording, path, named ? named : settings.recording.sweep_topic);
  const std::vector<MapSweep> sweeps = sweeps_by_stamp(*job.map);
  std::vector<StampedPose> poses;
  poses.reserve(sweeps.size());
  for (const MapSweep& sweep : sweeps) {
    poses.push_back({.stamp = sweep.stamp, .pose = sweep.T_map_lidar});
  }
  Progress progress(*job.err, progress_style_of_stderr(), "export", poses.size());
  const SensorPath sensor(std::move(poses));
  std::size_t placed = 0;
  std::size_t without_pose = 0;
  std::size_t damaged = 0;
  const auto whole = pass_over_damage(*recording, [&](const InputError&) { ++damaged; });
  const RecordedSensors sensors = choose_sensors(*whole, topic, settings);
  const OneSensorRecording mapped(*whole, sensors.frames);
  const MergedRecording merged(mapped, sensors.sweeps, path);
  const auto whole_merged = pass_over_damage(merged, [&](const InputError&) { ++damaged; });
  const auto stream = whole_merged->events({.topics = {topic}});
  while (const std::optional<Event> event = stream->next()) {
    const auto& sweep = std::get<Sweep>(event->value);
    const auto stretch = sensor.from(sweep.stamp);
    if (!stretch) {
      ++without_pose;
      continue;
    }
    std::vector<CloudPoint> points = placed_points(sweep, *stretch);
    const MapSweep& known = *std::ranges::lower_bound(sweeps, sweep.stamp, {}, &MapSweep::stamp);
    std::erase_if(points, [&](const CloudPoint& point) {
      return selection.is_gone && selection.is_gone(point.position, known.session);
    });
    for (CloudPoint& point : points) {
      const Eigen::Vector3d in_map = point.position;
      point.moving = has_moved(selection, in_map);
      point.position = coordinates.from_map(in_map);
      classify(selection, in_map, point);
      point.keyframe = known.keyframe;
      point.session = known.session;
    }
    std::erase_if(points, [&](const CloudPoint& point) { return !is_wanted(selection, point); });
    take(points);
    ++placed;
    progress.update(placed, 0);
    require_within(job);
  }
  progress.finish();
  if (placed == 0) {
    throw InputError(path, {}, "none of its sweeps is in the map",
                     "Name the recording that the map is of: --recording REC");
  }
  std::string text = fmt::format("{} sweeps", placed);
  if (!same) {
    text += " of another file than the map was made of";
  }
  if (without_pose > 0) {
    text += fmt::format("; {} sweeps have no pose in the map", without_pose);
  }
  if (damaged > 0) {
    text += fmt::format("; {} places of the recording are damaged", damaged);
  }
  return text;
}

std::string export_dense(const ExportJob& job) {
  const CloudFormat format = cloud_format(job.options->dense);
  const ProductCoordinates coordinates = coordinates_of(job, is_las(format));
  CloudHeading heading = heading_of(coordinates);
  const CloudClasses classes = find_classes(job, coordinates);
  ClassFilter filter(classes);
  heading.measured = true;
  heading.classified = classes.any();
  heading.unix_times = has_unix_times(*job.map);
  std::unique_ptr<CloudProduct> product;  // of another recording nothing is written
  const std::string sweeps =
      visit_dense(job, coordinates, with_classes(selection_of(job, coordinates), classes),
                  [&](std::span<const CloudPoint> points) {
                    if (!product) {
                      product = make_cloud_product(job.file, format, heading);
                    }
                    product->write(filter.pass(points));
                  });
  product->close();
  return fmt::format("{} points of {}{}{}{}", product->count(), sweeps, in_coordinates(coordinates),
                     times_of(format, heading), filter.text());
}

std::string export_tiles(const ExportJob& job) {
  const ExportCommandOptions& options = *job.options;
  const CloudFormat format = options.cloud.empty() ? CloudFormat::pcd : cloud_format(options.cloud);
  ProductCoordinates coordinates = coordinates_of(job, true);
  CloudHeading heading = heading_of(coordinates);
  heading.unix_times = has_unix_times(*job.map);
  if (!is_las(format)) {  // Autoware's LocalCartesianUTM
    heading.offset = coordinates.origin();
    coordinates = coordinates.counted_from(heading.offset);
  }
  const CloudClasses classes = find_classes(job, coordinates);
  ClassFilter filter(classes);
  heading.classified = classes.any();
  if (job.file != *options.output) {
    TileFolder::remove(job.file);  // a draft that an interrupted export has left
  }
  TileFolder folder(job.file, format, heading, *options.tiles);
  visit_tiles(*job.map, coordinates,
              {.size = *options.tiles,
               .resolution = options.resolution,
               .selection = with_classes(selection_of(job, coordinates), classes)},
              job.memory->submap_bytes(),
              [&](const TileNumber& tile, std::span<const CloudPoint> points) {
                if (const auto kept = filter.pass(points); !kept.empty()) {
                  folder.write(tile, kept);
                }
                require_within(job);
              });
  folder.close(coordinates, job.georeference);
  return fmt::format(
      "{} points in {} tiles{}{}{}", folder.points(), folder.tiles(), in_coordinates(coordinates),
      is_las(format) || heading.coordinates.empty() ? "" : " less those of the origin",
      filter.text());
}

}  // namespace adit
