// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace adit {

/// The number of this process in an array of jobs, which Slurm, AWS Batch or Kubernetes sets.
std::optional<std::string> array_index();

}  // namespace adit
