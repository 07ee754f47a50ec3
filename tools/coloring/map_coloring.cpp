// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/coloring/map_coloring.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <numbers>
#include <utility>

#include "adit/slam/core/lie.hpp"
#include "adit/tools/coloring/blurred_image.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

constexpr uint64_t kMostViewBytes = uint64_t{512} << 20U;  // of views that stay
constexpr double kFarthest = 100.0;                        // m: as far as most lidars reach
// Of a sweep, points by which views are chosen; and views that each of them may need: as many as a
// colour is made of, and as many again, since some are hidden.
constexpr std::size_t kSamples = 128;
constexpr std::size_t kViewsASample = 2 * gpu::kMostSightings;

struct Rated {
  double weight = 0.0;
  std::size_t view = 0;
};

// For a camera's error: stretches of views, since those that follow each other see the same.
constexpr std::size_t kStretches = 5;
constexpr std::size_t kViewsAStretch = 12;

bool is_within(const CameraModel& model, const Eigen::Vector2d& pixel) {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 &&
         pixel.x() <= static_cast<double>(model.width) - 0.5 &&
         pixel.y() <= static_cast<double>(model.height) - 0.5;
}

/// What a view takes on the device, but for its depths, which are coarser.
uint64_t bytes_of(const CameraModel& model) {
  return sizeof(uint32_t) * uint64_t{model.width} * model.height;
}

/// Up to kSamples indices of so many, one behind the other never in a row: by the golden ratio.
std::vector<std::size_t> spread_indices(std::size_t count) {
  std::vector<std::size_t> indices;
  for (uint64_t k = 0; k < std::min(count, kSamples); ++k) {
    const uint64_t share = (k * 0x9e3779b97f4a7c15U) >> 32U;  // of 2^32
    indices.push_back(static_cast<std::size_t>((share * count) >> 32U));
  }
  return indices;
}

/// Numbers of a camera's views: all of few, of many those in stretches that are evenly spread, no
/// more than stay in memory.
std::vector<std::size_t> spread_views(const std::vector<MapView>& views, std::size_t camera,
                                      const CameraModel& model) {
  const uint64_t fit = kMostViewBytes / (2 * kStretches * bytes_of(model));  // a stretch
  const auto a_stretch = static_cast<std::size_t>(std::clamp<uint64_t>(fit, 2, kViewsAStretch));
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].camera == camera) {
      all.push_back(i);
    }
  }
  if (all.size() <= kStretches * a_stretch) {
    return all;
  }
  std::vector<std::size_t> spread;
  for (std::size_t i = 0; i < kStretches; ++i) {
    const std::size_t first = i * (all.size() - a_stretch) / (kStretches - 1);
    spread.insert(spread.end(), all.begin() + static_cast<std::ptrdiff_t>(first),
                  all.begin() + static_cast<std::ptrdiff_t>(first + a_stretch));
  }
  return spread;
}

Eigen::Isometry3d turned_by(const CameraError& error) {
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  turn.linear() = so3_exp(error.head<3>());
  return turn;
}

/// T_map_camera of an image, if the camera's error were this.
std::optional<Eigen::Isometry3d> camera_pose(const SensorPath& path, const CameraSource& camera,
                                             std::size_t image, const CameraError& error) {
  const auto T_map_lidar =
      path.at(camera.images->stamps()[image] + nanoseconds(camera.time_offset + error[3]));
  return T_map_lidar ? std::optional(*T_map_lidar * *camera.T_lidar_camera * turned_by(error))
                     : std::nullopt;
}

}  // namespace

MapColoring::MapColoring(const MapDatabase& map, engine::Context& context,
                         std::vector<CameraSource> cameras, const SensorPath& path,
                         std::shared_ptr<const MovedSpace> moved, uint64_t submap_bytes)
    : coloring_(context),
      surfaces_(map, coloring_, std::move(moved), submap_bytes),
      cameras_(std::move(cameras)),
      path_(path),
      views_(choose_views(cameras_, path_)),
      gains_(views_.size(), {1.0F, 1.0F, 1.0F}),
      kept_(kMostViewBytes) {
  for (const CameraSource& camera : cameras_) {
    projections_.emplace_back(camera.model);
    lenses_.push_back(coloring_.make_camera(camera.model));
    counts_.images += camera.images->stamps().size();
  }
}

/// Farther away a pixel is wider than the map's points are apart.
double MapColoring::reach_of(std::size_t camera) const {
  return std::min(surfaces_.spacing() * cameras_[camera].model.fx, kFarthest);
}

std::vector<std::size_t> MapColoring::views_of(std::span<const Eigen::Vector3d> places,
                                               const Eigen::Vector3d& sensor) const {
  double farthest = 0.0;
  for (const Eigen::Vector3d& place : places) {
    farthest = std::max(farthest, (place - sensor).norm());
  }
  struct Near {
    std::size_t number;
    double reach;
    Eigen::Vector3d at;
    Eigen::Isometry3d T_camera_map;
  };
  std::vector<Near> near;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const Eigen::Isometry3d& T_map_camera = views_[i].T_map_camera;
    const double reach = reach_of(views_[i].camera);
    if ((T_map_camera.translation() - sensor).norm() < farthest + reach) {
      near.push_back({.number = i,
                      .reach = reach,
                      .at = T_map_camera.translation(),
                      .T_camera_map = T_map_camera.inverse()});
    }
  }
  std::map<std::size_t, std::size_t> votes;  // by view
  std::vector<Rated> rated;
  for (const std::size_t i : spread_indices(places.size())) {
    rated.clear();
    for (const Near& one : near) {
      const double range = (places[i] - one.at).norm();
      if (range >= one.reach) {
        continue;
      }
      const CameraProjection& projection = projections_[views_[one.number].camera];
      const CameraModel& model = projection.camera();
      const auto pixel = projection.pixel(one.T_camera_map * places[i]);
      if (pixel && is_within(model, *pixel)) {
        rated.push_back({.weight = model.fx * model.fy / (range * range), .view = one.number});
      }
    }
    const std::size_t wanted = std::min(rated.size(), kViewsASample);
    std::ranges::partial_sort(rated, rated.begin() + static_cast<std::ptrdiff_t>(wanted), {},
                              [](const Rated& one) { return std::pair(-one.weight, one.view); });
    for (std::size_t k = 0; k < wanted; ++k) {
      ++votes[rated[k].view];
    }
  }
  return most_wanted(votes);
}

/// Views of the most votes, as many as stay in memory, in their order.
std::vector<std::size_t> MapColoring::most_wanted(
    const std::map<std::size_t, std::size_t>& votes) const {
  std::vector<std::pair<std::size_t, std::size_t>> by_votes(votes.begin(), votes.end());
  std::ranges::stable_sort(by_votes, std::greater(), &std::pair<std::size_t, std::size_t>::second);
  std::vector<std::size_t> chosen;
  uint64_t bytes = 0;
  for (const auto& [view, count] : by_votes) {
    bytes += bytes_of(cameras_[views_[view].camera].model);
    if (bytes > kMostViewBytes && !chosen.empty()) {
      break;
    }
    chosen.push_back(view);
  }
  std::ranges::sort(chosen);
  return chosen;
}

std::optional<ColorImage> MapColoring::image_of(const MapView& view) {
  const CameraSource& camera = cameras_[view.camera];
  try {
    ColorImage image = camera.images->image(view.image);
    if (image.width == camera.model.width && image.height == camera.model.height) {
      return image;
    }
    other_size_.insert({view.camera, view.image});
  } catch (const InputError&) {
    damaged_.insert({view.camera, view.image});
  }
  return std::nullopt;
}

MapColoring::View MapColoring::view_of(const MapView& view, std::span<const uint8_t> rgb) {
  const auto surfaces = surfaces_.near(view.T_map_camera.translation(), reach_of(view.camera));
  // Half the diagonal of a voxel's face: on a plane, neighbouring discs leave no hole.
  const double radius = surfaces_.spacing() / std::numbers::sqrt2;
  return coloring_.make_view(lenses_[view.camera], view.T_map_camera, rgb, surfaces, radius);
}

MapColoring::View MapColoring::make(std::size_t number) {
  const std::optional<ColorImage> image = image_of(views_[number]);
  return image ? view_of(views_[number], image->rgb) : nullptr;
}

std::vector<SurfaceSample> MapColoring::samples_of(const MapView& view) {
  const CameraProjection& projection = projections_[view.camera];
  const Eigen::Isometry3d T_camera_map = view.T_map_camera.inverse();
  const double reach = reach_of(view.camera);
  std::vector<SurfaceSample> samples =
      surfaces_.samples_near(view.T_map_camera.translation(), reach);
  std::erase_if(samples, [&](const SurfaceSample& sample) {
    const Eigen::Vector3d p = T_camera_map * sample.p;
    const auto pixel = p.norm() < reach ? projection.pixel(p) : std::nullopt;
    return !pixel || !is_within(projection.camera(), *pixel);
  });
  return samples;
}

CameraFinding MapColoring::find_error(std::size_t camera, const std::function<void()>& working) {
  struct Used {
    std::size_t number;
    MapView view;
    ColorImage image;
    std::vector<SurfaceSample> samples;
    std::vector<Eigen::Vector3d> places;
    View drawn;  ///< as `hidden_by` and `blur` below have it
  };
  std::vector<Used> used;
  for (const std::size_t number : spread_views(views_, camera, cameras_[camera].model)) {
    if (std::optional<ColorImage> image = image_of(views_[number])) {
      Used one{.number = number,
               .view = views_[number],
               .image = std::move(*image),
               .samples = samples_of(views_[number]),
               .places = {},
               .drawn = nullptr};
      std::ranges::transform(one.samples, std::back_inserter(one.places), &SurfaceSample::p);
      used.push_back(std::move(one));
    }
  }
  const CameraSource& source = cameras_[camera];
  std::optional<std::pair<CameraError, int>> drawn;
  const SightSurfaces sight = [&](const CameraError& error, const CameraError& hidden_by,
                                  int blur) {
    const bool anew = !drawn || drawn->first != hidden_by || drawn->second != blur;
    drawn = {hidden_by, blur};
    std::vector<Sighted> all;
    working();
    for (Used& one : used) {
      const auto pose = camera_pose(path_, source, one.view.image, error);
      const auto drawn_from = camera_pose(path_, source, one.view.image, hidden_by);
      if (!pose || !drawn_from) {
        continue;
      }
      if (anew || !one.drawn) {
        one.view.T_map_camera = *drawn_from;
        one.drawn = view_of(one.view, blurred(one.image, blur).rgb);
      }
      const ViewColoring::Look look{.view = one.drawn, .T_map_camera = *pose};
      const std::vector<SeenColor> seen =
          coloring_.colors(one.places, pose->translation(), {&look, 1}, surfaces_.spacing());
      for (std::size_t i = 0; i < seen.size(); ++i) {
        if (is_exposed(seen[i])) {
          all.push_back(
              {.surface = one.samples[i].key, .view = one.number, .color = log_color(seen[i])});
        }
      }
    }
    std::ranges::sort(all, {}, [](const Sighted& one) { return std::pair(one.surface, one.view); });
    return all;
  };
  const double pixel = 1.0 / source.model.fx;
  constexpr double kTimeStep = 0.005;  // s: a pixel or less at walking speed
  const CameraErrorEstimate found = estimate_camera_error(sight, {pixel, pixel, pixel, kTimeStep});
  return {.camera = source.name,
          .error = found.error,
          .determined = found.determined,
          .corrected = found.is_better()};
}

void MapColoring::balance(const std::function<void(std::size_t, std::size_t)>& progress) {
  // Of many views fewer samples each: memory holds so many colours.
  constexpr std::size_t kViewsWithAll = 256;
  const uint64_t one_in = 1 + views_.size() / kViewsWithAll;
  std::vector<Sighted> sighted;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if (const View one = view(i)) {
      std::vector<SurfaceSample> samples = samples_of(views_[i]);
      std::erase_if(samples,
                    [&](const SurfaceSample& sample) { return (sample.key >> 20U) % one_in != 0; });
      std::vector<Eigen::Vector3d> places;
      std::ranges::transform(samples, std::back_inserter(places), &SurfaceSample::p);
      const ViewColoring::Look look{.view = one, .T_map_camera = views_[i].T_map_camera};
      const std::vector<SeenColor> seen = coloring_.colors(
          places, views_[i].T_map_camera.translation(), {&look, 1}, surfaces_.spacing());
      for (std::size_t k = 0; k < seen.size(); ++k) {
        if (is_exposed(seen[k])) {
          sighted.push_back({.surface = samples[k].key, .view = i, .color = log_color(seen[k])});
        }
      }
    }
    progress(i + 1, views_.size());
  }
  sort_by_surface(sighted);
  gains_ = balanced_gains(views_.size(), ratios_of(sighted, far_pairs(sighted)));
}

std::vector<CameraFinding> MapColoring::prepare(
    bool corrects, const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<CameraFinding> findings;
  for (std::size_t i = 0; corrects && i < cameras_.size(); ++i) {
    findings.push_back(find_error(i, [&] { progress(0, views_.size()); }));
  }
  for (std::size_t i = 0; i < findings.size(); ++i) {
    if (findings[i].corrected) {
      cameras_[i].time_offset += findings[i].late();
      *cameras_[i].T_lidar_camera = *cameras_[i].T_lidar_camera * turned_by(findings[i].error);
    }
  }
  views_ = choose_views(cameras_, path_);
  gains_.assign(views_.size(), {1.0F, 1.0F, 1.0F});
  balance(progress);
  return findings;
}

MapColoring::View MapColoring::view(std::size_t number) {
  if (const View* known = kept_.find(number)) {
    return *known;
  }
  const View made = make(number);
  return kept_.add(number, made, made ? made->bytes() : 0);
}

ColoringCounts MapColoring::counts() const {
  ColoringCounts counts = counts_;
  counts.views = used_.size();
  counts.damaged = damaged_.size();
  counts.other_size = other_size_.size();
  return counts;
}

void MapColoring::color(std::span<CloudPoint> points, const Eigen::Vector3d& sensor) {
  std::vector<Eigen::Vector3d> places;
  places.reserve(points.size());
  std::ranges::transform(points, std::back_inserter(places), &CloudPoint::in_map);
  std::vector<ViewColoring::Look> looks;
  for (const std::size_t number : views_of(places, sensor)) {
    if (View one = view(number)) {
      looks.push_back({.view = std::move(one),
                       .T_map_camera = views_[number].T_map_camera,
                       .gain = gains_[number]});
      used_.insert(number);
    }
  }
  const std::vector<SeenColor> seen = coloring_.colors(places, sensor, looks, surfaces_.spacing());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (seen[i].sightings > 0 && !points[i].moving) {
      points[i].color = seen[i].color;
      ++counts_.colored;
    }
  }
  counts_.points += points.size();
}

}  // namespace adit
