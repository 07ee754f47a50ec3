// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace adit::bench {

/// Registers what other libraries need for the same work on the same clouds, and tells what was
/// registered. Which of peers_*.cpp is compiled depends on what CMake found.
std::string register_peers();

}  // namespace adit::bench
