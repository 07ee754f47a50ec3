// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/tile_folder.hpp"

#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

constexpr const char* kIndex = "tiles.csv";
constexpr const char* kCorners = "pointcloud_map_metadata.yaml";
constexpr const char* kProjector = "map_projector_info.yaml";

std::string subfolder_of(CloudFormat format) {
  return format == CloudFormat::pcd ? "pointcloud_map.pcd" : "tiles";
}

}  // namespace

TileFolder::TileFolder(std::filesystem::path folder, CloudFormat format, CloudHeading heading,
                       double size)
    : folder_(std::move(folder)), format_(format), heading_(std::move(heading)), size_(size) {
  const std::filesystem::path made = folder_ / subfolder_of(format_);
  std::error_code error;
  is_new_ = !std::filesystem::exists(folder_, error);
  if (!std::filesystem::create_directories(made, error)) {
    throw OutputError(made, made.string() + ": cannot be made: " +
                                (error ? error.message() : std::string("it exists")) +
                                ". Name another folder with -o.");
  }
}

TileFolder::~TileFolder() {
  if (!whole_) {
    product_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(is_new_ ? folder_ : folder_ / subfolder_of(format_), ignored);
  }
}

void TileFolder::remove(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const CloudFormat format : {CloudFormat::pcd, CloudFormat::las}) {
    std::filesystem::remove_all(folder / subfolder_of(format), ignored);
  }
  for (const char* const file : {kIndex, kCorners, kProjector}) {
    std::filesystem::remove(folder / file, ignored);
  }
  std::filesystem::remove(folder, ignored);
}

std::string TileFolder::name_of(const TileNumber& tile) const {
  return fmt::format("{:.0f}_{:.0f}{}", size_ * static_cast<double>(tile.x),
                     size_ * static_cast<double>(tile.y), extension_of(format_));
}

void TileFolder::write(const TileNumber& tile, std::span<const CloudPoint> points) {
  if (tile_ != tile) {
    end_tile();
    tile_ = tile;
    product_ =
        make_cloud_product(folder_ / subfolder_of(format_) / name_of(tile), format_, heading_);
  }
  if (is_las(format_)) {
    product_->write(points);
    return;
  }
  // Such products subtract the offset, which these positions are less of already.
  std::vector<CloudPoint> whole(points.begin(), points.end());
  for (CloudPoint& point : whole) {
    point.position += heading_.offset;
  }
  product_->write(whole);
}

void TileFolder::end_tile() {
  if (!tile_) {
    return;
  }
  product_->close();
  const Eigen::Vector2d corner =
      size_ * Eigen::Vector2d(static_cast<double>(tile_->x), static_cast<double>(tile_->y));
  const std::string name = name_of(*tile_);
  metadata_ += fmt::format("{}: [{:.0f}, {:.0f}]\n", name, corner.x(), corner.y());
  index_ +=
      fmt::format("{}/{},{:.0f},{:.0f},{:.0f},{:.0f},{}\n", subfolder_of(format_), name, corner.x(),
                  corner.y(), corner.x() + size_, corner.y() + size_, product_->count());
  ++tiles_;
  points_ += product_->count();
  product_.reset();
  tile_.reset();
}

void TileFolder::close(const ProductCoordinates& coordinates,
                       const std::optional<Georeference>& georeference) {
  end_tile();
  write_text_file(folder_ / kIndex, index_);
  if (format_ == CloudFormat::pcd) {
    write_text_file(
        folder_ / kCorners,
        fmt::format("x_resolution: {:.1f}\ny_resolution: {:.1f}\n", size_, size_) + metadata_);
  }
  std::string projector = "projector_type: Local\n";
  // Autoware knows no other zone than the origin's own, and no other heights.
  if (coordinates.frame() == ProductFrame::utm && georeference && !coordinates.has_geoid() &&
      to_string(coordinates.zone()) == to_string(zone_of(*georeference))) {
    const Geodetic& origin = georeference->origin;
    projector = fmt::format(
        "projector_type: LocalCartesianUTM\nvertical_datum: WGS84\nmap_origin:\n  latitude: {}\n"
        "  longitude: {}\n  altitude: {}\n",
        shortest(origin.latitude), shortest(origin.longitude), shortest(origin.altitude));
  }
  write_text_file(folder_ / kProjector,
                  "# " + (heading_.coordinates.empty() ? "the map's frame" : heading_.coordinates) +
                      "\n" + projector);
  whole_ = true;
}

}  // namespace adit
