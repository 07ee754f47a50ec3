// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Packets of Hesai's sensors, after their manuals: PandarXT and XT32M2X (protocol 6.1), PandarQT64
// (3.1), QT128C2X (3.2), OT128 and Pandar128 (1.4), Pandar64 and Pandar40P. Blocks of an azimuth
// and a range for each laser.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/packets/hesai_models.hpp"
#include "adit/tools/packets/packet_capture.hpp"

namespace adit {

/// Reads an angle correction file, as the sensor gives it: lines of channel, elevation and azimuth.
/// Throws InputError where it is none.
HesaiAngles read_hesai_angles(const std::filesystem::path& file);

/// A packet as its head describes it.
struct HesaiPacket {
  std::string model{};
  std::size_t lasers = 0;
  std::size_t blocks = 0;
  std::size_t block_at = 0;   ///< byte of the first block's azimuth
  std::size_t block_gap = 0;  ///< bytes between two blocks
  std::size_t channel_bytes = 0;
  double range_unit = 0.0;            ///< m
  std::size_t motor_at = 0;           ///< 16 bits, turns a minute or a tenth of that
  std::size_t utc_at = 0;             ///< 6 bytes
  std::size_t time_at = 0;            ///< 32 bits, us of the second
  std::size_t returns = 1;            ///< so many blocks of the same azimuth, a return each
  bool second_sequence = false;       ///< all blocks are of the second of two firing sequences
  const HesaiModel* times = nullptr;  ///< null: its lasers fire together, blocks by their azimuths

  std::size_t block_bytes() const { return 2 + lasers * channel_bytes + block_gap; }
};
/// Nothing where it is none of those that are read.
std::optional<HesaiPacket> hesai_packet(const Datagram& datagram);

/// The angles of the model's design; nothing where adit does not know them.
std::optional<HesaiAngles> hesai_angles_by_design(const HesaiPacket& packet);

/// The time of a packet by the sensor's clock.
Nanoseconds hesai_time(const HesaiPacket& packet, const Datagram& datagram);

/// Puts the packets of one sensor together to sweeps, from one passage through azimuth 0 to the
/// next, in the sensor's frame (y ahead at azimuth 0, azimuths clockwise from above, z up).
/// Directions without return are left out. Times are the sensor's own.
class HesaiSweeps {
 public:
  /// Without `points`, sweeps are only told apart.
  explicit HesaiSweeps(HesaiAngles angles, bool points = true);

  /// Takes a packet; gives the sweeps that are whole by then, as a rule none or one.
  std::vector<Sweep> take(const Datagram& datagram);
  /// What is left at the end.
  std::optional<Sweep> finish();

 private:
  void add_block(std::span<const std::byte> payload, const HesaiPacket& packet, std::size_t block,
                 Nanoseconds time);

  HesaiAngles angles_;
  std::vector<uint16_t> rings_;  // from the lowest up
  bool points_;
  std::optional<Sweep> sweep_;
  double last_azimuth_ = 0.0;  // degrees
};

}  // namespace adit
