// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The entry that a fuzzer calls with bytes that might be a depth image: it has all its pixels, or
// there is an InputError.
#include <string_view>

#include "adit/tests/recordings/fuzz_support.hpp"
#include "adit/tools/clouds/depth_png.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  try {
    const adit::DepthPng image =
        adit::parse_depth_png("input", {reinterpret_cast<const char*>(data), size});
    if (image.values.empty() || image.values.size() != image.width * image.height) {
      std::abort();
    }
  } catch (const adit::InputError&) {
    // the other right answer
  }
  return 0;
}
