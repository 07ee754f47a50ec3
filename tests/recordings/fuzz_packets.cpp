// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The entry that a fuzzer calls with bytes that might be what sensors send: whatever they are,
// sweeps must be valid. `./dev fuzz` is the fuzzer; captures are of fuzz_containers.cpp.
#include <span>
#include <utility>

#include "adit/tests/recordings/fuzz_support.hpp"
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
    if (is_packet(datagram)) {
      for (const Sweep& sweep : sweeps.take(datagram)) {
        require_whole(sweep);
      }
    }
  }
  if (const auto rest = sweeps.finish()) {
    require_whole(*rest);
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
       {OusterProfile::legacy, OusterProfile::rng19_rfl8_sig16_nir16}) {
    const OusterSensor sensor = small_sensor(profile);
    decode(OusterSweeps(sensor), bytes, sensor.packet_bytes(),
           [&](const Datagram& d) { return is_ouster_data(d, sensor); });
  }
  constexpr std::size_t kPosition = 512;
  if (size >= kPosition) {
    const auto fix = velodyne_fix({.payload = bytes.first(kPosition)});
    if (fix && !(std::abs(fix->latitude) <= 90.0)) {
      std::abort();
    }
  }
  return 0;
}
