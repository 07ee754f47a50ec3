// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/device_finding.hpp"

#include <cstddef>
#include <ostream>
#include <vector>

#include <nlohmann/json.hpp>

#include "adit/engine/context.hpp"
#include "adit/engine/error.hpp"
#include "adit/tools/setup/device_cache.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {

DeviceFinding examine(const engine::DeviceInfo& device, bool self_test, std::ostream& notes) {
  DeviceFinding finding{.device = device, .self_test = std::nullopt, .error = {}};
  if (!self_test || !device.meets_baseline()) {
    return finding;
  }
  try {
    const DeviceCache cache(cache_folder());
    if (!cache.find(device)) {
      notes << "note: compiling kernels for " << device.name << ", once for this device"
            << std::endl;
    }
    engine::Context context({.device = std::to_string(device.index)});
    const engine::ParallelSelfTest test =
        engine::run_self_test({.device = std::to_string(device.index)}, [](const auto&) {});
    finding.self_test = test.report;
    if (test.report.passed()) {
      for (const std::vector<std::byte>& pipelines : test.pipeline_caches) {
        context.add_to_pipeline_cache(pipelines);
      }
      cache.keep(device, context.pipeline_cache());
    } else {
      cache.forget(device);
    }
  } catch (const engine::Error& error) {
    finding.error = error.what();
  }
  return finding;
}

std::string verdict(const DeviceFinding& finding) {
  if (!finding.device.meets_baseline()) {
    return "NOT USABLE: it lacks part of what the kernels need";
  }
  if (!finding.error.empty()) {
    return "NOT USABLE: " + finding.error;
  }
  if (!finding.self_test) {
    return "usable (self-test not run)";
  }
  return finding.self_test->passed() ? "usable"
                                     : "NOT USABLE: its kernels do not give the known answers";
}

nlohmann::ordered_json to_json(const DeviceFinding& finding) {
  nlohmann::ordered_json json = to_json(finding.device);
  json["max_storage_buffer_bytes"] = finding.device.max_storage_buffer_bytes;
  json["max_texel_buffer_elements"] = finding.device.max_texel_buffer_elements;
  json["max_workgroup_invocations"] = finding.device.max_workgroup_invocations;
  json["max_shared_bytes"] = finding.device.max_shared_bytes;
  json["requirements"] = nlohmann::ordered_json::array();
  for (const engine::Requirement& r : finding.device.requirements) {
    json["requirements"].push_back(
        {{"name", r.name}, {"needed", r.needed}, {"has", r.has}, {"met", r.met}});
  }
  json["self_test"] = nlohmann::ordered_json();  // null: not run
  if (finding.self_test) {
    json["self_test"] = nlohmann::ordered_json::array();
    for (const engine::SelfTestCase& test : finding.self_test->cases) {
      json["self_test"].push_back(
          {{"kernel", test.kernel}, {"passed", test.passed}, {"detail", test.detail}});
    }
  }
  json["usable"] = finding.usable();
  json["verdict"] = verdict(finding);
  return json;
}

}  // namespace adit
