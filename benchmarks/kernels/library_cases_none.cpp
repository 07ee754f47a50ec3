// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/kernels/cases.hpp"

namespace adit::bench {

std::vector<Case> library_cases() {
  return {};
}

}  // namespace adit::bench
