// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "adit/tools/foxglove/shown_messages.hpp"
#include "adit/tools/viewer/foxglove_feed.hpp"

namespace adit {

/// What `adit convert --as foxglove` writes of a run or a map, as it is when this is made: first
/// what holds all the time, then the rest in the order of its stamps. Submaps are read when they
/// are asked for.
class FoxgloveRunFeed final : public FoxgloveFeed {
 public:
  /// Throws InputError: it is neither, or damaged.
  explicit FoxgloveRunFeed(const std::filesystem::path& what);

  const std::vector<FoxgloveChannel>& channels() const override { return channels_; }
  std::optional<uint64_t> next(std::size_t channel, uint64_t after) override;
  FoxgloveMessage message(std::size_t channel, uint64_t position) override;

 private:
  void add(const ShownTopic& topic, std::vector<uint64_t> positions);

  ShownMessages messages_;
  std::vector<FoxgloveChannel> channels_;
  std::vector<std::vector<uint64_t>> positions_;  ///< of each channel's messages, ascending
  std::map<uint64_t, FoxgloveMessage> kept_;      ///< by position: the graph and the overview
  uint64_t overview_ = 0;                         ///< its position; 0: there is none
  uint64_t first_moment_ = 1;                     ///< position
};

}  // namespace adit
