// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit bench consistency`: whether the odometry errs as much as its covariances say.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {
class Command;
}

namespace adit::bench {

struct BenchConsistencyOptions {
  std::vector<std::string> only{};  ///< names of cases; empty: all
  std::string sensor{};             ///< instead of the cases' own; empty: those
  int runs = 60;                    ///< in all, shared evenly among the cases
  uint64_t first_seed = 1;          ///< the others of a case follow
  double duration = 6.0;            ///< s of a run
  ConfigSource config{};
  std::filesystem::path json{};  ///< empty: not written
  DeviceOptions device{};
};

/// Returns the exit code: 0, whatever the figures are; 1 where nothing can be measured; 2 usage.
int bench_consistency_command(const BenchConsistencyOptions& options, std::ostream& out,
                              std::ostream& err);

/// Adds the sub-command to `bench`. It runs on std::cout and std::cerr once the command line is
/// read; `done` gets the exit code.
void add_bench_consistency_command(Command bench, std::function<void(int)> done);

}  // namespace adit::bench
