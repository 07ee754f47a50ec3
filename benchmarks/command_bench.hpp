// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit bench`: how fast this device is, kernel by kernel and for whole registrations.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "adit/tools/setup/device_session.hpp"

namespace adit {
class Command;
}

namespace adit::bench {

struct BenchCommandOptions {
  std::vector<std::string> cases{};  ///< names or beginnings of names; empty: all
  std::vector<int> sizes = {5'000, 30'000, 120'000, 1'000'000};  ///< raw points
  std::vector<int> batches = {1, 8, 64, 256};                    ///< pairs
  double seconds = 0.5;                                          ///< a case and size, at least
  std::vector<std::filesystem::path> input{};  ///< clouds instead of the simulated ones, 2 at most
  double r_input = 0.25;                       ///< m, for `input`
  bool peers = true;
  bool list = false;
  std::filesystem::path json{};                  ///< empty: not written
  std::filesystem::path report{};                ///< empty: not written
  std::filesystem::path html{};                  ///< empty: not written
  std::vector<std::string> compile{};            ///< families of GPUs: nothing is run
  std::vector<std::filesystem::path> compare{};  ///< two reports: nothing is measured
  DeviceOptions device{};
};

/// Returns the exit code: 0; 1 where a case is wrong or the device fails; 2 usage.
int bench_command(const BenchCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_bench_command(Command app, std::function<void(int)> done);

}  // namespace adit::bench
