// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is said to one client of the server, and what it may say.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "adit/tools/viewer/view_access.hpp"

namespace adit {

/// A text on its way to clients.
using ViewText = std::shared_ptr<const std::string>;

/// A WebSocket message: `head`, then the bytes of `content`.
struct ViewFrame {
  std::string head{};
  ViewText content{};  ///< null: none
  bool is_text = true;
  std::optional<ViewRefusal> refused{};  ///< instead of a message: the client is sent away
};

/// What became of a client's message.
struct ViewTaken {
  std::optional<ViewRefusal> refused{};
  bool goes_on = true;  ///< false: the client is sent away
  ViewText to_all{};    ///< for all clients of that kind, this one too; null: none
};

/// A client is sent one message at a time, when it has taken the one before: what it waits for is
/// made then, and not before.
class ViewSession {
 public:
  virtual ~ViewSession() = default;
  virtual ViewTaken take(std::string_view message, bool is_text) = 0;
  /// What is to be sent next; nothing: wait. Asked ten times a second, and after each message.
  virtual std::optional<ViewFrame> next() = 0;
  /// ViewTaken::to_all of a client; a refusal sends this one away.
  virtual std::optional<ViewRefusal> tell(const ViewText& text) = 0;
};

}  // namespace adit
