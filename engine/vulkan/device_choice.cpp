// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/vulkan/device_choice.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string>
#include <vector>

#include "adit/engine/error.hpp"

namespace adit::engine {
namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

std::string without_dashes(std::string text) {
  std::erase(text, '-');
  return text;
}

std::string listing(std::span<const DeviceInfo> devices) {
  std::string text;
  for (const DeviceInfo& device : devices) {
    text += "\n  " + std::to_string(device.index) + ": " + device.name + " (" + device.driver +
            " " + device.driver_version + ", " + device.uuid +
            (device.software ? ", software)" : ")");
  }
  return text;
}

std::string lacks(const DeviceInfo& device) {
  std::string text;
  for (const Requirement& requirement : device.requirements) {
    if (!requirement.met) {
      text +=
          "\n  " + requirement.name + ": needs " + requirement.needed + ", has " + requirement.has;
    }
  }
  return text;
}

// Mesa's software driver is known by its project's name, but calls itself by its rasterizer's.
std::string searchable(const DeviceInfo& device) {
  const std::string text = lower(device.name + " " + device.driver);
  return text.find("llvmpipe") == std::string::npos ? text : text + " lavapipe";
}

std::vector<std::size_t> matches(std::span<const DeviceInfo> devices, std::string_view wanted) {
  uint32_t index = 0;
  const auto [end, status] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  const bool number = status == std::errc() && end == wanted.data() + wanted.size();
  const std::string text = lower(wanted);
  std::vector<std::size_t> by_index;
  std::vector<std::size_t> by_uuid;
  std::vector<std::size_t> by_name;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    if (number && devices[i].index == index) {
      by_index.push_back(i);
    }
    if (!devices[i].uuid.empty() &&
        without_dashes(lower(devices[i].uuid)) == without_dashes(text)) {
      by_uuid.push_back(i);
    }
    if (searchable(devices[i]).find(text) != std::string::npos) {
      by_name.push_back(i);
    }
  }
  return !by_index.empty() ? by_index : !by_uuid.empty() ? by_uuid : by_name;
}

}  // namespace

DeviceChoice choose_device(std::span<const DeviceInfo> devices, std::string_view wanted) {
  if (devices.empty()) {
    throw Error("there is no Vulkan device");
  }
  DeviceChoice choice;
  if (!wanted.empty()) {
    const std::vector<std::size_t> found = matches(devices, wanted);
    if (found.size() != 1) {
      throw NoSuchDevice(
          (found.empty() ? "no Vulkan device is called '" : "several Vulkan devices are called '") +
          std::string(wanted) + "'; there are:" + listing(devices));
    }
    choice.position = found.front();
  } else {
    // Hardware that lacks something is not passed over for software: that would be slow in silence.
    const auto preference = [](const DeviceInfo& d) {
      return (d.software ? 0 : 2) + (d.meets_baseline() ? 1 : 0);
    };
    const auto best = std::ranges::max_element(devices, {}, preference);
    choice.position = static_cast<std::size_t>(best - devices.begin());
    choice.software_fallback = best->software;
  }
  const DeviceInfo& device = devices[choice.position];
  if (!device.meets_baseline()) {
    throw Error(
        "device " + std::to_string(device.index) + " (" + device.name +
        ") lacks part of what the kernels need:" + lacks(device) +
        (devices.size() > 1 ? "\nAsk for another by index, UUID or name:" + listing(devices) : ""));
  }
  return choice;
}

}  // namespace adit::engine
