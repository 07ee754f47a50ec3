// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What lines streets. Metres.
#pragma once

#include <Eigen/Core>

#include "adit/tools/simulator/mesh.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {

/// Adds a tree with a trunk of 3 to 4.5 m.
void add_street_tree(Mesh& mesh, const Eigen::Vector3d& foot, Random& random);

}  // namespace adit
