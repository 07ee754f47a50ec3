// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/mcap_reader.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <map>
#include <set>
#include <utility>

#include "adit/tools/containers/crc32.hpp"
#include "adit/tools/containers/mcap_cursor.hpp"
#include "adit/tools/containers/message_blocks.hpp"
#include "adit/tools/containers/packed_messages.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

Nanoseconds to_time(uint64_t nanoseconds) {
  return Nanoseconds(static_cast<int64_t>(
      std::min<uint64_t>(nanoseconds, static_cast<uint64_t>(Nanoseconds::max().count()))));
}

bool has_magic(const SeekableFile& file, uint64_t offset) {
  std::array<std::byte, mcap::kMagic.size()> bytes;
  if (offset > file.size() || file.size() - offset < bytes.size()) {
    return false;
  }
  file.read(offset, bytes);
  return std::memcmp(bytes.data(), mcap::kMagic.data(), bytes.size()) == 0;
}

/// What a file holds, from its summary or from all of it.
struct Contents {
  std::map<uint16_t, mcap::Schema> schemas;
  std::map<uint16_t, mcap::Channel> channels;
  std::map<uint16_t, uint64_t> counts;
  std::optional<TimeSpan> span;
  std::set<std::string> compressions;
  std::vector<MessageBlock> blocks;  // their channels by id; empty where the index tells none
  bool indexed = false;
  std::string ros_distro;
  std::optional<InputError> damage;
  std::vector<DeclarationError> contradictions;
};

void widen(std::optional<TimeSpan>& span, const TimeSpan& by) {
  span = span ? TimeSpan{std::min(span->begin, by.begin), std::max(span->end, by.end)} : by;
}

/// The summary section: what the file declares.
struct Summary {
  Contents contents;  // without counts
  mcap::Statistics statistics;
  std::vector<mcap::ChunkIndex> chunks;
  uint64_t attachments = 0;  // in the index
};

/// What rosbag2's recorder wrote of itself; empty where the record tells nothing.
std::string read_ros_distro(const SeekableFile& file, const mcap::MetadataIndex& index) {
  constexpr uint64_t kLargest = 1U << 24U;
  if (index.length < mcap::kRecordHeader || index.length > kLargest || index.offset > file.size() ||
      index.length > file.size() - index.offset) {
    return {};
  }
  const std::vector<std::byte> bytes = file.read(index.offset, index.length);
  ByteReader record(file.path(), index.offset, bytes);
  if (record.number<uint8_t>("a metadata record") != static_cast<uint8_t>(mcap::Opcode::metadata)) {
    return {};
  }
  const auto length = record.number<uint64_t>("a metadata record");
  const mcap::Metadata metadata = mcap::read_metadata(record.part(length, "a metadata record"));
  const auto found = metadata.values.find("ROS_DISTRO");
  return found == metadata.values.end() ? std::string() : found->second;
}

void take(Contents& contents, mcap::Opcode opcode, const ByteReader& record) {
  if (opcode == mcap::Opcode::schema) {
    mcap::Schema schema = mcap::read_schema(record);
    contents.schemas[schema.id] = std::move(schema);
  } else if (opcode == mcap::Opcode::channel) {
    mcap::Channel channel = mcap::read_channel(record);
    contents.channels[channel.id] = std::move(channel);
  }
}

/// The summary section, where the file has one with statistics; nothing otherwise.
std::optional<Summary> read_summary(const SeekableFile& file) {
  constexpr uint64_t kTail = mcap::kRecordHeader + mcap::kFooterContent + mcap::kMagic.size();
  if (file.size() < mcap::kMagic.size() + kTail || !has_magic(file, file.size() - 8)) {
    return std::nullopt;
  }
  const uint64_t footer_at = file.size() - kTail;
  const std::vector<std::byte> tail =
      file.read(footer_at, mcap::kRecordHeader + mcap::kFooterContent);
  ByteReader reader(file.path(), footer_at, tail);
  const auto opcode = static_cast<mcap::Opcode>(reader.number<uint8_t>("the footer"));
  if (opcode != mcap::Opcode::footer ||
      reader.number<uint64_t>("the footer") != mcap::kFooterContent) {
    return std::nullopt;
  }
  const mcap::Footer footer = mcap::read_footer(reader);
  if (footer.summary_start < mcap::kMagic.size() || footer.summary_start >= footer_at) {
    return std::nullopt;
  }
  const std::vector<std::byte> bytes =
      file.read(footer.summary_start, footer_at - footer.summary_start);
  if (footer.summary_crc != 0) {
    const auto summed = std::span(tail).first(tail.size() - sizeof footer.summary_crc);
    if (crc32(summed, crc32(bytes)) != footer.summary_crc) {
      return std::nullopt;
    }
  }
  Summary summary;
  Contents& contents = summary.contents;
  contents.indexed = true;
  std::optional<mcap::Statistics> statistics;
  ByteReader records(file.path(), footer.summary_start, bytes);
  while (records.remaining() > 0) {
    const auto kind = static_cast<mcap::Opcode>(records.number<uint8_t>("a summary record"));
    const auto length = records.number<uint64_t>("a summary record");
    const ByteReader record = records.part(length, "a summary record");
    take(contents, kind, record);
    if (kind == mcap::Opcode::statistics) {
      statistics = mcap::read_statistics(record);
    } else if (kind == mcap::Opcode::chunk_index) {
      summary.chunks.push_back(mcap::read_chunk_index(record));
      const std::string& compression = summary.chunks.back().compression;
      contents.compressions.insert(compression.empty() ? "none" : compression);
    } else if (kind == mcap::Opcode::attachment_index) {
      ++summary.attachments;
    } else if (kind == mcap::Opcode::metadata_index) {
      const mcap::MetadataIndex index = mcap::read_metadata_index(record);
      if (index.name == "rosbag2") {
        contents.ros_distro = read_ros_distro(file, index);
      }
    }
  }
  if (!statistics) {
    return std::nullopt;
  }
  std::ranges::sort(summary.chunks, {}, &mcap::ChunkIndex::offset);
  summary.statistics = std::move(*statistics);
  return summary;
}

bool is_empty(const mcap::ChunkIndex& chunk) {
  return chunk.begin == 0 && chunk.end == 0 && chunk.channel_messages.empty();
}

/// The index of chunks tells of each how many messages of which channels it has.
bool counts_messages(const std::vector<mcap::ChunkIndex>& chunks) {
  return !chunks.empty() && std::ranges::all_of(chunks, [](const mcap::ChunkIndex& chunk) {
    return is_empty(chunk) || !chunk.channel_messages.empty();
  });
}

/// Fills in what the index of chunks tells.
void take_chunks(Contents& contents, const std::vector<mcap::ChunkIndex>& chunks) {
  for (const mcap::ChunkIndex& chunk : chunks) {
    MessageBlock block{chunk.offset, {to_time(chunk.begin), to_time(chunk.end)}, {}};
    for (const auto& [id, count] : chunk.channel_messages) {
      contents.counts[id] += count;
      if (count > 0) {
        block.channels.push_back(id);
      }
    }
    if (!block.channels.empty()) {
      widen(contents.span, block.received);
      contents.blocks.push_back(std::move(block));
    }
  }
}

uint64_t sum(const std::map<uint16_t, uint64_t>& counts) {
  uint64_t all = 0;
  for (const auto& [id, count] : counts) {
    all += count;
  }
  return all;
}

uint64_t count_of(const std::map<uint16_t, uint64_t>& counts, uint16_t id) {
  const auto found = counts.find(id);
  return found == counts.end() ? 0 : found->second;
}

/// Times that the statistics give and that are not those of the messages.
bool has_other_times(const mcap::Statistics& statistics, const std::optional<TimeSpan>& span) {
  constexpr Nanoseconds kRounding = std::chrono::milliseconds(1);
  const auto differ = [&](uint64_t told, Nanoseconds found) {
    return told != 0 &&
           (to_time(told) > found ? to_time(told) - found : found - to_time(told)) > kRounding;
  };
  return span && (differ(statistics.begin, span->begin) || differ(statistics.end, span->end));
}

/// The content as the summary tells it; nothing where it contradicts itself, or does not tell.
std::optional<Contents> told_contents(const Summary& summary) {
  const mcap::Statistics& statistics = summary.statistics;
  Contents contents = summary.contents;
  const bool counted = counts_messages(summary.chunks);
  if (counted) {
    take_chunks(contents, summary.chunks);
    if (sum(contents.counts) != statistics.messages || has_other_times(statistics, contents.span)) {
      return std::nullopt;
    }
  } else if (statistics.messages > 0) {
    contents.span = TimeSpan{to_time(statistics.begin), to_time(statistics.end)};
  }
  if (contents.channels.size() != statistics.channels ||
      (!summary.chunks.empty() && summary.chunks.size() != statistics.chunks)) {
    return std::nullopt;
  }
  if (statistics.channel_messages.empty()) {
    return counted || statistics.messages == 0 ? std::optional(std::move(contents)) : std::nullopt;
  }
  const bool same = std::ranges::all_of(contents.channels, [&](const auto& channel) {
    return !counted || count_of(contents.counts, channel.first) ==
                           count_of(statistics.channel_messages, channel.first);
  });
  if (!same || sum(statistics.channel_messages) != statistics.messages) {
    return std::nullopt;
  }
  contents.counts = statistics.channel_messages;
  return contents;
}

/// Where the summary differs from what is in the file.
std::vector<DeclarationError> contradictions(const fs::path& file, const Summary& summary,
                                             const Contents& there) {
  std::vector<DeclarationError> found;
  const mcap::Statistics& statistics = summary.statistics;
  const char* copy = "Copy the recording again from its source, or write it anew: adit convert";
  const auto differ = [&](const char* what, uint64_t declared, uint64_t listed) {
    found.emplace_back(file,
                       "its statistics declare " + std::to_string(declared) + " " + what +
                           ", but there are " + std::to_string(listed),
                       copy);
  };
  uint64_t told = 0;
  for (const auto& [id, channel] : there.channels) {
    const uint64_t declared = count_of(statistics.channel_messages, id);
    told += declared;
    if (!statistics.channel_messages.empty() && declared != count_of(there.counts, id)) {
      found.push_back(wrong_count(file, "the statistics record", channel.topic, declared,
                                  count_of(there.counts, id)));
    }
  }
  if (statistics.messages != sum(there.counts) && (found.empty() || told != statistics.messages)) {
    differ("messages in all", statistics.messages, sum(there.counts));
  }
  if (statistics.channels != there.channels.size()) {
    differ("topics", statistics.channels, there.channels.size());
  }
  if (!summary.chunks.empty() && summary.chunks.size() != statistics.chunks) {
    differ("chunks in the index", statistics.chunks, summary.chunks.size());
  }
  if (summary.attachments > 0 && summary.attachments != statistics.attachments) {
    differ("attachments in the index", statistics.attachments, summary.attachments);
  }
  if (has_other_times(statistics, there.span)) {
    found.emplace_back(file, "its statistics declare other times than its messages have", copy);
  }
  return found;
}

/// Reads everything once.
Contents scan(const SeekableFile& file) {
  Contents contents;
  mcap::Cursor cursor(file);
  BlockCollector blocks;
  while (true) {
    try {
      const std::optional<mcap::Record> record = cursor.next();
      if (!record) {
        break;
      }
      take(contents, record->opcode, record->content);
      if (record->opcode == mcap::Opcode::message) {
        ByteReader content = record->content;
        const mcap::MessageHeader message = mcap::read_message_header(content);
        const Nanoseconds time = to_time(message.log_time);
        ++contents.counts[message.channel];
        widen(contents.span, {time, time});
        blocks.add(message.channel, time, record->offset, record->in_chunk);
      }
    } catch (const InputError& error) {
      if (!contents.damage) {
        contents.damage = error;
      }
    }
  }
  contents.compressions = cursor.compressions();
  contents.blocks = std::move(blocks).take();
  return contents;
}

Contents read_contents(const SeekableFile& file) {
  std::optional<Summary> summary;
  try {
    summary = read_summary(file);
  } catch (const InputError&) {
    // a summary that cannot be read: the data tell the same
  }
  if (!summary) {
    return scan(file);
  }
  std::optional<Contents> told = told_contents(*summary);
  Contents contents = told ? std::move(*told) : scan(file);
  contents.indexed = true;
  contents.ros_distro = summary->contents.ros_distro;
  contents.contradictions = contradictions(file.path(), *summary, contents);
  return contents;
}

Encoding encoding_of(const mcap::Channel& channel) {
  if (channel.message_encoding == "cdr") {
    return Encoding::cdr;
  }
  return channel.message_encoding == "ros1" ? Encoding::ros1 : Encoding::other;
}

class McapStream final : public MessageStream {
 public:
  McapStream(const SeekableFile& file, const std::vector<adit::Channel>& all,
             std::map<uint16_t, std::size_t> channels, std::set<uint16_t> all_channels,
             std::set<uint64_t> skipped, const MessageSelection& selection)
      : cursor_(file, selection.begin, selection.end),
        path_(&file.path()),
        all_(&all),
        channels_(std::move(channels)),
        all_channels_(std::move(all_channels)),
        begin_(selection.begin),
        end_(selection.end) {
    if (selection.from > 0) {
      cursor_.start_at(selection.from);
    }
    cursor_.skip_chunks(std::move(skipped));
  }

  std::optional<RawMessage> next() override {
    while (std::optional<mcap::Record> record = cursor_.next()) {
      if (record->opcode != mcap::Opcode::message) {
        continue;
      }
      ByteReader& content = record->content;
      const mcap::MessageHeader message = mcap::read_message_header(content);
      const auto channel = channels_.find(message.channel);
      if (channel == channels_.end()) {
        if (!all_channels_.contains(message.channel)) {
          content.fail("a message of channel " + std::to_string(message.channel) +
                       ", which the file does not declare");
        }
        continue;
      }
      const Nanoseconds time = to_time(message.log_time);
      if (time >= begin_ && time <= end_) {
        const std::span<const std::byte> bytes = content.bytes(content.remaining(), "a message");
        const bool may_be_packed = (*all_)[channel->second].encoding == Encoding::cdr;
        return RawMessage{channel->second, time,
                          may_be_packed
                              ? unpacker_.unpack(bytes, *path_, Place::byte(record->offset).text())
                              : bytes,
                          record->offset};
      }
    }
    return std::nullopt;
  }

 private:
  mcap::Cursor cursor_;
  MessageUnpacker unpacker_;
  const fs::path* path_;
  const std::vector<adit::Channel>* all_;     // the file's channels
  std::map<uint16_t, std::size_t> channels_;  // those wanted
  std::set<uint16_t> all_channels_;
  Nanoseconds begin_;
  Nanoseconds end_;
};

class McapFile final : public MessageFile {
 public:
  explicit McapFile(const fs::path& path) : file_(path) {
    if (!has_magic(file_, 0)) {
      throw InputError(path, Place::byte(0), "it does not begin as an MCAP file does",
                       "Check that it is the right file");
    }
    Contents contents = read_contents(file_);
    for (const auto& [id, channel] : contents.channels) {
      const mcap::Schema& schema = contents.schemas[channel.schema];
      ids_.push_back(id);
      channels_.push_back({.topic = channel.topic,
                           .type = plain_type_name(schema.name),
                           .encoding = encoding_of(channel),
                           .definition = schema.data,
                           .messages = contents.counts[id],
                           .metadata = channel.metadata});
    }
    for (MessageBlock& block : contents.blocks) {
      for (std::size_t& channel : block.channels) {
        channel = static_cast<std::size_t>(std::ranges::find(ids_, channel) - ids_.begin());
      }
      std::erase(block.channels, ids_.size());  // of what the file does not declare
    }
    blocks_ = std::move(contents.blocks);
    contradictions_ = std::move(contents.contradictions);
    span_ = contents.span;
    damage_ = std::move(contents.damage);
    ros_distro_ = std::move(contents.ros_distro);
    format_ = "MCAP";
    for (const std::string& compression : contents.compressions) {
      format_ += compression == "none" ? "" : " " + compression;
    }
    format_ += contents.indexed ? "" : ", without an index";
  }

  const fs::path& path() const override { return file_.path(); }
  const std::vector<Channel>& channels() const override { return channels_; }
  std::optional<TimeSpan> span() const override { return span_; }
  std::string format() const override { return format_; }
  std::string ros_distro() const override { return ros_distro_; }
  const std::optional<InputError>& damage() const override { return damage_; }
  std::vector<DeclarationError> contradictions() const override { return contradictions_; }
  MessageLayout layout() const override { return layout_of(blocks_, channels_.size()); }

  std::unique_ptr<MessageStream> messages(const MessageSelection& selection) const override {
    std::map<uint16_t, std::size_t> wanted;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      if (selection.channels.empty() || std::ranges::count(selection.channels, i) > 0) {
        wanted[ids_[i]] = i;
      }
    }
    std::set<uint64_t> skipped;
    if (selection.by_index) {
      skipped = blocks_without(blocks_, selection.channels);
    }
    return std::make_unique<McapStream>(file_, channels_, std::move(wanted),
                                        std::set<uint16_t>(ids_.begin(), ids_.end()),
                                        std::move(skipped), selection);
  }

 private:
  SeekableFile file_;
  std::vector<uint16_t> ids_;  // ids of channels_, in their order
  std::vector<Channel> channels_;
  std::vector<MessageBlock> blocks_;
  std::optional<TimeSpan> span_;
  std::string format_;
  std::string ros_distro_;
  std::optional<InputError> damage_;
  std::vector<DeclarationError> contradictions_;
};

}  // namespace

bool is_mcap(const fs::path& file) {
  return has_magic(SeekableFile(file), 0);
}

std::unique_ptr<MessageFile> open_mcap(const fs::path& file) {
  return std::make_unique<McapFile>(file);
}

}  // namespace adit
