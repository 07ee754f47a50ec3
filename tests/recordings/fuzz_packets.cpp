// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The entry that a fuzzer calls with bytes that might be what sensors send: whatever they are,
// sweeps must be valid. `./dev fuzz` is the fuzzer; captures are of fuzz_containers.cpp.
#include <span>
#include <utility>

#include "adit/tests/recordings/fuzz_support.hpp"
#include "adit/tools/packets/hesai_packets.hpp"
#include "adit/tools/packets/livox_packets.hpp"
#include "adit/tools/packets/ouster_packets.hpp"
#include "adit/tools/packets/velodyne_packets.hpp"

namespace {

using namespace adit;

/// Sensors tell the ring and the time of every point.
void require_whole(const Sweep& sweep) {
  test::require_valid(sweep);
  if (sweep.times.size() != sweep.points.size() || sweep.rings.size() != sweep.points.size()) {
    std::abort();
  }
}

/// Lets the decoder at all packets of that size.
template <class Sweeps>
void decode(Sweeps sweeps, std::span<const std::byte> bytes, std::size_t size,
            const auto& is_packet) {
  for (std::size_t at = 0; at + size <= bytes.size(); at += size) {
    const Datagram datagram{
        .received = std::chrono::hours(at), .payload = bytes.subspan(at, size), .offset = at};
    Datagram cut = datagram;  // of which the second half was not captured
    cut.payload = datagram.payload.first(size / 2);
    cut.missing = size - size / 2;
    for (const Datagram& one : {datagram, cut}) {
      if (is_packet(one)) {
        for (const Sweep& sweep : sweeps.take(one)) {
          require_whole(sweep);
        }
      }
    }
  }
  if (const auto rest = sweeps.finish()) {
    require_whole(*rest);
  }
}

/// Packets that tell their own length.
void decode_whole(std::span<const std::byte> bytes) {
  const Datagram datagram{.received = std::chrono::hours(1), .payload = bytes};
  LivoxSweeps livox;
  if (is_livox_imu(datagram)) {
    livox_imu(datagram);
  } else if (is_livox_data(datagram)) {
    livox.take(datagram);
    test::require_valid(livox.finish().value());
  }
  Datagram cut = datagram;
  cut.payload = bytes.first(bytes.size() / 2);
  cut.missing = bytes.size() - cut.payload.size();
  if (is_livox_data(cut)) {
    livox.take(cut);
    test::require_valid(livox.finish().value());
  }
  HesaiAngles angles;
  for (int i = 0; i < 128; ++i) {
    angles.elevations.push_back(15.0 - 0.5 * i);
    angles.azimuths.push_back(0.1 * i);
  }
  HesaiSweeps hesai(angles);
  if (hesai_packet(datagram)) {
    for (int i = 0; i < 2; ++i) {
      for (const Sweep& sweep : hesai.take(datagram)) {
        require_whole(sweep);
      }
    }
    if (const auto rest = hesai.finish()) {
      require_whole(*rest);
    }
  }
}

OusterSensor small_sensor(OusterProfile profile) {
  return {.profile = profile,
          .beams = 2,
          .columns_per_packet = 4,
          .columns = 16,
          .beam_origin = 0.01,
          .beam_altitudes = {0.1, -0.1},
          .beam_azimuths = {0.01, -0.01}};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  decode(VelodyneSweeps(), bytes, 1206, [](const Datagram& d) { return is_velodyne_data(d); });
  for (const OusterProfile profile :
       {OusterProfile::legacy, OusterProfile::rng19_rfl8_sig16_nir16,
        OusterProfile::rng19_rfl8_sig16_nir16_dual, OusterProfile::rng15_rfl8_nir8,
        OusterProfile::rng15_rfl8_nir8_dual, OusterProfile::fusa_rng15_rfl8_nir8_dual}) {
    OusterSensor sensor = small_sensor(profile);
    sensor.fusa_header = profile == OusterProfile::fusa_rng15_rfl8_nir8_dual;
    decode(OusterSweeps(sensor), bytes, sensor.packet_bytes(),
           [&](const Datagram& d) { return is_ouster_data(d, sensor); });
  }
  decode_whole(bytes);
  constexpr std::size_t kPosition = 512;
  if (size >= kPosition) {
    const auto fix = velodyne_fix({.payload = bytes.first(kPosition)});
    if (fix && !(std::abs(fix->latitude) <= 90.0)) {
      std::abort();
    }
  }
  return 0;
}
