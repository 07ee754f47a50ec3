// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit export MAP`: what a map holds, in formats of others.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>

namespace adit {

class Command;

/// One of trajectory, graph, cloud, dense, picture and dump is set.
struct ExportCommandOptions {
  std::filesystem::path map{};
  std::optional<std::filesystem::path> output{};     ///< none: standard output, for the dump alone
  std::string trajectory{};                          ///< tum, kitti, csv
  std::string graph{};                               ///< g2o
  std::string cloud{};                               ///< ply, pcd
  std::string dense{};                               ///< ply, pcd
  std::optional<std::filesystem::path> recording{};  ///< for dense; none: that of the map
  std::optional<double> resolution{};                ///< m, one point of the cloud a voxel
  bool picture = false;
  bool dump = false;
  uint64_t max_ram_bytes = 0;  ///< that may be resident; 0: no limit
};

/// Returns the exit code: 0 done, 1 the map cannot be read or the file not written, 2 usage.
int export_command(const ExportCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_export_command(Command app, std::function<void(int)> done);

}  // namespace adit
