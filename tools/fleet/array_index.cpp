// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/array_index.hpp"

#include <array>
#include <cstdlib>

namespace adit {

std::optional<std::string> array_index() {
  constexpr std::array kNames = {"SLURM_ARRAY_TASK_ID", "AWS_BATCH_JOB_ARRAY_INDEX",
                                 "JOB_COMPLETION_INDEX"};
  for (const char* const name : kNames) {
    if (const char* const value = std::getenv(name)) {
      return value;
    }
  }
  return std::nullopt;
}

}  // namespace adit
