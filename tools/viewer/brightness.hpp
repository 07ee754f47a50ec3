// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Intensities as pages get them: from 0 to 255, whatever the sensor's own scale.
#pragma once

#include <cstdint>
#include <span>

#include "adit/slam/core/types.hpp"

namespace adit {

/// What 98 of 100 points are no brighter than, in the sensor's own scale; 0 where none has an
/// intensity.
float usual_brightest(std::span<const Point> points);

/// An intensity as TilePointFacts has it; 0 for NaN, and where `brightest` is 0.
uint8_t brightness_of(float intensity, float brightest);

}  // namespace adit
