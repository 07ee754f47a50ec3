// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The list of cases. Inputs, runs and checks are those of benchmarks/verify: a benchmark verifies
// before it times.
#pragma once

#include <vector>

#include "adit/benchmarks/kernels/work.hpp"

namespace adit::bench {

/// Each family of kernels by itself.
std::vector<Case> kernel_cases();
/// Places described by their looks, and found again.
std::vector<Case> place_cases();
/// Colours of points out of images.
std::vector<Case> coloring_cases();
/// Whole registrations, and batches of them.
std::vector<Case> registration_cases();
/// A sweep as the odometry takes it.
std::vector<Case> sweep_cases();
/// What the host does with the same clouds: de-skewing and one linearisation, in plain float32 C++
/// with threads.
std::vector<Case> host_cases();
/// Other libraries, those that were there when adit was built; may be empty.
std::vector<Case> library_cases();

/// All of them.
std::vector<Case> all_cases();

/// The one of this name; null where there is none.
const Case* find_case(const std::vector<Case>& cases, const std::string& name);

}  // namespace adit::bench
