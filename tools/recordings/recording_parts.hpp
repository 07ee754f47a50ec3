// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The files of a recording of messages, and their messages in the order of time.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "adit/tools/clouds/depth_camera.hpp"
#include "adit/tools/containers/message_file.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// A file of a recording, and the topic of each of its channels.
struct RecordingPart {
  std::unique_ptr<MessageFile> file;
  std::vector<std::size_t> topics;
  std::vector<std::unique_ptr<DepthCamera>> cameras;  ///< by channel; null where it has no depths
};

/// In which order messages are given.
enum class MessageOrder {
  files,     ///< that of the files and of the messages in them: in order of time as it is
  received,  ///< topics apart, put together by their times of receipt
  /// Topics apart, put together by the stamps in their messages, which then are the times of
  /// receipt, too: those that were recorded are of a program that copied topic by topic.
  stamps,
};

struct MessageTimes {
  MessageOrder order = MessageOrder::files;
  std::optional<Nanoseconds> begin{};  ///< earliest stamp, of MessageOrder::stamps
};

/// The order that puts the measurements of the recording into that of their times. Recordings whose
/// topics are interleaved stay as they are. Decided by the index; where there is none, or where it
/// shows the topics one behind the other, by messages. `topics` are of the parts.
MessageTimes times_of(const std::vector<RecordingPart>& parts, const std::vector<Topic>& topics);

/// What to read of a recording.
struct PartSelection {
  std::vector<bool> wanted;  ///< by topic
  TimeSpan received{Nanoseconds::min(), Nanoseconds::max()};
  MessageTimes times{};

  bool whole() const {
    return received.begin == Nanoseconds::min() && received.end == Nanoseconds::max();
  }
};

struct PartMessage {
  const RecordingPart* part = nullptr;
  RawMessage message;
};

class PartStream {
 public:
  PartStream() = default;
  virtual ~PartStream() = default;
  PartStream(const PartStream&) = delete;
  PartStream& operator=(const PartStream&) = delete;

  /// As MessageStream::next(). Where all times are read, also throws DeclarationError where a file
  /// does not hold what it declares, once it was read.
  virtual std::optional<PartMessage> next() = 0;
};

/// Memory does not grow with the recording. `parts` must outlive the stream.
std::unique_ptr<PartStream> read_parts(const std::vector<RecordingPart>& parts,
                                       const std::vector<Topic>& topics, PartSelection selection);

}  // namespace adit
