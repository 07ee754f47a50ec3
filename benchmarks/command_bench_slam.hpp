// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit bench slam`: how far whole trajectories are from the truth, sequence by sequence.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "adit/benchmarks/slam/slam_sequences.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {
class Command;
}

namespace adit::bench {

struct BenchSlamOptions {
  std::vector<std::string> only{};  ///< names of sequences or their beginnings; empty: all
  bool quick = false;               ///< the catalogue's quick ones alone
  bool list = false;
  bool loops = false;  ///< loop closing: with maps, another catalogue and its own table
  uint64_t seeds = 0;  ///< each sequence of the catalogue so many times; 0: as it stands there,
                       ///< or once where the others ask for seeds
  std::optional<uint64_t> first_seed{};  ///< the first of these; none: 1
  std::optional<double> apart{};         ///< m along the route, of where five of these begin
  std::filesystem::path recordings{};    ///< these instead of the catalogue
  std::filesystem::path trajectories{};  ///< other systems': SYSTEM/SEQUENCE.tum
  std::vector<std::string> variants{};   ///< "NAME:section.key=value", on top of `config`
  ConfigSource config{};                 ///< our configuration
  std::filesystem::path output = "adit-bench-slam";  ///< simulated recordings and our trajectories
  std::filesystem::path json{};                      ///< empty: not written
  std::filesystem::path html{};                      ///< empty: not written
  DeviceOptions device{};
};

/// Returns the exit code: 0, also where systems fail on sequences; 1 where nothing can be measured;
/// 2 usage.
int bench_slam_command(const BenchSlamOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command to `bench`. It runs on std::cout and std::cerr once the command line is
/// read; `done` gets the exit code.
void add_bench_slam_command(Command bench, std::function<void(int)> done);

}  // namespace adit::bench
