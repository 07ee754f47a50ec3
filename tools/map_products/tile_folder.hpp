// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "adit/tools/map_products/cloud_product.hpp"
#include "adit/tools/map_products/tiled_cloud.hpp"

namespace adit {

/// A cloud in tiles, as Autoware's map loader takes it: a folder of PCD files
/// (`pointcloud_map.pcd/`), where each begins (`pointcloud_map_metadata.yaml`), and how coordinates
/// are to be understood (`map_projector_info.yaml`). Other formats lie in `tiles/`. `tiles.csv` is
/// the index for everybody else. Throws OutputError.
class TileFolder {
 public:
  /// Makes the folder, which must not exist. `size`: m, of a tile. PLY and PCD: `heading.offset`
  /// is what positions are already less of.
  TileFolder(std::filesystem::path folder, CloudFormat format, CloudHeading heading, double size);
  /// What is not whole is removed.
  ~TileFolder();
  TileFolder(const TileFolder&) = delete;
  TileFolder& operator=(const TileFolder&) = delete;

  /// Removes what such a folder holds, and the folder where it holds nothing else.
  static void remove(const std::filesystem::path& folder);

  /// Points of a tile; of one after the other.
  void write(const TileNumber& tile, std::span<const CloudPoint> points);
  /// Must be called for the folder to be whole.
  void close(const ProductCoordinates& coordinates,
             const std::optional<Georeference>& georeference);

  std::size_t tiles() const { return tiles_; }
  uint64_t points() const { return points_; }

 private:
  void end_tile();
  std::string name_of(const TileNumber& tile) const;

  std::filesystem::path folder_;
  CloudFormat format_;
  CloudHeading heading_;
  double size_;
  std::optional<TileNumber> tile_;
  std::unique_ptr<CloudProduct> product_;
  std::string metadata_;
  std::string index_ = "file,min_x_m,min_y_m,max_x_m,max_y_m,points\n";
  std::size_t tiles_ = 0;
  uint64_t points_ = 0;
  bool is_new_ = false;
  bool whole_ = false;
};

}  // namespace adit
