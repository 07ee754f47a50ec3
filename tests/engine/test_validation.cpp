// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The validation layer is worth its place in the tests only if it sees mistakes: these make some.
#include <string>

#include <gtest/gtest.h>

#include "adit/shaders/shared/engine_probe.h"
#include "adit/tests/support/device_fixture.hpp"

namespace adit::engine {
namespace {

using gpu::ProbePush;

// On whatever ADIT_TEST_VALIDATION says: without the layer there is nothing to test here.
ContextOptions validated(bool synchronization) {
  ContextOptions options;
  options.validation = true;
  options.synchronization_validation = synchronization;
  return options;
}

void write_and_read(Context& context, bool with_barrier) {
  const Kernel kernel(context, "engine_probe");
  const Buffer in = context.make_buffer(4096, Memory::device, "input");
  const Buffer out = context.make_buffer(4096, Memory::device, "racing output");
  Recorder recorder = context.make_recorder();
  recorder.fill(out, 0);
  recorder.fill(in, 1);
  if (with_barrier) {
    recorder.barrier();
  }
  recorder.dispatch(kernel, 1, ProbePush{1000, 0}, {in, out});
  context.submit(std::move(recorder)).wait();
}

TEST(Validation, MissingBarrierIsReportedWithTheNamesOfBufferAndKernel) {
  Context context(validated(true));
  write_and_read(context, false);
  const std::vector<std::string> messages = context.validation_messages();
  ASSERT_FALSE(messages.empty());
  for (const char* part : {"SYNC-HAZARD", "[racing output]", "[engine_probe]"}) {
    EXPECT_NE(messages.front().find(part), std::string::npos)
        << part << " is not in: " << messages.front();
  }
}

TEST(Validation, BarrierMakesItSilent) {
  Context context(validated(true));
  write_and_read(context, true);
  EXPECT_TRUE(context.validation_messages().empty());
}

TEST(Validation, BarrierCoversKernelToKernelCopyAndIndirectArguments) {
  Context context(validated(true));
  const Kernel kernel(context, "engine_probe");
  const Buffer in = context.make_buffer(4096, Memory::device, "input");
  const Buffer out = context.make_buffer(4096, Memory::device, "output");
  const Buffer last = context.make_buffer(4096, Memory::device, "last");
  const Buffer back = context.make_buffer(4096, Memory::readback, "back");
  Recorder recorder = context.make_recorder();
  recorder.fill(in, 0);
  recorder.fill(out, 0);
  recorder.fill(last, 0);
  recorder.barrier();
  recorder.dispatch(kernel, 1, ProbePush{100, 1}, {in, out});
  recorder.barrier();
  // The results (1, 1, 1, ...) of the first kernel are the group counts of the second.
  recorder.dispatch_indirect(kernel, out.slice(8, 12), ProbePush{10, 5}, {out, last});
  recorder.barrier();
  recorder.copy(last, back);
  context.submit(std::move(recorder)).wait();
  EXPECT_EQ(back.as<gpu::ProbeSums>()[0].items, 10U);
  EXPECT_EQ(back.as<gpu::ProbeSums>()[0].total, 100U + 100U + 8U + 10U * 5U);
  EXPECT_TRUE(context.validation_messages().empty()) << context.validation_messages().front();
}

// A kernel stores, and the next reads the same through a texel buffer.
void store_and_fetch(Context& context, bool with_barrier) {
  const Kernel store(context, "engine_probe");
  const Kernel fetch(context, "engine_texel_probe");
  const Buffer in = context.make_buffer(4096, Memory::device, "input");
  const Buffer table = context.make_buffer(4096, Memory::device, "racing table");
  const Buffer out = context.make_buffer(4096, Memory::device, "output");
  Recorder recorder = context.make_recorder();
  for (const Buffer* buffer : {&in, &table, &out}) {
    recorder.fill(*buffer, 0);
  }
  recorder.barrier();
  recorder.dispatch(store, 1, ProbePush{100, 1}, {in, table});
  if (with_barrier) {
    recorder.barrier();
  }
  recorder.dispatch(fetch, 1, gpu::TexelProbePush{10, 0}, {in, table, in, out});
  context.submit(std::move(recorder)).wait();
}

TEST(Validation, MissingBarrierBeforeATexelFetchIsReported) {
  Context context(validated(true));
  store_and_fetch(context, false);
  const std::vector<std::string> messages = context.validation_messages();
  ASSERT_FALSE(messages.empty());
  for (const char* part :
       {"SYNC-HAZARD-READ-AFTER-WRITE", "[racing table]", "[engine_texel_probe]"}) {
    EXPECT_NE(messages.front().find(part), std::string::npos)
        << part << " is not in: " << messages.front();
  }
}

TEST(Validation, BarrierCoversTexelFetches) {
  Context context(validated(true));
  store_and_fetch(context, true);
  EXPECT_TRUE(context.validation_messages().empty()) << context.validation_messages().front();
}

TEST(Validation, OffMeansNoMessages) {
  Context context({});
  write_and_read(context, false);
  EXPECT_TRUE(context.validation_messages().empty());
}

}  // namespace
}  // namespace adit::engine
