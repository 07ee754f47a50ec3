// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/setting.hpp"

#include <chrono>
#include <ctime>
#include <fstream>
#include <thread>

#include "adit/tools/support/commit.hpp"
#include "adit/tools/support/version.hpp"

namespace adit::bench {
namespace {

std::string processor() {
  std::ifstream cpu("/proc/cpuinfo");
  for (std::string line; std::getline(cpu, line);) {
    if (line.starts_with("model name")) {
      return line.substr(line.find(':') + 2);
    }
  }
  return "unknown processor";
}

std::string now() {
  const std::time_t time = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::string text(32, '\0');
  text.resize(std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&time)));
  return text;
}

}  // namespace

Setting setting_of(const engine::DeviceInfo& device) {
  return {.version = std::string(version()),
          .commit = std::string(commit()),
          .date = now(),
          .device = device.name,
          .driver = device.driver,
          .driver_version = device.driver_version,
          .vulkan = device.api_version,
          .software = device.software,
          .host = processor(),
          .threads = std::thread::hardware_concurrency(),
          .peers = ADIT_PEERS_FOUND};
}

}  // namespace adit::bench
