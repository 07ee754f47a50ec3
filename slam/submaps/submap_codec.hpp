// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A keyframe's submap as the chunks that a MapStore keeps: the first has its sweeps, the second its
// points, number by number and byte by byte apart, so that they compress well; the third, where
// there is one, what the place looks like. Each ends with a checksum: what a disk spoils within
// packed bytes need not show otherwise.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "adit/slam/submaps/keyframe_submap.hpp"
#include "adit/slam/submaps/map_submap.hpp"
#include "adit/slam/submaps/place_descriptor.hpp"

namespace adit {

/// Which chunk has the sweeps, and which the descriptor.
inline constexpr std::size_t kSweepChunk = 0;
inline constexpr std::size_t kPlaceChunk = 2;  ///< number of the chunk with the place's descriptor

/// Chunks that are no submap. what() says what is wrong, for people.
class SubmapDamaged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// With the box around the points.
MapSubmap encode(const KeyframeSubmap& submap,
                 const std::optional<PlaceDescriptor>& descriptor = std::nullopt);
/// The same submap, bit by bit. Throws SubmapDamaged.
KeyframeSubmap decode(const MapSubmap& stored);
/// A submap without its points, from the first chunk alone. Throws SubmapDamaged.
KeyframeSubmap decode_sweeps(std::span<const std::byte> chunk);
/// What the submap looks like; nothing where that was not stored, or by a version that means
/// something else: PlaceIndex describes it anew. Throws SubmapDamaged.
std::optional<PlaceDescriptor> decode_descriptor(const MapSubmap& stored);

}  // namespace adit
