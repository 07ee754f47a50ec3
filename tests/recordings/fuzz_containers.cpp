// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The entry that a fuzzer calls with bytes that might be a recording in one file: reading must end,
// with events or InputErrors. test_container_mutations.cpp calls it with damaged files; `./dev
// fuzz` is the fuzzer.
#include "adit/tests/recordings/fuzz_support.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const adit::test::ScratchFile file(data, size);
  try {
    const auto recording = adit::open_recording(file.path());
    adit::test::require_readable(*recording, size);
  } catch (const adit::InputError&) {
    // the other right answer
  }
  return 0;
}
