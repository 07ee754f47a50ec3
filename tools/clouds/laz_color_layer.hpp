// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Colours of LAZ chunks of formats 7, 8 and 10 on their way out of the file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "adit/tools/clouds/las_layout.hpp"
#include "adit/tools/clouds/laz_color.hpp"

namespace adit {

/// Colours of a chunk in one layer. Each scanner channel has models of its own, which begin with
/// the colour of the point before.
class ColorLayer {
 public:
  /// `first`: of the chunk's first point. An empty layer: all colours are the same.
  ColorLayer(std::span<const std::byte> layer, const LazColor& first, std::size_t channel)
      : last_(first) {
    if (!layer.empty()) {
      decoder_.emplace(layer);
    }
    channels_[channel].emplace(Channel{.last = first});
  }

  LazColor next(std::size_t channel) {
    if (!channels_[channel]) {
      channels_[channel].emplace(Channel{.last = last_});
    }
    Channel& here = *channels_[channel];
    if (decoder_) {
      here.last = here.codec.code(*decoder_, here.last, {});
    }
    return last_ = here.last;
  }
  bool is_overrun() const { return decoder_ && decoder_->is_overrun(); }

 private:
  struct Channel {
    LazColorCodec codec{};
    LazColor last{};
  };
  std::optional<ArithmeticDecoder> decoder_;
  std::array<std::optional<Channel>, 4> channels_;
  LazColor last_;
};

inline std::size_t scanner_channel(const char* point) {
  return (static_cast<uint8_t>(point[15]) >> 4U) & 3U;
}

/// `points` with the colours that follow their first 30 bytes; the first of them is `first`.
inline std::string with_colors(std::string_view points, std::string_view first, ColorLayer& layer) {
  std::string all;
  all.reserve(points.size() / kLas6Bytes * (kLas6Bytes + kLasColorBytes));
  all.append(first.substr(0, kLas6Bytes + kLasColorBytes));
  for (std::size_t at = kLas6Bytes; at < points.size(); at += kLas6Bytes) {
    all.append(points.substr(at, kLas6Bytes));
    const LazColor color = layer.next(scanner_channel(points.data() + at));
    all.append(reinterpret_cast<const char*>(color.data()), color.size());
  }
  return all;
}

}  // namespace adit
