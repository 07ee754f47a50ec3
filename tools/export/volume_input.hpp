// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit volume` reads.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "adit/tools/export/volume_job.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {

/// A keyframe where it is in the product's map frame.
struct VolumeKeyframe {
  const MapDatabase* map = nullptr;
  const ProductCoordinates* coordinates = nullptr;
  MapKeyframe keyframe{};
};

/// Both states of the place, in product coordinates.
struct VolumeInput {
  std::vector<std::unique_ptr<MapDatabase>> maps{};
  std::vector<std::unique_ptr<ProductCoordinates>> coordinates{};  ///< the first: the product's
  std::vector<VolumeKeyframe> before{};
  std::vector<VolumeKeyframe> after{};
  CloudSelection selection{};  ///< its polygon
  VolumeOutcome outcome{};
};

/// Throws UsageError where options contradict each other.
void check_volume(const VolumeCommandOptions& options);

/// What is asked for, where it lies. Throws as volume_job().
VolumeInput volume_input(const VolumeCommandOptions& options,
                         const std::function<bool(const MergeStep&)>& on_step);

}  // namespace adit
