// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Packets of the sensors whose blocks differ from those of packet_support.hpp, as the tests need
// them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "adit/tests/recordings/packet_support.hpp"

namespace adit::test {

/// Three firing sequences of a VLS-128 from azimuth `first` (degrees) on, or with dual returns one;
/// range(sequence, laser, return) in steps of 4 mm. The reflectivity is the laser's number.
template <class Range>
Bytes vls128_packet(double first, double step, uint32_t microseconds, bool dual,
                    const Range& range) {
  constexpr std::array<uint16_t, 4> kFlags = {0xeeff, 0xddff, 0xccff, 0xbbff};
  Bytes packet(1206);
  const std::size_t returns = dual ? 2 : 1;
  for (std::size_t block = 0; block < (dual ? 8 : 12); ++block) {
    const std::size_t bank = block / returns % 4;
    const std::size_t sequence = block / returns / 4;
    const double azimuth = std::fmod(first + step * static_cast<double>(sequence), 360.0);
    put(packet, 100 * block, kFlags.at(bank));
    put(packet, 100 * block + 2, static_cast<uint16_t>(std::lround(100.0 * azimuth) % 36000));
    for (std::size_t i = 0; i < 32; ++i) {
      const std::size_t laser = 32 * bank + i;
      put(packet, 100 * block + 4 + 3 * i,
          static_cast<uint16_t>(range(sequence, laser, block % returns)));
      packet[100 * block + 6 + 3 * i] = static_cast<std::byte>(laser);
    }
  }
  put(packet, 1200, microseconds);
  packet[1204] = dual ? std::byte{0x39} : std::byte{0x37};
  packet[1205] = std::byte{0xa1};
  return packet;
}

inline void put_date(Bytes& packet) {  // 2023-11-14, 22:13:20
  for (const int value : {23, 11, 14, 22, 13, 20}) {
    packet.push_back(static_cast<std::byte>(value));
  }
}

/// Blocks of an azimuth (degrees) and, for each laser, a range (range(block, laser), in steps of
/// 4 mm) and a reflectivity (the laser's number), `begin` before each.
template <class Range>
void put_blocks(Bytes& packet, const std::vector<double>& azimuths, std::size_t lasers,
                const Bytes& begin, std::size_t channel_bytes, const Range& range) {
  for (std::size_t block = 0; block < azimuths.size(); ++block) {
    append(packet, begin);
    put(packet, packet.size(), static_cast<uint16_t>(std::lround(100.0 * azimuths[block])));
    for (std::size_t laser = 0; laser < lasers; ++laser) {
      put(packet, packet.size(), static_cast<uint16_t>(range(block, laser)));
      packet.push_back(static_cast<std::byte>(laser));
      packet.resize(packet.size() + channel_bytes - 3);
    }
  }
}

/// A Pandar40P at 600 turns a minute; ten azimuths.
template <class Range>
Bytes pandar40p_packet(const std::vector<double>& azimuths, uint32_t microseconds, uint8_t mode,
                       bool sequence, const Range& range) {
  Bytes packet;
  put_blocks(packet, azimuths, 40, {std::byte{0xff}, std::byte{0xee}}, 3, range);
  packet.resize(packet.size() + 8);
  put(packet, packet.size(), uint16_t{600});
  put(packet, packet.size(), microseconds);
  packet.push_back(std::byte{mode});
  packet.push_back(std::byte{0x42});
  put_date(packet);
  packet.resize(packet.size() + (sequence ? 4 : 0));
  return packet;
}

inline Bytes hesai_head(uint8_t major, uint8_t minor, uint8_t lasers, std::size_t blocks,
                        uint8_t flags) {
  Bytes head;
  for (const uint8_t value :
       {uint8_t{0xee}, uint8_t{0xff}, major, minor, uint8_t{0}, uint8_t{0}, lasers,
        static_cast<uint8_t>(blocks), uint8_t{0}, uint8_t{4}, uint8_t{1}, flags}) {
    head.push_back(std::byte{value});
  }
  return head;
}

/// A PandarQT64 at 600 turns a minute; four azimuths.
template <class Range>
Bytes qt64_packet(const std::vector<double>& azimuths, uint32_t microseconds, uint8_t mode,
                  const Range& range, uint8_t lasers = 64) {
  Bytes packet = hesai_head(3, 1, lasers, azimuths.size(), 1);
  put_blocks(packet, azimuths, lasers, {}, 4, range);
  packet.resize(packet.size() + 10);
  put(packet, packet.size(), uint16_t{600});
  put(packet, packet.size(), microseconds);
  packet.push_back(std::byte{mode});
  packet.push_back(std::byte{0x42});
  put_date(packet);
  packet.resize(packet.size() + 4);  // sequence number
  return packet;
}

/// What follows the blocks of a QT128C2X, and how long its channels are.
struct Qt128Layout {
  uint8_t flags = 0x0f;  ///< sequence number, functional safety, signature
  std::size_t channel_bytes = 4;
  uint8_t mode = 0x37;
  uint8_t mode_flag = 1;
  uint8_t lasers = 128;
};

/// A QT128C2X at 600 turns a minute; two azimuths.
template <class Range>
Bytes qt128_packet(const Qt128Layout& layout, const std::vector<double>& azimuths,
                   uint32_t microseconds, const Range& range) {
  Bytes packet = hesai_head(3, 2, layout.lasers, azimuths.size(), layout.flags);
  put_blocks(packet, azimuths, layout.lasers, {}, layout.channel_bytes, range);
  packet.resize(packet.size() + 4 + ((layout.flags & 4U) != 0 ? 17 : 0) + 5);
  packet.push_back(std::byte{layout.mode_flag});
  packet.resize(packet.size() + 6);
  packet.push_back(std::byte{layout.mode});
  put(packet, packet.size(), uint16_t{600});
  put_date(packet);
  put(packet, packet.size(), microseconds);
  packet.push_back(std::byte{0x42});
  packet.resize(packet.size() + ((layout.flags & 1U) != 0 ? 4 : 0) + 4 +
                ((layout.flags & 8U) != 0 ? 32 : 0));
  return packet;
}

}  // namespace adit::test
