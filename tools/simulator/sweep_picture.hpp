// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "adit/slam/core/checkpoint.hpp"
#include "adit/tools/simulator/range_simulator.hpp"
#include "adit/tools/simulator/scene.hpp"

namespace adit {

/// Draws sweep `index` of a sensor as PNG, over the scene in grey: from above, with the sensor in
/// red, and below it all around as the sensor sees it. Points are coloured by the rank of their
/// intensity, each where it was measured at its own time. Throws OutputError.
void write_sweep_picture(const std::filesystem::path& file, const Scene& scene,
                         const RangeSimulator& lidar, int64_t index, const Checkpoint& checkpoint);

}  // namespace adit
