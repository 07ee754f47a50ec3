// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How fast sweeps come out of an MCAP file, beside reading the same bytes with the same
// decompression and nothing else. Each mode is a run of its own, so that its peak memory is its
// own.
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "adit/tools/containers/byte_reader.hpp"
#include "adit/tools/containers/compression.hpp"
#include "adit/tools/containers/mcap_records.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/containers/seekable_file.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/recordings/ros_events.hpp"

namespace {

using namespace adit;
using Clock = std::chrono::steady_clock;

constexpr int kBeams = 128;
constexpr int kColumns = 1024;

/// A sweep of 131072 points in a hall with a wavy wall, so that compression has something to do.
Sweep sweep_of(int index) {
  Sweep sweep;
  sweep.stamp = std::chrono::seconds(1'700'000'000) + std::chrono::milliseconds(100 * index);
  uint32_t noise = static_cast<uint32_t>(index) * 2654435761U + 1U;
  for (int column = 0; column < kColumns; ++column) {
    const double azimuth = 2.0 * std::numbers::pi * column / kColumns;
    for (int beam = 0; beam < kBeams; ++beam) {
      const double elevation = 0.7 * (beam - 64) / 64.0;
      noise = noise * 1664525U + 1013904223U;
      const double range = 12.0 + 3.0 * std::sin(5.0 * azimuth + 0.1 * index) + 1e-11 * noise;
      sweep.points.push_back({static_cast<float>(range * std::cos(azimuth) * std::cos(elevation)),
                              static_cast<float>(range * std::sin(azimuth) * std::cos(elevation)),
                              static_cast<float>(range * std::sin(elevation)),
                              static_cast<float>(noise >> 24U)});
      sweep.times.push_back(static_cast<float>(0.1 * column / kColumns));
      sweep.rings.push_back(static_cast<uint16_t>(beam));
    }
  }
  return sweep;
}

void write(const std::filesystem::path& file, Compression compression, int sweeps) {
  McapWriter writer(file, {.compression = compression});
  for (int i = 0; i < sweeps; ++i) {
    const Sweep sweep = sweep_of(i);
    const ros::EncodedEvent message = ros::from_event(sweep, Encoding::cdr, "lidar");
    if (i == 0) {
      writer.add_channel({.topic = "/points",
                          .type = message.type,
                          .encoding = Encoding::cdr,
                          .definition = {},
                          .messages = std::nullopt});
    }
    writer.write(0, sweep.stamp, message.bytes);
  }
  writer.close();
}

/// What was read, after decompression.
struct Amount {
  uint64_t bytes = 0;
  uint64_t sweeps = 0;
};

Amount read_sweeps(const std::filesystem::path& file) {
  const auto recording = open_recording(file);
  const auto events = recording->events({});
  Amount amount;
  while (const auto event = events->next()) {
    amount.bytes += event->bytes;
    amount.sweeps += std::get<Sweep>(event->value).points.size() == kBeams * kColumns ? 1U : 0U;
  }
  return amount;
}

/// Every record, chunks unpacked, nothing looked at.
Amount read_plainly(const std::filesystem::path& path) {
  const SeekableFile file(path);
  Decompressor decompressor;
  Amount amount;
  std::vector<std::byte> record;
  for (uint64_t at = mcap::kMagic.size(); at + mcap::kRecordHeader < file.size();) {
    const std::vector<std::byte> head = file.read(at, mcap::kRecordHeader);
    ByteReader reader(path, at, head);
    const auto opcode = static_cast<mcap::Opcode>(reader.number<uint8_t>("opcode"));
    const auto size = reader.number<uint64_t>("length");
    record.resize(size);
    file.read(at + mcap::kRecordHeader, record);
    if (opcode == mcap::Opcode::chunk) {
      ByteReader body(path, at, record);
      const mcap::ChunkHeader chunk = mcap::read_chunk_header(body);
      const auto compression = compression_named(chunk.compression);
      const auto packed = body.bytes(chunk.packed_size, "chunk");
      amount.bytes +=
          decompressor.unpack(compression.value(), packed, chunk.unpacked_size).bytes.size();
    }
    if (opcode == mcap::Opcode::footer) {
      break;
    }
    at += mcap::kRecordHeader + size;
  }
  return amount;
}

double peak_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

int run(const std::string& mode, const std::filesystem::path& file, const char* compression,
        int sweeps) {
  const auto start = Clock::now();
  Amount amount;
  if (mode == "write") {
    write(file, compression_named(compression).value(), sweeps);
    amount.sweeps = static_cast<uint64_t>(sweeps);
    amount.bytes = std::filesystem::file_size(file);
  } else {
    amount = mode == "read" ? read_sweeps(file) : read_plainly(file);
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const double mib = static_cast<double>(amount.bytes) / 1048576.0;
  std::printf("%-5s  %8.1f MiB  %6.2f s  %7.1f MiB/s  %6.1f sweeps/s  peak %6.1f MiB\n",
              mode.c_str(), mib, seconds, mib / seconds,
              static_cast<double>(amount.sweeps) / seconds, peak_mib());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  const bool writes = mode == "write" && argc == 5;
  if (!writes && !((mode == "read" || mode == "plain") && argc == 3)) {
    std::fputs(
        "Usage: recordings_speed write FILE none|lz4|zstd SWEEPS   (16 sweeps are 44 MiB)\n"
        "       recordings_speed read FILE     sweeps, as `adit run` gets them\n"
        "       recordings_speed plain FILE    the same bytes and decompression alone\n",
        stderr);
    return 2;
  }
  try {
    return run(mode, argv[2], writes ? argv[3] : "", writes ? std::atoi(argv[4]) : 0);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "recordings_speed: %s\n", error.what());
    return 1;
  }
}
