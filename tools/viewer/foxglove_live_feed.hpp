// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "adit/tools/viewer/foxglove_feed.hpp"
#include "adit/tools/viewer/live_scene.hpp"

namespace adit {

/// A run that goes on. Positions are the scene's versions: who is slow misses sweeps, and gets the
/// newest of what is drawn as a whole.
class FoxgloveLiveFeed final : public FoxgloveFeed {
 public:
  /// `scene` must outlive it.
  explicit FoxgloveLiveFeed(const LiveScene& scene);

  const std::vector<FoxgloveChannel>& channels() const override { return channels_; }
  std::optional<uint64_t> next(std::size_t channel, uint64_t after) override;
  FoxgloveMessage message(std::size_t channel, uint64_t position) override;

 private:
  FoxgloveMessage map_points(uint64_t position);

  const LiveScene* scene_;
  std::vector<FoxgloveChannel> channels_;
  FoxgloveMessage map_points_;  ///< the newest, made once for all clients
  uint64_t map_position_ = 0;   ///< its position; 0: there is none
};

}  // namespace adit
