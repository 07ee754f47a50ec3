// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is found out about a device: whether it offers what the kernels need, and whether it
// computes correctly.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "adit/engine/device_info.hpp"
#include "adit/engine/self_test/self_test.hpp"

namespace adit {

struct DeviceFinding {
  engine::DeviceInfo device;
  std::optional<engine::SelfTestReport> self_test;  ///< none: not run
  std::string error;  ///< the device could not be opened or the test not be run

  bool usable() const {
    return device.meets_baseline() && error.empty() && (!self_test || self_test->passed());
  }
};

/// The kernels run here whatever earlier runs have found, which is kept for those that follow.
/// `notes` is told where they have to be compiled first.
DeviceFinding examine(const engine::DeviceInfo& device, bool self_test, std::ostream& notes);

/// One line.
std::string verdict(const DeviceFinding& finding);

/// The device with its limits, what the kernels need of it, and the self-test.
nlohmann::ordered_json to_json(const DeviceFinding& finding);

}  // namespace adit
