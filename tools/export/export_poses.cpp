// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/export_poses.hpp"

#include <algorithm>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_products/g2o_file.hpp"
#include "adit/tools/map_products/tiled_cloud.hpp"
#include "adit/tools/map_products/trajectory_products.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

// Voxels of a picture: finer than its cells, of which there are a few hundred a side.
constexpr double kFinestOfPicture = 0.1;  // m
constexpr double kVoxelsAPicture = 1000.0;

}  // namespace

std::string export_trajectory(const ExportJob& job) {
  const std::string& format = job.options->trajectory;
  const MapPath path = map_path(*job.map, selection_of(job, {}));
  const auto poses = [](std::size_t count) { return fmt::format("{} poses", count); };
  if (format == "csv") {
    const bool on_earth = job.georeference || !job.options->frame.empty() || job.options->utm ||
                          job.options->crs || job.options->geoid;
    return poses(write_trajectory_csv(
        job.file, path, on_earth ? std::optional(earth_of(job, format)) : std::nullopt));
  }
  if (format == "geojson") {
    return poses(write_trajectory_geojson(job.file, path, *job.map, earth_of(job, format))) +
           ", in degrees on WGS 84";
  }
  if (format == "kml") {
    return poses(write_trajectory_kml(job.file, path, job.options->map.filename().string(),
                                      earth_of(job, format))) +
           ", in degrees on WGS 84";
  }
  if (format == "gpkg") {
    const ProductCoordinates earth = earth_of(job, format);
    return poses(write_trajectory_geopackage(job.file, path, *job.map, earth)) +
           (earth.epsg() ? in_coordinates(earth) : ", in degrees on WGS 84");
  }
  const ProductCoordinates coordinates = coordinates_of(job, false);
  std::vector<StampedPose> placed;
  placed.reserve(path.sweeps.size());
  for (const MapSweep& sweep : path.sweeps) {
    placed.push_back({.stamp = sweep.stamp, .pose = coordinates.from_map(sweep.T_map_lidar)});
  }
  write_trajectory(job.file, format == "tum" ? TrajectoryFormat::tum : TrajectoryFormat::kitti,
                   placed, path.parts);
  return poses(placed.size()) + in_coordinates(coordinates);
}

std::string export_graph(const ExportJob& job) {
  PoseGraph graph = job.map->graph();
  const ProductCoordinates coordinates = coordinates_of(job, false);
  if (coordinates.frame() != ProductFrame::map) {
    for (const PoseNode& node : std::vector<PoseNode>(graph.nodes())) {
      graph.set_pose(node.id, coordinates.from_map(node.T_map_node));
    }
  }
  write_g2o(job.file, graph);
  return fmt::format("{} nodes, {} edges{}", graph.nodes().size(), graph.edges().size(),
                     in_coordinates(coordinates));
}

std::string drawing_of(const ExportJob& job, const ProductCoordinates& coordinates,
                       const std::string& title, PictureFormat format) {
  const MapDatabase& map = *job.map;
  std::vector<Point> points;
  PictureGraph drawn;
  drawn.north_up = coordinates.frame() == ProductFrame::local;
  const auto place = [&](const Eigen::Isometry3d& pose) -> Eigen::Vector2d {
    return coordinates.from_map(Eigen::Vector3d(pose.translation())).head<2>();
  };
  for (const MapKeyframe& keyframe : map.keyframes()) {
    drawn.keyframes.push_back(place(keyframe.T_map_keyframe));
  }
  Eigen::AlignedBox3d extent;
  for (const auto& [id, box] : map.boxes()) {
    extent.extend(box);
  }
  const double widest = extent.isEmpty() ? 0.0 : extent.sizes().head<2>().maxCoeff();
  visit_thinned_cloud(map, coordinates, {}, std::max(kFinestOfPicture, widest / kVoxelsAPicture),
                      job.memory->submap_bytes(), [&](std::span<const CloudPoint> tile) {
                        for (const CloudPoint& point : tile) {
                          const Eigen::Vector3f p = point.position.cast<float>();
                          points.push_back({.x = p.x(), .y = p.y(), .z = p.z()});
                        }
                        require_within(job);
                      });
  const PoseGraph graph = map.graph();
  const auto node = [&](NodeId id) { return place(graph.nodes()[graph.index_of(id)].T_map_node); };
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind == EdgeKind::loop) {
      drawn.loops.push_back({.from = node(edge.from),
                             .to = node(edge.to),
                             .revoked = edge.status == EdgeStatus::revoked});
    }
  }
  std::vector<StampedPose> path = map_trajectory(map, job.options->map);
  for (StampedPose& pose : path) {
    pose.pose = coordinates.from_map(pose.pose);
  }
  return map_picture(points, path, title, drawn, format);
}

std::string export_picture(const ExportJob& job, PictureFormat format) {
  write_text_file(job.file, drawing_of(job, {}, job.options->map.filename().string(), format));
  return fmt::format("{} keyframes", job.map->keyframes().size());
}

}  // namespace adit
