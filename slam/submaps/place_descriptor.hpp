// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "adit/shaders/shared/places.h"

namespace adit {

/// Version of what a descriptor's bits mean. Those of different versions are not compared.
inline constexpr uint32_t kPlaceVersion = 1;

/// What stands around a place, as shaders/shared/places.h has it.
struct PlaceDescriptor {
  double cell = 0.0;  ///< edge of a cell of the plan, m
  std::array<uint32_t, gpu::kPolarWords> polar{};
  std::array<uint32_t, gpu::kPlanWords> plan{};

  bool operator==(const PlaceDescriptor&) const = default;
};

/// Edge of a cell of a submap's plan, m: two of the cells that its points were merged in.
inline double plan_cell(double r_submap) {
  return 2.0 * r_submap;
}

}  // namespace adit
