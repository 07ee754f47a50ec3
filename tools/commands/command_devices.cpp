// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_devices.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "adit/engine/context.hpp"
#include "adit/engine/self_test/self_test.hpp"
#include "adit/tools/commands/command_guard.hpp"
#include "adit/tools/commands/command_line.hpp"
#include "adit/tools/run/device_cache.hpp"
#include "adit/tools/run/device_session.hpp"

namespace adit {
namespace {

/// A device with what was found out about it.
struct Finding {
  engine::DeviceInfo device;
  std::optional<engine::SelfTestReport> self_test;  ///< none: not run
  std::string error;  ///< the device could not be opened or the test not be run

  bool usable() const {
    return device.meets_baseline() && error.empty() && (!self_test || self_test->passed());
  }
};

// The kernels run here whatever earlier runs have found; those that follow rely on it.
Finding examine(const engine::DeviceInfo& device, bool self_test, std::ostream& notes) {
  Finding finding{.device = device, .self_test = std::nullopt, .error = {}};
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
        engine::run_self_test({.device = std::to_string(device.index)}, [] {});
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

std::string verdict(const Finding& finding) {
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

std::string mebibytes(uint64_t bytes) {
  return std::to_string(bytes / (uint64_t{1024} * 1024)) + " MiB";
}

void print(const Finding& finding, std::ostream& out) {
  const engine::DeviceInfo& d = finding.device;
  out << d.index << ": " << d.name << (d.software ? " (software)" : "") << "\n"
      << "   uuid       " << d.uuid << "\n"
      << "   driver     " << d.driver << " " << d.driver_version << ", Vulkan " << d.api_version
      << "\n"
      << "   memory     " << mebibytes(d.device_memory_bytes)
      << (d.unified_memory ? ", shared with the host" : "") << "; largest buffer a kernel can use "
      << mebibytes(d.max_storage_buffer_bytes) << "\n"
      << "   subgroups  " << d.subgroup_size << " lanes\n";
  const auto met = std::ranges::count_if(d.requirements, &engine::Requirement::met);
  out << "   baseline   " << met << " of " << d.requirements.size() << " requirements met\n";
  for (const engine::Requirement& r : d.requirements) {
    out << (r.met ? "     ok       " : "     LACKING  ") << r.name << ": " << r.has << " (needs "
        << r.needed << ")\n";
  }
  if (finding.self_test) {
    const auto& cases = finding.self_test->cases;
    out << "   self-test  " << std::ranges::count_if(cases, &engine::SelfTestCase::passed) << " of "
        << cases.size() << " kernels give the known answers\n";
    for (const engine::SelfTestCase& test : cases) {
      out << (test.passed ? "     ok       " : "     WRONG    ") << test.kernel
          << (test.detail.empty() ? "" : ": " + test.detail) << "\n";
    }
  }
  out << "   verdict    " << verdict(finding) << "\n";
}

nlohmann::ordered_json describe(const Finding& finding) {
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

int devices(const DevicesCommandOptions& options, std::ostream& out, std::ostream& err) {
  give_mesa_a_cache();
  std::vector<Finding> findings;
  for (const engine::DeviceInfo& device : engine::list_devices()) {
    findings.push_back(examine(device, options.self_test, err));
  }
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Finding& finding : findings) {
    if (options.json) {
      json.push_back(describe(finding));
    } else {
      print(finding, out);
    }
  }
  if (options.json) {
    out << nlohmann::ordered_json{{"schema", "devices/1"}, {"devices", json}}.dump(2) << "\n";
  }
  out << std::flush;
  return std::ranges::any_of(findings, &Finding::usable) ? 0 : 1;
}

}  // namespace

int devices_command(const DevicesCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit devices", out, err, [&] { return devices(options, out, err); });
}

void add_devices_command(Command app, std::function<void(int)> done) {
  auto options = std::make_shared<DevicesCommandOptions>();
  const Command command =
      app.add_command("devices", "List the devices, check their limits, test their kernels");
  command.footer(
      "Choose one with --device or the environment's ADIT_DEVICE: by index, UUID or part of the "
      "name.\n\n"
      "Examples:\n"
      "  adit devices\n"
      "  adit devices --json --no-self-test\n\n"
      "Exit codes: 0 a device can be used, 1 none can.");
  command.flag("--json", options->json, "Print JSON instead of text");
  command.flag(
      "--no-self-test", [options] { options->self_test = false; },
      "Do not run the kernels on known cases");
  command.action(
      [options, done = std::move(done)] { done(devices_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
