// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "adit/tools/viewer/cloud_tiles.hpp"
#include "adit/tools/viewer/foxglove_feed.hpp"

namespace adit {

/// The points of as many levels of tiles as are no more than `most` together, and those of the
/// first level: x, y and z in the cube's frame, intensity from 0 to 255. Throws OutputError.
std::vector<Point> points_of_tiles(const CloudTiles& tiles, std::size_t most);

/// A cloud without a trajectory: /map/points alone, at time 0.
class FoxgloveCloudFeed final : public FoxgloveFeed {
 public:
  /// Throws OutputError: the temporary file of the tiles cannot be read.
  explicit FoxgloveCloudFeed(const CloudTiles& tiles);

  const std::vector<FoxgloveChannel>& channels() const override { return channels_; }
  std::optional<uint64_t> next(std::size_t channel, uint64_t after) override;
  FoxgloveMessage message(std::size_t channel, uint64_t position) override;

 private:
  std::vector<FoxgloveChannel> channels_;
  FoxgloveMessage message_;
};

}  // namespace adit
