// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace adit::test {

/// A small valid input of a fuzzer.
struct FuzzSeed {
  std::string fuzzer;  ///< "containers": of fuzz_containers.cpp
  std::string format;  ///< "mcap": each is fuzzed by itself
  std::string name;
  std::string bytes;
};

/// What the fuzzers start from: every format in its variants, written by adit's own writers where
/// it has them.
std::vector<FuzzSeed> fuzz_corpus();

}  // namespace adit::test
