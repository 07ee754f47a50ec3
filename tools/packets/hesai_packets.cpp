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

/// By the return mode: those of two returns are numbered from 0x39 on, one of them has three.
std::size_t returns_by_mode(std::span<const std::byte> payload, std::size_t mode_at) {
  constexpr unsigned kDual = 0x39;
  constexpr unsigned kTriple = 0x3d;
  const unsigned mode = load<uint8_t>(payload, mode_at);
  return mode == kTriple ? 3 : mode >= kDual ? 2 : 1;
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
  // The XT32M2X is told by its packets of 6 blocks; those of the PandarXT have 8.
  const bool medium = packet.lasers == 32 && packet.blocks == 6;
  packet.model = medium ? "XT32M2X" : "PandarXT-" + std::to_string(packet.lasers);
  packet.motor_at = tail + 11;
  packet.utc_at = tail + 13;
  packet.time_at = tail + 19;
  packet.returns = returns_by_mode(payload, tail + 10);
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
  packet.returns = returns_by_mode(payload, tail + 12);
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
  packet.returns = returns_by_mode(payload, tail + 14);
  return packet;
}

/// Protocol 3.1: PandarQT64, with or without a sequence number at the end.
std::optional<HesaiPacket> qt64_packet(std::span<const std::byte> payload) {
  HesaiPacket packet{.model = "PandarQT64",
                     .lasers = load<uint8_t>(payload, 6),
                     .blocks = load<uint8_t>(payload, 7),
                     .block_at = 12,
                     .channel_bytes = 4,
                     .range_unit = 1e-3 * load<uint8_t>(payload, 9)};
  const std::size_t tail = packet.block_at + packet.blocks * packet.block_bytes();
  constexpr std::size_t kTail = 24;
  if (!is_sensible(packet) ||
      (payload.size() != tail + kTail && payload.size() != tail + kTail + 4)) {
    return std::nullopt;
  }
  packet.motor_at = tail + 10;
  packet.time_at = tail + 12;
  packet.utc_at = tail + 18;
  packet.returns = returns_by_mode(payload, tail + 16);
  return packet;
}

/// Protocol 3.2: QT128C2X. Behind the blocks: a checksum (4 bytes), functional safety (17, by the
/// flags), the tail (26), then a sequence number (4) and a signature (32), by the flags, and
/// another checksum. A channel's fourth byte is there in all of the manual's packets, but not in
/// all that the maker's SDK knows: the length decides.
std::optional<HesaiPacket> qt128_packet(std::span<const std::byte> payload) {
  const unsigned flags = load<uint8_t>(payload, 11);
  const std::size_t safety = (flags & 0x04U) != 0 ? 17 : 0;
  for (const std::size_t channel_bytes : {4U, 3U}) {
    HesaiPacket packet{.model = "QT128C2X",
                       .lasers = load<uint8_t>(payload, 6),
                       .blocks = load<uint8_t>(payload, 7),
                       .block_at = 12,
                       .channel_bytes = channel_bytes,
                       .range_unit = 1e-3 * load<uint8_t>(payload, 9)};
    const std::size_t tail = packet.block_at + packet.blocks * packet.block_bytes() + 4 + safety;
    constexpr std::size_t kTail = 26;
    const std::size_t rest = payload.size() - std::min(payload.size(), tail + kTail);
    const bool fits = payload.size() >= tail + kTail &&
                      (rest % 32 == 0 || rest % 32 == 4 || rest % 32 == 8) && rest <= 40;
    if (is_sensible(packet) && fits) {
      packet.motor_at = tail + 13;
      packet.utc_at = tail + 15;
      packet.time_at = tail + 21;
      packet.returns = returns_by_mode(payload, tail + 12);
      packet.second_sequence = packet.returns > 1 && (load<uint8_t>(payload, tail + 5) & 1U) == 0;
      return packet;
    }
  }
  return std::nullopt;
}

/// Pandar40P, which has no header: ten blocks that begin with FF EE, with or without a sequence
/// number at the end.
std::optional<HesaiPacket> pandar40p_packet(std::span<const std::byte> payload) {
  constexpr std::size_t kTail = 22;
  HesaiPacket packet{.model = "Pandar40P",
                     .lasers = 40,
                     .blocks = 10,
                     .block_at = 2,
                     .block_gap = 2,
                     .channel_bytes = 3,
                     .range_unit = 4e-3};
  const std::size_t tail = packet.blocks * packet.block_bytes();
  if (payload.size() != tail + kTail && payload.size() != tail + kTail + 4) {
    return std::nullopt;
  }
  for (std::size_t block = 0; block < packet.blocks; ++block) {
    if (load<uint16_t>(payload, block * packet.block_bytes()) != 0xeeff) {
      return std::nullopt;
    }
  }
  packet.motor_at = tail + 8;
  packet.time_at = tail + 10;
  packet.utc_at = tail + 16;
  packet.returns = returns_by_mode(payload, tail + 14);
  return packet;
}

/// Whichever it is, by its first bytes.
std::optional<HesaiPacket> any_packet(std::span<const std::byte> payload) {
  constexpr uint16_t kBegin = 0xffee;       // EE FF
  constexpr uint16_t kBlockBegin = 0xeeff;  // FF EE
  if (payload.size() < 24) {
    return std::nullopt;
  }
  const unsigned begin = load<uint16_t>(payload, 0);
  if (begin != kBegin) {
    return begin == kBlockBegin ? pandar40p_packet(payload) : std::nullopt;
  }
  switch (load<uint8_t>(payload, 2) * 16U + load<uint8_t>(payload, 3)) {  // version
    case 0x61:
      return xt_packet(payload);
    case 0x14:
      return ot_packet(payload);
    case 0x31:
      return qt64_packet(payload);
    case 0x32:
      return qt128_packet(payload);
    default:
      return pandar64_packet(payload);
  }
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

/// s after the packet's own time that a block begins.
double block_time(const HesaiPacket& packet, std::size_t block, double azimuth, double last_azimuth,
                  double turns_per_s) {
  if (packet.times != nullptr) {
    const HesaiBlocks& blocks = packet.times->blocks;
    const std::size_t number = block / packet.returns;
    const std::size_t last = (packet.blocks - 1) / packet.returns;
    return blocks.from_last ? blocks.first - blocks.period * static_cast<double>(last - number)
                            : blocks.first + blocks.period * static_cast<double>(number);
  }
  // Others are as far apart as their azimuths.
  const double behind = std::fmod(last_azimuth - azimuth + 360.0, 360.0);
  return turns_per_s > 0.0 && behind < 10.0 ? -behind / (360.0 * turns_per_s) : 0.0;
}

/// s after the begin of a block, by channel; null where lasers fire together.
const std::vector<double>* firing_of(const HesaiPacket& packet, std::size_t block) {
  if (packet.times == nullptr) {
    return nullptr;
  }
  const bool alternate = !packet.times->firing[1].empty();
  const bool second = packet.returns > 1 ? packet.second_sequence : block % 2 == 1;
  return &packet.times->firing.at(alternate && second ? 1 : 0);
}

/// Turns a minute, or tenths of them, by the model; 200 a second there are none.
double turns_of(std::span<const std::byte> payload, const HesaiPacket& packet) {
  const double motor = load<uint16_t>(payload, packet.motor_at);
  return motor < 2000.0 ? motor / 60.0 : motor / 600.0;
}

/// True where an earlier block of the same firing has the same range.
bool is_repeated_return(std::span<const std::byte> payload, const HesaiPacket& packet,
                        std::size_t block, std::size_t channel) {
  for (std::size_t back = 1; back <= block % packet.returns; ++back) {
    if (load<uint16_t>(payload, channel) ==
        load<uint16_t>(payload, channel - back * packet.block_bytes())) {
      return true;
    }
  }
  return false;
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
  std::optional<HesaiPacket> packet =
      datagram.missing == 0 ? any_packet(datagram.payload) : std::nullopt;
  if (packet) {
    packet->times = find_hesai_model(packet->model);
  }
  return packet;
}

std::optional<HesaiAngles> hesai_angles_by_design(const HesaiPacket& packet) {
  const HesaiModel* model = find_hesai_model(packet.model);
  return model != nullptr && model->design.elevations.size() == packet.lasers
             ? std::optional(model->design)
             : std::nullopt;
}

Nanoseconds hesai_time(const HesaiPacket& packet, const Datagram& datagram) {
  const uint32_t microseconds =
      std::min<uint32_t>(load<uint32_t>(datagram.payload, packet.time_at), 2'000'000);
  return second_of(datagram.payload, packet.utc_at, datagram.received) +
         std::chrono::microseconds(microseconds);
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
  const std::vector<double>* firing = firing_of(packet, block);
  const bool turns_on = firing != nullptr && packet.times->azimuth_read.has_value();
  const double read = turns_on ? *packet.times->azimuth_read : 0.0;
  const double rate = turns_on ? 360.0 * turns_of(payload, packet) : 0.0;  // degrees/s
  const std::size_t lasers = std::min(packet.lasers, angles_.elevations.size());
  for (std::size_t i = 0; i < lasers; ++i) {
    const std::size_t channel = at + 2 + i * packet.channel_bytes;
    const unsigned range = load<uint16_t>(payload, channel);
    if (range == 0 || is_repeated_return(payload, packet, block, channel)) {
      continue;
    }
    const double within = firing != nullptr && i < firing->size() ? (*firing)[i] : 0.0;
    const double turned = rate * (within - read);
    const double angle = (azimuth + angles_.azimuths[i] + turned) * kDegree;
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
  const Nanoseconds packet_time = hesai_time(*packet, datagram);
  const double turns = turns_of(payload, *packet);
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
        (azimuth + 180.0 < last_azimuth_ || since < 0.0 || since > seconds(kLongestTurn))) {
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
