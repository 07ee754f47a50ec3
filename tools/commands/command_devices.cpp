// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_devices.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "adit/engine/context.hpp"
#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/setup/device_cache.hpp"
#include "adit/tools/setup/device_finding.hpp"

namespace adit {
namespace {

std::string mebibytes(uint64_t bytes) {
  return std::to_string(bytes / (uint64_t{1024} * 1024)) + " MiB";
}

void print(const DeviceFinding& finding, std::ostream& out) {
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

int devices(const DevicesCommandOptions& options, std::ostream& out, std::ostream& err) {
  give_mesa_a_cache();
  std::vector<DeviceFinding> findings;
  for (const engine::DeviceInfo& device : engine::list_devices()) {
    findings.push_back(examine(device, options.self_test, err));
  }
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const DeviceFinding& finding : findings) {
    if (options.json) {
      json.push_back(to_json(finding));
    } else {
      print(finding, out);
    }
  }
  if (options.json) {
    out << nlohmann::ordered_json{{"schema", "devices/1"}, {"devices", json}}.dump(2) << "\n";
  }
  out << std::flush;
  return std::ranges::any_of(findings, &DeviceFinding::usable) ? 0 : 1;
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
