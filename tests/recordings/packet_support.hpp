// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Packets of sensors and captures of them, as the tests need them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit::test {

using Bytes = std::vector<std::byte>;

template <class T>
void put(Bytes& bytes, std::size_t at, T value) {
  bytes.resize(std::max(bytes.size(), at + sizeof(T)));
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

inline void put_network(Bytes& bytes, std::size_t at, uint16_t value) {
  put(bytes, at, static_cast<uint16_t>((value >> 8U) | (value << 8U)));
}

inline void append(Bytes& to, std::span<const std::byte> bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

/// Ethernet frames of a datagram; more than one where it is longer than `most` bytes.
inline std::vector<Bytes> frames_of(std::span<const std::byte> payload, uint16_t port,
                                    std::size_t most = 65000, uint16_t id = 1) {
  Bytes udp(8);
  put_network(udp, 0, 4000);
  put_network(udp, 2, port);
  put_network(udp, 4, static_cast<uint16_t>(8 + payload.size()));
  append(udp, payload);
  std::vector<Bytes> frames;
  for (std::size_t at = 0; at < udp.size(); at += most) {
    const std::size_t size = std::min(most, udp.size() - at);
    const bool more = at + size < udp.size();
    Bytes frame(34);
    put_network(frame, 12, 0x0800);
    frame[14] = std::byte{0x45};
    put_network(frame, 16, static_cast<uint16_t>(20 + size));
    put_network(frame, 18, id);
    put_network(frame, 20, static_cast<uint16_t>((more ? 0x2000U : 0U) | (at / 8)));
    frame[23] = std::byte{17};
    put(frame, 26, uint32_t{0xc9a8010a});
    append(frame, std::span(udp).subspan(at, size));
    frames.push_back(std::move(frame));
  }
  return frames;
}

struct CapturedFrame {
  Nanoseconds received{0};
  Bytes bytes;
};

inline Bytes pcap(const std::vector<CapturedFrame>& frames, bool nanoseconds = true) {
  Bytes file(24);
  put(file, 0, nanoseconds ? uint32_t{0xa1b23c4d} : uint32_t{0xa1b2c3d4});
  put(file, 4, uint32_t{0x00040002});
  put(file, 16, uint32_t{262144});
  put(file, 20, uint32_t{1});
  for (const CapturedFrame& frame : frames) {
    Bytes header(16);
    const int64_t rest = frame.received.count() % 1'000'000'000;
    put(header, 0, static_cast<uint32_t>(frame.received.count() / 1'000'000'000));
    put(header, 4, static_cast<uint32_t>(nanoseconds ? rest : rest / 1000));
    put(header, 8, static_cast<uint32_t>(frame.bytes.size()));
    put(header, 12, static_cast<uint32_t>(frame.bytes.size()));
    append(file, header);
    append(file, frame.bytes);
  }
  return file;
}

inline void append_block(Bytes& file, uint32_t type, Bytes body) {
  body.resize((body.size() + 3) / 4 * 4);
  Bytes block(8);
  put(block, 0, type);
  put(block, 4, static_cast<uint32_t>(body.size() + 12));
  append(block, body);
  put(block, block.size(), static_cast<uint32_t>(body.size() + 12));
  append(file, block);
}

/// With the resolution of nanoseconds.
inline Bytes pcapng(const std::vector<CapturedFrame>& frames) {
  Bytes file;
  Bytes section(16, std::byte{0xff});
  put(section, 0, uint32_t{0x1a2b3c4d});
  put(section, 4, uint32_t{1});
  append_block(file, 0x0a0d0d0a, section);
  Bytes interface(8);
  put(interface, 0, uint16_t{1});
  put(interface, 8, uint16_t{9});
  put(interface, 10, uint16_t{1});
  put(interface, 12, uint32_t{9});
  put(interface, 16, uint32_t{0});
  append_block(file, 1, interface);
  append_block(file, 5, Bytes(12));  // statistics, of no interest
  for (const CapturedFrame& frame : frames) {
    Bytes body(20);
    const auto ticks = static_cast<uint64_t>(frame.received.count());
    put(body, 4, static_cast<uint32_t>(ticks >> 32U));
    put(body, 8, static_cast<uint32_t>(ticks));
    put(body, 12, static_cast<uint32_t>(frame.bytes.size()));
    put(body, 16, static_cast<uint32_t>(frame.bytes.size()));
    append(body, frame.bytes);
    append_block(file, 6, body);
  }
  return file;
}

/// Twelve blocks from azimuth `first` (degrees) on; range and reflectivity of a laser are given by
/// range(block, i) in steps of 2 mm and i.
template <class Range>
Bytes velodyne_packet(double first, double step, uint32_t microseconds, uint8_t mode, uint8_t model,
                      const Range& range) {
  Bytes packet(1206);
  for (std::size_t block = 0; block < 12; ++block) {
    const std::size_t at = 100 * block;
    const std::size_t turn = mode == 0x39 ? block / 2 : block;
    const double azimuth = std::fmod(first + step * static_cast<double>(turn), 360.0);
    put(packet, at, uint16_t{0xeeff});
    put(packet, at + 2, static_cast<uint16_t>(std::lround(100.0 * azimuth) % 36000));
    for (std::size_t i = 0; i < 32; ++i) {
      put(packet, at + 4 + 3 * i, static_cast<uint16_t>(range(block, i)));
      packet[at + 6 + 3 * i] = static_cast<std::byte>(i);
    }
  }
  put(packet, 1200, microseconds);
  packet[1204] = std::byte{mode};
  packet[1205] = std::byte{model};
  return packet;
}

inline Bytes position_packet(const std::string& sentence) {
  Bytes packet(512);
  std::memcpy(packet.data() + 206, sentence.data(), sentence.size());
  return packet;
}

/// Metadata of a sensor with so many beams from +15 degrees down to -15, 32 columns a turn.
inline std::string ouster_metadata(std::size_t beams, const std::string& profile,
                                   bool sections = false) {
  std::string altitudes;
  std::string azimuths;
  for (std::size_t i = 0; i < beams; ++i) {
    const double altitude = 15.0 - 30.0 * static_cast<double>(i) / static_cast<double>(beams - 1);
    altitudes += (i == 0 ? "" : ", ") + std::to_string(altitude);
    azimuths += (i == 0 ? "" : ", ") + std::to_string(i % 2 == 0 ? 2.0 : -2.0);
  }
  const std::string beams_part = "\"beam_altitude_angles\": [" + altitudes +
                                 "], \"beam_azimuth_angles\": [" + azimuths +
                                 "], \"lidar_origin_to_beam_origin_mm\": 15.0";
  const std::string format =
      "\"columns_per_packet\": 16, \"udp_profile_lidar\": \"" + profile + "\"";
  const std::string mode = "\"lidar_mode\": \"32x10\"";
  return sections ? "{\"beam_intrinsics\": {" + beams_part + "}, \"lidar_data_format\": {" +
                        format + "}, \"config_params\": {" + mode + "}}"
                  : "{" + beams_part + ", " + format + ", " + mode + "}";
}

/// Sixteen columns from `first` on, a column every 100 µs; range(column, beam) in mm.
template <class Range>
Bytes ouster_packet(bool legacy, std::size_t beams, std::size_t first, uint16_t frame,
                    uint64_t time, const Range& range) {
  Bytes packet;
  if (!legacy) {
    packet.resize(32);
    put(packet, 0, uint16_t{1});
    put(packet, 2, frame);
  }
  for (std::size_t i = 0; i < 16; ++i) {
    Bytes column;
    put(column, 0, time + 100000 * i);
    put(column, 8, static_cast<uint16_t>(first + i));
    put(column, 10, legacy ? frame : uint16_t{1});
    if (legacy) {
      put(column, 12, static_cast<uint32_t>(88 * (first + i)));
    }
    const std::size_t head = column.size();
    for (std::size_t beam = 0; beam < beams; ++beam) {
      put(column, head + 12 * beam, static_cast<uint32_t>(range(first + i, beam)));
      put(column, head + 12 * beam + 4, uint16_t{50});
      put(column, head + 12 * beam + 6, static_cast<uint16_t>(100 + beam));
      put(column, head + 12 * beam + 8, uint32_t{0});
    }
    if (legacy) {
      put(column, column.size(), uint32_t{0xffffffff});
    }
    append(packet, column);
  }
  if (!legacy) {
    packet.resize(packet.size() + 32);
  }
  return packet;
}

/// The same in any profile but the legacy one: a pixel is `pixel_bytes` long and write(bytes, at,
/// column, beam) fills it in.
template <class Write>
Bytes ouster_profile_packet(std::size_t pixel_bytes, bool fusa, std::size_t beams,
                            std::size_t first, uint32_t frame, uint64_t time, const Write& write) {
  Bytes packet(32);
  packet[0] = std::byte{1};
  if (fusa) {
    put(packet, 4, frame);
  } else {
    put(packet, 2, static_cast<uint16_t>(frame));
  }
  for (std::size_t i = 0; i < 16; ++i) {
    Bytes column(12 + pixel_bytes * beams);
    put(column, 0, time + 100000 * i);
    put(column, 8, static_cast<uint16_t>(first + i));
    put(column, 10, uint16_t{1});
    for (std::size_t beam = 0; beam < beams; ++beam) {
      write(column, 12 + pixel_bytes * beam, first + i, beam);
    }
    append(packet, column);
  }
  packet.resize(packet.size() + 32);
  return packet;
}

/// A packet of a Livox: `points` are x y z in mm, reflectivity and tag; 1 µs apart.
inline Bytes livox_packet(uint64_t time, const std::vector<std::array<int32_t, 5>>& points,
                          bool centimetres = false) {
  Bytes packet(36);
  put(packet, 3, static_cast<uint16_t>(10 * points.size()));
  put(packet, 5, static_cast<uint16_t>(points.size()));
  packet[10] = centimetres ? std::byte{2} : std::byte{1};
  put(packet, 28, time);
  for (const auto& point : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (centimetres) {
        put(packet, packet.size(), static_cast<int16_t>(point[axis] / 10));
      } else {
        put(packet, packet.size(), point[axis]);
      }
    }
    put(packet, packet.size(), static_cast<uint8_t>(point[3]));
    put(packet, packet.size(), static_cast<uint8_t>(point[4]));
  }
  put(packet, 1, static_cast<uint16_t>(packet.size()));
  return packet;
}

inline Bytes livox_imu_packet(uint64_t time) {
  Bytes packet(60);
  put(packet, 1, uint16_t{60});
  put(packet, 5, uint16_t{1});
  put(packet, 28, time);
  const float readings[6] = {0.1F, 0.2F, 0.3F, 0.0F, 0.5F, 1.0F};  // rad/s, g
  std::memcpy(packet.data() + 36, readings, sizeof readings);
  return packet;
}

/// A block for each azimuth (degrees); range(block, laser) in steps of 4 mm. 2023-11-14, 22:13:20
/// and `microseconds`.
struct HesaiLayout {
  bool pandar64 = false;  ///< else protocol `major`.`minor`
  uint8_t major = 6;
  uint8_t minor = 1;
  uint8_t lasers = 32;
  uint8_t mode = 0x37;
  uint8_t flags = 0;     ///< protocol 1.4
  std::size_t more = 0;  ///< bytes of a channel behind its reflectivity
};
template <class Range>
Bytes hesai_packet(const HesaiLayout& layout, const std::vector<double>& azimuths,
                   uint32_t microseconds, const Range& range) {
  const bool xt = layout.major == 6 && !layout.pandar64;
  Bytes packet{std::byte{0xee}, std::byte{0xff}};
  const auto add = [&](auto value) { put(packet, packet.size(), value); };
  const auto blocks = static_cast<uint8_t>(azimuths.size());
  if (layout.pandar64) {
    for (const uint8_t value :
         {layout.lasers, blocks, uint8_t{0}, uint8_t{4}, uint8_t{0}, uint8_t{0}}) {
      add(value);
    }
  } else {
    for (const uint8_t value : {layout.major, layout.minor, uint8_t{0}, uint8_t{0}, layout.lasers,
                                blocks, uint8_t{0}, uint8_t{4}, uint8_t{1}, layout.flags}) {
      add(value);
    }
  }
  for (std::size_t block = 0; block < azimuths.size(); ++block) {
    add(static_cast<uint16_t>(std::lround(100.0 * azimuths[block])));
    for (std::size_t laser = 0; laser < layout.lasers; ++laser) {
      add(static_cast<uint16_t>(range(block, laser)));
      add(static_cast<uint8_t>(laser));
      packet.resize(packet.size() + (xt ? 1 : layout.more), std::byte{0x5a});
    }
  }
  const std::array<uint8_t, 6> utc = {23, 11, 14, 22, 13, 20};
  const auto add_utc = [&] {
    for (const uint8_t value : utc) {
      add(value);
    }
  };
  if (layout.pandar64) {
    packet.resize(packet.size() + 8);
    add(uint16_t{600});
    add(microseconds);
    add(layout.mode);
    add(uint8_t{0x42});
    add_utc();
  } else {
    packet.resize(packet.size() + (xt ? 10 : ((layout.flags & 4U) != 0 ? 17 : 0) + 4 + 12));
    add(layout.mode);
    add(uint16_t{6000});
    add_utc();
    add(microseconds);
    add(uint8_t{0x42});
    add(uint32_t{7});
  }
  return packet;
}

inline Bytes ouster_imu_packet(uint64_t time) {
  Bytes packet(48);
  put(packet, 0, time - 20);
  put(packet, 8, time - 10);
  put(packet, 16, time);
  const float readings[6] = {0.0F, 0.5F, 1.0F, 180.0F, -90.0F, 0.0F};  // g, degrees a second
  std::memcpy(packet.data() + 24, readings, sizeof readings);
  return packet;
}

}  // namespace adit::test
