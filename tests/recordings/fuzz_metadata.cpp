// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The entry that a fuzzer calls with bytes that might be the metadata of an Ouster sensor: what is
// accepted must describe a sensor whose packets can be taken apart.
#include <cmath>

#include "adit/tests/recordings/fuzz_support.hpp"
#include "adit/tools/packets/ouster_sensor.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const adit::test::ScratchFile file(data, size);
  try {
    const adit::OusterSensor sensor = adit::read_ouster_sensor(file.path());
    bool valid = sensor.beams > 0 && sensor.beam_altitudes.size() == sensor.beams &&
                 sensor.beam_azimuths.size() == sensor.beams && sensor.columns > 0 &&
                 sensor.columns_per_packet > 0 && sensor.packet_bytes() < (1U << 20U) &&
                 std::isfinite(sensor.beam_origin) && sensor.T_sensor_lidar.matrix().allFinite() &&
                 sensor.T_sensor_imu.matrix().allFinite();
    for (std::size_t i = 0; i < sensor.beams && valid; ++i) {
      valid = std::isfinite(sensor.beam_altitudes[i]) && std::isfinite(sensor.beam_azimuths[i]);
    }
    if (!valid) {
      std::abort();
    }
  } catch (const adit::InputError&) {
    // the other right answer
  }
  return 0;
}
