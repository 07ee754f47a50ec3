// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/cloud_product.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/clouds/copc_writer.hpp"
#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/clouds/pcd_writer.hpp"
#include "adit/tools/clouds/ply_writer.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

std::vector<std::string> comments_of(const CloudHeading& heading) {
  if (heading.coordinates.empty()) {
    return {};
  }
  return {"coordinates: " + heading.coordinates,
          fmt::format("offset: {:.4f} {:.4f} {:.4f}, to be added to x, y and z", heading.offset.x(),
                      heading.offset.y(), heading.offset.z())};
}

/// A point as files in single precision hold it, at that place.
template <class P>
P packed(const CloudPoint& point, const Eigen::Vector3f& p) {
  if constexpr (kHasClass<P>) {
    return {packed<decltype(P::point)>(point, p), static_cast<uint8_t>(class_of(point))};
  } else if constexpr (kHasColor<P>) {
    return {packed<decltype(P::point)>(point, p), decltype(P::color)::of(point.color)};
  } else if constexpr (kHasTime<P>) {
    return {.x = p.x(),
            .y = p.y(),
            .z = p.z(),
            .intensity = point.intensity,
            .time = seconds(point.time),
            .ring = point.ring};
  } else {
    return {.x = p.x(), .y = p.y(), .z = p.z(), .intensity = point.intensity};
  }
}

/// PLY and PCD.
template <class Writer, class P>
class SingleProduct final : public CloudProduct {
 public:
  SingleProduct(const std::filesystem::path& file, const CloudHeading& heading)
      : offset_(heading.offset), writer_(file, comments_of(heading)) {}

  void write(std::span<const CloudPoint> points) override {
    single_.clear();
    for (const CloudPoint& point : points) {
      single_.push_back(packed<P>(point, (point.position - offset_).cast<float>()));
    }
    writer_.write(single_);
  }
  void close() override { writer_.close(); }
  uint64_t count() const override { return writer_.count(); }

 private:
  Eigen::Vector3d offset_;
  Writer writer_;
  std::vector<P> single_;
};

constexpr float kMost = 65535.0F;

/// What brings the intensities of a sensor to 16 bits.
float stretch_of(std::span<const CloudPoint> points) {
  float largest = 0.0F;
  for (const CloudPoint& point : points) {
    largest = std::max(largest, point.intensity);
  }
  return largest <= 1.0F ? kMost : largest <= 255.0F ? kMost / 255.0F : 1.0F;
}

struct Format {
  CloudFormat format;
  const char* name;
  const char* extension;
};
constexpr std::array<Format, 5> kFormats = {{{CloudFormat::ply, "ply", ".ply"},
                                             {CloudFormat::pcd, "pcd", ".pcd"},
                                             {CloudFormat::las, "las", ".las"},
                                             {CloudFormat::laz, "laz", ".laz"},
                                             {CloudFormat::copc, "copc", ".copc.laz"}}};

LasHeading las_heading(const CloudHeading& heading) {
  return {.software = "adit " + std::string(version()),
          .wkt = heading.wkt,
          .offset = heading.offset,
          .unix_times = heading.unix_times,
          .colored = heading.colored};
}

/// Of BasicPlyWriter or BasicPcdWriter, for the points that the heading says.
template <template <class> class Writer, class Color>
std::unique_ptr<CloudProduct> make_single(const std::filesystem::path& file,
                                          const CloudHeading& heading) {
  const auto make = [&]<class P>(P) -> std::unique_ptr<CloudProduct> {
    if (heading.classified) {
      return std::make_unique<SingleProduct<Writer<Classified<P>>, Classified<P>>>(file, heading);
    }
    return std::make_unique<SingleProduct<Writer<P>, P>>(file, heading);
  };
  const auto with_color = [&]<class P>(P point) {
    return heading.colored ? make(Colored<P, Color>{}) : make(point);
  };
  return heading.measured ? with_color(TimedPoint{}) : with_color(Point{});
}

/// LasWriter or CopcWriter.
template <class Writer>
class LasProduct final : public CloudProduct {
 public:
  template <class... Arguments>
  explicit LasProduct(Arguments&&... arguments) : writer_(std::forward<Arguments>(arguments)...) {}

  void write(std::span<const CloudPoint> points) override {
    if (!stretch_ && !points.empty()) {
      stretch_ = stretch_of(points);
    }
    las_.clear();
    for (const CloudPoint& point : points) {
      const float intensity = std::isfinite(point.intensity) ? point.intensity : 0.0F;
      las_.push_back(
          {.position = point.position,
           .time = point.time,
           .intensity = static_cast<uint16_t>(
               std::lround(std::clamp(intensity * stretch_.value_or(1.0F), 0.0F, kMost))),
           .classification = class_of(point),
           .source = static_cast<uint16_t>(std::clamp<SessionId>(point.session, 0, 65535)),
           .ring = point.ring,
           .keyframe = static_cast<uint32_t>(point.keyframe),
           .color = point.color});
    }
    writer_.write(las_);
  }
  void close() override { writer_.close(); }
  uint64_t count() const override { return writer_.count(); }

 private:
  Writer writer_;
  std::optional<float> stretch_;
  std::vector<LasPoint> las_;
};

}  // namespace

CloudFormat cloud_format(std::string_view name) {
  for (const Format& format : kFormats) {
    if (name == format.name) {
      return format.format;
    }
  }
  throw std::logic_error("no cloud format: " + std::string(name));
}

std::string extension_of(CloudFormat format) {
  return kFormats.at(static_cast<std::size_t>(format)).extension;
}

bool is_las(CloudFormat format) {
  return format >= CloudFormat::las;
}

CloudHeading heading_of(const ProductCoordinates& coordinates) {
  if (coordinates.frame() == ProductFrame::map) {
    return {};
  }
  return {
      .coordinates = coordinates.name(), .wkt = coordinates.wkt(), .offset = coordinates.offset()};
}

std::unique_ptr<CloudProduct> make_cloud_product(const std::filesystem::path& file,
                                                 CloudFormat format, const CloudHeading& heading) {
  switch (format) {
    case CloudFormat::las:
      return std::make_unique<LasProduct<LasWriter>>(file, las_heading(heading));
    case CloudFormat::laz:
      return std::make_unique<LasProduct<LasWriter>>(file, las_heading(heading), LasPacking::laz);
    case CloudFormat::copc:
      return std::make_unique<LasProduct<CopcWriter>>(file, las_heading(heading));
    case CloudFormat::ply:
      return make_single<BasicPlyWriter, PlyColor>(file, heading);
    case CloudFormat::pcd:
      break;
  }
  return make_single<BasicPcdWriter, PcdColor>(file, heading);
}

}  // namespace adit
