// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

#include "adit/slam/core/checkpoint.hpp"

namespace adit {

/// How many pieces of work are done at the same time.
inline std::size_t parallel_pieces() {
  return std::max(std::size_t{1}, std::size_t{std::thread::hardware_concurrency()});
}

/// Calls work(begin, end) for pieces of [0, count), on as many threads as the machine has. Pieces
/// are taken in turn, so `work` must give the same whoever does which. It must not throw. The
/// checkpoint is called between pieces; where it throws, the other threads end after their piece.
template <class Work>
void in_parallel(std::size_t count, std::size_t piece, const Work& work,
                 const Checkpoint& checkpoint = {}) {
  std::atomic<std::size_t> next{0};
  const auto run = [&](const Checkpoint& between) {
    for (std::size_t begin = next.fetch_add(piece); begin < count; begin = next.fetch_add(piece)) {
      work(begin, std::min(count, begin + piece));
      pass(between);
    }
  };
  std::vector<std::jthread> helpers;
  for (std::size_t i = 1; i < parallel_pieces(); ++i) {
    helpers.emplace_back([&] { run({}); });
  }
  try {
    run(checkpoint);
  } catch (...) {
    next = count;
    throw;
  }
}

}  // namespace adit
