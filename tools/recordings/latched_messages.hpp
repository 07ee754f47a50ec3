// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Messages that hold until the next one: who subscribes late gets them all the same, and so must
// who reads a recording from the middle on.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "adit/tools/containers/message_file.hpp"

namespace adit {

/// True for static transforms, calibrations of cameras, latched topics (ROS 1) and those whose
/// publisher offers the durability transient_local (ROS 2).
bool is_latched(const Channel& channel);

/// The messages that still hold after all that were added. Of static transforms that is the last
/// message with the same children, since several publishers share the topic; of other topics the
/// last one.
class LatchedMessages {
 public:
  struct Held {
    std::size_t file = 0;
    std::size_t channel = 0;  ///< index within the file
    uint64_t offset = 0;      ///< byte of the file
    std::vector<std::byte> bytes;
  };

  /// `message` is of the file number `file`, one of whose channels is_latched().
  void add(std::size_t file, const Channel& channel, const RawMessage& message);

  /// In the order in which they were added.
  std::vector<Held> held() const;

 private:
  uint64_t added_ = 0;
  std::map<std::pair<std::string, std::string>, std::pair<uint64_t, Held>>
      messages_;  // by topic and children
};

}  // namespace adit
