// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Files that a map's cloud is written to, as its points come.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {

/// The last three are LAS files: plain, packed, and packed as an octree (COPC).
enum class CloudFormat { ply, pcd, las, laz, copc };
/// "ply", "pcd", "las", "laz" and "copc".
CloudFormat cloud_format(std::string_view name);
/// How its files end: ".ply" to ".copc.laz".
std::string extension_of(CloudFormat format);
/// Of the LAS family: their headers state coordinates, and all offsets.
bool is_las(CloudFormat format);

/// What a file says of its points.
struct CloudHeading {
  std::string coordinates{};  ///< for people; empty: the map's frame, without an offset
  std::string wkt{};          ///< of LAS
  /// m: PLY and PCD hold positions less this, as their headers say; LAS files add it themselves.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  bool measured = false;  ///< intensity, ring and time are those of returns: PLY and PCD have them
  bool unix_times = false;  ///< stamps are; of LAS
  bool classified = false;  ///< classes were looked for: PLY and PCD have them
  bool colored = false;  ///< points have colours: PLY and PCD as well as the LAS family have them
};
/// That of a cloud in these coordinates.
CloudHeading heading_of(const ProductCoordinates& coordinates);

class CloudProduct {
 public:
  virtual ~CloudProduct() = default;
  virtual void write(std::span<const CloudPoint> points) = 0;
  /// Must be called for the file to be whole.
  virtual void close() = 0;
  virtual uint64_t count() const = 0;
};

/// Throws OutputError, as all members do. Those of the LAS family hold intensities in 16 bits:
/// those of sensors that tell 0 to 1 or 0 to 255, as the first points do, are stretched.
std::unique_ptr<CloudProduct> make_cloud_product(const std::filesystem::path& file,
                                                 CloudFormat format, const CloudHeading& heading);

}  // namespace adit
