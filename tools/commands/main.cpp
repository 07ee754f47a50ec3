// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/program.hpp"

#ifdef ADIT_BENCHMARKS
#include <array>

#include "adit/benchmarks/command_bench.hpp"
#endif

// Where the program is put together: the only file here that sees the benchmarks, where it is built
// with them.
int main(int argc, char** argv) {
#ifdef ADIT_BENCHMARKS
  const std::array<adit::AddCommand, 1> more = {adit::bench::add_bench_command};
  return adit::program(argc, argv, more);
#else
  return adit::program(argc, argv);
#endif
}
