// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/ouster_packets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "adit/slam/core/units.hpp"
#include "adit/tools/packets/packet_bytes.hpp"

namespace adit {
namespace {

constexpr std::size_t kImuPacketBytes = 48;

/// Nanoseconds of the sensor's clock; times that no clock shows become the latest.
Nanoseconds time_of(uint64_t nanoseconds) {
  constexpr auto kLatest = static_cast<uint64_t>(std::numeric_limits<int64_t>::max() / 4);
  return Nanoseconds(static_cast<int64_t>(std::min(nanoseconds, kLatest)));
}

/// The head of a column.
struct Column {
  Nanoseconds time{0};
  std::size_t index = 0;  ///< within the turn
  unsigned frame = 0;
  bool valid = false;
  std::span<const std::byte> pixels;
};

/// Nothing where the packet was not captured that far.
std::optional<Column> column_of(std::span<const std::byte> packet, std::size_t i,
                                const OusterSensor& sensor) {
  constexpr std::size_t kPacketHeader = 32;
  const bool legacy = sensor.profile == OusterProfile::legacy;
  const std::size_t at = (legacy ? 0 : kPacketHeader) + i * sensor.column_bytes();
  if (at + sensor.column_bytes() > packet.size()) {
    return std::nullopt;
  }
  const auto column = packet.subspan(at, sensor.column_bytes());
  if (legacy) {
    // The sensor tells the frame in every column; packets that ouster-sdk writes, in the first.
    return Column{.time = time_of(load<uint64_t>(column, 0)),
                  .index = load<uint16_t>(column, 8),
                  .frame = load<uint16_t>(packet, 10),
                  .valid = load<uint32_t>(column, column.size() - 4) == 0xffffffffU,
                  .pixels = column.subspan(16, 12 * sensor.beams)};
  }
  return Column{.time = time_of(load<uint64_t>(column, 0)),
                .index = load<uint16_t>(column, 8),
                .frame = sensor.fusa_header ? load<uint32_t>(packet, 4) : load<uint16_t>(packet, 2),
                .valid = (load<uint16_t>(column, 10) & 1U) != 0,
                .pixels = column.subspan(12)};
}

}  // namespace

bool is_ouster_data(const Datagram& datagram, const OusterSensor& sensor) {
  if (datagram.sent() != sensor.packet_bytes() || datagram.payload.size() < 2) {
    return false;
  }
  return sensor.profile == OusterProfile::legacy ||
         (sensor.fusa_header ? load<uint8_t>(datagram.payload, 0) == 1
                             : load<uint16_t>(datagram.payload, 0) == 1);
}

bool is_ouster_imu(const Datagram& datagram) {
  return datagram.payload.size() == kImuPacketBytes && datagram.missing == 0;
}

std::optional<Nanoseconds> ouster_time(const Datagram& datagram, const OusterSensor& sensor) {
  for (std::size_t i = 0; i < sensor.columns_per_packet; ++i) {
    const std::optional<Column> column = column_of(datagram.payload, i, sensor);
    if (column && column->valid && column->index < sensor.columns) {
      return column->time;
    }
  }
  return std::nullopt;
}

OusterSweeps::OusterSweeps(const OusterSensor& sensor, bool points)
    : sensor_(&sensor), pixel_(pixel_of(sensor.profile)), points_(points) {}

void OusterSweeps::add_column(std::span<const std::byte> pixels, std::size_t column,
                              Nanoseconds time) {
  const double encoder =
      2.0 * std::numbers::pi *
      (1.0 - static_cast<double>(column) / static_cast<double>(sensor_->columns));
  const auto after = static_cast<float>(std::max(0.0, seconds(time - sweep_->stamp)));
  for (std::size_t beam = 0; beam < sensor_->beams; ++beam) {
    const std::span<const std::byte> pixel = pixels.subspan(pixel_.bytes * beam, pixel_.bytes);
    std::optional<uint32_t> first;
    for (const OusterReturn& one : pixel_.returns) {
      const uint32_t range = load<uint32_t>(pixel, one.range_at) & pixel_.range_mask;
      if (first && (range == 0 || range == *first)) {
        continue;  // a second return is only reported where it is another one
      }
      first = range;
      Point point = point_of(pixel_.range_unit * range, encoder, beam);
      if (range != 0) {
        point.intensity = one.intensity_bytes == 1
                              ? static_cast<float>(load<uint8_t>(pixel, one.intensity_at))
                              : static_cast<float>(load<uint16_t>(pixel, one.intensity_at));
      }
      sweep_->points.push_back(point);
      sweep_->times.push_back(after);
      sweep_->rings.push_back(static_cast<uint16_t>(beam));
    }
  }
}

/// A return at `range` m of a beam, while the encoder stands at `encoder` rad.
Point OusterSweeps::point_of(double range, double encoder, std::size_t beam) const {
  if (range <= 0.0) {
    return {};
  }
  const double from_origin = range - sensor_->beam_origin;
  const double altitude = sensor_->beam_altitudes[beam];
  const double azimuth = encoder - sensor_->beam_azimuths[beam];
  const double flat = from_origin * std::cos(altitude);
  return {static_cast<float>(flat * std::cos(azimuth) + sensor_->beam_origin * std::cos(encoder)),
          static_cast<float>(flat * std::sin(azimuth) + sensor_->beam_origin * std::sin(encoder)),
          static_cast<float>(from_origin * std::sin(altitude)), 0.0F};
}

std::vector<Sweep> OusterSweeps::take(const Datagram& datagram) {
  std::vector<Sweep> whole;
  for (std::size_t i = 0; i < sensor_->columns_per_packet; ++i) {
    const std::optional<Column> column = column_of(datagram.payload, i, *sensor_);
    if (!column || !column->valid || column->index >= sensor_->columns) {
      continue;
    }
    const bool anew = sweep_ && (column->frame != frame_ || column->time < sweep_->stamp ||
                                 column->time - sweep_->stamp > kLongestTurn);
    if (anew) {
      whole.push_back(std::move(*sweep_));
      sweep_.reset();
    }
    if (!sweep_) {
      sweep_.emplace();
      sweep_->stamp = column->time;
      frame_ = column->frame;
    }
    if (points_) {
      add_column(column->pixels, column->index, column->time);
    }
  }
  return whole;
}

std::optional<Sweep> OusterSweeps::finish() {
  return std::exchange(sweep_, std::nullopt);
}

ImuSample ouster_imu(const Datagram& datagram) {
  const auto vector = [&](std::size_t at) {
    return Eigen::Vector3d(static_cast<double>(load<float>(datagram.payload, at)),
                           static_cast<double>(load<float>(datagram.payload, at + 4)),
                           static_cast<double>(load<float>(datagram.payload, at + 8)));
  };
  return {.stamp = time_of(load<uint64_t>(datagram.payload, 16)),
          .angular_velocity = vector(36) * kDegree,
          .linear_acceleration = vector(24) * kStandardGravity};
}

}  // namespace adit
