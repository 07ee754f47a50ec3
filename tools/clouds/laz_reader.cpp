// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/laz_reader.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <new>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/clouds/arithmetic_coder.hpp"
#include "adit/tools/clouds/laz_chunk.hpp"
#include "adit/tools/clouds/laz_format.hpp"
#include "adit/tools/clouds/laz_pointwise.hpp"
#include "adit/tools/support/parallel.hpp"

namespace adit {
namespace {

// Of files that were written in one go: where the table is, they say at their end.
constexpr uint64_t kTableAtTheEnd = ~uint64_t{0};
constexpr std::size_t kRecordHeader = 54;
// The coder spends 1 / 1100 byte on a point at least, of points that all are alike: its models
// leave so much for other symbols. What promises more is damaged, or is to fill the memory.
constexpr uint64_t kMostPointsPerByte = 2048;

template <class T>
std::optional<T> load_within(std::span<const std::byte> bytes, uint64_t at) {
  if (at > bytes.size() || bytes.size() - at < sizeof(T)) {
    return std::nullopt;
  }
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

struct LazFormat {
  uint16_t compressor = 0;
  uint32_t chunk_points = 0;
  std::vector<LazItem> items{};
};

/// The content of the record that says how points are packed.
std::optional<std::span<const std::byte>> laz_record_of(std::span<const std::byte> records) {
  while (records.size() >= kRecordHeader) {
    const std::size_t size = load_within<uint16_t>(records, 20).value_or(0);
    if (records.size() - kRecordHeader < size) {
      return std::nullopt;
    }
    const std::string_view user(reinterpret_cast<const char*>(records.data()) + 2, 16);
    if (user.starts_with(kLazUser) && load_within<uint16_t>(records, 18) == kLazRecord) {
      return records.subspan(kRecordHeader, size);
    }
    records = records.subspan(kRecordHeader + size);
  }
  return std::nullopt;
}

std::optional<LazFormat> laz_format_of(std::span<const std::byte> records) {
  const auto content = laz_record_of(records);
  constexpr std::size_t kItems = 34;
  if (!content || content->size() < kItems) {
    return std::nullopt;
  }
  LazFormat format{.compressor = *load_within<uint16_t>(*content, 0),
                   .chunk_points = *load_within<uint32_t>(*content, 12)};
  const std::size_t items = *load_within<uint16_t>(*content, 32);
  for (std::size_t i = 0; i < items && kItems + 6 * (i + 1) <= content->size(); ++i) {
    const std::size_t at = kItems + 6 * i;
    format.items.push_back({.kind = static_cast<LazItemKind>(*load_within<uint16_t>(*content, at)),
                            .bytes = *load_within<uint16_t>(*content, at + 2),
                            .version = *load_within<uint16_t>(*content, at + 4)});
  }
  return format.items.size() == items ? std::make_optional(format) : std::nullopt;
}

/// Layers of an item of LAS 1.4.
std::size_t layers_of(const LazItem& item) {
  switch (item.kind) {
    case LazItemKind::point14:
      return 9;
    case LazItemKind::color14:
    case LazItemKind::wave14:
      return 1;
    case LazItemKind::color_nir14:
      return 2;
    default:
      return item.bytes;  // extra bytes: one each
  }
}

/// The items of a point format; extra bytes may follow.
std::vector<LazItem> items_of(std::size_t format) {
  constexpr LazItem kPoint10{LazItemKind::point10, 20, 2};
  constexpr LazItem kTime{LazItemKind::time11, 8, 2};
  constexpr LazItem kColor{LazItemKind::color12, 6, 2};
  constexpr LazItem kPoint14{LazItemKind::point14, kLas6Bytes, 3};
  constexpr LazItem kColor14{LazItemKind::color14, 6, 3};
  constexpr LazItem kColorNir{LazItemKind::color_nir14, 8, 3};
  constexpr LazItem kWave{LazItemKind::wave14, 29, 3};
  const std::array<std::vector<LazItem>, 11> items = {{{kPoint10},
                                                       {kPoint10, kTime},
                                                       {kPoint10, kColor},
                                                       {kPoint10, kTime, kColor},
                                                       {},
                                                       {},
                                                       {kPoint14},
                                                       {kPoint14, kColor14},
                                                       {kPoint14, kColorNir},
                                                       {kPoint14, kWave},
                                                       {kPoint14, kColorNir, kWave}}};
  return items.at(format);
}

/// How the chunks of a file are packed; version 4 of an item differs in what is not read.
struct LazLayout {
  bool layered = false;
  LazChunkLayout layers{};
  PointwiseLayout pointwise{};
};

std::optional<LazLayout> layout_of(const LazFormat& format, const LazSource& source) {
  const std::vector<LazItem> items = items_of(source.format);
  const bool layered = format.compressor == kLayeredChunks;
  if (items.empty() || layered != (items.front().kind == LazItemKind::point14) ||
      (!layered && format.compressor != kPointwiseChunks) || format.items.size() < items.size() ||
      format.items.size() > items.size() + 1) {
    return std::nullopt;
  }
  LazLayout layout{.layered = layered, .layers = {.point_bytes = source.point_bytes, .layers = 0}};
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < format.items.size(); ++i) {
    const LazItem& item = format.items[i];
    const bool is_extra = i == items.size();
    const bool same = is_extra ? item.kind == (layered ? LazItemKind::bytes14 : LazItemKind::bytes)
                               : item.kind == items[i].kind && item.bytes == items[i].bytes;
    if (!same || (item.version != (layered ? 3 : 2) && !(layered && item.version == 4))) {
      return std::nullopt;
    }
    bytes += item.bytes;
    layout.layers.layers += layers_of(item);
    layout.layers.colored = layout.layers.colored || item.kind == LazItemKind::color14 ||
                            item.kind == LazItemKind::color_nir14;
    layout.pointwise.has_time = layout.pointwise.has_time || item.kind == LazItemKind::time11;
    layout.pointwise.has_color = layout.pointwise.has_color || item.kind == LazItemKind::color12;
    layout.pointwise.extra_bytes = is_extra ? item.bytes : 0;
  }
  return bytes == source.point_bytes ? std::make_optional(layout) : std::nullopt;
}

/// Where chunks are that say their sizes themselves, as far as they are whole.
std::vector<LazChunk> layered_chunks(std::span<const std::byte> file, const LazSource& source,
                                     const LazChunkLayout& layout) {
  std::vector<LazChunk> chunks;
  uint64_t found = 0;
  for (uint64_t at = source.begin + sizeof(uint64_t); found < source.points;) {
    const uint64_t sizes = at + layout.point_bytes + sizeof(uint32_t);
    const auto points = load_within<uint32_t>(file, at + layout.point_bytes);
    uint64_t end = sizes + layout.layers * sizeof(uint32_t);
    for (std::size_t layer = 0; layer < layout.layers; ++layer) {
      end += load_within<uint32_t>(file, sizes + layer * sizeof(uint32_t)).value_or(0);
    }
    if (!points || *points == 0 || *points > source.points - found || end > file.size() ||
        *points > kMostPointsPerByte * (end - at)) {
      break;
    }
    chunks.push_back({.begin = at, .bytes = end - at, .points = *points});
    found += *points;
    at = end;
  }
  return chunks;
}

/// Where chunks are by the table, as far as they are whole.
std::vector<LazChunk> chunks_of_table(std::span<const std::byte> file, const LazSource& source,
                                      uint32_t chunk_points) {
  uint64_t table = load_within<uint64_t>(file, source.begin).value_or(0);
  if (table == kTableAtTheEnd && file.size() > sizeof(table)) {
    table = *load_within<uint64_t>(file, file.size() - sizeof(table));
  }
  const auto count = load_within<uint32_t>(file, table + 4);
  if (table < source.begin + sizeof(uint64_t) || table > file.size() || !count) {
    return {};
  }
  ArithmeticDecoder decoder(file.subspan(std::min<uint64_t>(table + 8, file.size())));
  IntegerModel model(32, 2);
  std::vector<LazChunk> chunks;
  LazChunk chunk{.begin = source.begin + sizeof(uint64_t)};
  uint64_t found = 0;
  for (uint32_t i = 0; i < *count && found < source.points && !decoder.is_overrun(); ++i) {
    if (chunk_points == kLazAnyPoints) {
      chunk.points =
          static_cast<uint32_t>(model.code(decoder, static_cast<int32_t>(chunk.points), 0, 0));
    } else {
      chunk.points = std::min<uint64_t>(chunk_points, source.points - found);
    }
    chunk.bytes =
        static_cast<uint32_t>(model.code(decoder, static_cast<int32_t>(chunk.bytes), 0, 1));
    if (chunk.points == 0 || chunk.points > source.points - found || chunk.bytes > table ||
        chunk.begin + chunk.bytes > table || chunk.points > kMostPointsPerByte * chunk.bytes) {
      break;
    }
    chunks.push_back(chunk);
    chunk.begin += chunk.bytes;
    found += chunk.points;
  }
  return chunks;
}

using Unpack = std::function<UnpackedChunk(const LazChunk&)>;

/// Some chunks at the same time. One that the memory has no room for is not whole.
std::vector<UnpackedChunk> unpack_some(std::span<const LazChunk> chunks, const Unpack& unpack) {
  std::vector<UnpackedChunk> parts(chunks.size());
  in_parallel(parts.size(), 1, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      try {
        parts[i] = unpack(chunks[i]);
      } catch (const std::bad_alloc&) {
        parts[i] = {};
      }
    }
  });
  return parts;
}

/// The points of all chunks up to the first that is damaged, `point_bytes` each.
LazPoints unpack_chunks(const std::vector<LazChunk>& chunks, uint64_t promised,
                        std::size_t point_bytes, const Unpack& unpack) {
  LazPoints unpacked{.point_bytes = point_bytes};
  const std::size_t together = 8 * parallel_pieces();
  bool whole = true;
  for (std::size_t begin = 0; begin < chunks.size() && whole; begin += together) {
    const std::size_t some = std::min(together, chunks.size() - begin);
    for (const UnpackedChunk& part : unpack_some(std::span(chunks).subspan(begin, some), unpack)) {
      if (whole = whole && part.is_whole; whole) {
        unpacked.bytes += part.points;
      }
    }
  }
  const uint64_t there = unpacked.bytes.size() / point_bytes;
  if (there != promised) {
    unpacked.fault = fmt::format("the header promises {} packed points; {} can be unpacked{}",
                                 promised, there, there > 0 ? ", which are read" : "");
  }
  return unpacked;
}

}  // namespace

LazPoints unpack_laz(std::span<const std::byte> file, const LazSource& source) {
  const std::optional<LazFormat> format = laz_format_of(source.records);
  if (!format) {
    return {.fault = "its points are packed, and no whole record says how"};
  }
  const std::optional<LazLayout> layout = layout_of(*format, source);
  if (!layout) {
    return {.fault =
                "its points are packed in a way that is not known: by LASzip 1, with the "
                "waveforms of formats 4 and 5, or not as their format has them"};
  }
  const auto bytes_of = [&](const LazChunk& chunk) {
    return file.subspan(chunk.begin, chunk.bytes);
  };
  if (layout->layered) {
    return unpack_chunks(layered_chunks(file, source, layout->layers), source.points,
                         layout->layers.unpacked_bytes(), [&](const LazChunk& chunk) {
                           return unpack_laz_chunk(bytes_of(chunk), chunk.points, layout->layers);
                         });
  }
  return unpack_chunks(chunks_of_table(file, source, format->chunk_points), source.points,
                       source.point_bytes, [&](const LazChunk& chunk) {
                         return unpack_pointwise_chunk(bytes_of(chunk), chunk.points,
                                                       layout->pointwise);
                       });
}

}  // namespace adit
