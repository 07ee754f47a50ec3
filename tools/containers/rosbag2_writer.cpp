// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/rosbag2_writer.hpp"

#include <algorithm>
#include <stdexcept>

#include "adit/tools/containers/compression.hpp"
#include "adit/tools/containers/rosbag2_metadata.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kBatchBytes = uint64_t{8} << 20U;

fs::path make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_empty(folder, error)) {
    throw OutputError(folder, folder.string() +
                                  (error ? ": the folder cannot be made: " + error.message()
                                         : std::string(": the folder is not empty")) +
                                  ". Name another one.");
  }
  return folder;
}

std::string storage_name(const fs::path& folder) {
  return fs::absolute(folder / "").lexically_normal().parent_path().filename().string() + "_0.db3";
}

SqliteDatabase make_database(const fs::path& file) {
  return {file, SqliteDatabase::Mode::create};
}

/// The tables of storage schema 4.
constexpr const char* kTables =
    "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
    "CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata "
    "TEXT "
    "NOT NULL);"
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
    "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL, type_description_hash "
    "TEXT NOT NULL);"
    "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding "
    "TEXT NOT NULL, encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER "
    "NOT "
    "NULL, data BLOB NOT NULL);"
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);";

}  // namespace

Rosbag2Writer::Rosbag2Writer(const fs::path& folder, const Rosbag2Options& options)
    : folder_(make_folder(folder)),
      file_name_(storage_name(folder)),
      options_(options),
      database_(make_database(folder / file_name_)),
      insert_([&] {
        database_.execute(kTables);
        SqliteStatement schema = database_.prepare("INSERT INTO schema VALUES (4, ?1)");
        schema.bind(1, std::string_view(options_.ros_distro));
        schema.step();
        database_.execute("BEGIN");
        return database_.prepare(
            "INSERT INTO messages (topic_id, timestamp, data) VALUES (?1, ?2, ?3)");
      }()) {}

std::size_t Rosbag2Writer::add_channel(const Channel& channel) {
  if (channel.encoding != Encoding::cdr) {
    throw std::logic_error("rosbag2: " + channel.topic + " is not in CDR");
  }
  const auto id = static_cast<int64_t>(channels_.size() + 1);
  const std::string type = ros2_type_name(channel.type);
  const auto told = [&](const char* key) {
    const auto found = channel.metadata.find(key);
    return found == channel.metadata.end() ? std::string() : found->second;
  };
  const std::string qos = named_qos_profiles(told("offered_qos_profiles"));
  const std::string hash = told("topic_type_hash");
  SqliteStatement topic =
      database_.prepare("INSERT INTO topics VALUES (?1, ?2, ?3, 'cdr', ?4, ?5)");
  topic.bind(1, id)
      .bind(2, std::string_view(channel.topic))
      .bind(3, std::string_view(type))
      .bind(4, std::string_view(qos))
      .bind(5, std::string_view(hash));
  topic.step();
  const bool known = std::ranges::count(channels_, channel.type, &Channel::type) > 0;
  if (!known && !channel.definition.empty()) {
    SqliteStatement definition =
        database_.prepare("INSERT INTO message_definitions VALUES (?1, ?2, 'ros2msg', ?3, ?4)");
    definition.bind(1, id)
        .bind(2, std::string_view(type))
        .bind(3, std::string_view(channel.definition))
        .bind(4, std::string_view(hash));
    definition.step();
  }
  channels_.push_back(channel);
  channels_.back().messages = 0;
  return channels_.size() - 1;
}

void Rosbag2Writer::write(std::size_t channel, Nanoseconds received,
                          std::span<const std::byte> bytes) {
  channels_.at(channel).messages = *channels_[channel].messages + 1;
  span_ = span_ ? TimeSpan{std::min(span_->begin, received), std::max(span_->end, received)}
                : TimeSpan{received, received};
  insert_.bind(1, static_cast<int64_t>(channel + 1)).bind(2, received.count());
  if (options_.pack_messages) {
    const std::vector<std::byte> packed = compress(Compression::zstd, bytes);
    insert_.bind(3, packed);
  } else {
    insert_.bind(3, bytes);
  }
  insert_.step();
  insert_.reset();
  uncommitted_ += bytes.size();
  if (uncommitted_ >= kBatchBytes) {
    database_.execute("COMMIT; BEGIN");
    uncommitted_ = 0;
  }
}

void Rosbag2Writer::close() {
  const std::string text = to_yaml({.channels = channels_,
                                    .span = span_,
                                    .packed_messages = options_.pack_messages,
                                    .file = file_name_,
                                    .ros_distro = options_.ros_distro});
  SqliteStatement row = database_.prepare("INSERT INTO metadata VALUES (1, 9, ?1)");
  row.bind(1, std::string_view(text));
  row.step();
  database_.execute("COMMIT");
  write_text_file(folder_ / "metadata.yaml", text);
}

}  // namespace adit
