// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/scene_street.hpp"

#include <cstdint>

namespace adit {

using Eigen::Vector3d;

void add_street_tree(Mesh& mesh, const Vector3d& foot, Random& random) {
  const double height = random.uniform(3.0, 4.5);
  add_rod(mesh,
          {.from = foot,
           .to = foot + Vector3d(0, 0, height),
           .radius_from = 0.18,
           .radius_to = 0.12,
           .sides = 7},
          Material::bark);
  const double size = random.uniform(1.2, 2.0);
  add_blob(mesh,
           {.center = foot + Vector3d(0, 0, height + 0.7 * size),
            .radii = {size, size, 1.1 * size},
            .roughness = 0.5,
            .seed = static_cast<uint64_t>(random.uniform(0.0, 1e9))},
           Material::leaves);
}

}  // namespace adit
