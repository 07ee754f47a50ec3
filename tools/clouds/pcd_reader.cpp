// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/pcd_reader.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
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
    names.push_back(field.count > 0 ? std::string_view(field.name) : std::string_view());
  }
  const FieldRoles roles = find_roles(names, header.reading.colors);
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

/// A cloud of which the header says something else than the file holds: what is there counts.
InputError count_fault(const std::filesystem::path& file, const PcdHeader& header, uint64_t there) {
  const bool twice = header.points != header.other_points;
  return {file, Place::named(twice ? "WIDTH, HEIGHT and POINTS" : "POINTS"),
          "the header promises " + std::to_string(header.points) + " points" +
              (twice ? ", by WIDTH x HEIGHT " + std::to_string(header.other_points) : "") +
              "; the file holds " + std::to_string(there) + ", which are read",
          "The file is cut off or its header is wrong: write it again"};
}

/// Points that the header promises: where it gives two numbers, the one that the file holds.
uint64_t promised(const PcdHeader& header, uint64_t there) {
  return header.other_points == there ? there : header.points;
}

/// The numbers of an ASCII file that have a role, as far as its lines can be read.
class AsciiRows {
 public:
  AsciiRows(const std::filesystem::path& file, const PcdHeader& header)
      : file_(file), roles_(roles_of(file, header)) {
    for (const PcdField& field : header.fields) {
      first_word_.push_back(words_.size());
      words_.resize(words_.size() + field.count);
    }
  }

  void read(std::string_view body, uint64_t header_lines) {
    LineReader lines(body);
    while (const std::optional<std::string_view> line = lines.next()) {
      const std::size_t count = split_words(*line, words_);
      if (count == 0) {
        continue;
      }
      const Place place = Place::line(header_lines + lines.number());
      if (count != words_.size()) {
        refuse(place, "it has " + std::to_string(count) + " numbers, expected " +
                          std::to_string(words_.size()));
      } else {
        add(place);
      }
    }
  }

  const std::vector<double>& values() const { return values_; }
  std::size_t points() const { return values_.size() / kFieldRoles; }
  std::size_t refused() const { return refused_; }  ///< lines
  /// The first of them.
  const std::optional<InputError>& first() const { return first_; }

 private:
  void refuse(const Place& place, const std::string& found) {
    ++refused_;
    if (!first_) {
      first_.emplace(file_, place, found,
                     "The file is cut off or its header is wrong: write it again");
    }
  }

  void add(const Place& place) {
    std::array<double, kFieldRoles> row{};
    for (std::size_t role = 0; role < kFieldRoles; ++role) {
      if (roles_.index[role] < 0) {
        continue;
      }
      const std::string_view word =
          words_[first_word_[static_cast<std::size_t>(roles_.index[role])]];
      const std::optional<double> value = parse_double(word);
      if (!value) {
        refuse(place, in_quotes(word) + " is no number");
        return;
      }
      row[role] = *value;
    }
    values_.insert(values_.end(), row.begin(), row.end());
  }

  const std::filesystem::path& file_;
  FieldRoles roles_;
  std::vector<std::size_t> first_word_;  // one per field
  std::vector<std::string_view> words_;  // of the line
  std::vector<double> values_;
  std::size_t refused_ = 0;
  std::optional<InputError> first_;
};

CloudFile parse_ascii(const std::filesystem::path& file, const PcdHeader& header,
                      std::string_view body) {
  AsciiRows rows(file, header);
  rows.read(body, header.lines);
  if (rows.points() == 0 && rows.first()) {
    throw InputError(*rows.first());
  }
  if (rows.points() == 0 && header.points > 0) {
    throw InputError(
        file, Place::named("POINTS"),
        "the header promises " + std::to_string(header.points) + " points; the file has none",
        "The file is cut off or its header is wrong: write it again");
  }
  const FieldRoles roles = roles_of(file, header);
  CloudColumns columns;
  columns.points = rows.points();
  columns.reading = header.reading;
  for (std::size_t role = 0; role < kFieldRoles; ++role) {
    if (roles.index[role] >= 0) {
      columns.columns[role] =
          Column{reinterpret_cast<const std::byte*>(rows.values().data()),
                 role * sizeof(double),
                 kFieldRoles * sizeof(double),
                 ScalarType::f64,
                 false,
                 header.fields[static_cast<std::size_t>(roles.index[role])].type};
    }
  }
  CloudFile cloud = decode_cloud(file, columns);
  if (const uint64_t there = rows.points() + rows.refused();
      there != header.points || there != header.other_points) {
    cloud.faults.push_back(count_fault(file, header, there));
  }
  if (rows.first()) {
    cloud.faults.push_back(with_count(*rows.first(), rows.refused(), "lines"));
  }
  return cloud;
}

CloudFile parse_binary(const std::filesystem::path& file, PcdHeader header,
                       std::span<const std::byte> body) {
  const uint64_t there = body.size() / header.point_bytes;
  const uint64_t wanted = promised(header, there);
  if (there == 0 && wanted > 0) {
    throw InputError(file, Place::byte(header.bytes),
                     "the header promises " + std::to_string(wanted) + " points of " +
                         std::to_string(header.point_bytes) + " bytes; the file holds " +
                         std::to_string(body.size()) + " bytes after its header, no whole point",
                     "The file is cut off or its header is wrong: write it again");
  }
  // Bytes behind the points that are no points themselves stay out.
  const bool more = there > wanted && body.size() % header.point_bytes == 0;
  std::optional<InputError> fault;
  if (there < wanted || more || header.points != header.other_points) {
    fault = count_fault(file, header, more ? there : std::min(there, wanted));
  } else if (there > wanted) {
    fault = InputError(file, Place::byte(header.bytes + wanted * header.point_bytes),
                       std::to_string(body.size() - wanted * header.point_bytes) +
                           " bytes follow the " + std::to_string(wanted) +
                           " points of the header; they are left out",
                       "Correct WIDTH, HEIGHT and POINTS, or write the file again");
  }
  header.points = more ? there : std::min(there, wanted);
  std::vector<FieldPlace> places;
  places.reserve(header.fields.size());
  for (const PcdField& field : header.fields) {
    places.push_back({field.offset, header.point_bytes});
  }
  CloudFile cloud = decode_cloud(file, columns_of(file, header, body.data(), places));
  if (fault) {
    cloud.faults.push_back(*fault);
  }
  return cloud;
}

uint32_t load_u32(std::span<const std::byte> from) {
  uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= std::to_integer<uint32_t>(from[i]) << (8U * i);
  }
  return value;
}

CloudFile parse_compressed(const std::filesystem::path& file, PcdHeader header,
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
  const auto holds = [&](std::size_t bytes) {  // of a point
    return bytes > 0 &&
           (unpacked == header.points * bytes || unpacked == header.other_points * bytes);
  };
  const bool padded = holds(header.point_bytes) || !holds(without_padding);
  const std::size_t point_bytes = padded ? header.point_bytes : without_padding;
  if (unpacked % point_bytes != 0 || (unpacked == 0 && header.points > 0)) {
    throw InputError(file, Place::byte(header.bytes + 4),
                     "the compressed data stands for " + std::to_string(unpacked) +
                         " bytes; the header's " + std::to_string(header.points) + " points of " +
                         std::to_string(header.point_bytes) + " bytes need " +
                         std::to_string(header.points * header.point_bytes),
                     remedy);
  }
  const uint64_t there = unpacked / point_bytes;
  std::optional<InputError> fault;
  if (there != header.points || there != header.other_points) {
    fault = count_fault(file, header, there);
  }
  header.points = there;
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
  CloudFile cloud = decode_cloud(file, columns_of(file, header, data.data(), places));
  if (fault) {
    cloud.faults.push_back(*fault);
  }
  return cloud;
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
