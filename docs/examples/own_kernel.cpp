// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A kernel of your own on adit's engine: ranges.comp on a million points of a spiral.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <utility>
#include <vector>

#include "adit/engine/context.hpp"
#include "ranges.spirv.h"

struct Point {
  float x, y, z, w;
};

int main() {
  using namespace adit::engine;
  constexpr uint32_t kCount = 1'000'000;
  Context context({});
  const Kernel kernel(context, {.name = "ranges", .spirv = ranges_spirv});

  Buffer given = context.make_buffer(kCount * sizeof(Point), Memory::upload, "given");
  const auto points = given.as<Point>();
  for (uint32_t i = 0; i < kCount; ++i) {
    const float range = 1e-4F * static_cast<float>(i);
    points[i] = {range * std::cos(range), range * std::sin(range), 0.0F, 1.0F};
  }
  Buffer ranges = context.make_buffer(kCount * sizeof(float), Memory::device, "ranges");
  Buffer result = context.make_buffer(ranges.size(), Memory::readback, "result");

  Recorder recorder = context.make_recorder();
  recorder.dispatch(kernel, std::min(kernel.groups_for(kCount), 1024U), kCount, {given, ranges});
  recorder.barrier();
  recorder.copy(ranges, result);
  context.submit(std::move(recorder)).wait();

  const auto found = result.as<float>();
  std::cout << context.device().name << ": the farthest of " << kCount << " points lies at "
            << *std::ranges::max_element(found) << " m\n";
}
