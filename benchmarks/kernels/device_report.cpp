// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/kernels/device_report.hpp"

#include <chrono>
#include <string>

#include <nlohmann/json.hpp>

#include "adit/benchmarks/kernels/compile_table.hpp"
#include "adit/engine/error.hpp"
#include "adit/tools/setup/device_finding.hpp"

namespace adit::bench {
namespace {

nlohmann::ordered_json compiled(const engine::DeviceInfo& device) {
  try {
    return to_json(compile_table(device));
  } catch (const engine::Error& error) {
    return {{"problem", error.what()}};
  }
}

}  // namespace

nlohmann::ordered_json device_report(const Report& measured, const engine::DeviceInfo& device,
                                     std::ostream& notes) {
  using Clock = std::chrono::steady_clock;
  nlohmann::ordered_json json = to_json(measured);
  const auto start = Clock::now();
  json["device"] = to_json(examine(device, true, notes));
  json["self_test_s"] = std::chrono::duration<double>(Clock::now() - start).count();
  json["compiled"] = compiled(device);
  return json;
}

}  // namespace adit::bench
