// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/bag_reader.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <utility>

#include "adit/tools/containers/bag_cursor.hpp"
#include "adit/tools/containers/message_blocks.hpp"

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
  std::map<uint32_t, uint64_t> counts;  // messages by connection
};

/// What a bag holds, from its index or from all of it.
struct Contents {
  std::map<uint32_t, bag::Connection> connections;
  std::map<uint32_t, uint64_t> counts;
  std::optional<TimeSpan> span;
  std::vector<ChunkInfo> chunks;
  std::vector<MessageBlock> blocks;  // their channels by id
  std::set<std::string> compressions;
  bool indexed = false;
  std::optional<InputError> damage;
  std::vector<DeclarationError> contradictions;
};

/// The index of a bag, and how much of it the bag's header declares.
struct Index {
  Contents contents;
  uint32_t connections = 0;
  uint32_t chunks = 0;
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
  ChunkInfo info{record.header.number<uint64_t>("chunk_pos"),
                 {record.header.time("start_time"), record.header.time("end_time")},
                 {}};
  const auto connections = record.header.number<uint32_t>("count");
  uint64_t messages = 0;
  for (uint32_t i = 0; i < connections; ++i) {
    const auto id = record.data.number<uint32_t>("a chunk's counts");
    const auto count = record.data.number<uint32_t>("a chunk's counts");
    contents.counts[id] += count;
    if (count > 0) {
      info.counts[id] += count;
    }
    messages += count;
  }
  if (messages > 0) {
    widen(contents.span, info.span);
  }
  contents.chunks.push_back(std::move(info));
}

/// The index, where the bag has one; nothing otherwise.
std::optional<Index> read_index(const SeekableFile& file) {
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
  Index whole;
  Contents& contents = whole.contents;
  contents.indexed = true;
  whole.connections = header.number<uint32_t>("conn_count");
  whole.chunks = header.number<uint32_t>("chunk_count");
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
  std::ranges::sort(contents.chunks, {}, &ChunkInfo::offset);
  for (const ChunkInfo& chunk : contents.chunks) {
    MessageBlock block{chunk.offset, chunk.span, {}};
    for (const auto& [id, count] : chunk.counts) {
      block.channels.push_back(id);
    }
    if (!block.channels.empty()) {
      contents.blocks.push_back(std::move(block));
    }
  }
  return whole;
}

/// Messages by connection as the records behind a chunk tell; empty where there are none.
std::map<uint32_t, uint64_t> counts_behind(const SeekableFile& file, uint64_t chunk) {
  constexpr uint64_t kHead = 512;  // bytes: more than a header of these records has
  std::map<uint32_t, uint64_t> counts;
  for (uint64_t at = chunk;;) {
    if (at >= file.size()) {
      return counts;
    }
    const std::vector<std::byte> bytes = file.read(at, std::min(kHead, file.size() - at));
    ByteReader reader(file.path(), at, bytes);
    const auto length = reader.number<uint32_t>("the header of a record");
    const bag::Fields header(reader.part(length, "the header of a record"));
    const auto data = reader.number<uint32_t>("the data of a record");
    const auto expected = at == chunk ? bag::Opcode::chunk : bag::Opcode::index;
    if (header.opcode() != expected) {
      return counts;
    }
    if (const auto count = at == chunk ? 0U : header.number<uint32_t>("count"); count > 0) {
      counts[header.number<uint32_t>("conn")] += count;
    }
    at = reader.offset() + data;
  }
}

/// The index agrees with the bag's header, and with a sample of the records behind the chunks: all
/// of them would be as many places to read as there are chunks.
bool is_sound(const SeekableFile& file, const Index& index) {
  constexpr std::size_t kSample = 64;
  const std::vector<ChunkInfo>& chunks = index.contents.chunks;
  if (index.contents.connections.size() != index.connections || chunks.size() != index.chunks) {
    return false;
  }
  const std::size_t step = std::max<std::size_t>(1, chunks.size() / kSample);
  for (std::size_t i = 0; i < chunks.size(); i += step) {
    const std::map<uint32_t, uint64_t> counts = counts_behind(file, chunks[i].offset);
    if (!counts.empty() && counts != chunks[i].counts) {
      return false;
    }
  }
  return true;
}

/// Where the index differs from what is in the bag.
std::vector<DeclarationError> contradictions(const fs::path& file, const Index& index,
                                             const Contents& there) {
  std::vector<DeclarationError> found;
  const auto differ = [&](const char* what, uint64_t declared, uint64_t counted) {
    if (declared != counted) {
      found.emplace_back(file,
                         "its header declares " + std::to_string(declared) + " " + what +
                             ", but there are " + std::to_string(counted),
                         "Make its index anew (rosbag reindex), or copy the bag again");
    }
  };
  differ("topics", index.connections, there.connections.size());
  differ("chunks in the index", index.chunks, index.contents.chunks.size());
  for (const auto& [id, connection] : there.connections) {
    const auto declared = index.contents.counts.find(id);
    const auto counted = there.counts.find(id);
    const uint64_t told = declared == index.contents.counts.end() ? 0 : declared->second;
    const uint64_t real = counted == there.counts.end() ? 0 : counted->second;
    if (told != real) {
      found.push_back(wrong_count(file, "the bag's index", connection.topic, told, real));
    }
  }
  return found;
}

/// Reads everything once. `closed`: the bag has its index.
Contents scan(const SeekableFile& file, bool closed) {
  Contents contents;
  bag::Cursor cursor(file, closed);
  BlockCollector blocks;
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
        const auto id = record->header.number<uint32_t>("conn");
        ++contents.counts[id];
        widen(contents.span, {time, time});
        blocks.add(id, time, record->offset, record->in_chunk);
      }
    } catch (const InputError& error) {
      if (!contents.damage) {
        contents.damage = error;
      }
    }
  }
  contents.compressions = cursor.compressions();
  contents.blocks = std::move(blocks).take();
  contents.indexed = closed;
  return contents;
}

Contents read_contents(const SeekableFile& file) {
  std::optional<Index> index;
  bool sound = false;
  try {
    index = read_index(file);
    sound = index && is_sound(file, *index);
  } catch (const InputError&) {
    // an index that cannot be read: the chunks tell the same
  }
  if (sound) {
    return std::move(index->contents);
  }
  // An index that lists less than the header declares was cut off.
  const bool closed = index && index->contents.connections.size() >= index->connections &&
                      index->contents.chunks.size() >= index->chunks;
  Contents contents = scan(file, closed);
  if (index) {
    contents.contradictions = contradictions(file.path(), *index, contents);
  }
  return contents;
}

class BagStream final : public MessageStream {
 public:
  BagStream(const SeekableFile& file, const Contents& contents,
            std::map<uint32_t, std::size_t> channels, std::set<uint64_t> skipped,
            const MessageSelection& selection)
      : cursor_(file, contents.indexed),
        contents_(&contents),
        channels_(std::move(channels)),
        begin_(selection.begin),
        end_(selection.end) {
    for (const ChunkInfo& chunk : contents.chunks) {
      if (chunk.span.end < begin_ || chunk.span.begin > end_) {
        skipped.insert(chunk.offset);
      }
    }
    cursor_.skip_chunks(std::move(skipped));
    if (selection.from > 0) {
      cursor_.start_at(selection.from);
    }
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
    for (MessageBlock& block : contents_.blocks) {
      for (std::size_t& channel : block.channels) {
        channel = static_cast<std::size_t>(std::ranges::find(ids_, channel) - ids_.begin());
      }
      std::erase(block.channels, ids_.size());  // of what the bag does not declare
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
  std::vector<DeclarationError> contradictions() const override { return contents_.contradictions; }
  MessageLayout layout() const override { return layout_of(contents_.blocks, channels_.size()); }

  std::unique_ptr<MessageStream> messages(const MessageSelection& selection) const override {
    std::map<uint32_t, std::size_t> wanted;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      if (selection.channels.empty() || std::ranges::count(selection.channels, i) > 0) {
        wanted[ids_[i]] = i;
      }
    }
    std::set<uint64_t> skipped;
    if (selection.by_index) {
      skipped = blocks_without(contents_.blocks, selection.channels);
    }
    return std::make_unique<BagStream>(file_, contents_, std::move(wanted), std::move(skipped),
                                       selection);
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
