// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Captures of the packets of every sensor that is read.
#include <array>
#include <utility>

#include "adit/tests/commands/healthy_recordings.hpp"
#include "adit/tests/commands/small_room.hpp"
#include "adit/tests/recordings/packet_support.hpp"
#include "adit/tests/recordings/sensor_support.hpp"

namespace adit::test {
namespace {

namespace fs = std::filesystem;

struct Capture {
  std::vector<CapturedFrame> frames{};
  void add(double seconds, const Bytes& payload, uint16_t port) {
    for (Bytes& frame : frames_of(payload, port)) {
      frames.push_back({at(seconds), std::move(frame)});
    }
  }
};

Capture velodyne(uint8_t mode, uint8_t model) {
  Capture capture;
  for (int i = 0; i < 6 * kSweeps; ++i) {  // 60 degrees a packet
    const double since = i / 60.0;
    const double first = std::fmod(60.0 * i, 360.0);
    const auto of_hour = (MovingRig::kBegin + Nanoseconds(static_cast<int64_t>(1e9 * since))) %
                         std::chrono::hours(1);
    const auto packet = velodyne_packet(
        first, mode == 0x39 ? 10.0 : 5.0, static_cast<uint32_t>(of_hour.count() / 1000), mode,
        model, [&](std::size_t block, std::size_t ray) {
          return room(kDegree * (first + 5.0 * static_cast<double>(block)), ray) /
                 (model == 0x28 ? 0.004 : 0.002);
        });
    capture.add(since, packet, 2368);
    if (i % 20 == 0) {
      capture.add(
          since,
          position_packet("$GPRMC,000640,A,4139.0000,N,00052.8000,W,000.0,000.0,110621,,,A*67\r\n"),
          8308);
    }
  }
  return capture;
}

/// A VLS-128 that fires every 20 degrees.
Capture vls128(bool dual) {
  Capture capture;
  const int packets = dual ? 18 : 6;  // of a turn, with a firing or three each
  for (int i = 0; i < packets * kSweeps; ++i) {
    const double since = i / (10.0 * packets);
    const double first = std::fmod(360.0 * i / packets, 360.0);
    const auto of_hour = (MovingRig::kBegin + Nanoseconds(static_cast<int64_t>(1e9 * since))) %
                         std::chrono::hours(1);
    const auto packet = vls128_packet(
        first, 20.0, static_cast<uint32_t>(of_hour.count() / 1000), dual,
        [&](std::size_t sequence, std::size_t ray, std::size_t) {
          return room(kDegree * (first + 20.0 * static_cast<double>(sequence)), ray) / 0.004;
        });
    capture.add(since, packet, 2368);
  }
  return capture;
}

constexpr std::size_t kBeams = 16;

Capture ouster(const std::string& profile, std::size_t pixel_bytes) {
  Capture capture;
  for (int i = 0; i < 2 * kSweeps; ++i) {  // 16 of 32 columns a packet
    const double since = 0.05 * i;
    const auto time = static_cast<uint64_t>(at(since).count());
    const std::size_t first = i % 2 == 0 ? 0 : 16;
    const auto frame = static_cast<uint16_t>(7 + i / 2);
    const auto range = [](std::size_t column, std::size_t beam) {
      return 1000.0 * room(2.0 * std::numbers::pi * static_cast<double>(column) / 32.0, beam);
    };
    if (profile == "LEGACY" || profile == "RNG19_RFL8_SIG16_NIR16") {
      capture.add(since, ouster_packet(profile == "LEGACY", kBeams, first, frame, time, range),
                  7502);
    } else {
      capture.add(since,
                  ouster_profile_packet(
                      pixel_bytes, profile.starts_with("FUSA"), kBeams, first, frame, time,
                      [&](Bytes& bytes, auto offset, auto column, auto beam) {
                        const double mm = range(column, beam);
                        const double told = profile.starts_with("RNG19") ? mm : mm / 8.0;
                        put(bytes, offset, static_cast<uint32_t>(told));
                      }),
                  7502);
    }
    for (int reading = 0; reading < 5; ++reading) {
      const double then = since + 0.01 * reading;
      capture.add(then, ouster_imu_packet(static_cast<uint64_t>(at(then).count())), 7503);
    }
  }
  return capture;
}

Capture hesai(const HesaiLayout& layout) {
  Capture capture;
  for (int i = 0; i < 9 * kSweeps; ++i) {  // 40 degrees a packet
    const double since = i / 90.0;
    std::vector<double> azimuths;
    for (int block = 0; block < 8; ++block) {
      azimuths.push_back(std::fmod(40.0 * i + 5.0 * block, 360.0));
    }
    capture.add(since,
                hesai_packet(layout, azimuths, static_cast<uint32_t>(1e6 * since),
                             [&](std::size_t block, std::size_t laser) {
                               return room(kDegree * azimuths[block], laser) / 0.004;
                             }),
                2368);
  }
  return capture;
}

/// 40 degrees a packet, in so many blocks; make(azimuths, us, range(block, laser)).
Capture hesai_of(std::size_t blocks, const auto& make) {
  Capture capture;
  for (int i = 0; i < 9 * kSweeps; ++i) {
    const double since = i / 90.0;
    std::vector<double> azimuths;
    for (std::size_t block = 0; block < blocks; ++block) {
      azimuths.push_back(std::fmod(
          40.0 * i + 40.0 * static_cast<double>(block) / static_cast<double>(blocks), 360.0));
    }
    capture.add(since,
                make(azimuths, static_cast<uint32_t>(1e6 * since),
                     [&](std::size_t block, std::size_t laser) {
                       return room(kDegree * azimuths[block], laser) / 0.004;
                     }),
                2368);
  }
  return capture;
}

Capture livox(bool centimetres) {
  Capture capture;
  const std::vector<Point> points = room_points();
  std::size_t next = 0;
  for (int i = 0; i < 6 * kSweeps; ++i) {
    const double since = i / 60.0;
    std::vector<std::array<int32_t, 5>> some;
    for (int k = 0; k < 96; ++k) {
      const Point& p = points[next++ % points.size()];
      some.push_back({static_cast<int32_t>(1e3F * p.x), static_cast<int32_t>(1e3F * p.y),
                      static_cast<int32_t>(1e3F * p.z), 40, k % 16 == 0 ? 0x20 : 0});
    }
    const auto time = static_cast<uint64_t>(at(since).count());
    capture.add(since, livox_packet(time, some, centimetres), 56301);
    capture.add(since, livox_imu_packet(time), 56301);
  }
  return capture;
}

/// A table of 128 lasers, more than any of the captures has.
std::string hesai_angles() {
  std::string table = "Laser id,Elevation,Azimuth\n";
  for (int i = 0; i < 128; ++i) {
    table += std::to_string(i + 1) + "," + std::to_string(15.0 - 0.25 * i) + ",0.5\n";
  }
  return table;
}

HealthyFormat captures(const fs::path& folder, const std::string& sensor,
                       const std::vector<std::pair<Capture, std::string>>& of) {
  HealthyFormat format{.name = sensor, .recordings = {}};
  for (const auto& [capture, metadata] : of) {
    const std::size_t number = format.recordings.size();
    HealthyRecording recording{.folder = folder / (sensor + std::to_string(number)),
                               .opened = number % 2 == 0 ? "drive.pcap" : "drive.pcapng",
                               .metadata = {}};
    const Bytes bytes = number % 2 == 0 ? pcap(capture.frames) : pcapng(capture.frames);
    write(recording.folder / recording.opened, text_of(bytes));
    if (!metadata.empty()) {
      recording.metadata = metadata.starts_with('{') ? "drive.json" : "angles.csv";
      write(recording.folder / recording.metadata, metadata);
    }
    format.recordings.push_back(std::move(recording));
  }
  return format;
}

}  // namespace

std::vector<HealthyFormat> write_healthy_captures(const fs::path& folder) {
  std::vector<HealthyFormat> formats;
  formats.push_back(captures(folder, "velodyne",
                             {{velodyne(0x37, 0x22), ""},
                              {velodyne(0x39, 0x22), ""},
                              {velodyne(0x37, 0x21), ""},
                              {velodyne(0x37, 0x28), ""},
                              {vls128(false), ""},
                              {vls128(true), ""}}));
  std::vector<std::pair<Capture, std::string>> of_ouster;
  for (const auto& [profile, pixel_bytes] : {std::pair<const char*, std::size_t>{"LEGACY", 12},
                                             {"RNG19_RFL8_SIG16_NIR16", 12},
                                             {"RNG19_RFL8_SIG16_NIR16_DUAL", 16},
                                             {"RNG15_RFL8_NIR8", 4},
                                             {"RNG15_RFL8_NIR8_DUAL", 8},
                                             {"FUSA_RNG15_RFL8_NIR8_DUAL", 8}}) {
    of_ouster.emplace_back(ouster(profile, pixel_bytes),
                           ouster_metadata(kBeams, profile, pixel_bytes != 12));
  }
  formats.push_back(captures(folder, "ouster", of_ouster));
  formats.push_back(captures(
      folder, "hesai",
      {{hesai({}), ""},
       {hesai({.lasers = 16}), ""},
       {hesai({.major = 1, .minor = 4, .lasers = 128}), hesai_angles()},
       {hesai({.pandar64 = true, .lasers = 64}), hesai_angles()},
       {hesai_of(6, [](const auto& azimuths, uint32_t micros,
                       const auto& range) { return hesai_packet({}, azimuths, micros, range); }),
        ""},
       {hesai_of(10,
                 [](const auto& azimuths, uint32_t micros, const auto& range) {
                   return pandar40p_packet(azimuths, micros, 0x37, true, range);
                 }),
        ""},
       {hesai_of(4, [](const auto& azimuths, uint32_t micros,
                       const auto& range) { return qt64_packet(azimuths, micros, 0x37, range); }),
        hesai_angles()},
       {hesai_of(2, [](const auto& azimuths, uint32_t micros,
                       const auto& range) { return qt128_packet({}, azimuths, micros, range); }),
        ""}}));
  formats.push_back(captures(folder, "livox", {{livox(false), ""}, {livox(true), ""}}));
  return formats;
}

}  // namespace adit::test
