// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/bag_reader.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <utility>

#include "adit/tools/containers/bag_cursor.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

bool has_magic(const SeekableFile& file) {
  if (file.size() < bag::kMagic.size()) {
    return false;
  }
  const std::vector<std::byte> bytes = file.read(0, bag::kMagic.size());
  return std::memcmp(bytes.data(), bag::kMagic.data(), bytes.size()) == 0;
}

/// A chunk by what the index tells.
struct ChunkInfo {
  uint64_t offset = 0;
  TimeSpan span;
};

/// What a bag holds, from its index or from all of it.
struct Contents {
  std::map<uint32_t, bag::Connection> connections;
  std::map<uint32_t, uint64_t> counts;
  std::optional<TimeSpan> span;
  std::vector<ChunkInfo> chunks;
  std::set<std::string> compressions;
  bool indexed = false;
  std::optional<InputError> damage;
};

void widen(std::optional<TimeSpan>& span, const TimeSpan& by) {
  span = span ? TimeSpan{std::min(span->begin, by.begin), std::max(span->end, by.end)} : by;
}

/// A header and its data from the reader.
struct Record {
  bag::Fields header;
  ByteReader data;
};
Record read_record(ByteReader& reader) {
  const auto header_length = reader.number<uint32_t>("the header of a record");
  const bag::Fields header(reader.part(header_length, "the header of a record"));
  const auto data_length = reader.number<uint32_t>("the data of a record");
  return {header, reader.part(data_length, "the data of a record")};
}

void take_chunk_info(Contents& contents, Record& record) {
  const ChunkInfo info{record.header.number<uint64_t>("chunk_pos"),
                       {record.header.time("start_time"), record.header.time("end_time")}};
  const auto connections = record.header.number<uint32_t>("count");
  uint64_t messages = 0;
  for (uint32_t i = 0; i < connections; ++i) {
    const auto id = record.data.number<uint32_t>("a chunk's counts");
    const auto count = record.data.number<uint32_t>("a chunk's counts");
    contents.counts[id] += count;
    messages += count;
  }
  if (messages > 0) {
    widen(contents.span, info.span);
  }
  contents.chunks.push_back(info);
}

/// The index, where the bag has a whole one; nothing otherwise.
std::optional<Contents> read_index(const SeekableFile& file) {
  const uint64_t head = std::min<uint64_t>(file.size(), bag::kMagic.size() + bag::kFileHeader);
  const std::vector<std::byte> bytes = file.read(bag::kMagic.size(), head - bag::kMagic.size());
  ByteReader reader(file.path(), bag::kMagic.size(), bytes);
  const auto length = reader.number<uint32_t>("the bag's header");
  const bag::Fields header(reader.part(length, "the bag's header"));
  const auto index = header.number<uint64_t>("index_pos");
  if (header.opcode() != bag::Opcode::file_header || index < bag::kMagic.size() ||
      index > file.size()) {
    return std::nullopt;
  }
  Contents contents;
  contents.indexed = true;
  const std::vector<std::byte> records = file.read(index, file.size() - index);
  ByteReader rest(file.path(), index, records);
  while (rest.remaining() > 0) {
    Record record = read_record(rest);
    const std::optional<bag::Opcode> opcode = record.header.opcode();
    if (opcode == bag::Opcode::connection) {
      bag::Connection connection = bag::read_connection(record.header, record.data);
      contents.connections[connection.id] = std::move(connection);
    } else if (opcode == bag::Opcode::chunk_info) {
      take_chunk_info(contents, record);
    }
  }
  const bool whole = contents.connections.size() == header.number<uint32_t>("conn_count") &&
                     contents.chunks.size() == header.number<uint32_t>("chunk_count");
  return whole ? std::optional(std::move(contents)) : std::nullopt;
}

/// Reads everything once.
Contents scan(const SeekableFile& file) {
  Contents contents;
  bag::Cursor cursor(file, false);
  while (true) {
    try {
      const std::optional<bag::Record> record = cursor.next();
      if (!record) {
        break;
      }
      if (record->opcode == bag::Opcode::connection) {
        bag::Connection connection = bag::read_connection(record->header, record->data);
        contents.connections[connection.id] = std::move(connection);
      } else {
        const Nanoseconds time = record->header.time("time");
        ++contents.counts[record->header.number<uint32_t>("conn")];
        widen(contents.span, {time, time});
      }
    } catch (const InputError& error) {
      if (!contents.damage) {
        contents.damage = error;
      }
    }
  }
  contents.compressions = cursor.compressions();
  return contents;
}

Contents read_contents(const SeekableFile& file) {
  try {
    if (std::optional<Contents> contents = read_index(file)) {
      return std::move(*contents);
    }
  } catch (const InputError&) {
    // an index that cannot be read: the chunks tell the same
  }
  return scan(file);
}

class BagStream final : public MessageStream {
 public:
  BagStream(const SeekableFile& file, const Contents& contents,
            std::map<uint32_t, std::size_t> channels, Nanoseconds begin, Nanoseconds end)
      : cursor_(file, contents.indexed),
        contents_(&contents),
        channels_(std::move(channels)),
        begin_(begin),
        end_(end) {
    std::set<uint64_t> outside;
    for (const ChunkInfo& chunk : contents.chunks) {
      if (chunk.span.end < begin || chunk.span.begin > end) {
        outside.insert(chunk.offset);
      }
    }
    cursor_.skip_chunks(std::move(outside));
  }

  std::optional<RawMessage> next() override {
    while (std::optional<bag::Record> record = cursor_.next()) {
      if (record->opcode != bag::Opcode::message) {
        continue;
      }
      const auto id = record->header.number<uint32_t>("conn");
      const auto channel = channels_.find(id);
      if (channel == channels_.end()) {
        if (!contents_->connections.contains(id)) {
          record->data.fail("a message of connection " + std::to_string(id) +
                            ", which the bag does not declare");
        }
        continue;
      }
      const Nanoseconds time = record->header.time("time");
      if (time >= begin_ && time <= end_) {
        return RawMessage{channel->second, time,
                          record->data.bytes(record->data.remaining(), "a message"),
                          record->offset};
      }
    }
    return std::nullopt;
  }

 private:
  bag::Cursor cursor_;
  const Contents* contents_;
  std::map<uint32_t, std::size_t> channels_;  // those wanted
  Nanoseconds begin_;
  Nanoseconds end_;
};

class BagFile final : public MessageFile {
 public:
  explicit BagFile(const fs::path& path) : file_(path) {
    if (!has_magic(file_)) {
      throw InputError(path, Place::byte(0), "it does not begin as a ROS bag of version 2.0 does",
                       "Check that it is the right file");
    }
    contents_ = read_contents(file_);
    for (const auto& [id, connection] : contents_.connections) {
      ids_.push_back(id);
      channels_.push_back({.topic = connection.topic,
                           .type = connection.type,
                           .encoding = Encoding::ros1,
                           .definition = connection.definition,
                           .messages = contents_.counts[id],
                           .metadata = connection.metadata});
    }
    format_ = "ROS 1 bag";
    for (const std::string& compression : contents_.compressions) {
      format_ += compression == "none" ? "" : " " + compression;
    }
    format_ += contents_.indexed ? "" : ", without an index";
  }

  const fs::path& path() const override { return file_.path(); }
  const std::vector<Channel>& channels() const override { return channels_; }
  std::optional<TimeSpan> span() const override { return contents_.span; }
  std::string format() const override { return format_; }
  const std::optional<InputError>& damage() const override { return contents_.damage; }

  std::unique_ptr<MessageStream> messages(const MessageSelection& selection) const override {
    std::map<uint32_t, std::size_t> wanted;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      if (selection.channels.empty() || std::ranges::count(selection.channels, i) > 0) {
        wanted[ids_[i]] = i;
      }
    }
    return std::make_unique<BagStream>(file_, contents_, std::move(wanted), selection.begin,
                                       selection.end);
  }

 private:
  SeekableFile file_;
  Contents contents_;
  std::vector<uint32_t> ids_;  // ids of channels_, in their order
  std::vector<Channel> channels_;
  std::string format_;
};

}  // namespace

bool is_bag(const fs::path& file) {
  return has_magic(SeekableFile(file));
}

std::unique_ptr<MessageFile> open_bag(const fs::path& file) {
  return std::make_unique<BagFile>(file);
}

}  // namespace adit
