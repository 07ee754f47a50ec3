// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Damaged captures and packets: whatever is left must be read to an end; the sanitizers watch for
// the rest.
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/fuzz_corpus.hpp"
#include "adit/tests/recordings/packet_support.hpp"

// fuzz_containers.cpp and fuzz_packets.cpp; renamed by tests/CMakeLists.txt.
extern "C" int adit_fuzz_containers(const uint8_t* data, std::size_t size);
extern "C" int adit_fuzz_packets(const uint8_t* data, std::size_t size);

namespace adit {
namespace {

using test::Bytes;

/// A few bytes changed, most of them among the first `head`.
Bytes mutated(Bytes bytes, std::mt19937& random, std::size_t head) {
  const int changes = 1 + static_cast<int>(random() % 6U);
  for (int i = 0; i < changes; ++i) {
    const std::size_t most = random() % 3U == 0 ? bytes.size() : std::min(head, bytes.size());
    bytes[random() % most] = static_cast<std::byte>(random() % 4U == 0 ? 0xffU : random());
  }
  bytes.resize(bytes.size() - (random() % 3U == 0 ? random() % (bytes.size() / 4) : 0));
  return bytes;
}

const uint8_t* data_of(const Bytes& bytes) {
  return reinterpret_cast<const uint8_t*>(bytes.data());
}

TEST(PacketMutations, Captures) {
  std::vector<test::CapturedFrame> frames;
  for (int i = 0; i < 4; ++i) {
    const Bytes packet = test::velodyne_packet(100.0 * i, 5.0, 1000, i == 3 ? 0x39 : 0x37, 0x22,
                                               [](auto block, auto k) { return block * 50 + k; });
    for (Bytes& frame : test::frames_of(packet, 2368, i % 2 == 0 ? 65000 : 400)) {
      frames.push_back({std::chrono::seconds(1700000000), std::move(frame)});
    }
  }
  std::mt19937 random(1);
  for (const Bytes& whole : {test::pcap(frames), test::pcapng(frames)}) {
    for (int i = 0; i < 3000; ++i) {
      const Bytes bytes = mutated(whole, random, 300);
      adit_fuzz_containers(data_of(bytes), bytes.size());
    }
  }
}

TEST(PacketMutations, Packets) {
  std::mt19937 random(2);
  Bytes velodyne;
  for (int i = 0; i < 3; ++i) {
    test::append(velodyne, test::velodyne_packet(
                               170.0 * i, 5.0, 1000, i == 2 ? 0x39 : 0x37, i == 1 ? 0x21 : 0x22,
                               [](auto block, auto k) { return block * 50 + k; }));
  }
  Bytes noise(1024);
  for (int i = 0; i < 3000; ++i) {
    const Bytes bytes = mutated(velodyne, random, velodyne.size());
    adit_fuzz_packets(data_of(bytes), bytes.size());
    for (std::byte& byte : noise) {
      byte = static_cast<std::byte>(random() % 3U == 0 ? 0xffU : random() % 2U);
    }
    adit_fuzz_packets(data_of(noise), noise.size());
  }
}

TEST(PacketMutations, OtherSensors) {
  std::mt19937 random(3);
  std::size_t seeds = 0;
  for (const test::FuzzSeed& seed : test::fuzz_corpus()) {
    if (seed.fuzzer != "packets") {
      continue;
    }
    ++seeds;
    const auto bytes = std::as_bytes(std::span(seed.bytes));
    for (int i = 0; i < 300; ++i) {
      const Bytes changed = mutated(Bytes(bytes.begin(), bytes.end()), random, 64);
      adit_fuzz_packets(data_of(changed), changed.size());
    }
  }
  EXPECT_GE(seeds, 16U);
}

}  // namespace
}  // namespace adit
