// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where, when and with what something was measured.
#pragma once

#include <string>

#include "adit/engine/device_info.hpp"

namespace adit::bench {

/// Where, with what and on what.
struct Setting {
  std::string version{};
  std::string commit{};
  std::string date{};  ///< ISO 8601, UTC
  std::string device{};
  std::string driver{};
  std::string driver_version{};
  std::string vulkan{};
  bool software = false;
  std::string host{};  ///< its processor
  unsigned threads = 0;
  std::string peers{};
  std::string input{};
  double seconds = 0.0;  ///< measured a case, at least
};

/// This program, this moment, this machine; `input` and `seconds` are left to the caller.
Setting setting_of(const engine::DeviceInfo& device);

}  // namespace adit::bench
