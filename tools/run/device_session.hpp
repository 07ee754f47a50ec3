// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Opening a device for a command: what was asked for, what was found, whether it can be trusted.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "adit/engine/context.hpp"

namespace adit {

struct DeviceOptions {
  std::string device;  ///< --device; empty: the environment's ADIT_DEVICE, else the best there is
  uint64_t max_vram_bytes = 0;  ///< 0: no limit
  bool validation = false;
  bool profile = true;  ///< device timestamps around every stage; they cost nothing measurable
  engine::Context* opened = nullptr;  ///< a device to work on instead of opening one
};

/// The device asked for by option or environment; empty where none was.
std::string requested_device(const std::string& option);

/// Opens the device and runs the self-test on it. Throws UsageError where the request names no
/// device (with the list), engine::Error where there is no device or where its kernels do not give
/// the known answers (with what failed).
engine::Context open_device(const DeviceOptions& options);

/// The device that a command works on: one that is open already, else one that it opens.
class DeviceSession {
 public:
  explicit DeviceSession(const DeviceOptions& options) {
    if (options.opened == nullptr) {
      own_.emplace(open_device(options));
    }
    context_ = own_ ? &*own_ : options.opened;
  }
  DeviceSession(const DeviceSession&) = delete;
  DeviceSession& operator=(const DeviceSession&) = delete;

  engine::Context& context() { return *context_; }

 private:
  std::optional<engine::Context> own_;
  engine::Context* context_ = nullptr;
};

/// What to tell when Context::software_fallback(), one line.
std::string software_note(const engine::DeviceInfo& device);

/// "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe Mesa 22.3.6, software".
std::string describe(const engine::DeviceInfo& device);

/// What the device is, without its limits.
nlohmann::ordered_json to_json(const engine::DeviceInfo& device);

}  // namespace adit
