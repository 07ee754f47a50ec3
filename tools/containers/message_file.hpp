// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Containers of messages (MCAP, ROS bags): which channels they have, and the messages one after the
// other. What a message means is known to ros_events.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/containers/declaration_error.hpp"
#include "adit/tools/containers/time_span.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

/// How the bytes of a message are laid out.
enum class Encoding {
  ros1,  ///< ROS 1 serialisation: little-endian, packed
  cdr,   ///< ROS 2: CDR with its 4-byte encapsulation header
  other,
};
std::string_view to_string(Encoding encoding);

/// A named series of messages of one type.
struct Channel {
  std::string topic;
  std::string type;  ///< "sensor_msgs/Imu": package and name, the same for ROS 1 and ROS 2
  Encoding encoding = Encoding::other;
  std::string definition;            ///< text of the type as the container has it; may be empty
  std::optional<uint64_t> messages;  ///< how many the container says there are
  std::map<std::string, std::string> metadata{};  ///< e.g. "offered_qos_profiles"
};

/// "sensor_msgs/msg/Imu" and "sensor_msgs/Imu" to the latter.
std::string plain_type_name(std::string_view name);

/// "sensor_msgs/Imu" as ROS 2 writes it: "sensor_msgs/msg/Imu".
std::string ros2_type_name(std::string_view type);

struct RawMessage {
  std::size_t channel = 0;           ///< index into MessageFile::channels()
  Nanoseconds received{0};           ///< when the recorder took it
  std::span<const std::byte> bytes;  ///< valid until the next call of MessageStream::next()
  uint64_t offset = 0;               ///< byte of the file where it, or the chunk around it, begins
};

struct MessageSelection {
  std::vector<std::size_t> channels{};     ///< indices; empty: all
  Nanoseconds begin = Nanoseconds::min();  ///< earliest `received`, inclusive
  Nanoseconds end = Nanoseconds::max();    ///< latest `received`, inclusive
  uint64_t from = 0;                       ///< RawMessage::offset to start at; 0: the first message
  bool by_index = false;  ///< pass over chunks that have none of the channels, by the index
};

/// A stretch of a file without messages of a channel.
struct ChannelPause {
  Nanoseconds length{0};  ///< from receipt to receipt, as far as the index tells
  uint64_t before = 0;    ///< RawMessage::offset of the message before it, or of its chunk
  uint64_t after = 0;     ///< likewise
};

/// Messages that are received long before others that precede them in the file.
struct LateBlock {
  uint64_t offset = 0;             ///< RawMessage::offset of the first one, or of its chunk
  Nanoseconds received_before{0};  ///< when those that precede it were
};

/// Where the messages of a channel are in a file.
struct ChannelLayout {
  std::optional<TimeSpan> received{};  ///< covers all of them; none: there are no messages
  uint64_t last = 0;                   ///< RawMessage::offset of the last one, or of its chunk
  ChannelPause pause{};                ///< the longest
};

/// How the channels of a file are interleaved.
struct MessageLayout {
  std::vector<ChannelLayout> channels{};  ///< by channel; empty: the index does not tell
  /// Messages are received long before others that precede them in the file, and each channel is in
  /// the order of receipt, as far as the index tells.
  bool grouped = false;
  std::vector<LateBlock> late{};  ///< where: the first few
};

class MessageStream {
 public:
  MessageStream() = default;
  virtual ~MessageStream() = default;
  MessageStream(const MessageStream&) = delete;
  MessageStream& operator=(const MessageStream&) = delete;

  /// The next message in the order of the file, nothing at its end. Throws InputError at a damaged
  /// place; the call after that goes on behind it, if there is a way to.
  virtual std::optional<RawMessage> next() = 0;
};

class MessageFile {
 public:
  MessageFile() = default;
  virtual ~MessageFile() = default;
  MessageFile(const MessageFile&) = delete;
  MessageFile& operator=(const MessageFile&) = delete;

  virtual const std::filesystem::path& path() const = 0;
  virtual const std::vector<Channel>& channels() const = 0;
  /// Span of `received` over all messages; nothing where there are none.
  virtual std::optional<TimeSpan> span() const = 0;
  /// For people: "MCAP (zstd)".
  virtual std::string format() const = 0;
  /// The ROS distribution that it was recorded with; empty where it does not tell.
  virtual std::string ros_distro() const { return {}; }
  /// What opening found wrong, if anything; messages() gives what can be read all the same.
  virtual const std::optional<InputError>& damage() const = 0;
  /// Where the file does not hold what it declares, as far as opening can tell.
  virtual std::vector<DeclarationError> contradictions() const { return {}; }
  virtual MessageLayout layout() const { return {}; }
  /// Reads from the beginning. The file must outlive the stream; several streams may be open.
  virtual std::unique_ptr<MessageStream> messages(const MessageSelection& selection) const = 0;
};

/// Where the file does not hold what it declares, once it was read: `counts` are of the messages
/// by channel; none: the channel was not read.
std::vector<DeclarationError> contradictions_of(const MessageFile& file,
                                                const std::vector<std::optional<uint64_t>>& counts);

}  // namespace adit
