// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/foxglove_feed.hpp"

#include "adit/tools/foxglove/foxglove_types.hpp"

namespace adit {

FoxgloveChannel foxglove_channel(const ShownTopic& topic) {
  return {.topic = topic.topic, .schema = protobuf_mcap_schema(shown_types(), topic.type)};
}

FoxgloveMessage foxglove_message(const ShownMessage& message) {
  const auto bytes = message.message.content();
  return {.stamp = message.stamp,
          .content = std::make_shared<const std::string>(
              reinterpret_cast<const char*>(bytes.data()), bytes.size())};
}

}  // namespace adit
