// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "benchmarks/command_bench.hpp"
#include "tools/program.hpp"

// Where the program is put together: the only file here that sees the benchmarks.
int main(int argc, char** argv) {
  const std::array<adit::AddCommand, 1> more = {adit::bench::add_bench_command};
  return adit::program(argc, argv, more);
}
