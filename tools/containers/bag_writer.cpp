// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/bag_writer.hpp"

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "adit/tools/containers/bag_records.hpp"
#include "adit/tools/containers/ros_definitions.hpp"

namespace adit {
namespace {

using bag::Opcode;

constexpr int64_t kSecond = 1'000'000'000;

void add_time(ByteWriter& writer, Nanoseconds time) {
  const int64_t count = std::max<int64_t>(time.count(), 0);
  writer.number(static_cast<uint32_t>(count / kSecond));
  writer.number(static_cast<uint32_t>(count % kSecond));
}

/// A record's header, field by field.
class Header {
 public:
  explicit Header(Opcode opcode) { number("op", static_cast<uint8_t>(opcode)); }

  template <class T>
  Header& number(std::string_view name, T value) {
    ByteWriter bytes;
    bytes.number(value);
    return field(name, bytes.content());
  }
  Header& time(std::string_view name, Nanoseconds value) {
    ByteWriter bytes;
    add_time(bytes, value);
    return field(name, bytes.content());
  }
  Header& text(std::string_view name, std::string_view value) {
    return field(name, std::as_bytes(std::span(value)));
  }

  /// The header's length, the header, the data's length, the data.
  ByteWriter record(std::span<const std::byte> data) const {
    ByteWriter record;
    record.number(static_cast<uint32_t>(fields_.size()));
    record.bytes(fields_.content());
    record.number(static_cast<uint32_t>(data.size()));
    record.bytes(data);
    return record;
  }
  std::span<const std::byte> fields() const { return fields_.content(); }

 private:
  Header& field(std::string_view name, std::span<const std::byte> value) {
    fields_.number(static_cast<uint32_t>(name.size() + 1 + value.size()));
    fields_.bytes(std::as_bytes(std::span(name)));
    fields_.number('=');
    fields_.bytes(value);
    return *this;
  }

  ByteWriter fields_;
};

/// The first record: padded, so that it can be written again once its numbers are known.
ByteWriter file_header(uint64_t index, std::size_t connections, std::size_t chunks) {
  Header header(Opcode::file_header);
  header.number("index_pos", index)
      .number("conn_count", static_cast<uint32_t>(connections))
      .number("chunk_count", static_cast<uint32_t>(chunks));
  const std::size_t used = 2 * sizeof(uint32_t) + header.fields().size();
  const std::string padding(bag::kFileHeader - used, ' ');
  return header.record(std::as_bytes(std::span(padding)));
}

std::string text_of(const ByteWriter& bytes) {
  return {reinterpret_cast<const char*>(bytes.content().data()), bytes.size()};
}

}  // namespace

BagWriter::BagWriter(const std::filesystem::path& path, const BagOptions& options)
    : file_(path), options_(options) {
  file_.write(bag::kMagic);
  offset_ = bag::kMagic.size();
  put(file_header(0, 0, 0));
}

void BagWriter::put(const ByteWriter& bytes) {
  file_.write(bytes.content().data(), bytes.size());
  offset_ += bytes.size();
}

std::size_t BagWriter::add_channel(const Channel& channel) {
  if (channel.encoding != Encoding::ros1) {
    throw std::logic_error("ROS 1 bag: " + channel.topic + " is not in ROS 1 serialisation");
  }
  const auto definition = ros::definition_of(channel.type, Encoding::ros1);
  const auto told = channel.metadata.find("md5sum");
  // "*" is how ROS 1 says that the sum is not known.
  const std::string md5 = definition                       ? definition->md5
                          : told != channel.metadata.end() ? told->second
                                                           : "*";
  ByteWriter data;
  const auto add = [&](std::string_view name, const std::string& value) {
    data.text(std::string(name) + "=" + value);
  };
  add("topic", channel.topic);
  add("type", channel.type);
  add("md5sum", md5);
  add("message_definition", channel.definition);
  for (const char* name : {"callerid", "latching"}) {
    if (const auto found = channel.metadata.find(name); found != channel.metadata.end()) {
      add(name, found->second);
    }
  }
  const auto id = static_cast<uint32_t>(connections_.size());
  connections_.push_back(text_of(Header(Opcode::connection)
                                     .number("conn", id)
                                     .text("topic", channel.topic)
                                     .record(data.content())));
  told_.push_back(false);
  return id;
}

void BagWriter::write(std::size_t channel, Nanoseconds received, std::span<const std::byte> bytes) {
  const auto id = static_cast<uint32_t>(channel);
  if (!told_.at(channel)) {
    chunk_.bytes(std::as_bytes(std::span(connections_[channel])));
    told_[channel] = true;
  }
  chunk_index_[id].emplace_back(received, static_cast<uint32_t>(chunk_.size()));
  const ByteWriter record =
      Header(Opcode::message).number("conn", id).time("time", received).record(bytes);
  chunk_.bytes(record.content());
  if (chunk_.size() >= options_.chunk_bytes) {
    close_chunk();
  }
}

void BagWriter::close_chunk() {
  if (chunk_index_.empty()) {
    return;
  }
  ChunkEntry entry{
      .offset = offset_, .begin = Nanoseconds::max(), .end = Nanoseconds::min(), .counts = {}};
  const std::vector<std::byte> packed = compress(options_.compression, chunk_.content());
  put(Header(Opcode::chunk)
          .text("compression", to_string(options_.compression))
          .number("size", static_cast<uint32_t>(chunk_.size()))
          .record(packed));
  for (const auto& [id, messages] : chunk_index_) {
    ByteWriter index;
    for (const auto& [time, at] : messages) {
      add_time(index, time);
      index.number(at);
      entry.begin = std::min(entry.begin, time);
      entry.end = std::max(entry.end, time);
    }
    const auto count = static_cast<uint32_t>(messages.size());
    entry.counts[id] = count;
    put(Header(Opcode::index)
            .number("ver", uint32_t{1})
            .number("conn", id)
            .number("count", count)
            .record(index.content()));
  }
  chunks_.push_back(std::move(entry));
  chunk_.clear();
  chunk_index_.clear();
}

void BagWriter::close() {
  close_chunk();
  const uint64_t index = offset_;
  for (const std::string& connection : connections_) {
    file_.write(connection);
  }
  for (const ChunkEntry& chunk : chunks_) {
    ByteWriter counts;
    for (const auto& [id, count] : chunk.counts) {
      counts.number(id);
      counts.number(count);
    }
    put(Header(Opcode::chunk_info)
            .number("ver", uint32_t{1})
            .number("chunk_pos", chunk.offset)
            .time("start_time", chunk.begin)
            .time("end_time", chunk.end)
            .number("count", static_cast<uint32_t>(chunk.counts.size()))
            .record(counts.content()));
  }
  const ByteWriter header = file_header(index, connections_.size(), chunks_.size());
  file_.overwrite(bag::kMagic.size(), text_of(header));
  file_.close();
}

}  // namespace adit
