// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/foxglove_run_feed.hpp"

#include <algorithm>
#include <chrono>
#include <ostream>
#include <utility>

namespace adit {

FoxgloveRunFeed::FoxgloveRunFeed(const std::filesystem::path& what)
    : messages_(read_shown_run(what)) {
  uint64_t position = 0;
  for (const ShownMessage& message : messages_.graph()) {
    add(message.topic, {++position});
    kept_.emplace(position, foxglove_message(message));
  }
  if (messages_.has_points()) {
    overview_ = ++position;
    add(kMapPointsTopic, {overview_});
  }
  first_moment_ = position + 1;
  std::array<std::vector<uint64_t>, kShownKinds> by_kind;
  for (const ShownMoment& moment : messages_.moments()) {
    by_kind[static_cast<std::size_t>(moment.what)].push_back(++position);
  }
  for (int kind = 0; kind < kShownKinds; ++kind) {
    const auto& positions = by_kind[static_cast<std::size_t>(kind)];
    if (!positions.empty()) {
      for (const ShownTopic& topic : messages_.topics_of(static_cast<Shown>(kind))) {
        add(topic, positions);
      }
    }
  }
}

FoxgloveRunFeed::~FoxgloveRunFeed() {
  stop_.request_stop();
}

void FoxgloveRunFeed::add(const ShownTopic& topic, std::vector<uint64_t> positions) {
  channels_.push_back(foxglove_channel(topic));
  positions_.push_back(std::move(positions));
}

std::optional<uint64_t> FoxgloveRunFeed::next(std::size_t channel, uint64_t after) {
  const std::vector<uint64_t>& positions = positions_[channel];
  const auto found = std::ranges::upper_bound(positions, after);
  if (found == positions.end() || (*found == overview_ && !has_overview())) {
    return std::nullopt;
  }
  return *found;
}

/// It is made, or cannot be made; else it is begun.
bool FoxgloveRunFeed::has_overview() {
  if (!made_.valid()) {
    made_ = std::async(std::launch::async, [this, stop = stop_.get_token()] {
      std::ostream nowhere(nullptr);
      return foxglove_message(messages_.overview(nowhere, stop));
    });
  }
  return made_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

FoxgloveMessage FoxgloveRunFeed::message(std::size_t channel, uint64_t position) {
  if (position == overview_) {
    return made_.get();
  }
  if (const auto kept = kept_.find(position); kept != kept_.end()) {
    return kept->second;
  }
  const ShownMoment& moment = messages_.moments()[position - first_moment_];
  const std::vector<ShownMessage> all = messages_.at(moment);
  return foxglove_message(
      *std::ranges::find(all, channels_[channel].topic,
                         [](const ShownMessage& message) { return message.topic.topic; }));
}

}  // namespace adit
