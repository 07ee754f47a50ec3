// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace adit {

/// A program that is to be run.
struct ChildProcess {
  std::filesystem::path program{};
  std::vector<std::string> words{};  ///< its arguments, without its own name
  std::filesystem::path folder{};    ///< that it works in
  std::filesystem::path log{};       ///< gets all that it prints, behind what is there
};

/// What became of it.
struct ChildOutcome {
  int code = 0;                    ///< its exit code; 128 and the signal that ended it
  double seconds = 0.0;            ///< by the clock
  double processor_seconds = 0.0;  ///< of all its threads
  uint64_t peak_memory = 0;        ///< bytes that were resident
};

/// Runs it to its end. It is stopped when this process is told to stop (StopSignal), and killed
/// where this process is. Throws OutputError: the log cannot be written, or no process be made.
ChildOutcome run_child(const ChildProcess& child);

/// The program that this process runs.
std::filesystem::path own_program();

}  // namespace adit
