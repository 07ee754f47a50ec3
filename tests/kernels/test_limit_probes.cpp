// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The kernels that measure a device's limits do the work that their figures count.
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/reference/limit_probes.hpp"
#include "adit/engine/kernels/limit_probes.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using gpu::uvec4;

class LimitProbes : public test::DeviceTest {
 protected:
  static std::vector<uvec4> numbered(uint32_t count) {
    std::vector<uvec4> values;
    for (uint32_t i = 0; i < count; ++i) {
      values.push_back({i, ~i, reference::mix32(i), reference::mix32(~i)});
    }
    return values;
  }
  static bool same(const uvec4& a, const uvec4& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w;
  }
};

TEST_F(LimitProbes, CopiesEverything) {
  const engine::LimitProbes probes(context());
  for (const uint32_t count : {1U, 1000U, 70'001U}) {
    const std::vector<uvec4> values = numbered(count);
    const engine::Buffer from = upload(values);
    const engine::Buffer to =
        context().make_buffer(from.size(), engine::Memory::device, "test output");
    run([&](engine::Recorder& recorder) { probes.record_copy(recorder, from, to); });
    const std::vector<uvec4> copied = download<uvec4>(to);
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < count; ++i) {
      wrong += same(copied[i], values[i]) ? 0U : 1U;
    }
    EXPECT_EQ(wrong, 0U) << "of " << count;
  }
}

TEST_F(LimitProbes, MultipliesAndAddsAsOftenAsItSays) {
  const engine::LimitProbes probes(context());
  const engine::Buffer results =
      context().make_buffer(probes.threads() * sizeof(float), engine::Memory::device, "sums");
  for (const uint32_t rounds : {0U, 1U, 20U}) {
    const gpu::LimitMultiplyAddPush push{rounds, 0.9921875F, 0.25F};
    run([&](engine::Recorder& recorder) { probes.record_multiply_add(recorder, push, results); });
    const std::vector<float> sums = download<float>(results);
    for (uint32_t t = 0; t < probes.threads(); ++t) {
      const double expected = reference::multiply_add(push, t % probes.local_size());
      // 320 steps at most, half a unit in the last place each, of values up to 32; eight chains.
      ASSERT_NEAR(sums[t], expected, 320 * 8 * 32 * 6e-8) << "thread " << t << ", " << rounds;
    }
  }
}

TEST_F(LimitProbes, ReadsTheRecordsItSays) {
  const engine::LimitProbes probes(context());
  const std::vector<uvec4> table = numbered(gpu::kRecordQuads * 4096);
  const engine::Buffer records = upload(table);
  const engine::Buffer results =
      context().make_buffer(probes.threads() * sizeof(uvec4), engine::Memory::device, "xors");
  const uint32_t count = 3 * probes.threads() + 17;
  run([&](engine::Recorder& recorder) { probes.record_gather(recorder, count, records, results); });
  const std::vector<uvec4> found = download<uvec4>(results);
  uint32_t wrong = 0;
  for (uint32_t t = 0; t < probes.threads(); ++t) {
    wrong += same(found[t], reference::gather(table, count, probes.threads(), t)) ? 0U : 1U;
  }
  EXPECT_EQ(wrong, 0U);
}

TEST_F(LimitProbes, AddsToTheWordsItSays) {
  const engine::LimitProbes probes(context());
  const uint32_t count = 2 * probes.threads() + 5;
  std::vector<uint32_t> expected(1024, 7);
  const engine::Buffer table = upload(expected);
  run([&](engine::Recorder& recorder) { probes.record_atomics(recorder, count, table); });
  for (uint32_t i = 0; i < count; ++i) {
    expected[reference::mix32(i) % expected.size()] += 1;
  }
  EXPECT_EQ(download<uint32_t>(table), expected);
}

}  // namespace
}  // namespace adit
