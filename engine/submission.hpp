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

  struct State;

 private:
  friend class Context;
  explicit Submission(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace adit::engine
