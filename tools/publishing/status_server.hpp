// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>

namespace adit {

struct StatusAnswer {
  unsigned code = 200;  ///< of HTTP
  std::string type;     ///< "application/json"
  std::string body;
};

/// Answers GET requests of this machine (127.0.0.1), in a thread of its own. At most 16 clients at
/// a time, each with five seconds and 8 KiB for its request.
class StatusServer {
 public:
  using Answer = std::function<StatusAnswer(const std::string& path)>;

  /// Listens from now on; `port` 0: any that is free. Throws UsageError where it cannot.
  StatusServer(uint16_t port, Answer answer);
  ~StatusServer();
  StatusServer(const StatusServer&) = delete;
  StatusServer& operator=(const StatusServer&) = delete;

  uint16_t port() const;

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
  std::jthread thread_;  ///< last: it uses the other
};

}  // namespace adit
