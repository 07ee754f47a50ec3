// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is kept from one run to the next, so that kernels are compiled and tested once for a device
// and not in every run.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adit/engine/device_info.hpp"

namespace adit {

/// A folder with a file for each device, driver and build of adit whose kernels gave the known
/// answers. What is damaged, or of something else, counts as not there; a file is replaced whole,
/// so that several processes may use one folder. Nothing is thrown: a cache that cannot be used is
/// one that is empty.
class DeviceCache {
 public:
  /// Without a folder it stays empty.
  explicit DeviceCache(std::optional<std::filesystem::path> folder) : folder_(std::move(folder)) {}

  /// The driver's pipeline cache, which may hold nothing; none where the device was not tested, or
  /// by other kernels.
  std::optional<std::vector<std::byte>> find(const engine::DeviceInfo& device) const;
  /// The device has given the known answers.
  void keep(const engine::DeviceInfo& device, std::span<const std::byte> pipelines) const;
  /// It gives them no longer.
  void forget(const engine::DeviceInfo& device) const;

  /// For messages and tests.
  std::optional<std::filesystem::path> file_of(const engine::DeviceInfo& device) const;

 private:
  std::optional<std::filesystem::path> folder_;
};

/// $XDG_CACHE_HOME/adit or ~/.cache/adit; where that cannot be written, a folder of the user's own
/// in the system's temporary one; none where that cannot be written either.
std::optional<std::filesystem::path> cache_folder();

/// Mesa's drivers keep what they compile in a folder of their own, or compile it again in every
/// process where they cannot write there (a container, a read-only home). Then they get one in
/// cache_folder(), by the environment: to be called before anything opens a device, and before
/// there are threads.
void give_mesa_a_cache();

}  // namespace adit
