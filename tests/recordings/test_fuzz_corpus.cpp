// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the fuzzers start from must be good: a seed that no reader accepts leads nowhere.
#include "adit/tests/recordings/fuzz_corpus.hpp"

#include <set>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/bin_reader.hpp"
#include "adit/tools/clouds/las_reader.hpp"
#include "adit/tools/clouds/pcd_reader.hpp"
#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/packets/ouster_sensor.hpp"

// The entries, renamed by tests/CMakeLists.txt.
extern "C" int adit_fuzz_containers(const uint8_t* data, std::size_t size);
extern "C" int adit_fuzz_clouds(const uint8_t* data, std::size_t size);
extern "C" int adit_fuzz_folders(const uint8_t* data, std::size_t size);
extern "C" int adit_fuzz_images(const uint8_t* data, std::size_t size);
extern "C" int adit_fuzz_messages(const uint8_t* data, std::size_t size);
extern "C" int adit_fuzz_metadata(const uint8_t* data, std::size_t size);
extern "C" int adit_fuzz_packets(const uint8_t* data, std::size_t size);

namespace adit {
namespace {

using test::FuzzSeed;

/// Events in a recording of that content.
std::size_t events_in(const FuzzSeed& seed) {
  const test::TemporaryFolder folder;
  const test::ReadEvents read = test::read_all(*open_recording(folder.write("input", seed.bytes)));
  EXPECT_TRUE(read.errors.empty()) << seed.format << ' ' << seed.name;
  return read.events.size();
}

TEST(FuzzCorpus, ContainersAreReadToTheLastEvent) {
  std::set<std::string> formats;
  for (const FuzzSeed& seed : test::fuzz_corpus()) {
    if (seed.fuzzer == "containers") {
      formats.insert(seed.format);
      // A message of every type, with two transforms in one, or eight; a turn of the sensor and one
      // position.
      const std::size_t expected = seed.format.starts_with("pcap")    ? 2U
                                   : seed.name.starts_with("grouped") ? 58U
                                                                      : 9U;
      EXPECT_EQ(events_in(seed), expected) << seed.format << ' ' << seed.name;
    }
  }
  EXPECT_EQ(formats, (std::set<std::string>{"bag", "mcap", "pcap", "pcapng", "rosbag2"}));
}

TEST(FuzzCorpus, CloudsHavePoints) {
  for (const FuzzSeed& seed : test::fuzz_corpus()) {
    if (seed.fuzzer == "clouds") {
      const auto parse = seed.format == "pcd"   ? parse_pcd
                         : seed.format == "ply" ? parse_ply
                         : seed.format == "bin" ? parse_bin
                                                : parse_las;
      EXPECT_FALSE(parse("seed", seed.bytes, {}).sweep.points.empty()) << seed.name;
    }
  }
}

TEST(FuzzCorpus, MetadataDescribesASensor) {
  const test::TemporaryFolder folder;
  for (const FuzzSeed& seed : test::fuzz_corpus()) {
    if (seed.fuzzer == "metadata") {
      EXPECT_EQ(read_ouster_sensor(folder.write("seed.json", seed.bytes)).beams, 2U) << seed.name;
    }
  }
}

TEST(FuzzCorpus, EveryEntryTakesItsSeeds) {
  std::set<std::string> fuzzers;
  for (const FuzzSeed& seed : test::fuzz_corpus()) {
    fuzzers.insert(seed.fuzzer);
    const auto entry = seed.fuzzer == "containers" ? adit_fuzz_containers
                       : seed.fuzzer == "clouds"   ? adit_fuzz_clouds
                       : seed.fuzzer == "folders"  ? adit_fuzz_folders
                       : seed.fuzzer == "images"   ? adit_fuzz_images
                       : seed.fuzzer == "messages" ? adit_fuzz_messages
                       : seed.fuzzer == "metadata" ? adit_fuzz_metadata
                                                   : adit_fuzz_packets;
    const auto bytes = std::span(seed.bytes);
    EXPECT_EQ(entry(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()), 0);
  }
  EXPECT_EQ(fuzzers.size(), 7U);
}

}  // namespace
}  // namespace adit
