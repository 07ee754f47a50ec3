// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/hesai_packets.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "adit/slam/core/units.hpp"
#include "adit/tools/packets/packet_bytes.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

constexpr std::size_t kMostLasers = 128;
constexpr std::size_t kMostBlocks = 16;
constexpr unsigned kDualReturns = 0x39;

/// Modes from two returns on are numbered from 0x39.
bool is_dual(std::span<const std::byte> payload, std::size_t mode_at) {
  return load<uint8_t>(payload, mode_at) >= kDualReturns;
}

bool is_sensible(const HesaiPacket& packet) {
  return packet.lasers >= 1 && packet.lasers <= kMostLasers && packet.blocks >= 1 &&
         packet.blocks <= kMostBlocks && packet.range_unit > 0.0;
}

/// Protocol 6.1: XT.
std::optional<HesaiPacket> xt_packet(std::span<const std::byte> payload) {
  HesaiPacket packet{.lasers = load<uint8_t>(payload, 6),
                     .blocks = load<uint8_t>(payload, 7),
                     .block_at = 12,
                     .channel_bytes = 4,
                     .range_unit = 1e-3 * load<uint8_t>(payload, 9)};
  const std::size_t tail = packet.block_at + packet.blocks * packet.block_bytes();
  constexpr std::size_t kTail = 28;
  if (!is_sensible(packet) || payload.size() != tail + kTail) {
    return std::nullopt;
  }
  packet.model = "PandarXT-" + std::to_string(packet.lasers);
  packet.motor_at = tail + 11;
  packet.utc_at = tail + 13;
  packet.time_at = tail + 19;
  packet.dual = is_dual(payload, tail + 10);
  return packet;
}

/// Protocol 1.4: OT128, Pandar128. What follows the tail is of no interest.
std::optional<HesaiPacket> ot_packet(std::span<const std::byte> payload) {
  const unsigned flags = load<uint8_t>(payload, 11);
  constexpr unsigned kFunctionalSafety = 0x04;
  constexpr unsigned kMoreOfAChannel = 0x70;  // confidence, weight, ambient light: a byte each
  HesaiPacket packet{
      .lasers = load<uint8_t>(payload, 6),
      .blocks = load<uint8_t>(payload, 7),
      .block_at = 12,
      .channel_bytes = static_cast<std::size_t>(3 + std::popcount(flags & kMoreOfAChannel)),
      .range_unit = 1e-3 * load<uint8_t>(payload, 9)};
  const std::size_t body = packet.block_at + packet.blocks * packet.block_bytes();
  const std::size_t tail = body + 4 + ((flags & kFunctionalSafety) != 0 ? 17U : 0U);
  constexpr std::size_t kTail = 26;
  if (!is_sensible(packet) || payload.size() < tail + kTail) {
    return std::nullopt;
  }
  packet.model = "OT128 or Pandar128";
  packet.motor_at = tail + 13;
  packet.utc_at = tail + 15;
  packet.time_at = tail + 21;
  packet.dual = is_dual(payload, tail + 12);
  return packet;
}

/// Pandar64, with or without a sequence number at the end.
std::optional<HesaiPacket> pandar64_packet(std::span<const std::byte> payload) {
  HesaiPacket packet{.lasers = load<uint8_t>(payload, 2),
                     .blocks = load<uint8_t>(payload, 3),
                     .block_at = 8,
                     .channel_bytes = 3,
                     .range_unit = 1e-3 * load<uint8_t>(payload, 5)};
  const std::size_t tail = packet.block_at + packet.blocks * packet.block_bytes();
  constexpr std::size_t kTail = 22;
  if (!is_sensible(packet) ||
      (payload.size() != tail + kTail && payload.size() != tail + kTail + 4)) {
    return std::nullopt;
  }
  packet.model = "Pandar" + std::to_string(packet.lasers);
  packet.motor_at = tail + 8;
  packet.time_at = tail + 10;
  packet.utc_at = tail + 16;
  packet.dual = is_dual(payload, tail + 14);
  return packet;
}

/// The second by the packet's calendar (year since 2000 or 1900), or by its seconds since 1970.
Nanoseconds second_of(std::span<const std::byte> payload, std::size_t at, Nanoseconds received) {
  using std::chrono::day, std::chrono::hours, std::chrono::minutes, std::chrono::month;
  using std::chrono::sys_days, std::chrono::year, std::chrono::year_month_day;
  const auto byte = [&](std::size_t i) { return std::to_integer<int>(payload[at + i]); };
  if (byte(0) == 0) {
    const uint32_t since = (static_cast<uint32_t>(byte(2)) << 24U) |
                           (static_cast<uint32_t>(byte(3)) << 16U) |
                           (static_cast<uint32_t>(byte(4)) << 8U) | static_cast<uint32_t>(byte(5));
    return since == 0 ? std::chrono::floor<std::chrono::seconds>(received)
                      : std::chrono::seconds(since);
  }
  const int year_number = byte(0) >= 100 ? 1900 + byte(0) : 2000 + byte(0);
  const year_month_day date{year(year_number), month(static_cast<unsigned>(byte(1))),
                            day(static_cast<unsigned>(byte(2)))};
  if (!date.ok() || byte(3) > 23 || byte(4) > 59 || byte(5) > 60) {
    return std::chrono::floor<std::chrono::seconds>(received);
  }
  return sys_days(date).time_since_epoch() + hours(byte(3)) + minutes(byte(4)) +
         std::chrono::seconds(byte(5));
}

/// s after the packet's own time that a block was fired at: blocks come before it. XT's manual
/// gives 50 µs a firing, the last one 5.632 µs after; others are as far apart as their azimuths.
double block_time(const HesaiPacket& packet, std::size_t block, double azimuth, double last_azimuth,
                  double turns_per_s) {
  if (packet.model.starts_with("PandarXT")) {
    const std::size_t step = packet.dual ? 2 : 1;
    const std::size_t after = (packet.blocks - 1) / step - block / step;
    return 5.632e-6 - 50e-6 * static_cast<double>(after);
  }
  const double behind = std::fmod(last_azimuth - azimuth + 360.0, 360.0);
  return turns_per_s > 0.0 && behind < 10.0 ? -behind / (360.0 * turns_per_s) : 0.0;
}

}  // namespace

HesaiAngles read_hesai_angles(const std::filesystem::path& file) {
  const std::string text = read_text_file(file);
  HesaiAngles angles;
  LineReader lines(text);
  while (auto line = lines.next()) {
    std::string words(*line);
    std::ranges::replace(words, ',', ' ');
    const std::vector<std::string_view> parts = split_words(words);
    const auto channel = parts.size() >= 3 ? parse_unsigned(parts[0]) : std::nullopt;
    if (!channel) {
      continue;  // a head, or a line that tells of the file
    }
    const auto elevation = parse_double(parts[1]);
    const auto azimuth = parse_double(parts[2]);
    if (*channel != angles.elevations.size() + 1 || *channel > kMostLasers || !elevation ||
        !azimuth || !(std::abs(*elevation) <= 90.0) || !(std::abs(*azimuth) <= 360.0)) {
      throw InputError(file, Place::line(lines.number()),
                       "expected channel " + std::to_string(angles.elevations.size() + 1) +
                           ", its elevation and azimuth in degrees",
                       "Save the sensor's angle correction file again");
    }
    angles.elevations.push_back(*elevation);
    angles.azimuths.push_back(*azimuth);
  }
  if (angles.elevations.empty()) {
    throw InputError(file, {}, "it holds no angles of lasers",
                     "Give the sensor's angle correction file: channel, elevation, azimuth");
  }
  return angles;
}

std::optional<HesaiPacket> hesai_packet(const Datagram& datagram) {
  const std::span<const std::byte> payload = datagram.payload;
  constexpr uint16_t kBegin = 0xffee;  // EE FF
  if (payload.size() < 24 || load<uint16_t>(payload, 0) != kBegin) {
    return std::nullopt;
  }
  const unsigned major = load<uint8_t>(payload, 2);
  const unsigned minor = load<uint8_t>(payload, 3);
  if (major == 6 && minor == 1) {
    return xt_packet(payload);
  }
  return major == 1 && minor == 4 ? ot_packet(payload) : pandar64_packet(payload);
}

std::optional<HesaiAngles> hesai_angles_by_design(const HesaiPacket& packet) {
  const bool xt = packet.model.starts_with("PandarXT");
  if (!xt || (packet.lasers != 32 && packet.lasers != 16)) {
    return std::nullopt;
  }
  HesaiAngles angles;
  const double step = packet.lasers == 32 ? 1.0 : 2.0;
  for (std::size_t i = 0; i < packet.lasers; ++i) {
    angles.elevations.push_back(15.0 - step * static_cast<double>(i));
    angles.azimuths.push_back(0.0);
  }
  return angles;
}

HesaiSweeps::HesaiSweeps(HesaiAngles angles, bool points)
    : angles_(std::move(angles)), points_(points) {
  for (const double elevation : angles_.elevations) {
    rings_.push_back(static_cast<uint16_t>(std::ranges::count_if(
        angles_.elevations, [&](double other) { return other < elevation; })));
  }
}

void HesaiSweeps::add_block(std::span<const std::byte> payload, const HesaiPacket& packet,
                            std::size_t block, Nanoseconds time) {
  const std::size_t at = packet.block_at + block * packet.block_bytes();
  const double azimuth = 0.01 * load<uint16_t>(payload, at);
  const double begin = seconds(time - sweep_->stamp);
  const bool xt = packet.model.starts_with("PandarXT");
  const std::size_t lasers = std::min(packet.lasers, angles_.elevations.size());
  for (std::size_t i = 0; i < lasers; ++i) {
    const std::size_t channel = at + 2 + i * packet.channel_bytes;
    const unsigned range = load<uint16_t>(payload, channel);
    const bool other = packet.dual && block % 2 == 1;
    if (range == 0 || (other && range == load<uint16_t>(payload, channel - packet.block_bytes()))) {
      continue;
    }
    // XT's lasers fire 1.512 µs apart; 16 of them, every second of those of 32.
    const double within =
        xt ? 1e-6 * (0.28 + 1.512 * static_cast<double>(packet.lasers == 16 ? 2 * i : i)) : 0.0;
    const double angle = (azimuth + angles_.azimuths[i]) * kDegree;
    const double elevation = angles_.elevations[i] * kDegree;
    const double metres = packet.range_unit * range;
    const double flat = metres * std::cos(elevation);
    sweep_->points.push_back({static_cast<float>(flat * std::sin(angle)),
                              static_cast<float>(flat * std::cos(angle)),
                              static_cast<float>(metres * std::sin(elevation)),
                              static_cast<float>(load<uint8_t>(payload, channel + 2))});
    sweep_->times.push_back(static_cast<float>(std::max(0.0, begin + within)));
    sweep_->rings.push_back(rings_[i]);
  }
}

std::vector<Sweep> HesaiSweeps::take(const Datagram& datagram) {
  std::vector<Sweep> whole;
  const std::optional<HesaiPacket> packet = hesai_packet(datagram);
  if (!packet) {
    return whole;
  }
  const std::span<const std::byte> payload = datagram.payload;
  const auto azimuth_of = [&](std::size_t block) {
    return 0.01 * load<uint16_t>(payload, packet->block_at + block * packet->block_bytes());
  };
  const uint32_t microseconds =
      std::min<uint32_t>(load<uint32_t>(payload, packet->time_at), 2'000'000);
  const Nanoseconds packet_time = second_of(payload, packet->utc_at, datagram.received) +
                                  std::chrono::microseconds(microseconds);
  // Turns a minute, or tenths of them, by the model; 200 a second there are none.
  const double motor = load<uint16_t>(payload, packet->motor_at);
  const double turns = motor < 2000.0 ? motor / 60.0 : motor / 600.0;
  const double last = azimuth_of(packet->blocks - 1);
  for (std::size_t block = 0; block < packet->blocks; ++block) {
    const double azimuth = azimuth_of(block);
    if (azimuth > 360.0) {
      continue;  // damaged
    }
    const Nanoseconds time =
        packet_time + nanoseconds(block_time(*packet, block, azimuth, last, turns));
    const double since = sweep_ ? seconds(time - sweep_->stamp) : 0.0;
    if (sweep_ &&
        (azimuth + 180.0 < last_azimuth_ || since < 0.0 || since > seconds(kLongestSweep))) {
      whole.push_back(std::move(*sweep_));
      sweep_.reset();
    }
    if (!sweep_) {
      sweep_.emplace();
      sweep_->stamp = time;
    }
    last_azimuth_ = azimuth;
    if (points_) {
      add_block(payload, *packet, block, time);
    }
  }
  return whole;
}

std::optional<Sweep> HesaiSweeps::finish() {
  return std::exchange(sweep_, std::nullopt);
}

}  // namespace adit
