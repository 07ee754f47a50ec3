// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/ply_reader.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adit/tools/clouds/ply_header.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

constexpr const char* kCutOff = "The file is cut off or its header is wrong: write it again";

FieldRoles roles_of(const std::filesystem::path& file, const PlyElement& vertex, bool colors) {
  std::vector<std::string_view> names;
  names.reserve(vertex.properties.size());
  for (const PlyProperty& property : vertex.properties) {
    names.push_back(property.list_count ? std::string_view() : std::string_view(property.name));
  }
  const FieldRoles roles = find_roles(names, colors);
  for (const FieldRole axis : {FieldRole::x, FieldRole::y, FieldRole::z}) {
    if (roles[axis] < 0) {
      throw InputError(file, Place::named("element vertex"), "it has no property x, y or z",
                       "Sweeps need x y z");
    }
  }
  return roles;
}

/// Refuses counts that the rest of the file cannot hold, before anything is allocated or walked
/// through.
void require_room(const std::filesystem::path& file, const PlyElement& element, uint64_t smallest,
                  uint64_t bytes) {
  if (element.count > 0 && (smallest == 0 || element.count > bytes / smallest)) {
    throw InputError(file, Place::named("element " + element.name),
                     "the header promises " + std::to_string(element.count) + " records of " +
                         std::to_string(smallest) + " bytes or more; " + std::to_string(bytes) +
                         " bytes are left in the file",
                     smallest == 0 ? "An element needs properties: write the file again" : kCutOff);
  }
}

/// The header says another number of vertices than the file holds: what is there counts.
InputError count_fault(const std::filesystem::path& file, uint64_t promised, uint64_t there) {
  return {file, Place::named("element vertex"),
          "the header promises " + std::to_string(promised) + " vertices; the file holds " +
              std::to_string(there) + ", which are read",
          kCutOff};
}

/// Walks through the records of a binary file.
class BinaryBody {
 public:
  BinaryBody(const std::filesystem::path& file, const PlyHeader& header,
             std::span<const std::byte> content)
      : file_(file),
        content_(content),
        at_(header.bytes),
        big_(header.format == PlyFormat::big_endian),
        reading_(header.reading) {}

  void skip(const PlyElement& element) {
    require_room(file_, element, element.smallest_record(), left());
    if (!element.has_lists()) {
      at_ += static_cast<std::size_t>(element.count) * element.smallest_record();
      return;
    }
    for (uint64_t record = 0; record < element.count; ++record) {
      for (const PlyProperty& property : element.properties) {
        skip(element, property, record);
      }
    }
  }

  /// `last`: no other element follows.
  CloudFile read(PlyElement vertex, bool last) {
    const FieldRoles roles = roles_of(file_, vertex, reading_.colors);
    const uint64_t record = vertex.smallest_record();
    const uint64_t room = record == 0 ? 0 : left() / record;
    if (room == 0 && vertex.count > 0) {
      require_room(file_, vertex, record, left());
    }
    if (vertex.has_lists()) {
      return read_lists(vertex, room, roles);
    }
    const bool more = last && room > vertex.count && left() % record == 0;
    const uint64_t there = more ? room : std::min(room, vertex.count);
    std::optional<InputError> fault;
    if (there != vertex.count) {
      fault = count_fault(file_, vertex.count, there);
    }
    vertex.count = there;
    CloudFile cloud = read_fixed(vertex, roles);
    if (fault) {
      cloud.faults.push_back(*fault);
    }
    return cloud;
  }

 private:
  std::size_t left() const { return content_.size() - at_; }

  void advance(const PlyElement& element, uint64_t record, uint64_t bytes) {
    if (bytes > left()) {
      throw InputError(file_, Place::byte(at_),
                       "the file ends inside record " + std::to_string(record) + " of the " +
                           std::to_string(element.count) + " of element " + element.name,
                       kCutOff);
    }
    at_ += static_cast<std::size_t>(bytes);
  }

  uint64_t load_integer(std::size_t bytes, bool is_signed) const {
    uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) {
      const std::size_t from = big_ ? i : bytes - 1 - i;
      value = (value << 8U) | std::to_integer<uint64_t>(content_[at_ + from]);
    }
    // A negative length reads as a huge one, which no file holds.
    const bool negative = is_signed && ((value >> (8 * bytes - 1)) & 1U) != 0;
    return negative ? ~uint64_t{0} : value;
  }

  void skip(const PlyElement& element, const PlyProperty& property, uint64_t record) {
    if (!property.list_count) {
      advance(element, record, size_of(property.type));
      return;
    }
    const std::size_t count_bytes = size_of(*property.list_count);
    const std::size_t start = at_;
    advance(element, record, count_bytes);
    at_ = start;
    const ScalarType type = *property.list_count;
    const bool is_signed = type == ScalarType::i8 || type == ScalarType::i16 ||
                           type == ScalarType::i32 || type == ScalarType::i64;
    const uint64_t count = load_integer(count_bytes, is_signed);
    at_ += count_bytes;
    advance(element, record, count > left() ? ~uint64_t{0} : count * size_of(property.type));
  }

  bool swap() const { return big_ != (std::endian::native == std::endian::big); }

  CloudFile read_fixed(const PlyElement& vertex, const FieldRoles& roles) const {
    CloudColumns columns;
    columns.reading = reading_;
    columns.points = static_cast<std::size_t>(vertex.count);
    for (std::size_t role = 0; role < kFieldRoles; ++role) {
      if (roles.index[role] < 0) {
        continue;
      }
      const auto field = static_cast<std::size_t>(roles.index[role]);
      std::size_t offset = 0;
      for (std::size_t i = 0; i < field; ++i) {
        offset += size_of(vertex.properties[i].type);
      }
      columns.columns[role] = Column{content_.data(), at_ + offset, vertex.smallest_record(),
                                     vertex.properties[field].type, swap()};
    }
    return decode_cloud(file_, columns);
  }

  /// Records of varying length: the numbers that matter are copied together first.
  CloudFile read_lists(const PlyElement& vertex, uint64_t room, const FieldRoles& roles) {
    const uint64_t most = std::min(vertex.count, room);
    std::vector<std::byte> rows(static_cast<std::size_t>(most) * kRow);
    std::optional<InputError> fault;
    uint64_t read = 0;
    try {
      for (; read < most; ++read) {
        read_record(vertex, read, roles, rows.data() + static_cast<std::size_t>(read) * kRow);
      }
    } catch (const InputError& error) {  // it ends within this record
      if (read == 0) {
        throw;
      }
    }
    if (read < vertex.count) {
      fault = count_fault(file_, vertex.count, read);
    }
    CloudColumns columns;
    columns.reading = reading_;
    columns.points = static_cast<std::size_t>(read);
    for (std::size_t role = 0; role < kFieldRoles; ++role) {
      if (roles.index[role] >= 0) {
        columns.columns[role] =
            Column{rows.data(), role * kSlot, kRow,
                   vertex.properties[static_cast<std::size_t>(roles.index[role])].type, swap()};
      }
    }
    CloudFile cloud = decode_cloud(file_, columns);
    if (fault) {
      cloud.faults.push_back(*fault);
    }
    return cloud;
  }

  /// Copies the numbers that have a role into `row`.
  void read_record(const PlyElement& vertex, uint64_t record, const FieldRoles& roles,
                   std::byte* row) {
    for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
      const std::size_t start = at_;
      skip(vertex, vertex.properties[i], record);
      for (std::size_t role = 0; role < kFieldRoles; ++role) {
        if (roles.index[role] == static_cast<int>(i)) {
          std::copy_n(content_.data() + start, size_of(vertex.properties[i].type),
                      row + role * kSlot);
        }
      }
    }
  }

  static constexpr std::size_t kSlot = 8;                   // bytes of a number
  static constexpr std::size_t kRow = kSlot * kFieldRoles;  // bytes of a record's numbers
  const std::filesystem::path& file_;
  std::span<const std::byte> content_;
  std::size_t at_;
  bool big_;
  CloudReading reading_;
};

/// Walks through the lines of an ASCII file, one record each.
class AsciiBody {
 public:
  AsciiBody(const std::filesystem::path& file, const PlyHeader& header, std::string_view content)
      : file_(file),
        lines_(content.substr(header.bytes)),
        header_lines_(header.lines),
        reading_(header.reading) {}

  void skip(const PlyElement& element) {
    require_room(element);
    for (uint64_t record = 0; record < element.count; ++record) {
      static_cast<void>(next_line(element, record));
    }
  }

  /// `last`: no other element follows.
  CloudFile read(const PlyElement& vertex, bool last) {
    const FieldRoles roles = roles_of(file_, vertex, reading_.colors);
    std::vector<double> values;
    uint64_t there = 0;  // records, also those that cannot be read
    uint64_t refused = 0;
    std::optional<InputError> first;
    while (last || there < vertex.count) {
      const std::optional<std::string_view> line = find_line();
      if (!line) {
        break;
      }
      ++there;
      std::array<double, kFieldRoles> row{};
      try {
        read_record(vertex, roles, *line, row.data());
        values.insert(values.end(), row.begin(), row.end());
      } catch (const InputError& error) {
        ++refused;
        if (!first) {
          first.emplace(error);
        }
      }
    }
    if (values.empty() && (first || vertex.count > 0)) {
      throw first ? InputError(*first) : ends_after(vertex, 0);
    }
    CloudColumns columns;
    columns.reading = reading_;
    columns.points = values.size() / kFieldRoles;
    for (std::size_t role = 0; role < kFieldRoles; ++role) {
      if (roles.index[role] >= 0) {
        columns.columns[role] =
            Column{reinterpret_cast<const std::byte*>(values.data()),
                   role * sizeof(double),
                   kFieldRoles * sizeof(double),
                   ScalarType::f64,
                   false,
                   vertex.properties[static_cast<std::size_t>(roles.index[role])].type};
      }
    }
    CloudFile cloud = decode_cloud(file_, columns);
    if (there != vertex.count) {
      cloud.faults.push_back(count_fault(file_, vertex.count, there));
    }
    if (first) {
      cloud.faults.push_back(with_count(*first, static_cast<std::size_t>(refused), "lines"));
    }
    return cloud;
  }

 private:
  /// A number and its separator take two bytes, the last one of the file perhaps one.
  void require_room(const PlyElement& element) const {
    adit::require_room(file_, element, 2 * element.properties.size(), lines_.rest().size() + 1);
  }

  Place place() const { return Place::line(header_lines_ + lines_.number()); }

  /// The next line that is not blank.
  std::optional<std::string_view> find_line() {
    while (const std::optional<std::string_view> line = lines_.next()) {
      if (line->find_first_not_of(" \t") != std::string_view::npos) {
        return line;
      }
    }
    return std::nullopt;
  }

  InputError ends_after(const PlyElement& element, uint64_t record) const {
    return {file_, Place::line(header_lines_ + lines_.number() + 1),
            "the file ends after " + std::to_string(record) + " of the " +
                std::to_string(element.count) + " records of element " + element.name,
            kCutOff};
  }

  std::string_view next_line(const PlyElement& element, uint64_t record) {
    if (const std::optional<std::string_view> line = find_line()) {
      return *line;
    }
    throw ends_after(element, record);
  }

  void read_record(const PlyElement& vertex, const FieldRoles& roles, std::string_view line,
                   double* values) {
    const std::size_t found = split_words(line, words_);
    if (found > words_.size()) {
      words_.resize(found);
      split_words(line, words_);
    }
    const std::span<const std::string_view> words = std::span(words_).first(found);
    std::size_t at = 0;
    for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
      if (at >= words.size()) {
        fail_count(words.size());
      }
      const std::string_view word = words[at++];
      if (vertex.properties[i].list_count) {
        const std::optional<uint64_t> count = parse_unsigned(word);
        if (!count || *count > words.size() - at) {
          throw InputError(file_, place(),
                           in_quotes(word) + " is not the length of the list that follows",
                           kCutOff);
        }
        at += static_cast<std::size_t>(*count);
        continue;
      }
      for (std::size_t role = 0; role < kFieldRoles; ++role) {
        if (roles.index[role] == static_cast<int>(i)) {
          const std::optional<double> value = parse_double(word);
          if (!value) {
            throw InputError(file_, place(), in_quotes(word) + " is no number", "Correct the line");
          }
          values[role] = *value;
        }
      }
    }
    if (at != words.size()) {
      fail_count(words.size());
    }
  }

  [[noreturn]] void fail_count(std::size_t count) const {
    throw InputError(
        file_, place(),
        "its " + std::to_string(count) + " numbers do not fit the properties of a vertex", kCutOff);
  }

  const std::filesystem::path& file_;
  LineReader lines_;
  uint64_t header_lines_;
  CloudReading reading_;
  std::vector<std::string_view> words_;
};

template <class Body>
CloudFile read_vertices(const std::filesystem::path& file, const PlyHeader& header, Body body) {
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      return body.read(element, &element == &header.elements.back());
    }
    body.skip(element);
  }
  throw InputError(file, Place::named("header"), "there is no element 'vertex'",
                   "Sweeps are points: write the vertices");
}

}  // namespace

CloudFile parse_ply(const std::filesystem::path& file, std::string_view content,
                    const CloudReading& reading) {
  PlyHeader header = parse_ply_header(file, content);
  header.reading = reading;
  if (header.format == PlyFormat::ascii) {
    return read_vertices(file, header, AsciiBody(file, header, content));
  }
  return read_vertices(
      file, header,
      BinaryBody(file, header, std::as_bytes(std::span(content.data(), content.size()))));
}

CloudFile read_ply(const std::filesystem::path& file, const CloudReading& reading) {
  return parse_ply(file, read_text_file(file), reading);
}

}  // namespace adit
