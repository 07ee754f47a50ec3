// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the tests of the containers share.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "adit/tests/recordings/message_support.hpp"
#include "adit/tools/containers/message_file.hpp"

namespace adit::test {

inline std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The messages that can be read, and what was wrong.
struct Reading {
  std::vector<SampleMessage> messages;
  std::vector<InputError> errors;
};
inline Reading read(const MessageFile& file, const MessageSelection& selection = {}) {
  Reading reading;
  const auto stream = file.messages(selection);
  for (bool more = true; more;) {
    try {
      const auto message = stream->next();
      more = message.has_value();
      if (message) {
        reading.messages.push_back(
            {message->channel, message->received, {message->bytes.begin(), message->bytes.end()}});
      }
    } catch (const InputError& error) {
      reading.errors.push_back(error);
    }
  }
  return reading;
}

/// True where the messages are the first of those written.
inline bool is_prefix(const std::vector<SampleMessage>& messages,
                      const std::vector<SampleMessage>& written) {
  return messages.size() <= written.size() &&
         std::equal(
             messages.begin(), messages.end(), written.begin(), [](const auto& a, const auto& b) {
               return a.channel == b.channel && a.received == b.received && a.bytes == b.bytes;
             });
}

}  // namespace adit::test
