// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The points of a map get the colours that cameras beside its lidar saw them in
// (docs/theory/coloring.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "adit/slam/coloring/view_coloring.hpp"
#include "adit/slam/core/recently_used.hpp"
#include "adit/tools/cameras/camera_source.hpp"
#include "adit/tools/coloring/camera_mounting.hpp"
#include "adit/tools/coloring/map_views.hpp"
#include "adit/tools/coloring/view_surfaces.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"

namespace adit {

/// What a camera's views say of its mounting and clock.
struct CameraFinding {
  std::string camera;
  CameraError error = CameraError::Zero();
  bool determined = false;  ///< CameraErrorEstimate::determined
  bool corrected = false;   ///< surfaces that were kept aside agree: colours are made with it

  double turned() const { return error.head<3>().norm(); }  ///< rad
  double late() const { return error[3]; }                  ///< s, images after their stamps
};

/// What colouring came to.
struct ColoringCounts {
  uint64_t points = 0;
  uint64_t colored = 0;
  std::size_t images = 0;      ///< of all cameras
  std::size_t views = 0;       ///< images that were used
  std::size_t damaged = 0;     ///< images that cannot be read
  std::size_t other_size = 0;  ///< images of another size than the first ones
};

class MapColoring {
 public:
  /// Cameras with images and a mounting. The map and the context must outlive it.
  /// What is in `moved` (null: nothing) hides nothing.
  MapColoring(const MapDatabase& map, engine::Context& context, std::vector<CameraSource> cameras,
              const SensorPath& path, std::shared_ptr<const MovedSpace> moved,
              uint64_t submap_bytes);

  /// Finds the gains of all views and, where `corrects`, the cameras' errors before. `progress` by
  /// images that were looked at.
  std::vector<CameraFinding> prepare(
      bool corrects, const std::function<void(std::size_t done, std::size_t total)>& progress);

  /// Gives points that were seen from around `sensor` (map frame, m) their colours, by their places
  /// in the map. What moves stays black: it was elsewhere when most images were taken.
  void color(std::span<CloudPoint> points, const Eigen::Vector3d& sensor);

  ColoringCounts counts() const;

 private:
  using View = std::shared_ptr<const ViewColoring::View>;

  /// Numbers of the views that see some of the points best.
  std::vector<std::size_t> views_of(std::span<const Eigen::Vector3d> places,
                                    const Eigen::Vector3d& sensor) const;
  std::vector<std::size_t> most_wanted(const std::map<std::size_t, std::size_t>& votes) const;
  View view(std::size_t number);
  View make(std::size_t number);
  /// The image of a view; none where it cannot be read.
  std::optional<ColorImage> image_of(const MapView& view);
  View view_of(const MapView& view, std::span<const uint8_t> rgb);
  /// The samples that a view may see.
  std::vector<SurfaceSample> samples_of(const MapView& view);
  CameraFinding find_error(std::size_t camera, const std::function<void()>& working);
  void balance(const std::function<void(std::size_t, std::size_t)>& progress);
  double reach_of(std::size_t camera) const;

  ViewColoring coloring_;
  ViewSurfaces surfaces_;
  std::vector<CameraSource> cameras_;
  std::vector<CameraProjection> projections_;
  std::vector<std::shared_ptr<const ViewColoring::Camera>> lenses_;
  SensorPath path_;
  std::vector<MapView> views_;
  std::vector<std::array<float, 3>> gains_;  ///< by view
  RecentlyUsed<std::size_t, View> kept_;     ///< by number; null: its image cannot be read
  std::set<std::size_t> used_;
  std::set<std::pair<std::size_t, std::size_t>> damaged_;     ///< camera and image
  std::set<std::pair<std::size_t, std::size_t>> other_size_;  ///< likewise
  ColoringCounts counts_;
};

}  // namespace adit
