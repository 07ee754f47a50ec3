// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/container_support.hpp"
#include "adit/tests/recordings/message_support.hpp"
#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/crc32.hpp"
#include "adit/tools/containers/mcap_reader.hpp"
#include "adit/tools/containers/mcap_writer.hpp"

namespace adit {
namespace {

using test::content_of;
using test::is_prefix;
using test::read;
using test::Reading;
using test::TemporaryFolder;

std::filesystem::path write_mcap(const TemporaryFolder& folder, const McapOptions& options,
                                 Encoding encoding = Encoding::cdr, uint32_t rounds = 3,
                                 bool definitions = true) {
  const std::filesystem::path file = folder / "sample.mcap";
  McapWriter writer(file, options);
  test::write_sample(writer, encoding, rounds, definitions);
  writer.close();
  return file;
}

std::vector<McapOptions> variants() {
  std::vector<McapOptions> all;
  for (const Compression compression : {Compression::none, Compression::lz4, Compression::zstd}) {
    for (const bool summary : {true, false}) {
      all.push_back({.compression = compression, .chunk_bytes = 2000, .summary = summary});
    }
  }
  all.push_back({.chunks = false, .summary = true});
  all.push_back({.chunks = false, .summary = false});
  return all;
}

TEST(Crc32, KnownSums) {
  const std::string text = "123456789";
  EXPECT_EQ(crc32(std::as_bytes(std::span(text))), 0xcbf43926U);
  EXPECT_EQ(crc32({}), 0U);
  const std::string longer = "The quick brown fox jumps over the lazy dog";
  const auto bytes = std::as_bytes(std::span(longer));
  EXPECT_EQ(crc32(bytes), 0x414fa339U);
  EXPECT_EQ(crc32(bytes.subspan(11), crc32(bytes.first(11))), 0x414fa339U);
}

/// Bit by bit, by the definition.
uint32_t plain_crc32(std::span<const std::byte> bytes) {
  uint32_t sum = ~0U;
  for (const std::byte byte : bytes) {
    sum ^= std::to_integer<uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) {
      sum = (sum >> 1U) ^ ((sum & 1U) != 0 ? 0xEDB88320U : 0U);
    }
  }
  return ~sum;
}

TEST(Crc32, IsByDefinitionWhateverTheLengthThePlaceAndThePieces) {
  std::vector<std::byte> noise(1000);
  uint32_t state = 7;
  for (std::byte& byte : noise) {
    state = state * 1664525U + 1013904223U;
    byte = static_cast<std::byte>(state >> 24U);
  }
  for (std::size_t size = 0; size <= 520; ++size) {
    const auto bytes = std::span<const std::byte>(noise).subspan(size % 17, size);
    const uint32_t expected = plain_crc32(bytes);
    EXPECT_EQ(crc32(bytes), expected) << size;
    const std::size_t piece = size / 3;
    EXPECT_EQ(crc32(bytes.subspan(piece), crc32(bytes.first(piece))), expected) << size;
  }
}

TEST(Mcap, EveryVariantIsReadAsItWasWritten) {
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    const std::vector<test::SampleMessage> written = test::sample_messages(encoding, 3);
    for (const McapOptions& options : variants()) {
      const TemporaryFolder folder;
      const auto file = open_mcap(write_mcap(folder, options, encoding));
      const Reading reading = read(*file);
      EXPECT_TRUE(reading.errors.empty());
      EXPECT_EQ(reading.messages.size(), written.size());
      EXPECT_TRUE(is_prefix(reading.messages, written));
      EXPECT_FALSE(file->damage());
      ASSERT_TRUE(file->span());
      EXPECT_EQ(file->span()->begin, written.front().received);
      EXPECT_EQ(file->span()->end, written.back().received);
      const std::vector<Channel> channels = test::sample_channels(encoding);
      ASSERT_EQ(file->channels().size(), channels.size());
      for (std::size_t i = 0; i < channels.size(); ++i) {
        const Channel& channel = file->channels()[i];
        EXPECT_EQ(channel.topic, channels[i].topic);
        EXPECT_EQ(channel.type, channels[i].type);
        EXPECT_EQ(channel.encoding, encoding);
        EXPECT_EQ(channel.definition, channels[i].definition);
        EXPECT_EQ(channel.messages, channel.topic == "/tf_static" ? 1U : 3U);
      }
    }
  }
}

TEST(Mcap, FormatTellsCompressionAndMissingIndex) {
  const TemporaryFolder folder;
  EXPECT_EQ(open_mcap(write_mcap(folder, {.summary = false}))->format(),
            "MCAP zstd, without an index");
  EXPECT_EQ(open_mcap(write_mcap(folder, {.compression = Compression::lz4}))->format(), "MCAP lz4");
  EXPECT_EQ(open_mcap(write_mcap(folder, {.compression = Compression::none}))->format(), "MCAP");
}

TEST(Mcap, ChannelsAndTimesAreChosen) {
  for (const McapOptions& options : variants()) {
    const TemporaryFolder folder;
    const auto file = open_mcap(write_mcap(folder, options));
    const Reading imu = read(*file, {.channels = {1}});
    ASSERT_EQ(imu.messages.size(), 3U);
    const Nanoseconds middle = imu.messages[1].received;
    EXPECT_EQ(imu.messages[2].channel, 1U);
    EXPECT_EQ(read(*file, {.channels = {1}, .begin = middle}).messages.size(), 2U);
    EXPECT_EQ(read(*file, {.channels = {1}, .end = middle}).messages.size(), 2U);
    EXPECT_EQ(read(*file, {.begin = middle, .end = middle}).messages.size(), 1U);
    EXPECT_TRUE(read(*file, {.begin = middle + std::chrono::hours(1)}).messages.empty());
  }
}

TEST(Mcap, CutOffAtEveryByteGivesWhatCameBeforeAndSaysWhere) {
  const std::vector<test::SampleMessage> written = test::sample_messages(Encoding::cdr, 1);
  for (McapOptions options : variants()) {
    options.chunk_bytes = 700;
    const TemporaryFolder folder;
    const std::string whole = content_of(write_mcap(folder, options, Encoding::cdr, 1, false));
    std::size_t most = 0;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const std::filesystem::path cut = folder.write("cut.mcap", whole.substr(0, size));
      if (size < 8) {
        EXPECT_THROW(open_mcap(cut), InputError);
        continue;
      }
      const auto file = open_mcap(cut);
      const Reading reading = read(*file);
      EXPECT_TRUE(is_prefix(reading.messages, written)) << size;
      EXPECT_GE(reading.messages.size(), most) << size << ": fewer messages than in a shorter file";
      most = reading.messages.size();
      if (most < written.size()) {
        ASSERT_EQ(reading.errors.size(), 1U) << size;
        EXPECT_EQ(reading.errors[0].file(), cut);
        EXPECT_TRUE(reading.errors[0].place().starts_with("byte "));
        ASSERT_TRUE(file->damage()) << size;
        EXPECT_STREQ(file->damage()->what(), reading.errors[0].what());
      }
    }
    EXPECT_EQ(most, written.size());
  }
}

/// A byte in the records of the chunk with this number, from 0.
std::size_t middle_of_chunk(const std::string& bytes, int number) {
  constexpr char kChunk = '\x06';
  for (std::size_t at = mcap::kMagic.size();;) {
    uint64_t length = 0;
    std::memcpy(&length, bytes.data() + at + 1, sizeof length);
    if (bytes[at] == kChunk && number-- == 0) {
      return at + mcap::kRecordHeader + (length + 40) / 2;  // 40: what stands before the records
    }
    at += mcap::kRecordHeader + length;
  }
}

TEST(Mcap, DamagedChunkIsReportedAndTheOthersAreRead) {
  for (const Compression compression : {Compression::none, Compression::lz4, Compression::zstd}) {
    const TemporaryFolder folder;
    const std::filesystem::path file =
        write_mcap(folder, {.compression = compression, .chunk_bytes = 1000}, Encoding::cdr, 10);
    const std::size_t all = read(*open_mcap(file)).messages.size();
    std::string bytes = content_of(file);
    const std::size_t middle = middle_of_chunk(bytes, 2);
    bytes[middle] = static_cast<char>(bytes[middle] ^ 0x55);
    const Reading reading = read(*open_mcap(folder.write("damaged.mcap", bytes)));
    ASSERT_EQ(reading.errors.size(), 1U);
    EXPECT_NE(reading.errors[0].found().find("chunk that begins here"), std::string::npos)
        << reading.errors[0].what();
    EXPECT_GT(reading.messages.size(), all / 2);
    EXPECT_LT(reading.messages.size(), all);
  }
}

TEST(Mcap, RecorderThatWasKilledLeavesAReadableFile) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "killed.mcap";
  {
    McapWriter writer(file, {.chunk_bytes = 1000});
    test::write_sample(writer, Encoding::cdr, 5);
  }
  const auto opened = open_mcap(file);
  const Reading reading = read(*opened);
  EXPECT_GT(reading.messages.size(), 20U);
  ASSERT_EQ(reading.errors.size(), 1U);
  EXPECT_NE(reading.errors[0].found().find("without the end mark"), std::string::npos);
  EXPECT_NE(reading.errors[0].remedy().find("recorder was killed"), std::string::npos);
}

TEST(Mcap, ChunkThatClaimsToUnpackToAGigabyteTakesNoMemory) {
  ByteWriter chunk;
  for (const uint64_t value : {uint64_t{0}, uint64_t{0}, uint64_t{1000} << 20U}) {
    chunk.number(value);
  }
  chunk.number(uint32_t{0});
  chunk.text("zstd");
  const std::vector<std::byte> packed =
      compress(Compression::zstd, std::as_bytes(std::span("hello")));
  chunk.number(static_cast<uint64_t>(packed.size()));
  chunk.bytes(packed);
  std::string bytes(reinterpret_cast<const char*>(mcap::kMagic.data()), 8);
  bytes += '\x06' + test::bytes_of(static_cast<uint64_t>(chunk.size()));
  bytes.append(reinterpret_cast<const char*>(chunk.content().data()), chunk.size());
  const TemporaryFolder folder;
  const auto file = open_mcap(folder.write("bomb.mcap", bytes));
  ASSERT_TRUE(file->damage());
  EXPECT_NE(file->damage()->found().find("it unpacks to 6 bytes, not to the 1048576000"),
            std::string::npos)
      << file->damage()->found();
}

TEST(Mcap, UnknownCompressionIsNamed) {
  const TemporaryFolder folder;
  std::string bytes = content_of(write_mcap(folder, {.summary = false}));
  for (std::size_t at = 0; (at = bytes.find("zstd", at)) != std::string::npos; at += 4) {
    bytes.replace(at, 4, "snap");
  }
  const auto file = open_mcap(folder.write("other.mcap", bytes));
  ASSERT_TRUE(file->damage());
  EXPECT_NE(file->damage()->found().find("'snap'; none, lz4 and zstd are known"),
            std::string::npos);
}

TEST(Mcap, OtherFilesAreRefused) {
  const TemporaryFolder folder;
  EXPECT_FALSE(is_mcap(folder.write("a.mcap", "hello, this is no recording")));
  EXPECT_THROW(open_mcap(folder / "a.mcap"), InputError);
  EXPECT_THROW(open_mcap(folder / "none.mcap"), InputError);
}

}  // namespace
}  // namespace adit
