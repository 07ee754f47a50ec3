// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit optimize GRAPH.g2o` and `adit optimize MAP`.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>

#include "adit/slam/graph/solver.hpp"

namespace adit {

class Command;

/// Which poses the optimisation starts from.
/// `better`: those of the file or chordal ones, whichever cost less; of a map and of large graphs
/// the file's.
enum class InitialPoses { better, file, tree, chordal };

struct OptimizeCommandOptions {
  std::filesystem::path input{};
  std::optional<std::filesystem::path> output{};   ///< none: nothing is written, but for a map
  std::optional<ResidualConvention> convention{};  ///< none: g2o's, of a map its own
  std::optional<InitialPoses> initial{};           ///< none: `better`
  std::optional<Kernel> loop_kernel{};             ///< none: no kernel, of a map as its run has it
  std::optional<double> kernel_width{};            ///< standard deviations
  std::optional<int> max_iterations{};             ///< none: OptimizationSettings' own
  bool direct = false;  ///< without condensing the chains of large graphs first
  /// Surveyed points that a map is adjusted to, and the system that their places are in.
  std::optional<std::filesystem::path> control{};
  std::optional<std::string> utm{};              ///< a zone, such as 32N
  std::optional<std::string> crs{};              ///< a projected system, such as EPSG:25832
  std::optional<std::filesystem::path> geoid{};  ///< their heights are above it
  bool json = false;
};

/// Optimises a graph, in g2o's format or of a map, which gets the poses where no other file is to.
/// Reports on `out`, progress and mistakes on `err`. Returns the exit code: 0
/// converged, 1 failed or not converged, 2 usage, 130 or 143 after a signal (nothing is written).
int optimize_command(const OptimizeCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_optimize_command(Command app, std::function<void(int)> done);

}  // namespace adit
