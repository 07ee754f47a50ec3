// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which device to run on. A function of the list alone, so that it is tested without devices.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "adit/engine/device_info.hpp"

namespace adit::engine {

struct DeviceChoice {
  std::size_t position = 0;        ///< in the list
  bool software_fallback = false;  ///< nothing was asked for and only software was there
};

/// `wanted` as ContextOptions::device says. Throws Error where it names no device or several
/// (listing them), and where the device lacks part of the baseline (listing what).
DeviceChoice choose_device(std::span<const DeviceInfo> devices, std::string_view wanted);

}  // namespace adit::engine
