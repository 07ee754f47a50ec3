// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/page_session.hpp"

#include <utility>

namespace adit {
namespace {

ViewText text_or_null(std::string text) {
  return text.empty() ? nullptr : std::make_shared<const std::string>(std::move(text));
}

}  // namespace

PageSession::PageSession(const ViewSite& site, std::size_t most) : site_(&site), most_(most) {
  for (std::string& text : site.greeting()) {
    waiting_.emplace_back(text_or_null(std::move(text)));
  }
}

ViewTaken PageSession::take(std::string_view message, bool is_text) {
  ViewAnswer answer = is_text ? site_->answer(message) : ViewAnswer{.understood = false};
  if (!answer.understood) {
    return {.refused = ViewRefusal::malformed, .goes_on = false};
  }
  waiting_.insert(waiting_.end(), answer.tiles.begin(), answer.tiles.end());
  if (const ViewText reply = text_or_null(std::move(answer.reply))) {
    waiting_.emplace_back(reply);
  }
  if (waiting_.size() > most_) {
    return {.refused = ViewRefusal::too_many, .goes_on = false};
  }
  return {.to_all = text_or_null(std::move(answer.to_all))};
}

std::optional<ViewFrame> PageSession::next() {
  if (waiting_.empty() && site_->news) {
    ViewNews news = site_->news(told_);
    told_ = news.told;
    waiting_.insert(waiting_.end(), news.texts.begin(), news.texts.end());
  }
  if (waiting_.empty()) {
    return std::nullopt;
  }
  const std::variant<uint32_t, ViewText> first = std::move(waiting_.front());
  waiting_.pop_front();
  if (const auto* text = std::get_if<ViewText>(&first)) {
    return ViewFrame{.content = *text};
  }
  ViewText tile = text_or_null(site_->tile(std::get<uint32_t>(first)));
  if (tile == nullptr) {
    return ViewFrame{.refused = ViewRefusal::malformed};
  }
  return ViewFrame{.content = std::move(tile), .is_text = false};
}

std::optional<ViewRefusal> PageSession::tell(const ViewText& text) {
  waiting_.emplace_back(text);
  return waiting_.size() > most_ ? std::optional(ViewRefusal::too_slow) : std::nullopt;
}

}  // namespace adit
