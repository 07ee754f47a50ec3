// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/kernels/compile_table.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/coloring.hpp"
#include "adit/engine/kernels/deskew.hpp"
#include "adit/engine/kernels/free_space.hpp"
#include "adit/engine/kernels/limit_probes.hpp"
#include "adit/engine/kernels/places.hpp"
#include "adit/engine/kernels/preprocess.hpp"
#include "adit/engine/kernels/registration.hpp"
#include "adit/engine/kernels/submap_merge.hpp"
#include "adit/engine/kernels/voxel_map.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit::bench {
namespace {

constexpr std::array<std::string_view, 9> kFamilies = {
    "POLARIS10", "VEGA10", "VEGA20", "RAVEN", "NAVI10", "NAVI14", "NAVI21", "NAVI23", "GFX1100"};

// The odometry's alignments, the map's, those of batches, and each method.
constexpr std::array<engine::RegistrationOptions, 8> kAlignments = {{
    {.robust = gpu::kCauchy},
    {.robust = gpu::kCauchy, .many = true},
    {},
    {.robust = gpu::kCauchy, .drop_back_faces = true},
    {.neighbours = 7},
    {.method = gpu::kNdt, .neighbours = 7},
    {.method = gpu::kPointToPlane},
    {.method = gpu::kNdtToNdt},
}};

// Makes every kernel, and nothing else.
void make_kernels(engine::Context& context) {
  const engine::Kernel probe(context, "engine_probe", {{1, 3}});
  const engine::Kernel texel_probe(context, "engine_texel_probe");
  const engine::LimitProbes limits(context);
  const engine::Deskew deskew(context);
  const engine::Preprocess preprocess(context);
  for (const engine::VoxelContent content :
       {engine::VoxelContent::surfaces, engine::VoxelContent::moments}) {
    const engine::VoxelMapKernels maps(context, content);
  }
  for (const engine::RegistrationOptions& options : kAlignments) {
    const engine::RegistrationKernels alignment(context, options);
  }
  const engine::SubmapMerge merge(context);
  const engine::FreeSpaceVotes votes(context);
  const engine::PlaceKernels places(context);
  const engine::Coloring coloring(context);
}

CompiledKernel row_of(const engine::KernelStatistics& kernel) {
  CompiledKernel row{.kernel = kernel.kernel, .constants = {}, .values = kernel.values};
  for (const engine::Specialization& constant : kernel.specializations) {
    row.constants +=
        fmt::format("{}{}={}", row.constants.empty() ? "" : " ", constant.id, constant.value);
  }
  return row;
}

/// Of a device that the options name.
CompileTable table_of(const std::string& device) {
  engine::Context context({.device = device, .compile_only = true});
  make_kernels(context);
  CompileTable table{.family = context.device().name,
                     .driver = context.device().driver + " " + context.device().driver_version,
                     .kernels = {}};
  for (const engine::KernelStatistics& kernel : context.kernel_statistics()) {
    CompiledKernel row = row_of(kernel);
    if (std::ranges::none_of(table.kernels, [&](const CompiledKernel& one) {
          return one.kernel == row.kernel && one.constants == row.constants;
        })) {
      table.kernels.push_back(std::move(row));
    }
  }
  return table;
}

}  // namespace

double CompiledKernel::value(std::string_view name) const {
  const auto found = std::ranges::find_if(values, [&](const auto& v) { return v.first == name; });
  return found == values.end() ? 0.0 : found->second;
}

std::span<const std::string_view> known_families() {
  return kFamilies;
}

CompileTable compile_table(const std::string& family) {
  if (std::ranges::count(kFamilies, family) == 0) {
    throw UsageError(fmt::format("--compile {}: no family of GPUs that RADV compiles for; it is {}",
                                 family, fmt::join(kFamilies, ", ")));
  }
  setenv("RADV_FORCE_FAMILY", family.c_str(), 1);
  try {
    CompileTable table = table_of("radv");
    table.family = family;
    return table;
  } catch (const engine::NoSuchDevice&) {
    throw engine::Error(
        "there is no RADV, Mesa's driver of AMD's GPUs, to compile with (Debian: apt install "
        "mesa-vulkan-drivers; VK_DRIVER_FILES may leave out radeon_icd)");
  }
}

CompileTable compile_table(const engine::DeviceInfo& device) {
  return table_of(std::to_string(device.index));
}

void print(const CompileTable& table, std::ostream& out) {
  out << table.family << ", compiled by " << table.driver << "\n"
      << fmt::format("{:24} {:32} {:>5} {:>5} {:>6} {:>6} {:>7} {:>5} {:>7} {:>8}\n", "kernel",
                     "constants", "VGPR", "SGPR", "spills", "LDS", "scratch", "waves", "instr.",
                     "latency");
  for (const CompiledKernel& row : table.kernels) {
    out << fmt::format("{:24} {:32} {:5} {:5} {:6} {:6} {:7} {:5} {:7} {:8}\n", row.kernel,
                       row.constants, row.value("VGPRs"), row.value("SGPRs"),
                       row.value(kSpilledVectors) + row.value(kSpilledScalars),
                       row.value("LDS size"), row.value("Scratch size"), row.value(kWaves),
                       row.value("Instructions"), row.value("Latency"));
  }
}

nlohmann::ordered_json to_json(const CompileTable& table) {
  nlohmann::ordered_json kernels = nlohmann::ordered_json::array();
  for (const CompiledKernel& row : table.kernels) {
    nlohmann::ordered_json one = {{"kernel", row.kernel}, {"constants", row.constants}};
    for (const auto& [name, value] : row.values) {
      if (name.find("hash") == std::string::npos && name.find("Hash") == std::string::npos) {
        one["values"][name] = value;
      }
    }
    kernels.push_back(std::move(one));
  }
  return {{"family", table.family}, {"driver", table.driver}, {"kernels", kernels}};
}

nlohmann::ordered_json tables_to_json(const std::vector<CompileTable>& tables) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const CompileTable& table : tables) {
    json.push_back(to_json(table));
  }
  return {{"compiled", json}};
}

std::vector<CompileTable> tables_of(const nlohmann::ordered_json& json) {
  std::vector<CompileTable> tables;
  for (const auto& one : json.at("compiled")) {
    CompileTable& table = tables.emplace_back();
    table.family = one.at("family").get<std::string>();
    table.driver = one.at("driver").get<std::string>();
    for (const auto& kernel : one.at("kernels")) {
      CompiledKernel& row = table.kernels.emplace_back();
      row.kernel = kernel.at("kernel").get<std::string>();
      row.constants = kernel.at("constants").get<std::string>();
      for (const auto& [name, value] : kernel.at("values").items()) {
        row.values.emplace_back(name, value.get<double>());
      }
    }
  }
  return tables;
}

}  // namespace adit::bench
