// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/ros_clouds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <optional>
#include <string_view>

#include "adit/tools/clouds/cloud_columns.hpp"
#include "adit/tools/packets/packet_order.hpp"
#include "adit/tools/packets/velodyne_packets.hpp"
#include "adit/tools/recordings/packet_decoder.hpp"
#include "adit/tools/recordings/ros_codec.hpp"

namespace adit::ros {
namespace {

std::optional<ScalarType> scalar_type(uint8_t datatype) {
  constexpr std::array kTypes = {ScalarType::i8,  ScalarType::u8,  ScalarType::i16,
                                 ScalarType::u16, ScalarType::i32, ScalarType::u32,
                                 ScalarType::f32, ScalarType::f64};
  if (datatype < 1 || datatype > kTypes.size()) {
    return std::nullopt;
  }
  return kTypes[datatype - 1U];
}

/// Throws CodecError unless the points lie within the data.
void check_layout(const PointCloud2& cloud) {
  const uint64_t row = uint64_t{cloud.width} * cloud.point_step;
  if (row > cloud.row_step && cloud.height > 1) {
    throw CodecError("its rows of " + std::to_string(cloud.width) + " points of " +
                     std::to_string(cloud.point_step) + " bytes do not fit into its row_step of " +
                     std::to_string(cloud.row_step) + " bytes");
  }
  const uint64_t step = cloud.height > 1 ? cloud.row_step : row;
  // The last row need not be padded.
  const uint64_t needed = cloud.height == 0 ? 0 : step * (cloud.height - 1) + row;
  if (needed > cloud.data.size()) {
    throw CodecError("it should have " + std::to_string(cloud.width) + " x " +
                     std::to_string(cloud.height) + " points, " + std::to_string(needed) +
                     " bytes, and has " + std::to_string(cloud.data.size()));
  }
}

/// The rows one behind the other, where there is room between them.
std::vector<std::byte> without_row_padding(const PointCloud2& cloud) {
  const std::size_t row = std::size_t{cloud.width} * cloud.point_step;
  std::vector<std::byte> packed;
  packed.reserve(row * cloud.height);
  for (std::size_t i = 0; i < cloud.height; ++i) {
    const std::span<const std::byte> one = cloud.data.subspan(i * cloud.row_step, row);
    packed.insert(packed.end(), one.begin(), one.end());
  }
  return packed;
}

CloudColumns find_columns(const PointCloud2& cloud, const std::byte* data) {
  std::vector<std::string_view> names;
  for (const PointField& field : cloud.fields) {
    names.emplace_back(field.name);
  }
  const FieldRoles roles = find_roles(names);
  CloudColumns columns;
  columns.points = std::size_t{cloud.width} * cloud.height;
  for (std::size_t role = 0; role < kFieldRoles; ++role) {
    if (roles.index[role] < 0) {
      continue;
    }
    const PointField& field = cloud.fields[static_cast<std::size_t>(roles.index[role])];
    const std::optional<ScalarType> type = scalar_type(field.datatype);
    if (!type) {
      throw CodecError("its field '" + field.name + "' has the datatype " +
                       std::to_string(field.datatype) + "; 1 to 8 are known");
    }
    if (role == static_cast<std::size_t>(FieldRole::doppler) && field.count > 1) {
      continue;  // a velocity in space, not along the ray
    }
    if (uint64_t{field.offset} + size_of(*type) > cloud.point_step) {
      throw CodecError("its field '" + field.name + "' lies at byte " +
                       std::to_string(field.offset) + " of points of " +
                       std::to_string(cloud.point_step) + " bytes");
    }
    columns.columns[role] = Column{.data = data,
                                   .offset = field.offset,
                                   .stride = cloud.point_step,
                                   .type = *type,
                                   .swap_bytes = cloud.is_bigendian};
  }
  if (const int time = roles[FieldRole::time]; time >= 0) {
    columns.time_field = cloud.fields[static_cast<std::size_t>(time)].name;
  }
  for (const FieldRole role : {FieldRole::x, FieldRole::y, FieldRole::z}) {
    if (!columns[role]) {
      throw CodecError("it lacks one of the fields x, y and z");
    }
  }
  return columns;
}

}  // namespace

CloudFile to_sweep(const PointCloud2& cloud, Nanoseconds stamp, const std::filesystem::path& file,
                   const CloudReading& reading) {
  check_layout(cloud);
  const bool padded =
      cloud.height > 1 && cloud.row_step != uint64_t{cloud.width} * cloud.point_step;
  const std::vector<std::byte> packed =
      padded ? without_row_padding(cloud) : std::vector<std::byte>{};
  CloudColumns columns = find_columns(cloud, padded ? packed.data() : cloud.data.data());
  columns.reading = reading;
  CloudFile decoded = decode_cloud(file, columns);
  if (!decoded.absolute_stamp) {
    decoded.sweep.stamp += stamp;
    decoded.absolute_stamp = true;
  }
  return decoded;
}

CloudFile to_sweep(const LivoxCustomMsg& message, Nanoseconds stamp) {
  constexpr uint8_t kConfidence = 0x30;
  constexpr uint8_t kGood = 0x00;
  constexpr uint8_t kFair = 0x10;
  Sweep sweep;
  uint32_t first = std::numeric_limits<uint32_t>::max();
  std::vector<uint32_t> offsets;
  for (const LivoxPoint& point : message.points) {
    const uint8_t confidence = point.tag & kConfidence;
    if (confidence == kGood || confidence == kFair) {
      sweep.points.push_back({point.x, point.y, point.z, static_cast<float>(point.reflectivity)});
      sweep.rings.push_back(point.line);
      offsets.push_back(point.offset_time);
      first = std::min(first, point.offset_time);
    }
  }
  for (const uint32_t offset : offsets) {
    sweep.times.push_back(static_cast<float>(1e-9 * (offset - first)));
  }
  const bool has_base =
      message.timebase != 0 &&
      message.timebase <= static_cast<uint64_t>(std::numeric_limits<int64_t>::max() / 2);
  sweep.stamp = has_base ? Nanoseconds(static_cast<int64_t>(message.timebase)) : stamp;
  if (!offsets.empty()) {
    sweep.stamp += Nanoseconds(first);
  }
  return {std::move(sweep), true, PointTimeNature{.field = "offset_time", .unit = 1e-9}};
}

CloudFile to_sweep(const VelodyneScan& scan, Nanoseconds stamp) {
  constexpr double kMostSeconds = 2.0;  // time in a message, from the first point on
  const PacketSensor sensor{.name = {}, .kind = PacketSensor::Kind::velodyne};
  PacketOrder<Datagram> order;
  for (const VelodynePacket& packet : scan.packets) {
    const Datagram datagram{.received = packet.stamp,
                            .payload = std::as_bytes(std::span(packet.data))};
    if (const std::optional<PacketPlace> place = place_of(datagram, sensor)) {
      order.add(datagram, *place);
    }
  }
  VelodyneSweeps sweeps;
  std::vector<Sweep> parts;  // a message need not begin where a turn does
  while (const std::optional<Datagram> datagram = order.next(true)) {
    std::ranges::move(sweeps.take(*datagram), std::back_inserter(parts));
  }
  if (std::optional<Sweep> last = sweeps.finish()) {
    parts.push_back(std::move(*last));
  }
  if (parts.empty()) {
    throw CodecError("none of its " + std::to_string(scan.packets.size()) +
                     " packets is of a Velodyne that is read");
  }
  Sweep sweep;
  for (const Sweep& part : parts) {
    const double after = seconds(part.stamp - parts.front().stamp);
    if (after < 0.0 || after > kMostSeconds) {
      throw CodecError("its packets are " + std::to_string(after) +
                       " s apart by the sensor's clock");
    }
    sweep.points.insert(sweep.points.end(), part.points.begin(), part.points.end());
    sweep.rings.insert(sweep.rings.end(), part.rings.begin(), part.rings.end());
    for (const float time : part.times) {
      sweep.times.push_back(time + static_cast<float>(after));
    }
  }
  const Nanoseconds first = scan.packets.front().stamp;
  sweep.stamp = first > Nanoseconds(0) ? first : stamp;
  const bool timed = !sweep.times.empty();
  return {
      std::move(sweep), true,
      timed ? std::optional(PointTimeNature{.field = "packet time", .unit = 1e-6}) : std::nullopt};
}

CloudMessage to_cloud(const Sweep& sweep, const std::string& frame, bool with_intensity) {
  constexpr uint8_t kUint16 = 4;
  constexpr uint8_t kUint32 = 6;
  constexpr uint8_t kFloat32 = 7;
  // More than a second in seconds would look like milliseconds to who tells units from the spread.
  constexpr float kMostNanoseconds = 4.2F;  // s, in 32 bits
  const float last = sweep.times.empty() ? 0.0F : *std::ranges::max_element(sweep.times);
  const bool slow = last > 1.0F && last < kMostNanoseconds;
  CloudMessage cloud;
  PointCloud2& message = cloud.message;
  message.header = {.sequence = 0, .stamp = sweep.stamp, .frame = frame};
  message.width = static_cast<uint32_t>(sweep.points.size());
  for (const char* name : {"x", "y", "z", "intensity"}) {
    if (!with_intensity && message.fields.size() == 3) {
      break;
    }
    message.fields.push_back({name, message.point_step, kFloat32, 1});
    message.point_step += 4;
  }
  const uint32_t ring_at = message.point_step;
  if (!sweep.rings.empty()) {
    message.fields.push_back({"ring", ring_at, kUint16, 1});
    message.point_step += 2;
  }
  const uint32_t time_at = message.point_step;
  if (!sweep.times.empty()) {
    message.fields.push_back({slow ? "t" : "time", time_at, slow ? kUint32 : kFloat32, 1});
    message.point_step += 4;
  }
  const uint32_t doppler_at = message.point_step;
  if (!sweep.doppler.empty()) {
    message.fields.push_back({"doppler", doppler_at, kFloat32, 1});
    message.point_step += 4;
  }
  message.row_step = message.width * message.point_step;
  cloud.data.resize(message.row_step);
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    std::byte* at = cloud.data.data() + i * message.point_step;
    std::memcpy(at, &sweep.points[i], ring_at);  // x y z, and intensity behind them
    if (!sweep.rings.empty()) {
      std::memcpy(at + ring_at, &sweep.rings[i], sizeof(uint16_t));
    }
    if (!sweep.times.empty() && slow) {
      const auto nanoseconds =
          static_cast<uint32_t>(std::llround(1e9 * static_cast<double>(sweep.times[i])));
      std::memcpy(at + time_at, &nanoseconds, sizeof nanoseconds);
    } else if (!sweep.times.empty()) {
      std::memcpy(at + time_at, &sweep.times[i], sizeof(float));
    }
    if (!sweep.doppler.empty()) {
      std::memcpy(at + doppler_at, &sweep.doppler[i], sizeof(float));
    }
  }
  message.data = cloud.data;
  return cloud;
}

}  // namespace adit::ros
