// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/kernels/cases.hpp"

#include <algorithm>

namespace adit::bench {

std::string to_string(CaseKind kind) {
  switch (kind) {
    case CaseKind::kernel:
      return "kernel";
    case CaseKind::registration:
      return "registration";
    case CaseKind::batch:
      return "batch";
    case CaseKind::peer:
      return "peer";
  }
  return "unknown";
}

std::vector<Case> all_cases() {
  std::vector<Case> all;
  for (const auto& part : {kernel_cases(), place_cases(), coloring_cases(), registration_cases(),
                           sweep_cases(), host_cases(), library_cases()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

const Case* find_case(const std::vector<Case>& cases, const std::string& name) {
  const auto found = std::ranges::find(cases, name, &Case::name);
  return found == cases.end() ? nullptr : &*found;
}

}  // namespace adit::bench
