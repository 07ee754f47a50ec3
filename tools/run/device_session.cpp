// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/device_session.hpp"

#include <cstdlib>

#include <nlohmann/json.hpp>

#include "adit/engine/error.hpp"
#include "adit/engine/self_test/self_test.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

void require_known_answers(engine::Context& context) {
  const engine::SelfTestReport report = engine::run_self_test(context);
  if (report.passed()) {
    return;
  }
  std::string message = "the device '" + context.device().name +
                        "' is refused: its kernels do not give the known answers";
  for (const engine::SelfTestCase& test : report.cases) {
    if (!test.passed) {
      message += "\n  " + test.kernel + ": " + test.detail;
    }
  }
  throw engine::Error(
      message + "\nUpdate its driver, or choose another device of `adit devices` with --device.");
}

}  // namespace

std::string requested_device(const std::string& option) {
  if (!option.empty()) {
    return option;
  }
  const char* environment = std::getenv("ADIT_DEVICE");
  return environment == nullptr ? std::string() : std::string(environment);
}

engine::Context open_device(const DeviceOptions& options) {
  const std::string requested = requested_device(options.device);
  try {
    engine::Context context({.device = requested,
                             .validation = options.validation,
                             .synchronization_validation = options.validation,
                             .profile = options.profile,
                             .memory_budget_bytes = options.max_vram_bytes});
    require_known_answers(context);
    return context;
  } catch (const engine::NoSuchDevice& error) {
    throw UsageError((options.device.empty() ? "ADIT_DEVICE: " : "--device: ") +
                     std::string(error.what()));
  }
}

std::string software_note(const engine::DeviceInfo& device) {
  return "note: no GPU was found; the CPU does its work in software (" + describe(device) + ")";
}

std::string describe(const engine::DeviceInfo& device) {
  return device.name + ", " + device.driver + " " + device.driver_version +
         (device.software ? ", software" : "");
}

nlohmann::ordered_json to_json(const engine::DeviceInfo& device) {
  return {{"index", device.index},
          {"name", device.name},
          {"uuid", device.uuid},
          {"driver", device.driver},
          {"driver_version", device.driver_version},
          {"api_version", device.api_version},
          {"software", device.software},
          {"unified_memory", device.unified_memory},
          {"subgroup_size", device.subgroup_size},
          {"memory_bytes", device.device_memory_bytes}};
}

}  // namespace adit
