// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a GPU's compiler makes of every kernel, without the GPU: Mesa's RADV compiles for a family
// that it is told.
#pragma once

#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/engine/device_info.hpp"

namespace adit::bench {

struct CompiledKernel {
  std::string kernel{};
  std::string constants{};                               ///< the specialisation, "ID=VALUE ..."
  std::vector<std::pair<std::string, double>> values{};  ///< by the driver's names

  /// 0 where the driver tells no such thing.
  double value(std::string_view name) const;
};

struct CompileTable {
  std::string family{};
  std::string driver{};  ///< with its version
  std::vector<CompiledKernel> kernels{};
};

/// The names of what is compared between tables.
inline constexpr std::string_view kWaves = "Subgroups per SIMD";
inline constexpr std::string_view kSpilledVectors = "Spilled VGPRs";
inline constexpr std::string_view kSpilledScalars = "Spilled SGPRs";

/// Families that RADV knows by name; it ends the process at any other.
std::span<const std::string_view> known_families();

/// Every kernel as a GPU gets it, in every variant that adit runs. Sets RADV_FORCE_FAMILY, so that
/// the process has no hardware of AMD from then on. Throws UsageError for an unknown family,
/// engine::Error where RADV is not installed.
CompileTable compile_table(const std::string& family);

/// The same as this device's own driver has it; the family is its name. Throws engine::Error where
/// the driver tells nothing of what it compiles.
CompileTable compile_table(const engine::DeviceInfo& device);

void print(const CompileTable& table, std::ostream& out);
nlohmann::ordered_json to_json(const CompileTable& table);
nlohmann::ordered_json tables_to_json(const std::vector<CompileTable>& tables);
std::vector<CompileTable> tables_of(const nlohmann::ordered_json& json);

}  // namespace adit::bench
