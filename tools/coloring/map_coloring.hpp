// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The points of a map get the colours that cameras beside its lidar saw them in
// (docs/theory/coloring.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <vector>

#include "adit/slam/coloring/view_coloring.hpp"
#include "adit/tools/cameras/camera_source.hpp"
#include "adit/tools/coloring/map_views.hpp"
#include "adit/tools/coloring/view_surfaces.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"

namespace adit {

/// What colouring came to.
struct ColoringCounts {
  uint64_t points = 0;
  uint64_t colored = 0;
  std::size_t images = 0;   ///< of all cameras
  std::size_t views = 0;    ///< images that were used
  std::size_t damaged = 0;  ///< images that cannot be read
};

class MapColoring {
 public:
  /// Cameras with images and a mounting. The map and the context must outlive it.
  MapColoring(const MapDatabase& map, engine::Context& context, std::vector<CameraSource> cameras,
              const SensorPath& path, uint64_t submap_bytes);

  /// Gives points that were seen from around `sensor` their colours; both map frame, m. What moves
  /// stays black: it was elsewhere when most images were taken.
  void color(std::span<CloudPoint> points, const Eigen::Vector3d& sensor);

  ColoringCounts counts() const { return counts_; }

 private:
  using View = std::shared_ptr<const ViewColoring::View>;
  struct Kept {
    std::size_t number = 0;
    View view;  ///< null: its image cannot be read
  };

  /// Numbers of the views that see some of the points best.
  std::vector<std::size_t> views_of(std::span<const CloudPoint> points,
                                    const Eigen::Vector3d& sensor) const;
  View view(std::size_t number);
  View make(std::size_t number);
  double reach_of(std::size_t camera) const;

  ViewColoring coloring_;
  ViewSurfaces surfaces_;
  std::vector<CameraSource> cameras_;
  std::vector<CameraProjection> projections_;
  std::vector<std::shared_ptr<const ViewColoring::Camera>> lenses_;
  std::vector<MapView> views_;
  std::list<Kept> kept_;  ///< the one that was needed last in front
  std::map<std::size_t, std::list<Kept>::iterator> places_;
  uint64_t kept_bytes_ = 0;
  std::set<std::size_t> used_;
  ColoringCounts counts_;
};

}  // namespace adit
