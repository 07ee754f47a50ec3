// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <variant>

#include "adit/tools/viewer/view_server.hpp"
#include "adit/tools/viewer/view_session.hpp"

namespace adit {

/// A page of ours: it is greeted, gets the tiles that it asks for, and what is new when it waits
/// for nothing.
class PageSession final : public ViewSession {
 public:
  /// `site` must outlive it; `most` tiles and texts may wait.
  PageSession(const ViewSite& site, std::size_t most);

  ViewTaken take(std::string_view message, bool is_text) override;
  std::optional<ViewFrame> next() override;
  std::optional<ViewRefusal> tell(const ViewText& text) override;

 private:
  const ViewSite* site_;
  std::size_t most_;
  std::deque<std::variant<uint32_t, ViewText>> waiting_;
  uint64_t told_ = 0;  ///< of the site's news
};

}  // namespace adit
