// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/shaders/shared/engine_probe.h"
#include "adit/tests/support/device_fixture.hpp"

namespace adit::engine {
namespace {

using gpu::ProbePush;

template <class Call>
std::string mistake(Call&& call) {
  try {
    call();
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "no std::logic_error";
}

class DispatchMistakes : public test::DeviceTest {
 protected:
  void expect_mistake(const std::string& text, std::initializer_list<const char*> parts) {
    for (const char* part : parts) {
      EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
    }
  }

  Kernel kernel_{context(), "engine_probe"};
  Buffer in_ = context().make_buffer(4096, Memory::device, "points");
  Buffer out_ = context().make_buffer(4096, Memory::device, "cells");
  Recorder recorder_ = context().make_recorder();
};

TEST_F(DispatchMistakes, PushConstantsOfTheWrongSizeNameKernelAndSizes) {
  expect_mistake(mistake([&] {
                   recorder_.dispatch(kernel_, 1, uint32_t{1}, {in_, out_});
                 }),
                 {"engine_probe", "push constants have 8 bytes", "given 4"});
  expect_mistake(mistake([&] {
                   recorder_.dispatch(kernel_, 1, {in_, out_});
                 }),
                 {"8 bytes", "given 0"});
}

TEST_F(DispatchMistakes, WrongNumberOfBuffersNamesBoth) {
  expect_mistake(mistake([&] { recorder_.dispatch(kernel_, 1, ProbePush{}, {in_}); }),
                 {"engine_probe", "binds 2 buffers", "given 1"});
  expect_mistake(mistake([&] {
                   recorder_.dispatch(kernel_, 1, ProbePush{}, {in_, out_, out_});
                 }),
                 {"given 3"});
}

TEST_F(DispatchMistakes, MisalignedSliceNamesBindingAndOffset) {
  expect_mistake(mistake([&] {
                   recorder_.dispatch(kernel_, 1, ProbePush{}, {in_, out_.slice(16, 64)});
                 }),
                 {"engine_probe", "binding 1", "256", "64 bytes at 16", "cells"});
}

TEST_F(DispatchMistakes, SliceWithoutBytesOrBufferIsRefused) {
  expect_mistake(mistake([&] {
                   recorder_.dispatch(kernel_, 1, ProbePush{}, {in_.slice(0, 0), out_});
                 }),
                 {"binding 0", "empty"});
  expect_mistake(mistake([&] {
                   recorder_.dispatch(kernel_, 1, ProbePush{}, {Slice{}, out_});
                 }),
                 {"binding 0", "no buffer"});
}

TEST_F(DispatchMistakes, SlicePastTheEndOfItsBufferIsRefused) {
  expect_mistake(
      mistake([&] {
        recorder_.dispatch(kernel_, 1, ProbePush{}, {Slice{in_.slice().buffer, 256, 4096}, out_});
      }),
      {"binding 0", "past", "points"});
}

TEST_F(DispatchMistakes, SliceLargerThanTheDeviceBindsIsRefused) {
  // Nothing of it is touched, so a software device does not need the memory.
  const uint64_t limit = context().device().max_storage_buffer_bytes;
  if (limit >= 1ULL << 30U) {
    // The largest buffer of the device is no larger than the largest slice: it cannot be exceeded.
    EXPECT_THROW(context().make_buffer(limit + 4, Memory::device, "huge"), OutOfMemory);
    return;
  }
  const Buffer huge = context().make_buffer(limit + 256, Memory::device, "huge");
  expect_mistake(mistake([&] {
                   recorder_.dispatch(kernel_, 1, ProbePush{}, {huge, out_});
                 }),
                 {"binding 0", "at most ", "huge"});
  recorder_.dispatch(kernel_, 1, ProbePush{0, 0}, {huge.slice(0, limit), out_});
}

TEST_F(DispatchMistakes, TooManyGroupsAreRefused) {
  expect_mistake(mistake([&] {
                   recorder_.dispatch(kernel_, 65'536, ProbePush{}, {in_, out_});
                 }),
                 {"engine_probe", "65535", "given 65536"});
  EXPECT_NO_THROW(recorder_.dispatch(kernel_, 65'535, ProbePush{}, {in_, out_}));
}

TEST_F(DispatchMistakes, IndirectArgumentsThatDoNotFitAreRefused) {
  const auto with = [&](Slice args) {
    return mistake([&] { recorder_.dispatch_indirect(kernel_, args, ProbePush{}, {in_, out_}); });
  };
  expect_mistake(with(in_.slice(0, 8)), {"engine_probe", "indirect", "12 bytes"});
  expect_mistake(with(in_.slice(2, 12)), {"indirect", "multiple of 4"});
  expect_mistake(with(Slice{}), {"indirect", "no buffer"});
}

TEST_F(DispatchMistakes, FillAndCopyCheckTheirRanges) {
  expect_mistake(mistake([&] { recorder_.fill(in_.slice(0, 6), 0); }), {"fill", "multiples of 4"});
  expect_mistake(mistake([&] { recorder_.fill(in_.slice(2, 8), 0); }), {"fill", "multiples of 4"});
  expect_mistake(mistake([&] { recorder_.copy(in_.slice(0, 8), out_.slice(0, 4)); }),
                 {"copy", "lengths differ"});
  expect_mistake(mistake([&] { recorder_.copy(in_.slice(0, 8), in_.slice(4, 8)); }),
                 {"copy", "overlap"});
  expect_mistake(mistake([&] { recorder_.copy(Slice{}, out_); }), {"copy", "no buffer"});
}

TEST_F(DispatchMistakes, UnknownShaderAndConstantAreRefused) {
  expect_mistake(mistake([&] { Kernel kernel(context(), "engine_prob"); }),
                 {"no shader 'engine_prob'"});
  expect_mistake(mistake([&] {
                   Kernel kernel(context(), "engine_probe", {{7, 1}});
                 }),
                 {"engine_probe", "constant 7"});
  expect_mistake(mistake([&] {
                   Kernel kernel(context(), "engine_probe", {{1, 1}, {1, 2}});
                 }),
                 {"given twice"});
}

TEST_F(DispatchMistakes, WorkGroupBeyondTheDeviceIsRefused) {
  const uint32_t limit = context().device().max_workgroup_invocations;
  expect_mistake(mistake([&] {
                   Kernel kernel(context(), "engine_probe", {{0, limit + 1}});
                 }),
                 {"engine_probe", "work-group size"});
  expect_mistake(mistake([&] {
                   Kernel kernel(context(), "engine_probe", {{0, 0}});
                 }),
                 {"work-group size of 0"});
}

TEST_F(DispatchMistakes, WhatBelongsToAnotherContextIsRefused) {
  Context other(test::test_options());
  const Kernel stranger(other, "engine_probe");
  const Buffer far = other.make_buffer(4096, Memory::device, "far");
  expect_mistake(mistake([&] {
                   recorder_.dispatch(stranger, 1, ProbePush{}, {in_, out_});
                 }),
                 {"engine_probe", "another context"});
  expect_mistake(mistake([&] {
                   recorder_.dispatch(kernel_, 1, ProbePush{}, {in_, far});
                 }),
                 {"binding 1", "another context", "far"});
  expect_mistake(mistake([&] { (void)other.submit(std::move(recorder_)); }), {"another context"});
}

TEST_F(DispatchMistakes, GroupsForMoreItemsThanADispatchTakesAreRefused) {
  EXPECT_EQ(kernel_.groups_for(0), 0U);
  EXPECT_EQ(kernel_.groups_for(64), 1U);
  EXPECT_EQ(kernel_.groups_for(65), 2U);
  expect_mistake(mistake([&] {
                   recorder_.dispatch(kernel_, kernel_.groups_for(~0ULL), ProbePush{}, {in_, out_});
                 }),
                 {"at most 65535"});
}

TEST_F(DispatchMistakes, SubmittedRecorderRecordsNoMore) {
  const Submission submission = context().submit(std::move(recorder_));
  EXPECT_THROW(recorder_.barrier(),
               std::logic_error);  // NOLINT(bugprone-use-after-move): that is the test
  EXPECT_THROW((void)context().submit(std::move(recorder_)), std::logic_error);
}

TEST_F(DispatchMistakes, OpenScopeIsNotSubmitted) {
  const auto scope = recorder_.scope("open");
  EXPECT_THROW((void)context().submit(std::move(recorder_)), std::logic_error);
}

TEST_F(DispatchMistakes, TimesAreNotReadBeforeTheWait) {
  const Submission submission = context().submit(std::move(recorder_));
  EXPECT_THROW(submission.scope_times(), std::logic_error);
}

TEST_F(DispatchMistakes, BufferThatIsNotMappedHasNoHostView) {
  if (context().device().unified_memory) {
    EXPECT_EQ(in_.as<uint32_t>().size(), 1024U);
  } else {
    EXPECT_THROW(in_.as<uint32_t>(), std::logic_error);
  }
}

}  // namespace
}  // namespace adit::engine
