// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// TIFF 6.0 with tiles and Adobe deflate, and GeoTIFF 1.1 (OGC 19-008).
#include "adit/tools/drawing/geotiff_writer.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <new>
#include <string_view>
#include <vector>

#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/raw_bytes.hpp"

namespace adit {
namespace {

constexpr uint16_t kAscii = 2;
constexpr uint16_t kShort = 3;
constexpr uint16_t kLong = 4;
constexpr uint16_t kDouble = 12;
constexpr uint16_t kUserDefined = 32767;

struct Field {
  uint16_t tag = 0;
  uint16_t type = 0;
  uint32_t count = 0;
  std::string bytes;
};

template <class T>
Field field(uint16_t tag, uint16_t type, std::initializer_list<T> values) {
  Field made{.tag = tag, .type = type, .count = static_cast<uint32_t>(values.size()), .bytes = {}};
  for (const T value : values) {
    append_raw(made.bytes, value);
  }
  return made;
}
Field number_field(uint16_t tag, uint16_t value) {
  return field<uint16_t>(tag, kShort, {value});
}
Field text_field(uint16_t tag, const std::string& value) {
  return {.tag = tag,
          .type = kAscii,
          .count = static_cast<uint32_t>(value.size() + 1),
          .bytes = value + std::string(1, '\0')};
}

/// The same number for each band.
Field band_field(uint16_t tag, uint16_t value, std::size_t bands) {
  Field made{.tag = tag, .type = kShort, .count = static_cast<uint32_t>(bands), .bytes = {}};
  for (std::size_t i = 0; i < bands; ++i) {
    append_raw(made.bytes, value);
  }
  return made;
}

/// Names and units of bands as GDAL keeps them.
std::string metadata_of(const std::vector<RasterBand>& bands) {
  std::string text = "<GDALMetadata>\n";
  const auto item = [&](std::size_t band, const char* name, const char* role,
                        const std::string& value) {
    text += std::string("  <Item name=\"") + name + "\" sample=\"" + std::to_string(band) +
            "\" role=\"" + role + "\">" + value + "</Item>\n";
  };
  for (std::size_t i = 0; i < bands.size(); ++i) {
    item(i, "DESCRIPTION", "description", bands[i].name);
    item(i, "UNITTYPE", "unittype", bands[i].unit);
  }
  return text + "</GDALMetadata>\n";
}

std::string deflated(std::span<const std::byte> bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()),
                Z_DEFAULT_COMPRESSION) != Z_OK) {
    throw std::bad_alloc();
  }
  packed.resize(size);
  return packed;
}

/// The GeoTIFF keys: which system of coordinates it is.
std::vector<Field> keys_of(const GeoTiffHeading& heading) {
  std::string directory;
  std::string doubles;
  std::string citation;
  uint16_t count = 0;
  uint16_t double_count = 0;
  const auto key = [&](uint16_t id, uint16_t value) {
    for (const uint16_t part : {id, uint16_t{0}, uint16_t{1}, value}) {
      append_raw(directory, part);
    }
    ++count;
  };
  const auto double_key = [&](uint16_t id, double value) {
    for (const uint16_t part : {id, uint16_t{34736}, uint16_t{1}, double_count}) {
      append_raw(directory, part);
    }
    append_raw(doubles, value);
    ++double_count;
    ++count;
  };
  key(1024, heading.epsg || heading.projection ? 1 : kUserDefined);  // projected
  key(1025, 1);                                                      // a cell is an area
  if (!heading.coordinates.empty()) {
    citation = heading.coordinates + "|";
    for (const uint16_t part :
         {uint16_t{1026}, uint16_t{34737}, static_cast<uint16_t>(citation.size()), uint16_t{0}}) {
      append_raw(directory, part);
    }
    ++count;
  }
  if (heading.epsg) {
    key(3072, static_cast<uint16_t>(*heading.epsg));
  } else if (heading.projection) {
    key(2048, 4326);
    key(3072, kUserDefined);
    key(3074, kUserDefined);
    key(3075, 1);  // transverse Mercator
  }
  key(3076, 9001);  // metres
  if (heading.projection && !heading.epsg) {
    double_key(3080, heading.projection->longitude);
    double_key(3081, heading.projection->latitude);
    double_key(3082, 0.0);
    double_key(3083, 0.0);
    double_key(3092, heading.projection->scale);
  }
  std::string begin;
  for (const uint16_t part : {uint16_t{1}, uint16_t{1}, uint16_t{1}, count}) {
    append_raw(begin, part);
  }
  std::vector<Field> fields;
  directory.insert(0, begin);
  fields.push_back({.tag = 34735,
                    .type = kShort,
                    .count = static_cast<uint32_t>(directory.size() / 2),
                    .bytes = directory});
  if (double_count > 0) {
    fields.push_back({.tag = 34736, .type = kDouble, .count = double_count, .bytes = doubles});
  }
  if (!citation.empty()) {
    fields.push_back(text_field(34737, citation));
  }
  return fields;
}

/// What a cell is made of.
struct Samples {
  std::vector<Field> fields{};       ///< that say so, and what "no data" is
  std::vector<std::byte> nothing{};  ///< a block without data
  std::size_t planes = 1;            ///< each with blocks of its own
};

/// A block's bytes; empty: no data there.
using ByteBlock =
    std::function<std::span<const std::byte>(std::size_t plane, int64_t column, int64_t row)>;

void write_raster(const std::filesystem::path& file, const GeoTiffHeading& heading,
                  const Samples& samples, const ByteBlock& block) {
  const int64_t across = (heading.columns + kRasterBlock - 1) / kRasterBlock;
  const int64_t down = (heading.rows + kRasterBlock - 1) / kRasterBlock;
  OutputFile output(file);
  std::string head = "II";
  append_raw(head, uint16_t{42});
  append_raw(head, uint32_t{0});
  output.write(head);
  uint64_t at = head.size();
  const auto take = [&](std::string_view bytes) {
    const uint64_t begin = at;
    output.write(bytes);
    at += bytes.size();
    if (at % 2 == 1) {
      output.write(std::string_view("\0", 1));
      ++at;
    }
    if (at > std::numeric_limits<uint32_t>::max()) {
      throw OutputError(file, file.string() +
                                  ": a TIFF file ends before 4 GiB. Choose larger cells with "
                                  "--cell, or a part with --box.");
    }
    return static_cast<uint32_t>(begin);
  };
  const std::string empty = deflated(samples.nothing);
  const uint32_t empty_at = take(empty);
  std::string offsets;
  std::string sizes;
  for (std::size_t plane = 0; plane < samples.planes; ++plane) {
    for (int64_t row = 0; row < down; ++row) {
      for (int64_t column = 0; column < across; ++column) {
        const std::span<const std::byte> cells = block(plane, column, row);
        const std::string packed = cells.empty() ? empty : deflated(cells);
        append_raw(offsets, cells.empty() ? empty_at : take(packed));
        append_raw(sizes, static_cast<uint32_t>(packed.size()));
      }
    }
  }
  const auto blocks = static_cast<uint32_t>(samples.planes) * static_cast<uint32_t>(across * down);
  std::vector<Field> fields = {
      field<uint32_t>(256, kLong, {static_cast<uint32_t>(heading.columns)}),
      field<uint32_t>(257, kLong, {static_cast<uint32_t>(heading.rows)}),
      number_field(259, 8),  // Adobe deflate
      text_field(270, heading.description),
      number_field(284, samples.planes == 1 ? 1 : 2),  // all numbers of a cell together, or not
      text_field(305, heading.software),
      number_field(322, kRasterBlock),
      number_field(323, kRasterBlock),
      {.tag = 324, .type = kLong, .count = blocks, .bytes = offsets},
      {.tag = 325, .type = kLong, .count = blocks, .bytes = sizes},
      field<double>(33550, kDouble, {heading.cell, heading.cell, 0.0}),
      field<double>(33922, kDouble, {0.0, 0.0, 0.0, heading.corner.x(), heading.corner.y(), 0.0})};
  for (const Field& key : keys_of(heading)) {
    fields.push_back(key);
  }
  fields.insert(fields.end(), samples.fields.begin(), samples.fields.end());
  std::ranges::sort(fields, {}, &Field::tag);
  std::string directory;
  append_raw(directory, static_cast<uint16_t>(fields.size()));
  for (const Field& one : fields) {
    append_raw(directory, one.tag);
    append_raw(directory, one.type);
    append_raw(directory, one.count);
    if (one.bytes.size() <= 4) {
      directory += one.bytes + std::string(4 - one.bytes.size(), '\0');
    } else {
      append_raw(directory, take(one.bytes));
    }
  }
  append_raw(directory, uint32_t{0});
  std::string pointer;
  append_raw(pointer, take(directory));
  output.flush();
  output.overwrite(4, pointer);
  output.close();
}

}  // namespace

void write_geotiff(const std::filesystem::path& file, const GeoTiffHeading& heading,
                   const RasterBlock& block) {
  const std::vector<float> nothing(std::size_t{kRasterBlock} * kRasterBlock,
                                   std::numeric_limits<float>::quiet_NaN());
  const auto bytes = std::as_bytes(std::span(nothing));
  const std::size_t bands = std::max<std::size_t>(1, heading.bands.size());
  std::vector<Field> fields = {band_field(258, 32, bands),                       // bits
                               number_field(262, 1),                             // more is brighter
                               number_field(277, static_cast<uint16_t>(bands)),  // numbers a cell
                               band_field(339, 3, bands),                        // floating point
                               text_field(42113, "nan")};                        // GDAL's "no data"
  if (bands > 1) {  // bands besides the first are no colours
    fields.push_back(band_field(338, 0, bands - 1));
  }
  if (!heading.bands.empty()) {
    fields.push_back(text_field(42112, metadata_of(heading.bands)));
  }
  write_raster(file, heading,
               {.fields = fields, .nothing = {bytes.begin(), bytes.end()}, .planes = bands},
               [&](std::size_t band, int64_t column, int64_t row) {
                 return std::as_bytes(block(band, column, row));
               });
}

void write_color_geotiff(const std::filesystem::path& file, const GeoTiffHeading& heading,
                         const ColorBlock& block) {
  constexpr std::size_t kBytes = std::size_t{4} * kRasterBlock * kRasterBlock;
  write_raster(
      file, heading,
      {.fields = {field<uint16_t>(258, kShort, {8, 8, 8, 8}),  // bits
                  number_field(262, 2),                        // RGB
                  number_field(277, 4),                        // red, green, blue and
                  number_field(338, 2),  // opacity that the colours are not multiplied by
                  field<uint16_t>(339, kShort, {1, 1, 1, 1})},  // unsigned numbers
       .nothing = std::vector<std::byte>(kBytes)},
      [&](std::size_t, int64_t column, int64_t row) { return std::as_bytes(block(column, row)); });
}

}  // namespace adit
