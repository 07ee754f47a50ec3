// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adit/tools/inspection/inspection.hpp"

namespace adit {

/// Which topics and frames a run passes over, and why.
std::vector<Finding> find_in_choices(const Inspection& inspection);

/// Transforms that a run ignores or normalises, those of /tf that it uses, and mountings on which
/// transforms disagree.
std::vector<Finding> find_in_transforms(const Inspection& inspection);

}  // namespace adit
