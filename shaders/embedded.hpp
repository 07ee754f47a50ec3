// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The SPIR-V of shaders/*.comp, embedded at build time.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace adit::shaders {

/// The module built from shaders/<name>.comp; empty where there is none.
std::span<const uint32_t> find(std::string_view name);

/// The same of those that include shaders/include/wide.glsl, with ADIT_WIDE defined.
std::span<const uint32_t> find_wide(std::string_view name);

/// Every shader, in alphabetical order.
std::vector<std::string_view> names();

/// The same, built with -g and without optimisation: the names and layouts of all structs are in
/// it. Only programs that link adit_shaders_debug have these.
std::span<const uint32_t> find_debug(std::string_view name);
std::vector<std::string_view> names_debug();

}  // namespace adit::shaders
