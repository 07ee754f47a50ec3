// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the tests of the whole program share.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tools/commands/program.hpp"

namespace adit::test {

struct Answer {
  int code = 0;
  std::string out;
  std::string err;
};

/// Calls the program with these words behind its name.
inline Answer call(std::vector<const char*> words) {
  words.insert(words.begin(), "adit");
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = program(static_cast<int>(words.size()), words.data());
  return {.code = code,
          .out = testing::internal::GetCapturedStdout(),
          .err = testing::internal::GetCapturedStderr()};
}

}  // namespace adit::test
