// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "adit/slam/core/types.hpp"
#include "adit/tools/containers/message_file.hpp"

namespace adit {

/// Writes a container of messages. Each member throws OutputError where the system refuses.
class MessageWriter {
 public:
  MessageWriter() = default;
  virtual ~MessageWriter() = default;
  MessageWriter(const MessageWriter&) = delete;
  MessageWriter& operator=(const MessageWriter&) = delete;

  /// Declares a channel and returns its index for write(). Throws std::logic_error for encodings
  /// that the container cannot hold.
  virtual std::size_t add_channel(const Channel& channel) = 0;

  /// Appends a message. Those of a recording come in the order of their time.
  virtual void write(std::size_t channel, Nanoseconds received,
                     std::span<const std::byte> bytes) = 0;

  /// Completes the file. Without it a recording is left as by a recorder that was killed.
  virtual void close() = 0;
};

}  // namespace adit
