// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include "adit/shaders/shared/engine_probe.h"
#include "adit/tests/support/layout.hpp"

namespace adit {
namespace {

using test::expect_layout;

TEST(ShaderLayout, ProbeStructsAreTheSameInCppAndGlsl) {
  expect_layout<gpu::ProbePush>("ProbePush", {{"count", offsetof(gpu::ProbePush, count)},
                                              {"offset", offsetof(gpu::ProbePush, offset)}});
  expect_layout<gpu::TexelProbePush>("TexelProbePush",
                                     {{"count", offsetof(gpu::TexelProbePush, count)},
                                      {"offset", offsetof(gpu::TexelProbePush, offset)}});
  expect_layout<gpu::ProbeSums>("ProbeSums", {{"total", offsetof(gpu::ProbeSums, total)},
                                              {"items", offsetof(gpu::ProbeSums, items)}});
}

TEST(ShaderLayout, ComparisonSeesAWrongOffset) {
  EXPECT_NONFATAL_FAILURE(expect_layout("ProbePush", 8, {{"count", 0}, {"offset", 8}}), "offset");
}

TEST(ShaderLayout, ComparisonSeesAWrongName) {
  EXPECT_NONFATAL_FAILURE(expect_layout("ProbePush", 8, {{"count", 0}, {"shift", 4}}), "shift");
}

TEST(ShaderLayout, ComparisonSeesAWrongSize) {
  EXPECT_NONFATAL_FAILURE(expect_layout("ProbePush", 12, {{"count", 0}, {"offset", 4}}), "12");
}

TEST(ShaderLayout, ComparisonSeesAMissingStruct) {
  EXPECT_NONFATAL_FAILURE(expect_layout("NoSuchStruct", 4, {{"x", 0}}), "no shader uses it");
}

}  // namespace
}  // namespace adit
