// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/foxglove_session.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/containers/byte_reader.hpp"
#include "adit/tools/support/base64.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr std::array<std::string_view, 2> kProtocols = {"foxglove.sdk.v1", "foxglove.websocket.v1"};
constexpr std::size_t kMostTexts = 64;      // that wait for a client that does not take them
constexpr std::size_t kMostEntries = 256;   // of a list in a client's message
constexpr std::size_t kMostTextShown = 40;  // of a client's words, when they are told back
constexpr uint8_t kMessageData = 1;

/// Foxglove's levels of a status.
enum class StatusLevel { info = 0, warning = 1, error = 2 };

std::string on_one_line(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::string status_text(StatusLevel level, const std::string& text) {
  return on_one_line({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", text}});
}

ordered_json json_of(const FoxgloveChannel& channel, std::size_t number) {
  const McapSchema& schema = channel.schema;
  return {{"id", number},
          {"topic", channel.topic},
          {"encoding", schema.message_encoding},
          {"schemaName", schema.name},
          {"schema", base64(std::as_bytes(std::span(schema.data)))},
          {"schemaEncoding", schema.encoding}};
}

/// What comes before a message.
std::string data_head(uint32_t subscription, Nanoseconds stamp) {
  ByteWriter head;
  head.number(kMessageData);
  head.number(subscription);
  head.number(static_cast<uint64_t>(stamp.count()));
  const auto bytes = head.content();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A number that fits into 32 bits.
std::optional<uint32_t> number_in(const ordered_json& json) {
  if (!json.is_number_unsigned() || json.get<uint64_t>() > std::numeric_limits<uint32_t>::max()) {
    return std::nullopt;
  }
  return json.get<uint32_t>();
}

std::optional<uint32_t> number_in(const ordered_json& json, const char* key) {
  return json.is_object() && json.contains(key) ? number_in(json[key]) : std::nullopt;
}

ViewTaken sent_away(ViewRefusal refusal) {
  return {.refused = refusal, .goes_on = false};
}

}  // namespace

std::string_view foxglove_protocol_of(std::string_view offered) {
  while (!offered.empty()) {
    const std::size_t end = std::min(offered.find(','), offered.size());
    std::string_view name = offered.substr(0, end);
    name.remove_prefix(std::min(name.find_first_not_of(" \t"), name.size()));
    name = name.substr(0, name.find_last_not_of(" \t") + 1);
    const auto* known = std::ranges::find(kProtocols, name);
    if (known != kProtocols.end()) {
      return *known;
    }
    offered.remove_prefix(std::min(end + 1, offered.size()));
  }
  return {};
}

FoxgloveSession::FoxgloveSession(Source source, const std::string& run)
    : source_(std::move(source)) {
  texts_.push_back(on_one_line({{"op", "serverInfo"},
                                {"name", std::string(kGenerator)},
                                {"capabilities", ordered_json::array()},
                                {"sessionId", run}}));
}

ViewTaken FoxgloveSession::take(std::string_view message, bool is_text) {
  const ordered_json json = is_text ? ordered_json::parse(message, nullptr, false) : ordered_json();
  if (!json.is_object() || !json.contains("op") || !json["op"].is_string()) {
    return sent_away(ViewRefusal::malformed);
  }
  const auto& op = json["op"].get_ref<const std::string&>();
  const bool subscribes = op == "subscribe";
  if (!subscribes && op != "unsubscribe") {
    return complain(fmt::format("'{}' is not offered", op.substr(0, kMostTextShown)));
  }
  const char* key = subscribes ? "subscriptions" : "subscriptionIds";
  if (!json.contains(key) || !json[key].is_array()) {
    return sent_away(ViewRefusal::malformed);
  }
  if (json[key].size() > kMostEntries) {
    return sent_away(ViewRefusal::too_many);
  }
  ViewTaken taken;
  for (const ordered_json& entry : json[key]) {
    const auto id = subscribes ? number_in(entry, "id") : number_in(entry);
    const auto channel = subscribes ? number_in(entry, "channelId") : id;
    if (!id || !channel) {
      return sent_away(ViewRefusal::malformed);
    }
    const ViewTaken one = subscribes ? subscribe(*id, *channel) : unsubscribe(*id);
    taken = one.refused ? one : taken;
    if (!taken.goes_on) {
      break;
    }
  }
  return taken;
}

ViewTaken FoxgloveSession::subscribe(uint32_t id, uint64_t number) {
  if (number >= announced_.size() || !announced_[number].channel) {
    return complain(fmt::format("there is no channel {}", number));
  }
  if (announced_[number].subscription ||
      std::ranges::find(announced_, id, [](const Announced& one) { return one.subscription; }) !=
          announced_.end()) {
    return complain(fmt::format("channel {} is subscribed to, or subscription {} is used, already",
                                number, id));
  }
  announced_[number].subscription = id;
  announced_[number].told = 0;
  return {};
}

ViewTaken FoxgloveSession::unsubscribe(uint32_t id) {
  const auto known = std::ranges::find(announced_, id, &Announced::subscription);
  if (known == announced_.end()) {
    if (ended_.erase(id) > 0) {
      return {};
    }
    return complain(fmt::format("there is no subscription {}", id));
  }
  known->subscription.reset();
  return {};
}

/// Tells the client, unless it takes nothing of what it is told.
ViewTaken FoxgloveSession::complain(const std::string& text) {
  if (texts_.size() >= kMostTexts) {
    return sent_away(ViewRefusal::too_many);
  }
  texts_.push_back(status_text(StatusLevel::error, text));
  return {.refused = ViewRefusal::not_offered};
}

void FoxgloveSession::fail(const std::string& text) {
  failed_ = true;
  texts_.push_back(status_text(StatusLevel::error, text));
}

std::optional<ViewFrame> FoxgloveSession::next() {
  follow_source();
  std::optional<ViewFrame> frame = texts_.empty() ? next_data() : std::nullopt;
  if (!texts_.empty()) {
    frame = ViewFrame{.head = std::move(texts_.front())};
    texts_.pop_front();
  }
  return frame;
}

void FoxgloveSession::follow_source() {
  if (failed_) {
    return;
  }
  try {
    const std::shared_ptr<FoxgloveFeed> feed = source_();
    if (feed != feed_) {
      announce(feed);
    }
  } catch (const FileError& error) {
    fail(error.what());
  }
}

void FoxgloveSession::announce(const std::shared_ptr<FoxgloveFeed>& feed) {
  feed_ = feed;
  const std::vector<FoxgloveChannel>& channels = feed->channels();
  ordered_json added = ordered_json::array();
  ordered_json removed = ordered_json::array();
  for (std::size_t number = 0; number < announced_.size(); ++number) {
    Announced& one = announced_[number];
    const auto same = std::ranges::find(channels, one.topic, &FoxgloveChannel::topic);
    if (same == channels.end()) {
      if (one.channel) {
        removed.push_back(number);
        if (one.subscription) {
          ended_.insert(*one.subscription);
        }
      }
      one = {.topic = one.topic};
      continue;
    }
    if (!one.channel) {
      added.push_back(json_of(*same, number));
    }
    one.channel = static_cast<std::size_t>(same - channels.begin());
    one.told = 0;
  }
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (std::ranges::find(announced_, channels[i].topic, &Announced::topic) == announced_.end()) {
      added.push_back(json_of(channels[i], announced_.size()));
      announced_.push_back({.topic = channels[i].topic, .channel = i});
    }
  }
  if (!removed.empty()) {
    texts_.push_back(on_one_line({{"op", "unadvertise"}, {"channelIds", removed}}));
  }
  if (!added.empty()) {
    texts_.push_back(on_one_line({{"op", "advertise"}, {"channels", added}}));
  }
}

/// The first message in the feed's order of all that the client has subscribed to.
std::optional<ViewFrame> FoxgloveSession::next_data() {
  if (failed_) {
    return std::nullopt;
  }
  Announced* chosen = nullptr;
  uint64_t position = std::numeric_limits<uint64_t>::max();
  for (Announced& one : announced_) {
    const auto next = one.subscription ? feed_->next(*one.channel, one.told) : std::nullopt;
    if (next && *next < position) {
      chosen = &one;
      position = *next;
    }
  }
  if (chosen == nullptr) {
    return std::nullopt;
  }
  chosen->told = position;
  try {
    FoxgloveMessage message = feed_->message(*chosen->channel, position);
    return ViewFrame{.head = data_head(*chosen->subscription, message.stamp),
                     .content = std::move(message.content),
                     .is_text = false};
  } catch (const FileError& error) {
    fail(error.what());
    return std::nullopt;
  }
}

}  // namespace adit
