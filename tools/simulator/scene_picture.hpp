// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "adit/slam/core/checkpoint.hpp"
#include "adit/tools/simulator/ray_scene.hpp"
#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/simulator/spline.hpp"

namespace adit {

/// Draws a scene as PNG: from above, cut open where it has a ceiling, with the way that the sensor
/// takes in red; and below it what is seen from the way. Throws OutputError.
void write_scene_picture(const std::filesystem::path& file, const Scene& scene,
                         const RayScene& still, const SplineTrajectory& trajectory,
                         const Checkpoint& checkpoint);

}  // namespace adit
