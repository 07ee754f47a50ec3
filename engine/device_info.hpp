// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a Vulkan device is and offers, in plain types.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace adit::engine {

/// One line of the baseline that every kernel may assume.
struct Requirement {
  std::string name;    ///< as Vulkan calls it
  std::string needed;  ///< for people, e.g. ">= 128"
  std::string has;     ///< what the device has, for people
  bool met = false;    ///< it is enough
};

/// A Vulkan device and its limits.
struct DeviceInfo {
  uint32_t index = 0;          ///< in the order of list_devices()
  std::string name;            ///< as its driver calls it
  std::string driver;          ///< name of the driver
  std::string driver_version;  ///< as the driver writes it
  std::string api_version;     ///< "major.minor.patch"
  std::string uuid;            ///< 8-4-4-4-12 hexadecimal digits
  bool software = false;       ///< runs on the CPU (lavapipe, SwiftShader)
  /// Kernels are launched as on a GPU, in many groups; on software devices where a test asks for
  /// it.
  bool gpu_shapes = true;
  uint32_t subgroup_size = 0;              ///< lanes
  uint64_t max_storage_buffer_bytes = 0;   ///< the largest slice bound as storage
  uint32_t max_texel_buffer_elements = 0;  ///< texels of the largest slice bound as texels
  uint64_t device_memory_bytes = 0;        ///< sum of the device-local heaps
  uint32_t max_workgroup_invocations = 0;  ///< largest work group
  uint32_t max_shared_bytes = 0;           ///< shared memory of a work group
  /// Software or integrated: device memory is the host's, so Memory::device is mapped as well.
  bool unified_memory = false;
  std::vector<Requirement> requirements;  ///< the baseline, each with what this device has

  /// It has all that kernels need.
  bool meets_baseline() const;
};

/// Every Vulkan device on the machine, in the loader's order. Throws Error where there is none (no
/// loader, no driver, no device), saying what to install.
std::vector<DeviceInfo> list_devices();

}  // namespace adit::engine
