// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <unistd.h>

#include "adit/tools/commands/program.hpp"

#ifdef ADIT_BENCHMARKS
#include <array>

#include "adit/benchmarks/command_bench.hpp"
#endif

namespace {

/// The number of a standard stream that is closed would go to the next file that is opened, and
/// messages into that. What takes it is not open for writing: that a report cannot be written is
/// still seen.
void hold_standard_streams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (fcntl(stream, F_GETFD) == -1) {
      static_cast<void>(open("/dev/null", O_RDONLY));  // the lowest number that is free
    }
  }
}

}  // namespace

// Where the program is put together: the only file here that sees the benchmarks, where it is built
// with them.
int main(int argc, char** argv) {
  hold_standard_streams();
#ifdef ADIT_BENCHMARKS
  const std::array<adit::AddCommand, 1> more = {adit::bench::add_bench_command};
  return adit::program(argc, argv, more);
#else
  return adit::program(argc, argv);
#endif
}
