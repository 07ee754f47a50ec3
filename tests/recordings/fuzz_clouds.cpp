// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The entry that a fuzzer calls with bytes that might be a file: each reader must answer with a
// sweep or an InputError. test_cloud_mutations.cpp calls it with damaged files; `./dev fuzz` is the
// fuzzer.
#include <string_view>

#include "adit/tests/recordings/fuzz_support.hpp"
#include "adit/tools/clouds/bin_reader.hpp"
#include "adit/tools/clouds/las_reader.hpp"
#include "adit/tools/clouds/pcd_reader.hpp"
#include "adit/tools/clouds/ply_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const std::string_view content(reinterpret_cast<const char*>(data), size);
  for (const auto parse : {adit::parse_pcd, adit::parse_ply, adit::parse_las, adit::parse_bin}) {
    try {
      adit::CloudReading reading{.coordinate_scale =
                                     size % 2 == 0 ? std::optional(0.001) : std::nullopt};
      if (size % 3 == 0) {
        reading.offset = Eigen::Vector3d(430000.0, 5400000.0, 300.0);
      }
      const adit::Sweep sweep = parse("input", content, reading).sweep;
      adit::test::require_valid(sweep);
      if (sweep.points.size() > 2048 * size) {  // of a chunk of LAZ at most
        std::abort();
      }
    } catch (const adit::InputError&) {
      // the other right answer
    }
  }
  return 0;
}
