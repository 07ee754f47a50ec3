// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Real data with known answers lie beside a checkout, in ../shared/data, and are not part of it.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace adit::test {

/// The source tree that the tests were built from.
std::filesystem::path tree();

/// ../shared/data/NAME beside the source tree, where it exists.
std::optional<std::filesystem::path> shared_data(std::string_view name);

}  // namespace adit::test

/// Binds `variable` to the path of shared data, or skips the test and says what is missing.
#define ADIT_SHARED_DATA_OR_SKIP(variable, name)                                                 \
  const std::optional<std::filesystem::path> variable##_found = ::adit::test::shared_data(name); \
  if (!variable##_found) {                                                                       \
    GTEST_SKIP() << "needs ../shared/data/" << (name) << " beside the checkout";                 \
  }                                                                                              \
  const std::filesystem::path variable = *variable##_found
