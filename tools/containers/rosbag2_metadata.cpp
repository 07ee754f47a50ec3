// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/rosbag2_metadata.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <span>
#include <string_view>
#include <system_error>

#include "adit/tools/containers/yaml_text.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetadataFile = "metadata.yaml";
constexpr std::string_view kBag = "rosbag2_bagfile_information";
constexpr std::string_view kQosKey = "offered_qos_profiles";
constexpr std::string_view kHashKey = "topic_type_hash";

/// A policy of rmw/types.h and its values, counted from 0.
struct Policy {
  std::string_view key;
  std::array<std::string_view, 6> values;
};
constexpr std::array<Policy, 4> kPolicies = {{
    {"history", {"system_default", "keep_last", "keep_all", "unknown"}},
    {"reliability", {"system_default", "reliable", "best_effort", "unknown", "best_available"}},
    {"durability", {"system_default", "transient_local", "volatile", "unknown", "best_available"}},
    {"liveliness",
     {"system_default", "automatic", "manual_by_node", "manual_by_topic", "unknown",
      "best_available"}},
}};

/// A text for YAML, in double quotes.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
    }
    out += c == '\n' ? ' ' : c;
  }
  return out + "\"";
}

std::string told(const Channel& channel, std::string_view key) {
  const auto found = channel.metadata.find(std::string(key));
  return found == channel.metadata.end() ? std::string() : found->second;
}

/// The numbers behind "KEY:" become names.
std::string with_names(std::string text, const Policy& policy) {
  const std::string key = std::string(policy.key) + ":";
  for (std::size_t at = text.find(key); at != text.npos; at = text.find(key, at + key.size())) {
    const std::size_t value = text.find_first_not_of(' ', at + key.size());
    if (value == text.npos) {
      break;
    }
    std::size_t number = 0;
    const auto end = std::from_chars(text.data() + value, text.data() + text.size(), number);
    if (end.ec == std::errc() && number < policy.values.size() && !policy.values[number].empty()) {
      text.replace(value, static_cast<std::size_t>(end.ptr - text.data()) - value,
                   policy.values[number]);
    }
  }
  return text;
}

/// The lines of a YAML sequence, each further in; "[]" where there are none.
std::string indented(const std::string& sequence, std::size_t columns) {
  if (sequence.empty()) {
    return " []";
  }
  std::string out;
  LineReader lines(sequence);
  while (const auto line = lines.next()) {
    out += "\n" + std::string(columns, ' ') + std::string(*line);
  }
  return out;
}

std::string to_yaml(const Channel& channel) {
  const std::string qos = named_qos_profiles(told(channel, kQosKey));
  return "    - topic_metadata:\n        name: " + quoted(channel.topic) +
         "\n        type: " + ros2_type_name(channel.type) +
         "\n        serialization_format: cdr\n        offered_qos_profiles:" + indented(qos, 10) +
         "\n        type_description_hash: " + quoted(told(channel, kHashKey)) +
         "\n      message_count: " + std::to_string(channel.messages.value_or(0)) + "\n";
}

/// metadata.yaml in the folder; nothing where there is none, or none of a size that makes sense.
std::optional<std::string> metadata_text(const fs::path& folder) {
  constexpr uint64_t kLargest = 1U << 24U;
  const fs::path file = folder / kMetadataFile;
  std::error_code error;
  if (!fs::is_regular_file(file, error) || fs::file_size(file, error) > kLargest || error) {
    return std::nullopt;
  }
  return read_text_file(file);
}

std::optional<uint64_t> number_in(const YamlNode& mapping, std::string_view key) {
  const YamlNode* value = mapping.find(key);
  return value == nullptr ? std::nullopt : parse_unsigned(value->scalar);
}

}  // namespace

std::string to_yaml(const Rosbag2Metadata& metadata) {
  uint64_t messages = 0;
  std::string topics;
  for (const Channel& channel : metadata.channels) {
    messages += channel.messages.value_or(0);
    topics += to_yaml(channel);
  }
  const TimeSpan span = metadata.span.value_or(TimeSpan{});
  const std::string begin = std::to_string(span.begin.count());
  const std::string duration = std::to_string((span.end - span.begin).count());
  const std::string count = std::to_string(messages);
  const bool packed = metadata.packed_messages;
  return std::string(
             "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: sqlite3\n") +
         "  duration:\n    nanoseconds: " + duration +
         "\n  starting_time:\n    nanoseconds_since_epoch: " + begin +
         "\n  message_count: " + count +
         "\n  topics_with_message_count:" + (topics.empty() ? " []\n" : "\n" + topics) +
         "  compression_format: \"" + (packed ? "zstd" : "") + "\"\n  compression_mode: \"" +
         (packed ? "MESSAGE" : "") + "\"\n  relative_file_paths:\n    - " + quoted(metadata.file) +
         "\n  files:\n    - path: " + quoted(metadata.file) +
         "\n      starting_time:\n        nanoseconds_since_epoch: " + begin +
         "\n      duration:\n        nanoseconds: " + duration + "\n      message_count: " + count +
         "\n  custom_data: ~\n  ros_distro: " + quoted(metadata.ros_distro) + "\n";
}

std::string named_qos_profiles(const std::string& text) {
  const auto printable = [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); };
  if (!text.starts_with("- ") || !std::ranges::all_of(text, printable)) {
    return {};
  }
  std::string named = text;
  for (const Policy& policy : kPolicies) {
    named = with_names(std::move(named), policy);
  }
  while (named.ends_with('\n')) {
    named.pop_back();
  }
  return named;
}

std::optional<Rosbag2Declaration> read_rosbag2_declaration(const fs::path& folder) {
  const std::optional<std::string> text = metadata_text(folder);
  if (!text) {
    return std::nullopt;
  }
  const std::optional<YamlNode> document = parse_yaml(*text);
  const YamlNode* bag = document ? document->find(kBag) : nullptr;
  const YamlNode* files = bag == nullptr ? nullptr : bag->find("relative_file_paths");
  Rosbag2Declaration declared;
  if (files != nullptr) {
    for (const YamlNode& file : files->items) {
      declared.files.emplace_back(file.scalar);
    }
  }
  if (declared.files.empty()) {
    throw UnusableMetadata(folder / kMetadataFile, {},
                           "it does not list the files of the recording",
                           "All containers in the folder are read; write it anew (ros2 bag "
                           "reindex)");
  }
  declared.messages = number_in(*bag, "message_count");
  const YamlNode* topics = bag->find("topics_with_message_count");
  for (const YamlNode& topic : topics == nullptr ? std::vector<YamlNode>() : topics->items) {
    const YamlNode* about = topic.find("topic_metadata");
    const YamlNode* name = about == nullptr ? nullptr : about->find("name");
    const std::optional<uint64_t> messages = number_in(topic, "message_count");
    if (name != nullptr && messages) {
      declared.topics.emplace_back(name->scalar, *messages);
    }
  }
  return declared;
}

fs::path without_metadata_file(const fs::path& path) {
  if (path.filename() != kMetadataFile) {
    return path;
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const std::optional<std::string> text = metadata_text(folder);
  return text && text->find(kBag) != std::string::npos ? folder : path;
}

std::string told_ros_distro(const fs::path& folder) {
  constexpr std::string_view kKey = "ros_distro:";
  const std::optional<std::string> text = metadata_text(folder);
  if (!text) {
    return {};
  }
  LineReader lines(*text);
  while (const auto line = lines.next()) {
    const std::vector<std::string_view> words = split_words(*line);
    if (words.size() == 2 && words[0] == kKey) {
      std::string distro(words[1]);
      std::erase_if(distro, [](char c) { return c == '"' || c == '\''; });
      return distro;
    }
  }
  return {};
}

}  // namespace adit
