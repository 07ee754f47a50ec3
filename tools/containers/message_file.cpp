// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/message_file.hpp"

namespace adit {

std::string_view to_string(Encoding encoding) {
  switch (encoding) {
    case Encoding::ros1:
      return "ros1";
    case Encoding::cdr:
      return "cdr";
    case Encoding::other:
      return "other";
  }
  return "unknown";
}

std::string plain_type_name(std::string_view name) {
  constexpr std::string_view kInfix = "/msg/";
  std::string plain(name);
  const std::size_t at = plain.find(kInfix);
  if (at != std::string::npos) {
    plain.replace(at, kInfix.size(), "/");
  }
  return plain;
}

std::string ros2_type_name(std::string_view type) {
  std::string name(type);
  const std::size_t slash = name.find('/');
  return slash == std::string::npos ? name : name.insert(slash, "/msg");
}

std::vector<DeclarationError> contradictions_of(
    const MessageFile& file, const std::vector<std::optional<uint64_t>>& counts) {
  std::vector<DeclarationError> found = file.contradictions();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const Channel& channel = file.channels()[i];
    if (counts[i] && channel.messages && *channel.messages != *counts[i]) {
      found.push_back(wrong_count(file.path(), "the file's index", channel.topic, *channel.messages,
                                  *counts[i]));
    }
  }
  return found;
}

}  // namespace adit
