// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The entry that a fuzzer calls with bytes that might be a file: each reader must answer with a
// sweep or an InputError. test_cloud_mutations.cpp calls it with damaged files. For libFuzzer, with
// clang from the root of the tree:
//   clang++ -std=c++20 -O1 -g -fsanitize=fuzzer,address,undefined -I. -I/usr/include/eigen3
//     tests/recordings/fuzz_clouds.cpp tools/recordings/{pcd,ply,cloud_columns,point_times}*.cpp
//     tools/input_*.cpp tools/output_file.cpp
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "tools/recordings/las_reader.hpp"
#include "tools/recordings/pcd_reader.hpp"
#include "tools/recordings/ply_reader.hpp"

namespace {

/// What every sweep promises to those that use it.
void require_valid(const adit::CloudFile& cloud, std::size_t bytes) {
  const adit::Sweep& sweep = cloud.sweep;
  const std::size_t n = sweep.points.size();
  bool valid = n <= 88 * bytes;
  valid = valid && (sweep.times.empty() || sweep.times.size() == n);
  valid = valid && (sweep.rings.empty() || sweep.rings.size() == n);
  for (const float time : sweep.times) {
    valid = valid && time >= 0.0F && time <= 10.0F;
  }
  if (!valid) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const std::string_view content(reinterpret_cast<const char*>(data), size);
  for (const auto parse : {adit::parse_pcd, adit::parse_ply, adit::parse_las}) {
    try {
      require_valid(parse("input", content, 0.0), size);
    } catch (const adit::InputError&) {
      // the other right answer
    }
  }
  return 0;
}
