// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace adit::engine {

/// Device time of one Recorder::scope(), ms.
struct ScopeTime {
  std::string name;        ///< of the scope
  double device_ms = 0.0;  ///< by the device's own clock
  uint32_t depth = 0;      ///< 0 for a scope that is in no other
};

/// What was recorded for the device, in one submission or several.
struct RecordedWork {
  uint32_t submissions = 0;  ///< each costs the host a wait
  uint32_t dispatches = 0;  ///< of kernels, also of such as the device then finds nothing to do for
  uint32_t barriers = 0;    ///< each waits for all that was recorded before it
  uint32_t copies = 0;      ///< of slices, and fills
  uint64_t upload_bytes = 0;    ///< copied from the host's memory
  uint64_t readback_bytes = 0;  ///< copied to the host's memory

  /// Both together.
  RecordedWork& operator+=(const RecordedWork& other);
};

/// Work on its way to, on, or done by the device. Destroying it waits for the work, so that buffers
/// made before it are never freed under the device's hands.
class [[nodiscard]] Submission {
 public:
  Submission(Submission&&) noexcept;
  Submission& operator=(Submission&&) noexcept;
  ~Submission();

  /// Returns when the work is done and its writes are visible in mapped memory. Throws DeviceLost.
  void wait();
  bool done() const;  ///< true once wait() would not block. Throws DeviceLost.

  /// In order of recording; empty unless the context profiles. Only after wait(): std::logic_error
  /// before.
  const std::vector<ScopeTime>& scope_times() const;
  /// What it consists of.
  const RecordedWork& recorded() const;

  struct State;

 private:
  friend class Context;
  explicit Submission(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace adit::engine
