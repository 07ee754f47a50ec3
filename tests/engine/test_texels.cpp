// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Buffers that kernels read as uniform texel buffers.
#include <algorithm>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/shaders/shared/engine_probe.h"
#include "adit/tests/support/device_fixture.hpp"

namespace adit::engine {
namespace {

using gpu::ProbePush;
using gpu::TexelProbePush;

using Words = std::vector<uint32_t>;

class Texels : public test::DeviceTest {
 protected:
  static Words random_words(std::size_t n, uint32_t seed) {
    std::mt19937 engine(seed);
    Words words(n);
    std::ranges::generate(words, [&] { return static_cast<uint32_t>(engine()); });
    return words;
  }
  static Words backwards(uint32_t n) {
    Words order(n);
    std::iota(order.rbegin(), order.rend(), 0U);
    return order;
  }
  static Buffer output(uint64_t texels) {
    return context().make_buffer(sizeof(gpu::ProbeSums) + kTexelBytes * texels, Memory::device,
                                 "output");
  }

  // What engine_texel_probe.comp writes: sum, number of results, results.
  static Words expected(const Words& order, std::span<const uint32_t> table,
                        std::span<const uint32_t> mask, uint32_t offset) {
    Words result{0, static_cast<uint32_t>(order.size())};
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (std::size_t c = 0; c < 4; ++c) {
        result.push_back((table[4 * order[i] + c] ^ mask[4 * i + c]) + offset);
        result[0] += result.back();
      }
    }
    return result;
  }

  static std::string mistake(const Slice& table) {
    const Kernel kernel(context(), "engine_texel_probe");
    const Buffer small = context().make_buffer(256, Memory::device, "small");
    Recorder recorder = context().make_recorder();
    try {
      recorder.dispatch(kernel, 1, TexelProbePush{0, 0}, {small, table, small, small});
    } catch (const std::logic_error& error) {
      return error.what();
    }
    return "no std::logic_error";
  }
  static void expect_parts(const std::string& text, std::initializer_list<std::string> parts) {
    for (const std::string& part : parts) {
      EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
    }
  }
};

TEST_F(Texels, KernelReadsAsTexelsWhatTheKernelBeforeItStored) {
  const Kernel write(context(), "engine_probe", {{1, 3}});
  const Kernel read(context(), "engine_texel_probe");
  for (const auto n : {1U, 7U, 1000U, static_cast<uint32_t>(kMinTexels)}) {
    SCOPED_TRACE(std::to_string(n) + " texels");
    const uint32_t items = 4 * n - 2;  // two words of sums before them make whole texels
    const Words source = random_words(items, n);
    const Words mask = random_words(4 * n, n + 1);
    const Buffer in = upload(source);
    const Buffer masks = upload(mask);
    const Buffer order = upload(backwards(n));
    const Buffer table = context().make_buffer(kTexelBytes * n, Memory::device, "table");
    const Buffer out = output(n);
    run([&](Recorder& recorder) {
      recorder.fill(table, 0);
      recorder.fill(out, 0);
      recorder.barrier();
      recorder.dispatch(write, std::min(write.groups_for(items), 16U), ProbePush{items, 11},
                        {in, table});
      recorder.barrier();
      recorder.dispatch(read, std::min(read.groups_for(n), 16U), TexelProbePush{n, 5},
                        {order, table, masks, out});
    });
    Words stored{0, items};
    for (const uint32_t word : source) {
      stored.push_back(3 * word + 11);
      stored[0] += stored.back();
    }
    EXPECT_EQ(download<uint32_t>(out), expected(backwards(n), stored, mask, 5));
  }
}

TEST_F(Texels, UploadBuffersAreReadAsTexels) {
  const Kernel kernel(context(), "engine_texel_probe");
  const Words table = random_words(4 * 50, 1);
  const Buffer mapped = context().make_buffer(kTexelBytes * 50, Memory::upload, "mapped");
  std::ranges::copy(table, mapped.as<uint32_t>().begin());
  const Buffer mask = upload(Words(4 * 50, 0));
  const Buffer order = upload(backwards(50));
  const Buffer out = output(50);
  run([&](Recorder& recorder) {
    recorder.fill(out, 0);
    recorder.barrier();
    recorder.dispatch(kernel, 1, TexelProbePush{50, 0}, {order, mapped, mask, out});
  });
  EXPECT_EQ(download<uint32_t>(out), expected(backwards(50), table, Words(4 * 50, 0), 0));
}

TEST_F(Texels, BitsThatAreNoNumberAsAFloatArriveUnchanged) {
  const Kernel kernel(context(), "engine_texel_probe");
  // Signalling and quiet NaN, denormals, minus zero, infinity: what a float format may alter.
  const Words bits{0x7F800001, 0x7FC00000, 0x00000001, 0x807FFFFF,
                   0x80000000, 0x7F800000, 0xFFFFFFFF, 0x00000000};
  const Buffer table = upload(bits);
  const Buffer zero = upload(Words(8, 0));
  const Buffer order = upload(Words{0, 1});
  const Buffer out = output(2);
  run([&](Recorder& recorder) {
    recorder.fill(out, 0);
    recorder.barrier();
    recorder.dispatch(kernel, 1, TexelProbePush{2, 0}, {order, table, zero, out});
  });
  EXPECT_EQ(download<uint32_t>(out), expected({0, 1}, bits, Words(8, 0), 0));
}

TEST_F(Texels, MoreRangesOfABufferThanViewsAreKeptAllReadTheirPart) {
  const Kernel kernel(context(), "engine_texel_probe");
  constexpr uint32_t kRanges = 150;
  const Words words = random_words(64 * kRanges, 3);
  const Words mask(4 * 16, 0x5A5A5A5A);
  const Buffer table = upload(words);
  const Buffer masks = upload(mask);
  const Buffer order = upload(backwards(16));
  const uint64_t stride = align_slice(output(16).size());
  const Buffer out = context().make_buffer(kRanges * stride, Memory::device, "outputs");
  std::optional<Submission> before;
  for (int round = 0; round < 2; ++round) {  // the second while the first may be in flight
    Recorder recorder = context().make_recorder();
    recorder.fill(out, 0);
    recorder.barrier();
    for (uint32_t i = 0; i < kRanges; ++i) {
      // A length of its own for each, too: not all of it is read.
      const uint64_t bytes = kTexelBytes * (16 + (i < kRanges - 1 ? i % 3 : 0));
      recorder.dispatch(kernel, 1, TexelProbePush{16, 1},
                        {order, table.slice(256 * i, bytes), masks, out.slice(i * stride, stride)});
    }
    Submission submission = context().submit(std::move(recorder));
    before = std::move(submission);
  }
  before->wait();
  const Words results = download<uint32_t>(out);
  for (uint32_t i = 0; i < kRanges; ++i) {
    SCOPED_TRACE("range " + std::to_string(i));
    const auto part = std::span(results).subspan(i * stride / 4, 2 + 4 * 16);
    ASSERT_EQ(Words(part.begin(), part.end()),
              expected(backwards(16), std::span(words).subspan(64 * i, 64), mask, 1));
  }
}

TEST_F(Texels, RecordingThatIsDroppedAfterItsBufferLeavesNoTrace) {
  const Kernel kernel(context(), "engine_texel_probe");
  Recorder recorder = context().make_recorder();
  {
    const Buffer table = upload(Words(64, 1), "gone");
    recorder.dispatch(kernel, 1, TexelProbePush{0, 0}, {table, table, table, table});
  }
  recorder = context().make_recorder();
  const Buffer table = upload(Words(64, 1));
  recorder.dispatch(kernel, 1, TexelProbePush{0, 0}, {table, table, table, table});
  context().submit(std::move(recorder)).wait();
}

TEST_F(Texels, SliceThatIsNotWholeTexelsIsRefused) {
  const Buffer table = context().make_buffer(4096, Memory::device, "table");
  expect_parts(mistake(table.slice(256, 40)),
               {"engine_texel_probe", "binding 1", "multiples of 16 bytes", "40 bytes at 256"});
  expect_parts(mistake(table.slice(16, 64)), {"binding 1", "256", "64 bytes at 16"});
  EXPECT_EQ(mistake(table.slice(256, 48)), "no std::logic_error");
}

TEST_F(Texels, TexelsHaveALimitOfTheirOwn) {
  const DeviceInfo& device = context().device();
  ASSERT_GE(device.max_texel_buffer_elements, kMinTexels);
  const uint64_t most = kTexelBytes * device.max_texel_buffer_elements;
  // Just above the lower limit, of storage or of texels. Nothing of it is touched.
  const uint64_t bytes = align_slice(std::min(most, device.max_storage_buffer_bytes) + 1);
  const Buffer large = context().make_buffer(bytes, Memory::device, "large");
  if (bytes <= most) {
    EXPECT_EQ(mistake(large), "no std::logic_error");
  } else {
    expect_parts(mistake(large), {"engine_texel_probe", "binding 1", device.name, "large",
                                  "at most " + std::to_string(device.max_texel_buffer_elements)});
    EXPECT_EQ(mistake(large.slice(0, most)), "no std::logic_error");
  }
}

}  // namespace
}  // namespace adit::engine
