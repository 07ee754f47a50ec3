// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Opening a device for a command: what was asked for, what was found, whether it can be trusted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <stdexcept>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "adit/engine/context.hpp"
#include "adit/engine/error.hpp"

namespace adit {

struct DeviceOptions {
  std::string device;  ///< --device; empty: the environment's ADIT_DEVICE, else the best there is
  uint64_t max_vram_bytes = 0;  ///< 0: no limit
  bool validation = false;
  bool profile = true;  ///< device timestamps around every stage; they cost nothing measurable
  engine::Context* opened = nullptr;  ///< a device to work on instead of opening one
  std::ostream* notes = nullptr;      ///< where a first start, which takes a while, says so
};

/// A signal came while kernels were compiled.
class StoppedWhileCompiling : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The device asked for by option or environment; empty where none was.
std::string requested_device(const std::string& option);

/// Opens the device and, unless an earlier run has found it right (DeviceCache), runs the self-test
/// on it, which compiles its kernels. Throws UsageError where the request names no device (with the
/// list), engine::Error where there is no device or where its kernels do not give the known answers
/// (with what failed), StoppedWhileCompiling where a StopSignal has come.
engine::Context open_device(const DeviceOptions& options);

/// The device that a command works on: one that is open already, else one that it opens.
class DeviceSession {
 public:
  explicit DeviceSession(const DeviceOptions& options) {
    if (options.opened == nullptr) {
      own_.emplace(open_device(options));
      kept_bytes_ = own_->pipeline_cache().size();
    }
    context_ = own_ ? &*own_ : options.opened;
  }
  /// Keeps what the driver has compiled since.
  ~DeviceSession();
  DeviceSession(const DeviceSession&) = delete;
  DeviceSession& operator=(const DeviceSession&) = delete;

  engine::Context& context() { return *context_; }

  /// Throws std::runtime_error with what --validation has complained of: that is a failure,
  /// whatever has come of the work.
  void require_no_complaints() const;

 private:
  std::optional<engine::Context> own_;
  std::size_t kept_bytes_ = 0;
  engine::Context* context_ = nullptr;
};

/// What to tell when Context::software_fallback(), one line.
std::string software_note(const engine::DeviceInfo& device);

/// "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe Mesa 22.3.6, software".
std::string describe(const engine::DeviceInfo& device);

/// What did not fit, and what to do.
std::string describe(const engine::OutOfMemory& error);

/// What the device is, without its limits.
nlohmann::ordered_json to_json(const engine::DeviceInfo& device);

}  // namespace adit
