// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Damaged recordings: with every bit flipped, with bytes changed, moved and repeated at random, and
// with numbers made huge. Whatever is left must be read to an end; the sanitizers watch for the
// rest.
#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/container_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/bag_writer.hpp"
#include "adit/tools/containers/mcap_writer.hpp"

// fuzz_containers.cpp; renamed by tests/CMakeLists.txt, since the program has another entry.
extern "C" int adit_fuzz_containers(const uint8_t* data, std::size_t size);

namespace adit {
namespace {

/// Bags have 4000 of these at the start, which tell nothing.
constexpr char kPadding = ' ';

void feed_containers(const std::string& content) {
  const std::vector<uint8_t> exact(content.begin(), content.end());
  adit_fuzz_containers(exact.data(), exact.size());
}

using test::content_of;

/// Two messages in a small file.
void write_small(MessageWriter& writer, Encoding encoding) {
  for (Channel channel : test::sample_channels(encoding)) {
    channel.definition = "x";
    writer.add_channel(channel);
  }
  for (const test::SampleMessage& message : test::sample_messages(encoding, 1)) {
    if (message.channel == 0 || message.channel == 6) {
      writer.write(message.channel, message.received, message.bytes);
    }
  }
  writer.close();
}

std::vector<std::string> container_seeds() {
  const test::TemporaryFolder folder;
  std::vector<std::string> seeds;
  const auto add_mcap = [&](const McapOptions& options, Encoding encoding) {
    McapWriter writer(folder / "seed", options);
    write_small(writer, encoding);
    seeds.push_back(content_of(folder / "seed"));
  };
  add_mcap({.compression = Compression::none}, Encoding::cdr);
  add_mcap({.compression = Compression::lz4, .summary = false}, Encoding::ros1);
  add_mcap({.compression = Compression::zstd}, Encoding::ros1);
  add_mcap({.chunks = false, .summary = false}, Encoding::cdr);
  for (const Compression compression : {Compression::none, Compression::lz4}) {
    BagWriter writer(folder / "seed", {.compression = compression});
    write_small(writer, Encoding::ros1);
    seeds.push_back(content_of(folder / "seed"));
  }
  return seeds;
}

TEST(ContainerMutations, EveryBitFlipped) {
  for (const std::string& seed : container_seeds()) {
    for (std::size_t bit = 0; bit < 8 * seed.size(); ++bit) {
      if (seed[bit / 8] == kPadding) {
        continue;
      }
      std::string damaged = seed;
      damaged[bit / 8] =
          static_cast<char>(static_cast<unsigned char>(damaged[bit / 8]) ^ (1U << (bit % 8)));
      feed_containers(damaged);
    }
  }
}

TEST(ContainerMutations, NumbersMadeHuge) {
  for (const std::string& seed : container_seeds()) {
    for (std::size_t at = 0; at + 8 <= seed.size(); ++at) {
      if (seed[at] == kPadding) {
        continue;
      }
      for (const std::size_t bytes : {2U, 4U, 8U}) {
        std::string damaged = seed;
        const auto begin = damaged.begin() + static_cast<long>(at);
        std::fill_n(begin, bytes, '\xff');
        feed_containers(damaged);
        std::fill_n(begin, bytes - 1, '\0');
        begin[static_cast<long>(bytes) - 1] = '\x3f';
        feed_containers(damaged);
      }
    }
  }
}

TEST(ContainerMutations, SeveralBytesChangedMovedAndRepeated) {
  std::mt19937 random(20260102);
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(random() % std::max<std::size_t>(n, 1));
  };
  for (const std::string& seed : container_seeds()) {
    for (int round = 0; round < 3000; ++round) {
      std::string damaged = seed;
      for (std::size_t change = 0; change <= below(4); ++change) {
        const std::size_t at = below(damaged.size());
        switch (below(4)) {
          case 0:
            damaged[at] = static_cast<char>(random());
            break;
          case 1:
            damaged.erase(at, below(16));
            break;
          case 2:
            damaged.insert(at, damaged.substr(below(damaged.size()), below(64)));
            break;
          default:
            damaged.resize(at);
            break;
        }
        if (damaged.empty()) {
          break;
        }
      }
      feed_containers(damaged);
    }
  }
}

}  // namespace
}  // namespace adit
