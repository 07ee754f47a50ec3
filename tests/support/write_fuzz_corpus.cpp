// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// write_fuzz_corpus FOLDER: the fuzzers' seeds as FOLDER/FUZZER/FORMAT/NAME.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "adit/tests/recordings/fuzz_corpus.hpp"

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("Usage: write_fuzz_corpus FOLDER\n", stderr);
    return 2;
  }
  for (const adit::test::FuzzSeed& seed : adit::test::fuzz_corpus()) {
    const std::filesystem::path folder =
        std::filesystem::path(arguments[1]) / seed.fuzzer / seed.format;
    std::filesystem::create_directories(folder);
    std::ofstream file(folder / seed.name, std::ios::binary);
    file.write(seed.bytes.data(), static_cast<std::streamsize>(seed.bytes.size()));
    if (!file.flush()) {
      std::fprintf(stderr, "cannot write %s\n", (folder / seed.name).c_str());
      return 1;
    }
  }
  return 0;
}
