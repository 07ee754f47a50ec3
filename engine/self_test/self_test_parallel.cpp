// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <future>
#include <utility>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/registration.hpp"
#include "adit/engine/self_test/self_test_parts.hpp"

namespace adit::engine {
namespace {

struct PartResult {
  std::vector<SelfTestCase> cases;
  std::vector<std::byte> pipeline_cache;
};

// The map's alignments on a GPU are launched in another shape than the odometry's: compiled here,
// beside the others, they cost no run its time.
std::vector<SelfTestCase> make_map_kernels(Context& context) {
  if (context.device().gpu_shapes) {
    const RegistrationKernels alignments(context, {.robust = gpu::kCauchy, .many = true});
  }
  return {};
}

SelfTestProgress progress_of(const std::vector<std::future<PartResult>>& parts) {
  const auto ended = std::ranges::count_if(parts, [](const std::future<PartResult>& part) {
    return !part.valid() || part.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  });
  return {.done = static_cast<std::size_t>(ended), .total = parts.size()};
}

}  // namespace

ParallelSelfTest run_self_test(const ContextOptions& options,
                               const std::function<void(const SelfTestProgress&)>& waiting) {
  std::vector<std::future<PartResult>> parts;
  const auto start = [&](SelfTestPart part) {
    parts.push_back(std::async(std::launch::async, [&options, part] {
      Context context(options);
      PartResult result{.cases = part(context), .pipeline_cache = {}};
      result.pipeline_cache = context.pipeline_cache();
      return result;
    }));
  };
  std::ranges::for_each(kSelfTestParts, start);
  start(make_map_kernels);
  ParallelSelfTest all;
  for (std::future<PartResult>& part : parts) {
    while (part.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) {
      waiting(progress_of(parts));
    }
    PartResult result = part.get();
    for (SelfTestCase& one : result.cases) {
      all.report.cases.push_back(std::move(one));
    }
    all.pipeline_caches.push_back(std::move(result.pipeline_cache));
  }
  return all;
}

}  // namespace adit::engine
