// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <future>
#include <map>
#include <optional>
#include <stop_token>
#include <vector>

#include "adit/tools/foxglove/shown_messages.hpp"
#include "adit/tools/viewer/foxglove_feed.hpp"

namespace adit {

/// What `adit convert --as foxglove` writes of a run or a map, as it is when this is made: first
/// what holds all the time, then the rest in the order of its stamps. Submaps are read when they
/// are asked for, and the overview of all of them on a thread of its own: whoever asks waits for
/// it, and nobody else.
class FoxgloveRunFeed final : public FoxgloveFeed {
 public:
  /// Throws InputError: it is neither, or damaged.
  explicit FoxgloveRunFeed(const std::filesystem::path& what);
  ~FoxgloveRunFeed() override;
  FoxgloveRunFeed(const FoxgloveRunFeed&) = delete;
  FoxgloveRunFeed& operator=(const FoxgloveRunFeed&) = delete;

  const std::vector<FoxgloveChannel>& channels() const override { return channels_; }
  std::optional<uint64_t> next(std::size_t channel, uint64_t after) override;
  FoxgloveMessage message(std::size_t channel, uint64_t position) override;

 private:
  void add(const ShownTopic& topic, std::vector<uint64_t> positions);
  bool has_overview();

  ShownMessages messages_;
  std::vector<FoxgloveChannel> channels_;
  std::vector<std::vector<uint64_t>> positions_;  ///< of each channel's messages, ascending
  std::map<uint64_t, FoxgloveMessage> kept_;      ///< by position: the graph
  uint64_t overview_ = 0;                         ///< its position; 0: there is none
  uint64_t first_moment_ = 1;                     ///< position
  std::stop_source stop_;                         ///< of the overview's thread
  /// Once it was asked for. Reads messages_, so it is ended before them.
  std::shared_future<FoxgloveMessage> made_;
};

}  // namespace adit
