// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/pcd_reader.hpp"

#include <bit>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "adit/tools/clouds/pcd_header.hpp"
#include "adit/tools/clouds/pcd_lzf.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

constexpr bool kSwap = std::endian::native == std::endian::big;  // PCD data is little-endian
constexpr std::string_view kPadding = "_";

/// Where each role's numbers are: an offset from the start and a stride, by field.
struct FieldPlace {
  std::size_t offset = 0;
  std::size_t stride = 0;
};

FieldRoles roles_of(const std::filesystem::path& file, const PcdHeader& header) {
  std::vector<std::string_view> names;
  names.reserve(header.fields.size());
  for (const PcdField& field : header.fields) {
    names.push_back(field.name);
  }
  const FieldRoles roles = find_roles(names);
  for (const FieldRole axis : {FieldRole::x, FieldRole::y, FieldRole::z}) {
    if (roles[axis] < 0) {
      throw InputError(file, Place::named("FIELDS"), "there is no field x, y or z",
                       "Sweeps need x y z");
    }
  }
  return roles;
}

CloudColumns columns_of(const std::filesystem::path& file, const PcdHeader& header,
                        const std::byte* data, const std::vector<FieldPlace>& places) {
  const FieldRoles roles = roles_of(file, header);
  CloudColumns columns;
  columns.points = static_cast<std::size_t>(header.points);
  columns.reading = header.reading;
  for (std::size_t role = 0; role < kFieldRoles; ++role) {
    if (roles.index[role] >= 0) {
      const auto i = static_cast<std::size_t>(roles.index[role]);
      columns.columns[role] =
          Column{data, places[i].offset, places[i].stride, header.fields[i].type, kSwap};
    }
  }
  return columns;
}

CloudFile parse_ascii(const std::filesystem::path& file, const PcdHeader& header,
                      std::string_view body) {
  // A number and its separator take two bytes, the last one of the file perhaps one.
  if (header.points * header.numbers > body.size() / 2 + 1) {
    throw InputError(file, Place::named("POINTS"),
                     "the header promises " + std::to_string(header.points) + " points of " +
                         std::to_string(header.numbers) + " numbers; the " +
                         std::to_string(body.size()) + " bytes after it cannot hold them",
                     "The file is cut off or its header is wrong: write it again");
  }
  const FieldRoles roles = roles_of(file, header);
  std::vector<std::size_t> first_word;  // one per field
  first_word.reserve(header.fields.size());
  std::size_t words_per_point = 0;
  for (const PcdField& field : header.fields) {
    first_word.push_back(words_per_point);
    words_per_point += field.count;
  }
  const auto points = static_cast<std::size_t>(header.points);
  std::vector<double> values(points * kFieldRoles);
  std::vector<std::string_view> words(words_per_point);
  LineReader lines(body);
  std::size_t point = 0;
  while (const std::optional<std::string_view> line = lines.next()) {
    const std::size_t count = split_words(*line, words);
    if (count == 0) {
      continue;
    }
    const Place place = Place::line(header.lines + lines.number());
    if (point == points) {
      throw InputError(
          file, place,
          "there are more points than the " + std::to_string(points) + " of the header",
          "Correct WIDTH, HEIGHT and POINTS, or delete the surplus lines");
    }
    if (count != words_per_point) {
      throw InputError(file, place,
                       "it has " + std::to_string(count) + " numbers, expected " +
                           std::to_string(words_per_point),
                       "The file is cut off or its header is wrong: write it again");
    }
    for (std::size_t role = 0; role < kFieldRoles; ++role) {
      if (roles.index[role] < 0) {
        continue;
      }
      const std::string_view word = words[first_word[static_cast<std::size_t>(roles.index[role])]];
      const std::optional<double> value = parse_double(word);
      if (!value) {
        throw InputError(file, place, in_quotes(word) + " is no number",
                         "Correct or delete the line (and the header's counts)");
      }
      values[point * kFieldRoles + role] = *value;
    }
    ++point;
  }
  if (point != points) {
    throw InputError(file, Place::line(header.lines + lines.number() + 1),
                     "the file ends after " + std::to_string(point) + " of the header's " +
                         std::to_string(points) + " points",
                     "The file is cut off or its header is wrong: write it again");
  }
  CloudColumns columns;
  columns.points = points;
  columns.reading = header.reading;
  for (std::size_t role = 0; role < kFieldRoles; ++role) {
    if (roles.index[role] >= 0) {
      columns.columns[role] =
          Column{reinterpret_cast<const std::byte*>(values.data()),
                 role * sizeof(double),
                 kFieldRoles * sizeof(double),
                 ScalarType::f64,
                 false,
                 header.fields[static_cast<std::size_t>(roles.index[role])].type};
    }
  }
  return decode_cloud(file, columns);
}

CloudFile parse_binary(const std::filesystem::path& file, const PcdHeader& header,
                       std::span<const std::byte> body) {
  // points <= 2^31 and a point is far below 2^32 bytes: the product fits.
  const uint64_t promised = header.points * header.point_bytes;
  const bool short_by = promised > body.size();
  if (short_by || body.size() - promised >= header.point_bytes) {
    throw InputError(file, Place::byte(header.bytes),
                     "the header promises " + std::to_string(header.points) + " points of " +
                         std::to_string(header.point_bytes) + " bytes, " +
                         std::to_string(promised) + " in all; the file holds " +
                         std::to_string(body.size()) + " bytes after its header, " +
                         std::to_string(body.size() / header.point_bytes) + " points",
                     short_by ? "The file is cut off or its header is wrong: write it again"
                              : "Correct WIDTH, HEIGHT and POINTS, or write the file again");
  }
  std::vector<FieldPlace> places;
  places.reserve(header.fields.size());
  for (const PcdField& field : header.fields) {
    places.push_back({field.offset, header.point_bytes});
  }
  return decode_cloud(file, columns_of(file, header, body.data(), places));
}

uint32_t load_u32(std::span<const std::byte> from) {
  uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= std::to_integer<uint32_t>(from[i]) << (8U * i);
  }
  return value;
}

CloudFile parse_compressed(const std::filesystem::path& file, const PcdHeader& header,
                           std::span<const std::byte> body) {
  const std::string remedy = "The file is cut off or damaged: write it again";
  if (body.size() < 8) {
    throw InputError(file, Place::byte(header.bytes),
                     "the two sizes of the compressed data are missing", remedy);
  }
  const std::size_t packed = load_u32(body);
  const std::size_t unpacked = load_u32(body.subspan(4));
  body = body.subspan(8);
  if (packed > body.size()) {
    throw InputError(file, Place::byte(header.bytes),
                     "it promises " + std::to_string(packed) +
                         " bytes of compressed data; the file holds " + std::to_string(body.size()),
                     remedy);
  }
  // Some writers leave the padding fields out of the data, although the header lists them.
  std::size_t without_padding = 0;
  for (const PcdField& field : header.fields) {
    without_padding += field.name == kPadding ? 0 : field.bytes();
  }
  const bool padded = unpacked == header.points * header.point_bytes;
  if (!padded && unpacked != header.points * without_padding) {
    throw InputError(file, Place::byte(header.bytes + 4),
                     "the compressed data stands for " + std::to_string(unpacked) +
                         " bytes; the header's " + std::to_string(header.points) + " points of " +
                         std::to_string(header.point_bytes) + " bytes need " +
                         std::to_string(header.points * header.point_bytes),
                     remedy);
  }
  if (unpacked / kLzfLargestExpansion > packed) {
    throw InputError(file, Place::byte(header.bytes),
                     std::to_string(packed) + " bytes of compressed data cannot stand for " +
                         std::to_string(unpacked),
                     remedy);
  }
  std::vector<std::byte> data(unpacked);
  if (const std::optional<std::size_t> bad = lzf_expand(body.first(packed), data)) {
    throw InputError(file, Place::byte(header.bytes + 8 + *bad),
                     "the compressed data makes no sense there", remedy);
  }
  // Compressed clouds are stored field by field: all x, then all y, ...
  std::vector<FieldPlace> places;
  places.reserve(header.fields.size());
  std::size_t offset = 0;
  for (const PcdField& field : header.fields) {
    places.push_back({offset, field.bytes()});
    const bool stored = padded || field.name != kPadding;
    offset += stored ? field.bytes() * static_cast<std::size_t>(header.points) : 0;
  }
  return decode_cloud(file, columns_of(file, header, data.data(), places));
}

}  // namespace

CloudFile parse_pcd(const std::filesystem::path& file, std::string_view content,
                    const CloudReading& reading) {
  PcdHeader header = parse_pcd_header(file, content);
  header.reading = reading;
  static_cast<void>(
      roles_of(file, header));  // before anything is sized by fields that might not be there
  const std::string_view body = content.substr(header.bytes);
  const std::span<const std::byte> bytes = std::as_bytes(std::span(body.data(), body.size()));
  switch (header.data) {
    case PcdData::ascii:
      return parse_ascii(file, header, body);
    case PcdData::binary:
      return parse_binary(file, header, bytes);
    case PcdData::binary_compressed:
      return parse_compressed(file, header, bytes);
  }
  return {};
}

CloudFile read_pcd(const std::filesystem::path& file, const CloudReading& reading) {
  return parse_pcd(file, read_text_file(file), reading);
}

}  // namespace adit
