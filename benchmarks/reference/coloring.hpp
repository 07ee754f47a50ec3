// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Twin of view_depth.comp, view_sight.comp and view_mean.comp.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "adit/shaders/shared/coloring.h"
#include "adit/slam/core/camera_model.hpp"

namespace adit::reference {

/// A surface of the map: a disc, or a ball where it has no normal.
struct Disc {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> normal{};
};

/// A camera with the pixels of its depth image.
struct DepthCameraTwin {
  CameraProjection projection;
  double pixels = 1.0;  ///< of the image, in one of the depth image's
  uint32_t width = 0;   ///< of the depth image
  uint32_t height = 0;
  std::vector<Eigen::Vector3d> rays{};  ///< of its pixels, unit length; zero: the lens has none
};
inline DepthCameraTwin depth_camera(const CameraModel& model, double pixels, uint32_t width,
                                    uint32_t height) {
  DepthCameraTwin camera{
      .projection = CameraProjection(model), .pixels = pixels, .width = width, .height = height};
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      camera.rays.push_back(
          camera.projection.ray({(x + 0.5) * pixels - 0.5, (y + 0.5) * pixels - 0.5})
              .value_or(Eigen::Vector3d::Zero()));
    }
  }
  return camera;
}

/// How far away (m) the nearest disc is in each pixel of the depth image; infinite: there is none.
/// Points are in the optical frame. `slack` widens (or, negative, narrows) what a pixel is said to
/// see, by so many pixels of the image and that share of the radius: devices round. Discs cover at
/// most gpu::kMostSplat pixels to either side.
inline std::vector<double> depths(const DepthCameraTwin& camera, std::span<const Disc> discs,
                                  double radius, double slack) {
  std::vector<double> depth(std::size_t{camera.width} * camera.height,
                            std::numeric_limits<double>::infinity());
  const auto see = [&](int64_t x, int64_t y, double away) {
    if (x >= 0 && y >= 0 && x < camera.width && y < camera.height) {
      double& seen = depth[static_cast<std::size_t>(y * camera.width + x)];
      seen = std::min(seen, away);
    }
  };
  const auto column = [&](double at) {
    return static_cast<int64_t>(std::floor((at + 0.5) / camera.pixels));
  };
  for (const Disc& disc : discs) {
    const double range = disc.p.norm();
    const auto middle = camera.projection.pixel(disc.p);
    if (!middle || !(range > radius)) {
      continue;
    }
    const auto [u, v] = std::pair(middle->x(), middle->y());
    const double certain = std::abs(slack);
    if (slack >= 0.0 || (column(u - certain) == column(u + certain) &&
                         column(v - certain) == column(v + certain))) {
      for (const double du : {-certain, certain}) {
        for (const double dv : {-certain, certain}) {
          see(column(u + du), column(v + dv), range);
        }
      }
    }
    const Eigen::Vector3d normal = disc.normal.value_or(disc.p / range);
    // Three times what the disc covers in the middle of the image: a lens magnifies less.
    const CameraModel& model = camera.projection.camera();
    const double covers = radius / range * std::max(model.fx, model.fy) / camera.pixels;
    const int64_t reach = std::min<int64_t>(gpu::kMostSplat + 1, std::llround(3.0 * covers) + 2);
    for (int64_t y = column(v) - reach; y <= column(v) + reach; ++y) {
      for (int64_t x = column(u) - reach; x <= column(u) + reach; ++x) {
        if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) {
          continue;
        }
        const Eigen::Vector3d& ray = camera.rays[static_cast<std::size_t>(y * camera.width + x)];
        const double along = normal.dot(disc.p) / normal.dot(ray);
        if (along > 0.0 && (along * ray - disc.p).norm() <= radius * (1.0 + slack)) {
          see(x, y, along);
        }
      }
    }
  }
  return depth;
}

/// An image as the kernels have it: red in the low byte.
struct PackedImage {
  uint32_t width = 0;
  uint32_t height = 0;
  std::vector<uint32_t> pixels{};
};

/// A point's look in one view.
struct Look {
  std::array<double, 3> color{};
  double weight = 0.0;
  double margin =
      0.0;  ///< of what decides whether it is seen: its distance from the border, m or pixels
};

/// What the image shows of a point of the optical frame; weight 0: it is hidden, or outside.
inline Look look(const DepthCameraTwin& camera, std::span<const uint32_t> depth_bits,
                 const PackedImage& image, const Eigen::Vector3d& p, double tolerance,
                 const std::array<double, 3>& gain) {
  Look look;
  const auto pixel = camera.projection.pixel(p);
  if (!pixel) {
    look.margin = 1.0;
    return look;
  }
  const double u = pixel->x();
  const double v = pixel->y();
  const double inside =
      std::min(std::min(u + 0.5, image.width - 0.5 - u), std::min(v + 0.5, image.height - 0.5 - v));
  if (inside < 0.0) {
    look.margin = -inside;
    return look;
  }
  const auto clamped = [](int64_t at, uint32_t size) {
    return static_cast<std::size_t>(std::clamp<int64_t>(at, 0, int64_t{size} - 1));
  };
  const auto nearness = [&](int64_t x, int64_t y) {
    const uint32_t bits =
        depth_bits[clamped(y, camera.height) * camera.width + clamped(x, camera.width)];
    return bits == gpu::kNoDepth ? 0.0 : 1.0 / static_cast<double>(std::bit_cast<float>(bits));
  };
  const double x = (u + 0.5) / camera.pixels - 0.5;
  const double y = (v + 0.5) / camera.pixels - 0.5;
  const auto column = static_cast<int64_t>(std::floor(x));
  const auto row = static_cast<int64_t>(std::floor(y));
  const double across = x - static_cast<double>(column);
  const double down = y - static_cast<double>(row);
  const double near =
      (1.0 - down) * ((1.0 - across) * nearness(column, row) + across * nearness(column + 1, row)) +
      down * ((1.0 - across) * nearness(column, row + 1) + across * nearness(column + 1, row + 1));
  const double range = p.norm();
  if (near == 0.0) {
    look.margin = inside;
    return look;
  }
  const double behind = range - tolerance - 1.0 / near;
  look.margin = std::min(std::abs(behind), inside);
  if (behind > 0.0) {
    return look;
  }
  look.weight = camera.projection.camera().fx * camera.projection.camera().fy / (range * range);
  const auto left = static_cast<int64_t>(std::floor(u));
  const auto top = static_cast<int64_t>(std::floor(v));
  for (const int64_t dy : {0, 1}) {
    for (const int64_t dx : {0, 1}) {
      const double share =
          (dx == 0 ? 1.0 - (u - static_cast<double>(left)) : u - static_cast<double>(left)) *
          (dy == 0 ? 1.0 - (v - static_cast<double>(top)) : v - static_cast<double>(top));
      const uint32_t packed = image.pixels[clamped(top + dy, image.height) * image.width +
                                           clamped(left + dx, image.width)];
      for (uint32_t k = 0; k < 3; ++k) {
        look.color[k] += share * ((packed >> (8 * k)) & 255U);
      }
    }
  }
  const double brightest = std::ranges::max(look.color);
  look.margin = std::min(look.margin, std::abs(brightest - gpu::kBrightest));
  look.weight *= brightest > gpu::kBrightest ? static_cast<double>(gpu::kSaturatedWorth) : 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    look.color[k] = std::min(255.0, gain[k] * look.color[k]);
  }
  return look;
}

/// The colour that most of the weight agrees on: the mean of those nearest to the sighting that all
/// are nearest to, of half of the weight at least. Equal distances come together.
inline std::array<double, 3> agreed_color(std::span<const gpu::ColorSighting> sightings) {
  const auto channel = [](uint32_t color, uint32_t k) {
    return static_cast<int>((color >> (8 * k)) & 255U);
  };
  const auto difference = [&](uint32_t a, uint32_t b) {
    int sum = 0;
    for (uint32_t k = 0; k < 3; ++k) {
      sum += std::abs(channel(a, k) - channel(b, k));
    }
    return sum;
  };
  std::vector<gpu::ColorSighting> seen;
  std::ranges::copy_if(sightings, std::back_inserter(seen),
                       [](const gpu::ColorSighting& one) { return one.weight > 0.0F; });
  if (seen.empty()) {
    return {};
  }
  double whole = 0.0;
  double least = std::numeric_limits<double>::infinity();
  uint32_t middle = 0;
  for (const gpu::ColorSighting& one : seen) {
    double sum = 0.0;
    for (const gpu::ColorSighting& other : seen) {
      sum += static_cast<double>(other.weight) * difference(one.color, other.color);
    }
    if (sum < least) {
      least = sum;
      middle = one.color;
    }
    whole += static_cast<double>(one.weight);
  }
  std::ranges::stable_sort(
      seen, {}, [&](const gpu::ColorSighting& one) { return difference(one.color, middle); });
  std::array<double, 3> sum{};
  double taken = 0.0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const bool as_far =
        i > 0 && difference(seen[i].color, middle) == difference(seen[i - 1].color, middle);
    if (!as_far && 2.0 * taken >= whole) {
      break;
    }
    for (uint32_t k = 0; k < 3; ++k) {
      sum[k] += static_cast<double>(seen[i].weight) * channel(seen[i].color, k);
    }
    taken += static_cast<double>(seen[i].weight);
  }
  return {sum[0] / taken, sum[1] / taken, sum[2] / taken};
}

}  // namespace adit::reference
