// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace adit::engine {

class Context;
struct ContextOptions;

/// One kernel on its known case.
struct SelfTestCase {
  std::string kernel;  ///< file stem of shaders/*.comp
  bool passed = false;
  std::string detail;  ///< for people: what was expected and what was found
};

struct SelfTestReport {
  std::vector<SelfTestCase> cases;

  /// Every kernel gave the known answer.
  bool passed() const;
};

/// Tells the kernels of this program from those of another build: 16 hexadecimal digits.
std::string kernels_identity();

/// Runs every kernel once on a small room corner whose down-sampled cloud, normals and alignment
/// are known in closed form. Some submissions, a few milliseconds besides the creation of
/// pipelines. A wrong answer is a case that did not pass; Error only where the device itself fails.
SelfTestReport run_self_test(Context& context);

/// The self-test on contexts of its own, several at a time.
struct ParallelSelfTest {
  SelfTestReport report;
  /// Of all contexts, for Context::add_to_pipeline_cache().
  std::vector<std::vector<std::byte>> pipeline_caches;
};

/// How far a self-test in parts is.
struct SelfTestProgress {
  std::size_t done = 0;   ///< parts that have ended
  std::size_t total = 0;  ///< parts
};

/// The same, its parts in threads: kernels compile as fast as the machine has processors for, those
/// of a software driver, which compiles when a kernel is first run, too. `waiting` is called
/// some times a second, on the caller's thread, and never throws.
ParallelSelfTest run_self_test(const ContextOptions& options,
                               const std::function<void(const SelfTestProgress&)>& waiting);

}  // namespace adit::engine
