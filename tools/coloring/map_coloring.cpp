// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/coloring/map_coloring.hpp"

#include <algorithm>
#include <utility>

#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

constexpr uint64_t kMostViewBytes = uint64_t{512} << 20U;  // of views that stay
// Of a sweep, points by which views are chosen; and views that each of them may need: as many as a
// colour is made of, and as many again, since some are hidden.
constexpr std::size_t kSamples = 128;
constexpr std::size_t kViewsASample = 2 * gpu::kMostSightings;

struct Rated {
  double weight = 0.0;
  std::size_t view = 0;
};

}  // namespace

MapColoring::MapColoring(const MapDatabase& map, engine::Context& context,
                         std::vector<CameraSource> cameras, const SensorPath& path,
                         uint64_t submap_bytes)
    : coloring_(context),
      surfaces_(map, coloring_, submap_bytes),
      cameras_(std::move(cameras)),
      views_(choose_views(cameras_, path)) {
  for (const CameraSource& camera : cameras_) {
    projections_.emplace_back(camera.model);
    lenses_.push_back(coloring_.make_camera(camera.model));
    counts_.images += camera.images->stamps().size();
  }
}

/// Farther away a pixel is wider than the map's points are apart.
double MapColoring::reach_of(std::size_t camera) const {
  return surfaces_.spacing() * cameras_[camera].model.fx;
}

std::vector<std::size_t> MapColoring::views_of(std::span<const CloudPoint> points,
                                               const Eigen::Vector3d& sensor) const {
  double farthest = 0.0;
  for (const CloudPoint& point : points) {
    farthest = std::max(farthest, (point.position - sensor).norm());
  }
  struct Near {
    std::size_t number;
    Eigen::Isometry3d T_camera_map;
  };
  std::vector<Near> near;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const Eigen::Isometry3d& T_map_camera = views_[i].T_map_camera;
    if ((T_map_camera.translation() - sensor).norm() < farthest + reach_of(views_[i].camera)) {
      near.push_back({.number = i, .T_camera_map = T_map_camera.inverse()});
    }
  }
  std::set<std::size_t> chosen;
  const std::size_t step = std::max<std::size_t>(1, points.size() / kSamples);
  std::vector<Rated> rated;
  for (std::size_t i = step / 2; i < points.size(); i += step) {
    rated.clear();
    for (const Near& one : near) {
      const std::size_t camera = views_[one.number].camera;
      const CameraModel& model = cameras_[camera].model;
      const Eigen::Vector3d p = one.T_camera_map * points[i].position;
      const auto pixel = p.norm() < reach_of(camera) ? projections_[camera].pixel(p) : std::nullopt;
      if (pixel && pixel->x() >= -0.5 && pixel->y() >= -0.5 &&
          pixel->x() <= static_cast<double>(model.width) - 0.5 &&
          pixel->y() <= static_cast<double>(model.height) - 0.5) {
        rated.push_back({.weight = model.fx * model.fy / p.squaredNorm(), .view = one.number});
      }
    }
    const std::size_t wanted = std::min(rated.size(), kViewsASample);
    std::ranges::partial_sort(rated, rated.begin() + static_cast<std::ptrdiff_t>(wanted),
                              [](const Rated& a, const Rated& b) {
                                return std::pair(-a.weight, a.view) < std::pair(-b.weight, b.view);
                              });
    for (std::size_t k = 0; k < wanted; ++k) {
      chosen.insert(rated[k].view);
    }
  }
  return {chosen.begin(), chosen.end()};
}

MapColoring::View MapColoring::make(std::size_t number) {
  const MapView& wanted = views_[number];
  try {
    const ColorImage image = cameras_[wanted.camera].images->image(wanted.image);
    const CameraModel& model = cameras_[wanted.camera].model;
    if (image.width != model.width || image.height != model.height) {
      ++counts_.damaged;
      return nullptr;
    }
    const auto surfaces =
        surfaces_.near(wanted.T_map_camera.translation(), reach_of(wanted.camera));
    return coloring_.make_view(lenses_[wanted.camera], wanted.T_map_camera, image.rgb, surfaces,
                               surfaces_.spacing());
  } catch (const InputError&) {
    ++counts_.damaged;
    return nullptr;
  }
}

MapColoring::View MapColoring::view(std::size_t number) {
  if (const auto place = places_.find(number); place != places_.end()) {
    kept_.splice(kept_.begin(), kept_, place->second);
    return kept_.front().view;
  }
  kept_.push_front({.number = number, .view = make(number)});
  places_[number] = kept_.begin();
  const auto bytes = [](const Kept& kept) {
    return kept.view ? kept.view->image.size() + kept.view->depth.size() : 0;
  };
  kept_bytes_ += bytes(kept_.front());
  while (kept_bytes_ > kMostViewBytes && kept_.size() > 1) {
    kept_bytes_ -= bytes(kept_.back());
    places_.erase(kept_.back().number);
    kept_.pop_back();
  }
  return kept_.front().view;
}

void MapColoring::color(std::span<CloudPoint> points, const Eigen::Vector3d& sensor) {
  counts_.points += points.size();
  std::vector<View> views;
  for (const std::size_t number : views_of(points, sensor)) {
    if (View one = view(number)) {
      views.push_back(std::move(one));
      used_.insert(number);
    }
  }
  counts_.views = used_.size();
  std::vector<Eigen::Vector3d> places;
  places.reserve(points.size());
  for (const CloudPoint& point : points) {
    places.push_back(point.position);
  }
  const std::vector<SeenColor> seen = coloring_.colors(places, sensor, views, surfaces_.spacing());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (seen[i].sightings > 0 && !points[i].moving) {
      points[i].color = seen[i].color;
      ++counts_.colored;
    }
  }
}

}  // namespace adit
