// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/foxglove/shown_messages.hpp"

namespace adit {

struct FoxgloveChannel {
  std::string topic;
  McapSchema schema;
};

struct FoxgloveMessage {
  Nanoseconds stamp{0};
  std::shared_ptr<const std::string> content;
};

/// The messages of channels. Positions, from 1, put the messages of all channels in an order; a
/// position is given to one message of a channel at most. Functions that make messages throw
/// InputError.
class FoxgloveFeed {
 public:
  virtual ~FoxgloveFeed() = default;
  /// Never others; each topic is there once, and has the same schema in every feed.
  virtual const std::vector<FoxgloveChannel>& channels() const = 0;
  /// Where the channel's next message is after a position; nothing: there is none yet.
  virtual std::optional<uint64_t> next(std::size_t channel, uint64_t after) = 0;
  /// The message at a position that next() has just given.
  virtual FoxgloveMessage message(std::size_t channel, uint64_t position) = 0;
};

FoxgloveChannel foxglove_channel(const ShownTopic& topic);
FoxgloveMessage foxglove_message(const ShownMessage& message);

}  // namespace adit
