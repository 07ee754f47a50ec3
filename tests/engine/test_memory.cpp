// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/device_fixture.hpp"

namespace adit::engine {
namespace {

constexpr uint64_t kMiB = 1ULL << 20U;

ContextOptions with_budget(uint64_t bytes) {
  ContextOptions options = test::test_options();
  options.memory_budget_bytes = bytes;
  return options;
}

TEST(Memory, UseIsCountedAndReturned) {
  Context context(test::test_options());
  EXPECT_EQ(context.memory_in_use(), 0U);
  {
    const Buffer one = context.make_buffer(1000, Memory::device, "one");
    const Buffer two = context.make_buffer(256, Memory::device, "two");
    EXPECT_EQ(context.memory_in_use(), 1024U + 256U);
    EXPECT_GE(context.memory_reserved(), context.memory_in_use());
  }
  EXPECT_EQ(context.memory_in_use(), 0U);
  EXPECT_EQ(context.memory_peak(), 1280U);
  EXPECT_TRUE(context.validation_messages().empty());
}

TEST(Memory, BuffersOfABlockDoNotOverlap) {
  Context context(test::test_options());
  std::vector<Buffer> buffers;
  for (uint32_t i = 0; i < 100; ++i) {
    buffers.push_back(context.make_buffer(4 * (i + 1), Memory::upload, "piece"));
    for (uint32_t& word : buffers.back().as<uint32_t>()) {
      word = i;
    }
  }
  for (uint32_t i = 0; i < 100; ++i) {
    ASSERT_EQ(buffers[i].as<uint32_t>().size(), i + 1);
    for (const uint32_t word : buffers[i].as<uint32_t>()) {
      ASSERT_EQ(word, i);
    }
  }
}

TEST(Memory, SliceOfABufferThatWasMovedIsTheSameBytes) {
  Context context(test::test_options());
  auto first = std::make_unique<Buffer>(context.make_buffer(1024, Memory::upload, "first"));
  const Slice slice = first->slice(256, 512);
  const Buffer second = std::move(*first);
  first.reset();
  std::memset(slice.mapped(), 7, 512);
  EXPECT_EQ(slice.mapped(), second.mapped() + 256);
  Recorder recorder = context.make_recorder();
  recorder.fill(slice, 0x01020304);
  context.submit(std::move(recorder)).wait();
  EXPECT_EQ(second.as<uint32_t>()[64], 0x01020304U);
  EXPECT_THROW(
      {
        try {
          slice.sub(512, 1);
        } catch (const std::out_of_range& error) {
          EXPECT_NE(std::string(error.what()).find("'first'"), std::string::npos) << error.what();
          throw;
        }
      },
      std::out_of_range);
}

TEST(Memory, UnusedMemoryIsReusedForTheNextBuffer) {
  Context context(test::test_options());
  uint64_t reserved = 0;
  for (int i = 0; i < 50; ++i) {
    const Buffer buffer = context.make_buffer(kMiB, Memory::device, "one of many");
    reserved = i == 0 ? context.memory_reserved() : reserved;
    EXPECT_EQ(context.memory_reserved(), reserved);
  }
}

TEST(Memory, LargeBufferGoesBackToTheDevice) {
  Context context(test::test_options());
  { const Buffer large = context.make_buffer(100 * kMiB, Memory::device, "large"); }
  EXPECT_EQ(context.memory_reserved(), 0U);
}

TEST(Memory, BudgetIsEnforcedAndTheErrorNamesEverything) {
  Context context(with_budget(8 * kMiB));
  const Buffer first = context.make_buffer(5 * kMiB, Memory::device, "first");
  try {
    const Buffer second = context.make_buffer(4 * kMiB, Memory::device, "voxel table");
    FAIL() << "the budget is not enforced";
  } catch (const OutOfMemory& error) {
    const std::string text = error.what();
    for (const char* part : {"voxel table", "4194304", "8388608", "5242880", "at least 9437184"}) {
      EXPECT_NE(text.find(part), std::string::npos) << part << " is not in: " << text;
    }
  }
  EXPECT_LE(context.memory_reserved(), 8 * kMiB);
  const Buffer third = context.make_buffer(2 * kMiB, Memory::device, "still usable");
  EXPECT_LE(context.memory_reserved(), 8 * kMiB);
}

TEST(Memory, BudgetSmallerThanABlockIsUsedToItsLastByte) {
  Context context(with_budget(kMiB));
  const Buffer first = context.make_buffer(kMiB / 2, Memory::device, "first half");
  const Buffer second = context.make_buffer(kMiB / 2, Memory::device, "second half");
  EXPECT_EQ(context.memory_reserved(), kMiB);
  EXPECT_THROW(context.make_buffer(4, Memory::device, "one more"), OutOfMemory);
}

TEST(Memory, UnusedBlocksMakeRoomUnderTheBudget) {
  Context context(with_budget(6 * kMiB));
  {
    const Buffer small = context.make_buffer(256, Memory::device, "small");
  }  // its block of 4 MiB stays
  const Buffer large = context.make_buffer(5 * kMiB, Memory::device, "large");
  EXPECT_EQ(context.memory_reserved(), 5 * kMiB);
}

TEST(Memory, BufferBeyondTheDeviceIsAnErrorThatNamesIt) {
  Context context(test::test_options());
  try {
    const Buffer buffer = context.make_buffer(1ULL << 45U, Memory::device, "the world");
    FAIL() << "32 TiB were given";
  } catch (const OutOfMemory& error) {
    EXPECT_NE(std::string(error.what()).find("the world"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(context.validation_messages().empty());
}

TEST(Memory, EmptyBufferIsAMistake) {
  Context context(test::test_options());
  EXPECT_THROW(context.make_buffer(0, Memory::device, "nothing"), std::logic_error);
}

TEST(Memory, SlicesStayInsideTheirBuffer) {
  Context context(test::test_options());
  const Buffer buffer = context.make_buffer(1024, Memory::device, "cut");
  const Slice part = buffer.slice(256, 512);
  EXPECT_EQ(part.sub(256, 256).offset, 512U);
  EXPECT_EQ(part.from(256).bytes, 256U);
  EXPECT_THROW(part.sub(256, 257), std::out_of_range);
  EXPECT_THROW(part.sub(513, 0), std::out_of_range);
  EXPECT_THROW(part.from(513), std::out_of_range);
  EXPECT_THROW(buffer.slice(~0ULL, 2), std::out_of_range);
}

}  // namespace
}  // namespace adit::engine
