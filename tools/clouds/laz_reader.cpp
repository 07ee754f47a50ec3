// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/laz_reader.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
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

constexpr std::size_t kRecordHeader = 54;
// A return differs from the one before it in time or place, which needs bits: files of more points
// a byte hold no measurements, and would fill the memory of whoever reads them.
constexpr uint64_t kMostPointsPerByte = 64;

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

/// Formats 0 to 3 as LASzip 2 packs them.
std::optional<PointwiseLayout> pointwise_layout_of(const LazFormat& format) {
  PointwiseLayout layout;
  for (std::size_t i = 0; i < format.items.size(); ++i) {
    const LazItem& item = format.items[i];
    const bool is_known = item.version == 2 && (item.kind == LazItemKind::point10) == (i == 0);
    if (!is_known || (item.kind != LazItemKind::point10 && item.kind != LazItemKind::time11 &&
                      item.kind != LazItemKind::color12 && item.kind != LazItemKind::bytes)) {
      return std::nullopt;
    }
    layout.has_time = layout.has_time || item.kind == LazItemKind::time11;
    layout.has_color = layout.has_color || item.kind == LazItemKind::color12;
    layout.extra_bytes += item.kind == LazItemKind::bytes ? item.bytes : 0;
  }
  return layout;
}

/// Layers of an item of LAS 1.4; 0: it is none.
std::size_t layers_of(const LazItem& item) {
  switch (item.kind) {
    case LazItemKind::point14:
      return 9;
    case LazItemKind::color14:
    case LazItemKind::wave14:
      return 1;
    case LazItemKind::color_nir14:
      return 2;
    case LazItemKind::bytes14:
      return item.bytes;
    default:
      return 0;
  }
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
  const uint64_t table = load_within<uint64_t>(file, source.begin).value_or(0);
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

/// The points of all chunks up to the first that is damaged.
LazPoints unpack_chunks(const std::vector<LazChunk>& chunks, const LazSource& source,
                        const Unpack& unpack) {
  LazPoints unpacked;
  const std::size_t together = parallel_pieces();
  bool whole = true;
  for (std::size_t begin = 0; begin < chunks.size() && whole; begin += together) {
    std::vector<UnpackedChunk> parts(std::min(together, chunks.size() - begin));
    in_parallel(parts.size(), 1, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        parts[i] = unpack(chunks[begin + i]);
      }
    });
    for (UnpackedChunk& part : parts) {
      if (whole = whole && part.is_whole; whole) {
        unpacked.bytes += part.points;
      }
    }
  }
  const uint64_t there = unpacked.bytes.size() / source.point_bytes;
  if (there != source.points) {
    unpacked.fault = fmt::format("the header promises {} packed points; {} can be unpacked{}",
                                 source.points, there, there > 0 ? ", which are read" : "");
  }
  return unpacked;
}

}  // namespace

LazPoints unpack_laz(std::span<const std::byte> file, const LazSource& source) {
  const std::optional<LazFormat> format = laz_format_of(source.records);
  if (!format) {
    return {.fault = "its points are packed, and no whole record says how"};
  }
  std::size_t bytes = 0;
  for (const LazItem& item : format->items) {
    bytes += item.bytes;
  }
  if (bytes != source.point_bytes) {
    return {.fault = fmt::format("its packed points have {} bytes, the header says {}", bytes,
                                 source.point_bytes)};
  }
  const auto unpack_each = [&](const std::vector<LazChunk>& chunks, const auto& unpack) {
    return unpack_chunks(chunks, source, [&](const LazChunk& chunk) {
      return unpack(file.subspan(chunk.begin, chunk.bytes), chunk.points);
    });
  };
  if (format->compressor == kLayeredChunks && format->items.front().kind == LazItemKind::point14) {
    LazChunkLayout layout{.point_bytes = source.point_bytes, .layers = 0};
    for (const LazItem& item : format->items) {
      layout.layers += layers_of(item);
    }
    return unpack_each(layered_chunks(file, source, layout),
                       [&](std::span<const std::byte> chunk, uint64_t points) {
                         return unpack_laz_chunk(chunk, points, layout);
                       });
  }
  const std::optional<PointwiseLayout> layout = pointwise_layout_of(*format);
  if (format->compressor == kPointwiseChunks && layout) {
    return unpack_each(chunks_of_table(file, source, format->chunk_points),
                       [&](std::span<const std::byte> chunk, uint64_t points) {
                         return unpack_pointwise_chunk(chunk, points, *layout);
                       });
  }
  return {.fault =
              "its points are packed in a way that is not known: by LASzip 1, or with "
              "waveforms"};
}

}  // namespace adit
