// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "adit/engine/self_test/self_test.hpp"
#include "adit/shaders/embedded.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit::engine {
namespace {

class SelfTest : public test::DeviceTest {};

TEST_F(SelfTest, PassesAndNamesEveryShaderThatResultsRestOn) {
  const SelfTestReport report = run_self_test(context());
  std::set<std::string> tested;
  for (const SelfTestCase& test : report.cases) {
    EXPECT_TRUE(test.passed) << test.kernel << ": " << test.detail;
    EXPECT_FALSE(test.detail.empty());
    tested.insert(test.kernel);
    RecordProperty(test.kernel, test.detail);
  }
  EXPECT_TRUE(report.passed());
  for (const std::string_view shader : shaders::names()) {
    if (shader.starts_with("limit_")) {
      continue;  // these measure devices, and nothing rests on what they compute
    }
    EXPECT_TRUE(tested.contains(std::string(shader)))
        << shader << " has no known case in the self-test";
  }
}

TEST_F(SelfTest, LeavesTheContextAsItWas) {
  const uint64_t in_use = context().memory_in_use();
  EXPECT_TRUE(run_self_test(context()).passed());
  EXPECT_EQ(context().memory_in_use(), in_use);
  EXPECT_TRUE(run_self_test(context()).passed());
}

}  // namespace
}  // namespace adit::engine
