// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/submaps/submap_codec.hpp"

#include <bit>
#include <cstring>
#include <string>
#include <type_traits>

namespace adit {
namespace {

static_assert(std::endian::native == std::endian::little, "stored submaps are little-endian");

constexpr uint32_t kVersion = 2;
constexpr uint32_t kVersionWithoutFlags = 1;
constexpr uint16_t kSeenThrough = 0x8000;  // beside a point's sweep, of which there are fewer
constexpr std::size_t kLeastChunks = 2;    // without a descriptor
using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

// FNV-1a: any changed byte changes it.
uint64_t checksum(std::span<const std::byte> bytes) {
  uint64_t value = 0xcbf29ce484222325U;
  for (const std::byte byte : bytes) {
    value = (value ^ static_cast<uint64_t>(byte)) * 0x100000001b3U;
  }
  return value;
}

class Writer {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof(T));
  }
  /// All lowest bytes, then all of the next.
  template <class Number>
  void put_planes(const std::vector<Number>& numbers) {
    for (std::size_t byte = 0; byte < sizeof(Number); ++byte) {
      for (const Number number : numbers) {
        bytes_.push_back(static_cast<std::byte>((number >> (8 * byte)) & 0xffU));
      }
    }
  }
  std::vector<std::byte> take() {
    put(checksum(bytes_));
    return std::move(bytes_);
  }

 private:
  std::vector<std::byte> bytes_;
};

class Reader {
 public:
  /// What stands before the checksum. Throws SubmapDamaged where that is another one.
  explicit Reader(std::span<const std::byte> chunk) {
    uint64_t written = 0;
    if (chunk.size() < sizeof(written)) {
      throw SubmapDamaged("ends early, at byte " + std::to_string(chunk.size()));
    }
    bytes_ = chunk.first(chunk.size() - sizeof(written));
    std::memcpy(&written, chunk.data() + bytes_.size(), sizeof(written));
    if (written != checksum(bytes_)) {
      throw SubmapDamaged("has a wrong checksum");
    }
  }

  template <class T>
  T get() {
    T value;
    std::memcpy(&value, next(sizeof(T)).data(), sizeof(T));
    return value;
  }
  template <class Number>
  std::vector<Number> get_planes(std::size_t count) {
    const std::span<const std::byte> planes = next(count * sizeof(Number));
    std::vector<Number> numbers(count, 0);
    for (std::size_t byte = 0; byte < sizeof(Number); ++byte) {
      for (std::size_t i = 0; i < count; ++i) {
        numbers[i] = static_cast<Number>(numbers[i] | static_cast<Number>(planes[byte * count + i])
                                                          << (8 * byte));
      }
    }
    return numbers;
  }
  std::size_t left() const { return bytes_.size() - at_; }
  void expect_end() const {
    if (left() > 0) {
      throw SubmapDamaged("has " + std::to_string(left()) + " bytes too many");
    }
  }

 private:
  std::span<const std::byte> next(std::size_t length) {
    if (length > left()) {
      throw SubmapDamaged("ends early, at byte " + std::to_string(bytes_.size()));
    }
    at_ += length;
    return bytes_.subspan(at_ - length, length);
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

// Differences of both signs as small numbers: 0, -1, 1, -2, ...
uint32_t zigzag(int32_t value) {
  return (static_cast<uint32_t>(value) << 1U) ^ static_cast<uint32_t>(value >> 31);
}
int32_t unzigzag(uint32_t value) {
  return static_cast<int32_t>((value >> 1U) ^ (~(value & 1U) + 1U));
}

std::vector<std::byte> encode_sweeps(const KeyframeSubmap& submap) {
  Writer writer;
  writer.put(kVersion);
  writer.put(submap.r_submap);
  writer.put(static_cast<uint32_t>(submap.vertical));
  writer.put(static_cast<uint32_t>(submap.sweeps.size()));
  for (const SubmapSweep& sweep : submap.sweeps) {
    writer.put(int64_t{sweep.stamp.count()});
    const Rows rows = sweep.T_keyframe_lidar.matrix().topRows<3>();
    for (Eigen::Index i = 0; i < rows.size(); ++i) {
      writer.put(rows.data()[i]);
    }
    writer.put(static_cast<uint32_t>(sweep.merged));
  }
  return writer.take();
}

std::vector<std::byte> encode_points(const KeyframeSubmap& submap) {
  Writer writer;
  writer.put(static_cast<uint32_t>(submap.points.size()));
  std::vector<uint32_t> numbers(submap.points.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    uint32_t last = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      // Wraps around as decoding does: any two places have a difference.
      const auto place = static_cast<uint32_t>(submap.points[i].place[axis]);
      numbers[i] = zigzag(static_cast<int32_t>(place - last));
      last = place;
    }
    writer.put_planes(numbers);
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = submap.points[i].surface;
  }
  writer.put_planes(numbers);
  std::vector<uint16_t> sweeps(submap.points.size());
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    const SubmapPoint& point = submap.points[i];
    sweeps[i] = static_cast<uint16_t>(point.sweep | (point.seen_through ? kSeenThrough : 0));
  }
  writer.put_planes(sweeps);
  return writer.take();
}

std::vector<std::byte> encode_descriptor(const PlaceDescriptor& descriptor) {
  Writer writer;
  writer.put(kPlaceVersion);
  writer.put(descriptor.cell);
  writer.put(descriptor.polar);
  writer.put(descriptor.plan);
  return writer.take();
}

void decode_points(std::span<const std::byte> chunk, KeyframeSubmap& submap) {
  Reader reader(chunk);
  const std::size_t count = reader.get<uint32_t>();
  if (count > reader.left()) {  // before memory is taken for a number that lies
    throw SubmapDamaged("claims " + std::to_string(count) + " points, and has not as many bytes");
  }
  submap.points.resize(count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    uint32_t last = 0;  // wraps around in a damaged chunk
    const std::vector<uint32_t> numbers = reader.get_planes<uint32_t>(count);
    for (std::size_t i = 0; i < count; ++i) {
      last += static_cast<uint32_t>(unzigzag(numbers[i]));
      submap.points[i].place[axis] = static_cast<int32_t>(last);
    }
  }
  const std::vector<uint32_t> surfaces = reader.get_planes<uint32_t>(count);
  const std::vector<uint16_t> sweeps = reader.get_planes<uint16_t>(count);
  for (std::size_t i = 0; i < count; ++i) {
    submap.points[i].surface = surfaces[i];
    SubmapPoint& point = submap.points[i];
    point.seen_through = (sweeps[i] & kSeenThrough) != 0;
    point.sweep = static_cast<uint16_t>(sweeps[i] & ~kSeenThrough);
    if (point.sweep >= submap.sweeps.size()) {
      throw SubmapDamaged("has a point of sweep " + std::to_string(point.sweep) + " of " +
                          std::to_string(submap.sweeps.size()));
    }
  }
  reader.expect_end();
}

}  // namespace

MapSubmap encode(const KeyframeSubmap& submap, const std::optional<PlaceDescriptor>& descriptor) {
  const SubmapBox box = box_of(submap);
  MapSubmap stored{.lower = box.lower,
                   .upper = box.upper,
                   .chunks = {encode_sweeps(submap), encode_points(submap)}};
  if (descriptor) {
    stored.chunks.push_back(encode_descriptor(*descriptor));
  }
  return stored;
}

KeyframeSubmap decode_sweeps(std::span<const std::byte> chunk) {
  Reader reader(chunk);
  const auto version = reader.get<uint32_t>();
  if (version != kVersion && version != kVersionWithoutFlags) {
    throw SubmapDamaged("is of version " + std::to_string(version) + ", expected " +
                        std::to_string(kVersion));
  }
  KeyframeSubmap submap;
  submap.r_submap = reader.get<double>();
  const auto vertical = reader.get<uint32_t>();
  if (vertical > static_cast<uint32_t>(Vertical::rough_gravity)) {
    throw SubmapDamaged("has an unknown kind of vertical, " + std::to_string(vertical));
  }
  submap.vertical = static_cast<Vertical>(vertical);
  const auto count = reader.get<uint32_t>();
  for (uint32_t i = 0; i < count; ++i) {
    SubmapSweep sweep;
    sweep.stamp = Nanoseconds(reader.get<int64_t>());
    Rows rows;
    for (Eigen::Index k = 0; k < rows.size(); ++k) {
      rows.data()[k] = reader.get<double>();
    }
    sweep.T_keyframe_lidar.matrix().topRows<3>() = rows;
    sweep.merged = reader.get<uint32_t>() != 0;
    submap.sweeps.push_back(sweep);
  }
  reader.expect_end();
  return submap;
}

KeyframeSubmap decode(const MapSubmap& stored) {
  if (stored.chunks.size() < kLeastChunks || stored.chunks.size() > kPlaceChunk + 1) {
    throw SubmapDamaged("has " + std::to_string(stored.chunks.size()) + " chunks, expected " +
                        std::to_string(kLeastChunks) + " or " + std::to_string(kPlaceChunk + 1));
  }
  KeyframeSubmap submap = decode_sweeps(stored.chunks[kSweepChunk]);
  decode_points(stored.chunks[1], submap);
  return submap;
}

std::optional<PlaceDescriptor> decode_descriptor(const MapSubmap& stored) {
  if (stored.chunks.size() <= kPlaceChunk) {
    return std::nullopt;
  }
  Reader reader(stored.chunks[kPlaceChunk]);
  if (reader.get<uint32_t>() != kPlaceVersion) {
    return std::nullopt;
  }
  PlaceDescriptor descriptor{.cell = reader.get<double>()};
  descriptor.polar = reader.get<decltype(descriptor.polar)>();
  descriptor.plan = reader.get<decltype(descriptor.plan)>();
  reader.expect_end();
  return descriptor;
}

}  // namespace adit
