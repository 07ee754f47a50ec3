// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <numeric>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "adit/shaders/embedded.hpp"
#include "adit/shaders/shared/engine_probe.h"
#include "adit/tests/support/device_fixture.hpp"

namespace adit::engine {
namespace {

using gpu::ProbePush;

constexpr uint64_t kHeader = sizeof(gpu::ProbeSums);

class Dispatch : public test::DeviceTest {
 protected:
  static std::vector<uint32_t> counting(uint32_t n) {
    std::vector<uint32_t> values(n);
    std::iota(values.begin(), values.end(), 0U);
    return values;
  }
  static Buffer output(uint32_t n) {
    return context().make_buffer(kHeader + 4ULL * n, Memory::device, "output");
  }

  // What engine_probe.comp writes: sum, number of items, results.
  static std::vector<uint32_t> expected(const std::vector<uint32_t>& values, uint32_t scale,
                                        uint32_t offset) {
    std::vector<uint32_t> result{0, static_cast<uint32_t>(values.size())};
    for (const uint32_t value : values) {
      result.push_back(scale * value + offset);
      result[0] += result.back();
    }
    return result;
  }
};

TEST_F(Dispatch, ProbeComputesWhatItsTwinComputesForAllSizes) {
  for (const uint32_t local_size : {1U, 4U, 64U, 96U, 256U}) {
    const Kernel kernel(context(), "engine_probe", {{0, local_size}, {1, 3}});
    EXPECT_EQ(kernel.local_size(), local_size);
    for (const uint32_t n : {1U, 7U, 64U, 1000U, 70'001U}) {
      SCOPED_TRACE("local size " + std::to_string(local_size) + ", n " + std::to_string(n));
      const std::vector<uint32_t> values = counting(n);
      const Buffer in = upload(values);
      const Buffer out = output(n);
      run([&](Recorder& recorder) {
        recorder.fill(out, 0);
        recorder.barrier();
        recorder.dispatch(kernel, std::min(kernel.groups_for(n), 16U), ProbePush{n, 11}, {in, out});
      });
      EXPECT_EQ(download<uint32_t>(out), expected(values, 3, 11));
    }
  }
}

TEST_F(Dispatch, ASubmissionTellsWhatWasRecorded) {
  const Kernel kernel(context(), "engine_probe");
  const Buffer up = context().make_buffer(4096, Memory::upload, "up");
  const Buffer in = context().make_buffer(4096, Memory::device, "in");
  const Buffer out = output(1000);
  const Buffer down = context().make_buffer(1024, Memory::readback, "down");
  Recorder recorder = context().make_recorder();
  recorder.copy(up.slice(0, 4000), in.slice(0, 4000));
  recorder.fill(out, 0);
  recorder.barrier();
  recorder.dispatch(kernel, 4, ProbePush{1000, 0}, {in, out});
  recorder.dispatch(kernel, 0, ProbePush{1000, 0}, {in, out});
  recorder.barrier();
  recorder.copy(out.slice(0, 1024), down);
  Submission submission = context().submit(std::move(recorder));
  submission.wait();
  RecordedWork work = submission.recorded();
  work += work;
  EXPECT_EQ(work.submissions, 2U);
  EXPECT_EQ(work.dispatches, 2U);  // no groups, no dispatch
  EXPECT_EQ(work.barriers, 6U);    // a submission begins with one
  EXPECT_EQ(work.copies, 6U);
  EXPECT_EQ(work.upload_bytes, 8000U);
  EXPECT_EQ(work.readback_bytes, 2048U);
}

TEST_F(Dispatch, ConstantsHaveTheirDefaultsUnlessSpecialised) {
  const Kernel kernel(context(), "engine_probe");
  EXPECT_EQ(kernel.local_size(), kDefaultLocalSize);
  const Buffer in = upload(counting(10));
  const Buffer out = output(10);
  run([&](Recorder& recorder) {
    recorder.fill(out, 0);
    recorder.barrier();
    recorder.dispatch(kernel, 1, ProbePush{10, 0}, {in, out});
  });
  EXPECT_EQ(download<uint32_t>(out), expected(counting(10), 1, 0));
}

TEST_F(Dispatch, ShaderOfTheCallersOwnIsAKernelToo) {
  const std::span<const uint32_t> embedded = shaders::find("engine_probe");
  std::vector<uint32_t> words(embedded.begin(), embedded.end());
  const Kernel kernel(context(), {.name = "own", .spirv = words}, {{1, 3}});
  words.clear();  // it keeps none of them
  EXPECT_EQ(kernel.name(), "own");
  const Buffer in = upload(counting(100));
  const Buffer out = output(100);
  run([&](Recorder& recorder) {
    recorder.fill(out, 0);
    recorder.barrier();
    recorder.dispatch(kernel, 2, ProbePush{100, 7}, {in, out});
  });
  EXPECT_EQ(download<uint32_t>(out), expected(counting(100), 3, 7));
  EXPECT_THROW(Kernel(context(), {.name = "cut short", .spirv = embedded.first(3)}), Error);
  EXPECT_THROW(Kernel(context(), {.name = "empty", .spirv = {}}), Error);
}

TEST_F(Dispatch, SlicesBindTheirPartOfABuffer) {
  const Kernel kernel(context(), "engine_probe");
  const Buffer in = upload(counting(1024));
  const Buffer out = context().make_buffer(4096, Memory::device, "output");
  run([&](Recorder& recorder) {
    recorder.fill(out, 0);
    recorder.barrier();
    recorder.dispatch(kernel, 1, ProbePush{3, 0}, {in.slice(512, 256), out.slice(1024, 512)});
  });
  const std::vector<uint32_t> words = download<uint32_t>(out);
  EXPECT_EQ(words[255], 0U);
  EXPECT_EQ(words[256], 128U + 129U + 130U);
  EXPECT_EQ(words[256 + 2], 128U);
  EXPECT_EQ(words[256 + 5], 0U);
}

TEST_F(Dispatch, FillSetsItsRangeAndNothingElse) {
  const Buffer buffer = upload(std::vector<uint32_t>(8, 7));
  run([&](Recorder& recorder) { recorder.fill(buffer.slice(4, 12), 0xABCD0123); });
  EXPECT_EQ(download<uint32_t>(buffer),
            (std::vector<uint32_t>{7, 0xABCD0123, 0xABCD0123, 0xABCD0123, 7, 7, 7, 7}));
}

TEST_F(Dispatch, CopyMovesItsRangeAndNothingElse) {
  const Buffer buffer = upload(counting(8));
  run([&](Recorder& recorder) { recorder.copy(buffer.slice(4, 8), buffer.slice(20, 8)); });
  EXPECT_EQ(download<uint32_t>(buffer), (std::vector<uint32_t>{0, 1, 2, 3, 4, 1, 2, 7}));
}

TEST_F(Dispatch, IndirectDispatchRunsTheGroupsThatTheDeviceWrote) {
  const Kernel kernel(context(), "engine_probe");
  const std::vector<uint32_t> values = counting(1000);
  const Buffer in = upload(values);
  const Buffer out = output(1000);
  const Buffer args = upload(std::vector<uint32_t>{9, 9, 9, 0, 0, 0});
  run([&](Recorder& recorder) {
    recorder.fill(out, 0);
    recorder.fill(args.slice(12, 12), 1);  // on the device, ahead of the dispatch that reads it
    recorder.barrier();
    recorder.dispatch_indirect(kernel, args.slice(12, 12), ProbePush{1000, 5}, {in, out});
  });
  EXPECT_EQ(download<uint32_t>(out), expected(values, 1, 5));
}

TEST_F(Dispatch, IndirectDispatchOfNoGroupsDoesNothing) {
  const Kernel kernel(context(), "engine_probe");
  const Buffer in = upload(counting(100));
  const Buffer out = output(100);
  const Buffer args = upload(std::vector<uint32_t>{0, 1, 1});
  run([&](Recorder& recorder) {
    recorder.fill(out, 42);
    recorder.barrier();
    recorder.dispatch_indirect(kernel, args, ProbePush{100, 5}, {in, out});
  });
  EXPECT_EQ(download<uint32_t>(out), std::vector<uint32_t>(102, 42));
}

TEST_F(Dispatch, DispatchOfNoGroupsDoesNothing) {
  const Kernel kernel(context(), "engine_probe");
  const Buffer in = upload(counting(100));
  const Buffer out = upload(std::vector<uint32_t>(102, 42));
  run([&](Recorder& recorder) { recorder.dispatch(kernel, 0, ProbePush{100, 5}, {in, out}); });
  EXPECT_EQ(download<uint32_t>(out), std::vector<uint32_t>(102, 42));
}

TEST_F(Dispatch, SecondSubmissionSeesWhatTheFirstWroteWithoutAWaitBetween) {
  const Kernel kernel(context(), "engine_probe", {{1, 2}});
  const Buffer in = upload(counting(50'000));
  const Buffer out = output(50'000);
  const Buffer back = context().make_buffer(out.size(), Memory::readback, "back");
  Recorder first = context().make_recorder();
  first.fill(out, 0);
  first.barrier();
  first.dispatch(kernel, 8, ProbePush{50'000, 1}, {in, out});
  Recorder second = context().make_recorder();
  second.copy(out, back);
  Submission one = context().submit(std::move(first));
  Submission two = context().submit(std::move(second));
  two.wait();
  EXPECT_TRUE(one.done()) << "submissions run in order";
  EXPECT_TRUE(two.done());
  const std::span<const uint32_t> words = back.as<uint32_t>();
  EXPECT_EQ(std::vector<uint32_t>(words.begin(), words.end()), expected(counting(50'000), 2, 1));
}

TEST_F(Dispatch, HundredsOfDispatchesFitIntoARecordingAndRecordingsAreReused) {
  const Kernel kernel(context(), "engine_probe");
  const Buffer in = upload(counting(16));
  for (int round = 0; round < 3; ++round) {
    const Buffer out = output(16);
    run([&](Recorder& recorder) {
      recorder.fill(out, 0);
      for (uint32_t i = 0; i < 700; ++i) {
        recorder.barrier();
        recorder.dispatch(kernel, 1, ProbePush{16, 0}, {in, out});
      }
    });
    EXPECT_EQ(download<gpu::ProbeSums>(out.slice(0, kHeader))[0].items, 700U * 16U);
  }
}

TEST_F(Dispatch, RecorderThatIsDroppedLeavesNoTrace) {
  const Buffer buffer = upload(counting(4));
  {
    Recorder recorder = context().make_recorder();
    recorder.fill(buffer, 9);
  }
  run([](Recorder&) {});
  EXPECT_EQ(download<uint32_t>(buffer), counting(4));
}

TEST_F(Dispatch, ScopesAreTimedInOrderAndContainTheirInnerScopes) {
  const Kernel kernel(context(), "engine_probe");
  const Buffer in = upload(counting(200'000));
  const Buffer out = output(200'000);
  const std::vector<ScopeTime> times = run([&](Recorder& recorder) {
    const auto outer = recorder.scope("sweep");
    {
      const auto inner = recorder.scope("clear");
      recorder.fill(out, 0);
    }
    recorder.barrier();
    {
      const auto inner = recorder.scope("probe");
      recorder.dispatch(kernel, 16, ProbePush{200'000, 1}, {in, out});
    }
  });
  ASSERT_EQ(times.size(), 3U);
  EXPECT_EQ(times[0].name, "sweep");
  EXPECT_EQ(times[1].name, "clear");
  EXPECT_EQ(times[2].name, "probe");
  EXPECT_EQ(times[0].depth, 0U);
  EXPECT_EQ(times[1].depth, 1U);
  EXPECT_EQ(times[2].depth, 1U);
  EXPECT_GE(times[1].device_ms, 0.0);
  EXPECT_GT(times[2].device_ms, 0.0);
  EXPECT_GE(times[0].device_ms, times[1].device_ms + times[2].device_ms);
  EXPECT_LT(times[0].device_ms, 60'000.0);
}

TEST_F(Dispatch, ManyScopesKeepTheirOrder) {
  const std::vector<ScopeTime> times = run([](Recorder& recorder) {
    for (int i = 0; i < 300; ++i) {
      const auto scope = recorder.scope(i % 2 == 0 ? "even" : "odd");
    }
  });
  ASSERT_EQ(times.size(), 300U);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_EQ(times[i].name, i % 2 == 0 ? "even" : "odd");
    EXPECT_GE(times[i].device_ms, 0.0);
  }
}

TEST_F(Dispatch, ContextIsSharedByThreads) {
  const Kernel kernel(context(), "engine_probe");
  std::vector<std::thread> threads;
  std::vector<std::vector<uint32_t>> results(4);
  for (uint32_t t = 0; t < results.size(); ++t) {
    threads.emplace_back([&, t] {
      for (int round = 0; round < 20; ++round) {
        const Buffer in = test::upload(context(), counting(500), "input");
        const Buffer out = output(500);
        Recorder recorder = context().make_recorder();
        recorder.fill(out, 0);
        recorder.barrier();
        recorder.dispatch(kernel, 2, ProbePush{500, t}, {in, out});
        context().submit(std::move(recorder)).wait();
        results[t] = test::download<uint32_t>(context(), out);
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (uint32_t t = 0; t < results.size(); ++t) {
    EXPECT_EQ(results[t], expected(counting(500), 1, t));
  }
}

}  // namespace
}  // namespace adit::engine
