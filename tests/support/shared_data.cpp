// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tests/support/shared_data.hpp"

namespace adit::test {

// The tree's path comes from CMake: __FILE__ is relative under some compiler caches.
std::filesystem::path tree() {
  return ADIT_TREE;
}

std::optional<std::filesystem::path> shared_data(std::string_view name) {
  const std::filesystem::path data = tree().parent_path() / "shared" / "data" / name;
  return std::filesystem::exists(data) ? std::optional(data) : std::nullopt;
}

}  // namespace adit::test
