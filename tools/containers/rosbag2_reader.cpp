// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/rosbag2_reader.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "adit/tools/clouds/sweep_times.hpp"
#include "adit/tools/containers/compression.hpp"
#include "adit/tools/containers/message_blocks.hpp"
#include "adit/tools/containers/packed_messages.hpp"
#include "adit/tools/containers/seekable_file.hpp"
#include "adit/tools/containers/sqlite_database.hpp"
#include "adit/tools/containers/unpacked_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSqliteMagic{"SQLite format 3\0", 16};

bool begins_with(std::span<const std::byte> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

std::vector<std::byte> first_bytes(const fs::path& path) {
  const SeekableFile file(path);
  return file.read(0, std::min<uint64_t>(file.size(), kSqliteMagic.size()));
}

Encoding encoding_of(const std::string& format) {
  return format == "cdr" ? Encoding::cdr : format == "ros1" ? Encoding::ros1 : Encoding::other;
}

/// In which order the messages of a database are read.
enum class RowOrder {
  rows,
  times,         ///< there is an index of times
  sorted_times,  ///< there is none: SQLite sorts the times, without the messages
};

/// The messages of the channels, by the ids of their topics. What is sorted by SQLite itself comes
/// without the data. The '+' keeps SQLite from other indexes than that of the order.
std::string query_of(const std::map<int64_t, std::size_t>& channels, RowOrder order) {
  std::string topics;
  for (const auto& [id, channel] : channels) {
    topics += (topics.empty() ? "" : ", ") + std::to_string(id);
  }
  return std::string("SELECT id, topic_id, timestamp") +
         (order == RowOrder::sorted_times ? "" : ", data") +
         " FROM messages WHERE timestamp >= ?1 AND timestamp <= ?2 AND +id >= ?3 AND +topic_id IN "
         "(" +
         topics + ") ORDER BY " + (order == RowOrder::rows ? "id" : "timestamp, id");
}

class DatabaseStream final : public MessageStream {
 public:
  DatabaseStream(const SqliteDatabase& database, const fs::path& path,
                 std::map<int64_t, std::size_t> channels, const MessageSelection& selection,
                 RowOrder order)
      : path_(&path),
        channels_(std::move(channels)),
        statement_(database.prepare(query_of(channels_, order))) {
    if (order == RowOrder::sorted_times) {
      data_.emplace(database.prepare("SELECT data FROM messages WHERE id = ?1"));
    }
    const uint64_t first = std::min<uint64_t>(selection.from, std::numeric_limits<int64_t>::max());
    statement_.bind(1, selection.begin.count())
        .bind(2, selection.end.count())
        .bind(3, selection.from == 0 ? std::numeric_limits<int64_t>::min()
                                     : static_cast<int64_t>(first));
  }

  std::optional<RawMessage> next() override {
    while (!ended_) {
      ended_ = true;  // SQLite starts anew after an error: there is no way to go on behind it
      if (!statement_.step()) {
        break;
      }
      ended_ = false;
      const auto channel = channels_.find(statement_.integer(1));
      if (channel != channels_.end()) {
        return RawMessage{
            channel->second, Nanoseconds(statement_.integer(2)),
            unpacker_.unpack(blob(), *path_, "row " + std::to_string(statement_.integer(0))),
            static_cast<uint64_t>(statement_.integer(0))};
      }
    }
    return std::nullopt;
  }

 private:
  std::span<const std::byte> blob() {
    if (!data_) {
      return statement_.blob(3);
    }
    data_->reset();
    data_->bind(1, statement_.integer(0));
    return data_->step() ? data_->blob(0) : std::span<const std::byte>();
  }

  const fs::path* path_;
  std::map<int64_t, std::size_t> channels_;
  SqliteStatement statement_;
  std::optional<SqliteStatement> data_;  // where `statement_` comes without them
  MessageUnpacker unpacker_;
  bool ended_ = false;
};

class DatabaseFile final : public MessageFile {
 public:
  explicit DatabaseFile(const fs::path& path)
      : path_(path), database_(path, SqliteDatabase::Mode::read) {
    format_ = "rosbag2 SQLite";
    format_ += database_.recovered() ? ", recovered by its journal" : "";
    if (!has_column("topics", "name")) {
      throw InputError(path_, {}, "it is an SQLite database without a table of topics",
                       "Databases of rosbag2 have one; `adit info` reads maps");
    }
    // Storage schemas before 2 have no qualities of service, those before 4 no hashes of types.
    const bool has_qos = has_column("topics", "offered_qos_profiles");
    const bool has_hash = has_column("topics", "type_description_hash");
    SqliteStatement topics =
        database_.prepare(std::string("SELECT id, name, type, serialization_format, ") +
                          (has_qos ? "offered_qos_profiles" : "''") + ", " +
                          (has_hash ? "type_description_hash" : "''") + " FROM topics ORDER BY id");
    while (topics.step()) {
      ids_.push_back(topics.integer(0));
      const std::string type = topics.text(2);
      channels_.push_back({.topic = topics.text(1),
                           .type = plain_type_name(type),
                           .encoding = encoding_of(topics.text(3)),
                           .definition = definition_of(type),
                           .messages = 0});
      const auto keep = [&](const char* key, const std::string& value) {
        if (!value.empty()) {
          channels_.back().metadata[key] = value;
        }
      };
      keep("offered_qos_profiles", topics.text(4));
      keep("topic_type_hash", topics.text(5));
    }
    SqliteStatement index = database_.prepare(
        "SELECT count(*) FROM sqlite_master WHERE type = 'index' AND tbl_name = 'messages' AND sql "
        "LIKE '%timestamp%'");
    order_ = index.step() && index.integer(0) > 0 ? RowOrder::times : RowOrder::rows;
    count();
  }

  const fs::path& path() const override { return path_; }
  const std::vector<Channel>& channels() const override { return channels_; }
  std::optional<TimeSpan> span() const override { return span_; }
  std::string format() const override { return format_; }
  const std::optional<InputError>& damage() const override { return damage_; }
  MessageLayout layout() const override { return layout_; }

  std::string ros_distro() const override {
    if (!has_column("schema", "ros_distro")) {
      return {};
    }
    SqliteStatement row = database_.prepare("SELECT ros_distro FROM schema");
    return row.step() ? row.text(0) : std::string();
  }

  std::unique_ptr<MessageStream> messages(const MessageSelection& selection) const override {
    std::map<int64_t, std::size_t> wanted;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      if (selection.channels.empty() || std::ranges::count(selection.channels, i) > 0) {
        wanted[ids_[i]] = i;
      }
    }
    return std::make_unique<DatabaseStream>(database_, path_, std::move(wanted), selection, order_);
  }

 private:
  /// False also where there is no such table.
  bool has_column(const char* table, const char* column) const {
    SqliteStatement row =
        database_.prepare("SELECT count(*) FROM pragma_table_info(?1) WHERE name = ?2");
    row.bind(1, std::string_view(table)).bind(2, std::string_view(column));
    return row.step() && row.integer(0) > 0;
  }

  /// Recordings since ROS 2 Iron have the definitions; older ones have none.
  std::string definition_of(const std::string& type) const {
    SqliteStatement table = database_.prepare(
        "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name = 'message_definitions'");
    if (!table.step() || table.integer(0) == 0) {
      return {};
    }
    SqliteStatement row = database_.prepare(
        "SELECT encoded_message_definition FROM message_definitions WHERE topic_type = ?1");
    row.bind(1, std::string_view(type));
    return row.step() ? row.text(0) : std::string();
  }

  /// Walks over the rows, without their messages.
  void count() {
    LayoutObserver observer(channels_.size());
    try {
      SqliteStatement rows =
          database_.prepare("SELECT id, topic_id, timestamp FROM messages ORDER BY id");
      while (rows.step()) {
        const Nanoseconds time(rows.integer(2));
        span_ = span_ ? TimeSpan{std::min(span_->begin, time), std::max(span_->end, time)}
                      : TimeSpan{time, time};
        const auto found = std::ranges::find(ids_, rows.integer(1));
        if (found != ids_.end()) {
          const auto channel = static_cast<std::size_t>(found - ids_.begin());
          channels_[channel].messages = *channels_[channel].messages + 1;
          observer.add(channel, {time, time}, static_cast<uint64_t>(rows.integer(0)));
        }
      }
      layout_ = std::move(observer).take();
      if (layout_.grouped && order_ == RowOrder::rows) {
        order_ = RowOrder::sorted_times;
      }
      layout_.grouped = false;  // the order of times is that of the stream
    } catch (const InputError& error) {
      damage_ = error;
      for (Channel& channel : channels_) {
        channel.messages = std::nullopt;
      }
    }
  }

  fs::path path_;
  SqliteDatabase database_;
  std::vector<int64_t> ids_;  // ids of channels_, in their order
  std::vector<Channel> channels_;
  std::optional<TimeSpan> span_;
  std::string format_;
  std::optional<InputError> damage_;
  RowOrder order_ = RowOrder::rows;
  MessageLayout layout_;
};

}  // namespace

bool is_rosbag2_database(const fs::path& file) {
  return begins_with(first_bytes(file), kSqliteMagic);
}

std::unique_ptr<MessageFile> open_rosbag2_database(const fs::path& file) {
  return std::make_unique<DatabaseFile>(file);
}

std::vector<fs::path> container_files(const fs::path& folder) {
  constexpr std::array kSuffixes = {".db3",       ".db3.zstd", ".mcap",
                                    ".mcap.zstd", ".bag",      ".bag.active"};
  std::vector<fs::path> files;
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  for (const fs::directory_iterator end; !error && entries != end; entries.increment(error)) {
    const std::string name = entries->path().filename().string();
    if (std::ranges::any_of(kSuffixes,
                            [&](const char* suffix) { return name.ends_with(suffix); })) {
      files.push_back(entries->path());
    }
  }
  // One that is packed and not yet removed, or unpacked by hand, is there once.
  std::erase_if(files, [all = files](const fs::path& file) {
    return file.extension() == ".zstd" &&
           std::ranges::count(all, fs::path(file).replace_extension()) > 0;
  });
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

}  // namespace adit
