// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/dds/dds_library.hpp"

#include <charconv>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

#include <dlfcn.h>

#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlugin = "adit_dds.so";
constexpr uint32_t kLastDomain = 232;  // beyond it DDS has no ports

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

template <class Function>
Function function_of(void* library, const char* name) {
  return reinterpret_cast<Function>(::dlsym(library, name));
}

}  // namespace

std::vector<fs::path> dds_plugin_places() {
  if (const std::string named = environment("ADIT_DDS_PLUGIN"); !named.empty()) {
    return {named};
  }
  std::error_code unknown;
  const fs::path folder = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  return {folder / kPlugin, folder.parent_path() / "lib" / "adit" / kPlugin};
}

std::unique_ptr<DdsNode> open_dds_node(const DdsOptions& options) {
  std::string looked;
  for (const fs::path& place : dds_plugin_places()) {
    looked += (looked.empty() ? "" : ", ") + place.string();
    std::error_code unknown;
    if (!fs::exists(place, unknown)) {
      continue;
    }
    // It stays open: its threads may outlive what is done with it here.
    void* library = ::dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
      throw std::runtime_error(place.string() + ": it cannot be opened: " + ::dlerror() +
                               ". It needs Cyclone DDS: apt install libddsc0debian");
    }
    const auto interface = function_of<int (*)()>(library, kDdsInterfaceFunction);
    const auto open =
        function_of<DdsNode* (*)(const DdsOptions&, std::string&)>(library, kDdsOpenFunction);
    if (interface == nullptr || open == nullptr || interface() != kDdsInterface) {
      throw std::runtime_error(place.string() + ": it belongs to another version of adit");
    }
    std::string error;
    std::unique_ptr<DdsNode> node(open(options, error));
    if (!node) {
      throw std::runtime_error("DDS: " + error);
    }
    return node;
  }
  throw std::runtime_error(
      "ROS 2 topics need adit's DDS plug-in, which is not here (looked for " + looked +
      "). The .deb has it, and a build makes it where cyclonedds-dev is installed.");
}

DdsOptions dds_options_of_environment() {
  DdsOptions options;
  if (const std::string domain = environment("ROS_DOMAIN_ID"); !domain.empty()) {
    const auto [end, error] =
        std::from_chars(domain.data(), domain.data() + domain.size(), options.domain);
    if (error != std::errc{} || end != domain.data() + domain.size() ||
        options.domain > kLastDomain) {
      throw UsageError("ROS_DOMAIN_ID: '" + domain + "' is not a number from 0 to 232.");
    }
  }
  const std::string range = environment("ROS_AUTOMATIC_DISCOVERY_RANGE");
  options.this_machine = range != kSubnetRange && environment("ROS_LOCALHOST_ONLY") != "0";
  return options;
}

}  // namespace adit
