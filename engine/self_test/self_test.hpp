// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace adit::engine {

class Context;

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

/// Runs every kernel once on a small room corner whose down-sampled cloud, normals and alignment
/// are known in closed form. Four submissions, a few milliseconds besides the creation of
/// pipelines. A wrong answer is a case that did not pass; Error only where the device itself fails.
SelfTestReport run_self_test(Context& context);

}  // namespace adit::engine
