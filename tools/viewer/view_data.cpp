// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/view_data.hpp"

#include <algorithm>
#include <array>
#include <span>

#include <nlohmann/json.hpp>

#include "adit/tools/clouds/cloud_origin.hpp"
#include "adit/tools/clouds/las_reader.hpp"
#include "adit/tools/clouds/pcd_reader.hpp"
#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_products/tiled_cloud.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/usage_error.hpp"
#include "adit/tools/support/version.hpp"
#include "adit/tools/viewer/brightness.hpp"
#include "adit/tools/viewer/foxglove_cloud_feed.hpp"
#include "adit/tools/viewer/foxglove_run_feed.hpp"
#include "adit/tools/viewer/seen_intensity.hpp"
#include "adit/tools/viewer/view_plots.hpp"
#include "adit/tools/viewer/view_world.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr uint64_t kKeyframesTold = 65'536;
// A place beyond is no place that a sensor was at, and would make all others one point.
constexpr double kFarthest = 1e8;       // m
constexpr double kLongestSurvey = 1e6;  // s

/// What is shown of a folder or file.
struct ViewFiles {
  fs::path map;         ///< a map database, or
  fs::path cloud;       ///< a cloud, and
  fs::path trajectory;  ///< its trajectory, where there is one
};

std::string extension_of(const fs::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool is_las_file(const std::string& extension) {
  return extension == ".las" || extension == ".laz";
}

bool is_cloud(const fs::path& file) {
  const std::string extension = extension_of(file);
  return extension == ".ply" || extension == ".pcd" || is_las_file(extension);
}

constexpr std::array kShownOfAFolder = {"map.adit", "map.ply", "cloud.ply"};

ViewFiles files_in(const fs::path& folder) {
  if (fs::exists(folder / "map.adit")) {
    return {.map = folder / "map.adit", .cloud = {}, .trajectory = {}};
  }
  for (const char* name : {"map.ply", "cloud.ply"}) {
    if (fs::exists(folder / name)) {
      const fs::path trajectory = folder / "trajectory.tum";
      return {.map = {},
              .cloud = folder / name,
              .trajectory = fs::exists(trajectory) ? trajectory : fs::path()};
    }
  }
  throw InputError(folder, {}, "it holds neither map.adit nor map.ply nor cloud.ply",
                   "`adit view` shows what `adit run RECORDING -o OUT` leaves in OUT");
}

ViewFiles files_of(const fs::path& what) {
  if (fs::is_directory(what)) {
    return files_in(what);
  }
  if (is_cloud(what)) {
    return {.map = {}, .cloud = what, .trajectory = {}};
  }
  if (fs::exists(what) && extension_of(what) != ".adit") {
    throw InputError(
        what, {}, "it is neither a map nor a cloud (.adit, .ply, .pcd, .las, .laz)",
        "A recording is mapped first: adit run " + what.string() + " -o out, then adit view out");
  }
  return {.map = what, .cloud = {}, .trajectory = {}};
}

CloudFile read_any_cloud(const fs::path& file) {
  const std::string extension = extension_of(file);
  return extension == ".pcd"      ? read_pcd(file, {.colors = true})
         : is_las_file(extension) ? read_las(file, {.longest = kLongestSurvey, .colors = true})
                                  : read_ply(file, {.colors = true});
}

bool is_place(const Point& point) {
  const Eigen::Vector3f p(point.x, point.y, point.z);
  return p.allFinite() && p.cwiseAbs().maxCoeff() < static_cast<float>(kFarthest);
}

ViewSpan span_of(const std::vector<ViewSweep>& sweeps) {
  if (sweeps.empty()) {
    return {};
  }
  const auto [first, last] = std::ranges::minmax(sweeps, {}, &ViewSweep::stamp);
  return {.first = first.stamp, .last = last.stamp};
}

}  // namespace

bool is_shown_as_it_is(const fs::path& what) {
  if (fs::is_directory(what)) {
    return std::ranges::any_of(kShownOfAFolder,
                               [&](const char* name) { return fs::exists(what / name); });
  }
  return !fs::exists(what) || is_cloud(what) || extension_of(what) == ".adit";
}

ViewData::ViewData(const ViewDataOptions& options, std::ostream& progress)
    : folder_(fs::is_directory(options.what) ? options.what : fs::path()),
      edit_(options.edit),
      verify_(options.verify),
      truth_(options.truth),
      stop_(options.stop) {
  const ViewFiles files = files_of(options.what);
  title_ = options.what.filename().empty() ? options.what.parent_path().filename().string()
                                           : options.what.filename().string();
  if (files.map.empty() && truth_) {
    throw UsageError("--truth: " + options.what.string() +
                     " has no map.adit, whose keyframes could be compared.");
  }
  if (files.map.empty() && edit_) {
    throw UsageError("--edit: " + options.what.string() +
                     " has no map.adit, so there are no loops to edit.");
  }
  if (!files.trajectory.empty()) {
    const Trajectory trajectory = read_trajectory(files.trajectory);
    for (const StampedPose& pose : trajectory.poses) {
      sweeps_.push_back({.stamp = pose.stamp, .keyframe = -1, .T_keyframe_lidar = pose.pose});
    }
    span_ = span_of(sweeps_);
  }
  if (files.map.empty()) {
    read_cloud(files.cloud, progress);
  } else {
    read_map(files.map, options, progress);
  }
}

void ViewData::read_map(const fs::path& file, const ViewDataOptions& options,
                        std::ostream& progress) {
  map_ = file;
  const MapDatabase map(file, MapAccess::read);
  sweeps_ = sweeps_of(map);
  span_ = span_of(sweeps_);
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  keyframes_ = keyframes.size();
  Eigen::AlignedBox3d box;
  for (const auto& [id, one] : map.boxes()) {
    if (one.min().cwiseAbs().maxCoeff() < kFarthest &&
        one.max().cwiseAbs().maxCoeff() < kFarthest) {
      box.extend(one);
    }
  }
  if (box.isEmpty()) {
    box.extend(Eigen::Vector3d::Zero().eval());
  }
  CloudTilesMaker maker(cube_about(box.min(), box.max()));
  Progress bar(progress, progress_style_of_stderr(), "read", keyframes_, Progress::Clock::now(),
               "keyframes");
  std::size_t read = 0;
  const SeenIntensity seen =
      folder_.empty() ? SeenIntensity() : SeenIntensity::of(folder_, keyframes, sweeps_, progress);
  bool has_intensity = false;
  visit_cloud(map, {}, {}, [&](std::span<const CloudPoint> points) {
    // The same number for all of them: keyframes beyond 65536 share theirs with the next.
    const auto keyframe = static_cast<uint16_t>(
        keyframes_ <= kKeyframesTold ? read : read * kKeyframesTold / keyframes_);
    for (const CloudPoint& point : options.paint ? options.paint(points) : points) {
      const std::optional<uint8_t> intensity = seen.at(read, point.position);
      has_intensity = has_intensity || intensity;
      maker.add(point.position,
                {.moment = span_.moment_of(point.time),
                 .keyframe = keyframe,
                 .intensity = intensity.value_or(0),
                 .flags = static_cast<uint8_t>((point.moving ? kMoves : 0) |
                                               (intensity ? 0 : kNoIntensity))},
                point.color);
    }
    bar.update(++read, 0);
    stop_if_wanted();
  });
  bar.finish();
  make_tiles(maker, progress);
  make_scene(has_intensity, keyframes, progress);
  earth_ = map.georeference();
  graph_ = graph_text(map);
}

std::string ViewData::graph_text(const MapDatabase& map) const {
  return text_of(graph_of(map, span_, truth_ ? std::optional(truth_(map)) : std::nullopt));
}

void ViewData::read_cloud(const fs::path& file, std::ostream& progress) {
  const CloudFile cloud = read_any_cloud(file);
  for (const InputError& fault : cloud.faults) {
    progress << "note: " << fault.what() << "\n";
  }
  if (!cloud.sweep.offset.isZero(0.0)) {
    progress << "note: the coordinates are large: " << offset_text(cloud.sweep.offset)
             << " is subtracted from what is shown\n";
  }
  if (cloud.coordinate_step > 0.0) {
    progress << "note: " << coarse_note(cloud.coordinate_step) << "\n";
  }
  const std::vector<Point>& points = cloud.sweep.points;
  Eigen::AlignedBox3d box;
  for (const Point& point : points) {
    if (is_place(point)) {
      box.extend(Eigen::Vector3f(point.x, point.y, point.z).cast<double>());
    }
  }
  if (points.empty()) {
    throw InputError(file, {}, "it holds no points", "Name a cloud that does, a map or a run");
  }
  if (box.isEmpty()) {
    throw InputError(file, {}, "it has no point that is anywhere",
                     "Its coordinates are all NaN or beyond " + std::to_string(kFarthest) + " m");
  }
  const float brightest = cloud.has_intensity ? usual_brightest(points) : 0.0F;
  // Points tell of their own time where nothing else does.
  const bool timed = cloud.sweep.times.size() == points.size() && sweeps_.empty();
  if (timed) {
    span_ = {.first = Nanoseconds(0), .last = nanoseconds(duration_of(cloud.sweep))};
  }
  CloudTilesMaker maker(cube_about(box.min(), box.max()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& point = points[i];
    if (!is_place(point)) {
      continue;
    }
    const double time = timed && std::isfinite(cloud.sweep.times[i]) ? cloud.sweep.times[i] : 0.0;
    maker.add(Eigen::Vector3d(point.x, point.y, point.z),
              {.moment = timed ? span_.moment_of(nanoseconds(time)) : uint16_t{0},
               .intensity = brightness_of(point.intensity, brightest)},
              cloud.colors.empty() ? PointColor{} : cloud.colors[i]);
  }
  make_tiles(maker, progress);
  make_scene(brightest > 0.0F, {}, progress);
  graph_ = text_of(no_graph());
}

void ViewData::stop_if_wanted() const {
  if (stop_ && stop_()) {
    throw ViewStopped("stopped before there was something to show");
  }
}

void ViewData::make_tiles(CloudTilesMaker& maker, std::ostream& progress) {
  Progress bar(progress, progress_style_of_stderr(), "tile", maker.added(), Progress::Clock::now(),
               "points");
  tiles_ = maker.make([&](uint64_t done) {
    bar.update(done, 0);
    stop_if_wanted();
  });
  bar.finish();
}

/// `tiled`: where keyframes were when their points came into tiles.
void ViewData::make_scene(bool has_intensity, const std::vector<MapKeyframe>& tiled,
                          std::ostream& progress) {
  ordered_json parents = ordered_json::array();
  ordered_json octants = ordered_json::array();
  ordered_json counts = ordered_json::array();
  for (const CloudTile& tile : tiles_.tiles()) {
    parents.push_back(tile.parent);
    octants.push_back(tile.octant);
    counts.push_back(tile.points);
  }
  const ViewRun run = folder_.empty() ? no_run() : run_of(folder_, span_, sweeps_, progress);
  const CloudCube& cube = tiles_.cube();
  scene_ = text_of({{"type", "scene"},
                    {"program", std::string(kGenerator)},
                    {"title", title_},
                    {"editable", edit_},
                    {"intensity", has_intensity},
                    {"colors", tiles_.colored()},
                    {"start_ns", std::to_string(span_.first.count())},
                    {"seconds", seconds(span_.last - span_.first)},
                    {"points", tiles_.points()},
                    {"keyframes_told", std::min<uint64_t>(keyframes_, kKeyframesTold)},
                    {"cube",
                     {{"low", {cube.low.x(), cube.low.y(), cube.low.z()}},
                      {"edge", cube.edge},
                      {"cells", kTileCells}}},
                    {"tiles", {{"parent", parents}, {"octant", octants}, {"points", counts}}},
                    {"tiled_poses", poses_of(tiled)},
                    {"sweeps", json_of(sweeps_, span_)},
                    {"map", map_.string()},
                    {"plots", run.plots},
                    {"weak", run.weak},
                    {"sources", run.sources}});
}

std::string ViewData::tile(uint32_t number) const {
  if (number >= tiles_.tiles().size()) {
    return {};
  }
  return tile_message(number, tiles_.read(number), tiles_.read_colors(number));
}

std::shared_ptr<FoxgloveFeed> ViewData::foxglove() {
  if (!foxglove_ && map_.empty() && sweeps_.empty()) {
    foxglove_ = std::make_shared<FoxgloveCloudFeed>(tiles_);
  } else if (!foxglove_) {
    foxglove_ = std::make_shared<FoxgloveRunFeed>(folder_.empty() ? map_ : folder_);
  }
  return foxglove_;
}

std::string ViewData::place(const Eigen::Vector3d& p_map) const {
  return place_answer(earth_, p_map);
}

void ViewData::must_edit() const {
  if (!edit_) {
    throw UsageError("this view does not edit: start it with `adit view MAP --edit`.");
  }
}

/// The graph is another.
LoopChange ViewData::shown(LoopChange changed) {
  foxglove_.reset();
  const MapDatabase map(map_, MapAccess::read);
  graph_ = graph_text(map);
  earth_ = map.georeference();
  return changed;
}

LoopChange ViewData::change(int64_t loop, LoopAction action) {
  must_edit();
  return shown(change_loop(map_, loop, action));
}

LoopChange ViewData::add(const LoopByHand& loop) {
  must_edit();
  if (!verify_) {
    throw UsageError("this view cannot verify a loop: use `adit loops MAP --add A B`.");
  }
  return shown(add_loop(map_, loop, verify_));
}

}  // namespace adit
