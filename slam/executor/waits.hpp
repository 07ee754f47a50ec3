// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

namespace adit {

/// On the host's clock, s.
inline double elapsed_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Of sweeps and fixes for the map while they come, s.
struct Waits {
  double sum = 0.0;
  double longest = 0.0;
};

/// A wait as long as its life.
class Waiting {
 public:
  explicit Waiting(Waits& waits) : waits_(waits) {}
  ~Waiting() {
    const double wait = elapsed_since(start_);
    waits_.sum += wait;
    waits_.longest = std::max(waits_.longest, wait);
  }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  Waits& waits_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace adit
