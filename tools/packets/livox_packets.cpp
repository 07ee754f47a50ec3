// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/livox_packets.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "adit/slam/core/units.hpp"
#include "adit/tools/packets/packet_bytes.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kPeriod = std::chrono::milliseconds(100);

// The head of a packet (bytes).
constexpr std::size_t kLengthAt = 1;    // 16 bits, of the whole packet
constexpr std::size_t kIntervalAt = 3;  // 16 bits, from the first point to the last, 0.1 µs
constexpr std::size_t kCountAt = 5;     // 16 bits, points
constexpr std::size_t kTypeAt = 10;
constexpr std::size_t kTimeAt = 28;  // 64 bits, ns, of the first point
constexpr std::size_t kHead = 36;

constexpr unsigned kImu = 0;
constexpr unsigned kMillimetres = 1;  // 32-bit coordinates
constexpr unsigned kCentimetres = 2;  // 16-bit coordinates
constexpr std::size_t kImuBytes = 24;

std::size_t point_bytes(unsigned type) {
  return type == kMillimetres ? 14 : type == kCentimetres ? 8 : 0;
}

/// Version 0, and as long as it says.
bool is_packet(const Datagram& datagram) {
  const std::span<const std::byte> packet = datagram.payload;
  return packet.size() > kHead && load<uint8_t>(packet, 0) == 0 &&
         load<uint16_t>(packet, kLengthAt) == datagram.sent();
}

/// Times that no clock shows become the latest.
Nanoseconds time_of(std::span<const std::byte> packet) {
  constexpr auto kLatest = static_cast<uint64_t>(std::numeric_limits<int64_t>::max() / 4);
  return Nanoseconds(static_cast<int64_t>(std::min(load<uint64_t>(packet, kTimeAt), kLatest)));
}

/// The point at `at`, in m, and its tag.
std::pair<Point, unsigned> point_at(std::span<const std::byte> packet, std::size_t at,
                                    unsigned type) {
  const auto read = [&]<class T>(T, double unit) {
    const auto coordinate = [&](std::size_t axis) {
      return static_cast<float>(unit * load<T>(packet, at + axis * sizeof(T)));
    };
    const std::size_t rest = at + 3 * sizeof(T);
    return std::pair<Point, unsigned>{{coordinate(0), coordinate(1), coordinate(2),
                                       static_cast<float>(load<uint8_t>(packet, rest))},
                                      load<uint8_t>(packet, rest + 1)};
  };
  return type == kMillimetres ? read(int32_t{}, 1e-3) : read(int16_t{}, 1e-2);
}

bool is_kept(const Point& p, unsigned tag) {
  constexpr unsigned kConfidence = 0x30;
  constexpr unsigned kFair = 0x10;
  return (tag & kConfidence) <= kFair && (p.x != 0.0F || p.y != 0.0F || p.z != 0.0F);
}

}  // namespace

bool is_livox_data(const Datagram& datagram) {
  const std::span<const std::byte> packet = datagram.payload;
  if (!is_packet(datagram)) {
    return false;
  }
  const std::size_t bytes = point_bytes(load<uint8_t>(packet, kTypeAt));
  const std::size_t count = load<uint16_t>(packet, kCountAt);
  return bytes > 0 && count > 0 && datagram.sent() == kHead + count * bytes;
}

bool is_livox_imu(const Datagram& datagram) {
  return is_packet(datagram) && datagram.payload.size() == kHead + kImuBytes &&
         load<uint8_t>(datagram.payload, kTypeAt) == kImu;
}

Nanoseconds livox_time(const Datagram& datagram) {
  return time_of(datagram.payload);
}

std::vector<Sweep> LivoxSweeps::take(const Datagram& datagram) {
  std::vector<Sweep> whole;
  const std::span<const std::byte> packet = datagram.payload;
  const Nanoseconds time = time_of(packet);
  if (sweep_ && (time < sweep_->stamp || time - sweep_->stamp >= kPeriod)) {
    whole.push_back(std::move(*sweep_));
    sweep_.reset();
  }
  if (!sweep_) {
    sweep_.emplace();
    sweep_->stamp = time;
  }
  if (!points_) {
    return whole;
  }
  const unsigned type = load<uint8_t>(packet, kTypeAt);
  const std::size_t count = load<uint16_t>(packet, kCountAt);
  const double step = 1e-7 * load<uint16_t>(packet, kIntervalAt) / static_cast<double>(count);
  const double begin = seconds(time - sweep_->stamp);
  const std::size_t captured = (packet.size() - kHead) / point_bytes(type);
  for (std::size_t i = 0; i < std::min(count, captured); ++i) {
    const auto [point, tag] = point_at(packet, kHead + i * point_bytes(type), type);
    if (is_kept(point, tag)) {
      sweep_->points.push_back(point);
      sweep_->times.push_back(static_cast<float>(begin + step * static_cast<double>(i)));
    }
  }
  return whole;
}

std::optional<Sweep> LivoxSweeps::finish() {
  return std::exchange(sweep_, std::nullopt);
}

ImuSample livox_imu(const Datagram& datagram) {
  const auto vector = [&](std::size_t at) {
    return Eigen::Vector3d(static_cast<double>(load<float>(datagram.payload, at)),
                           static_cast<double>(load<float>(datagram.payload, at + 4)),
                           static_cast<double>(load<float>(datagram.payload, at + 8)));
  };
  return {.stamp = time_of(datagram.payload),
          .angular_velocity = vector(kHead),
          .linear_acceleration = vector(kHead + 12) * kStandardGravity};
}

}  // namespace adit
