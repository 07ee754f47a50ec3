// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace adit::engine {

/// The highest version of Vulkan that the machine's loader knows, "major.minor.patch"; none where
/// there is no loader.
std::optional<std::string> loader_version();

}  // namespace adit::engine
