// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Time and memory of optimising a simulated pose graph from dead reckoning: as it is, by way of the
// condensed graph, or from chordal poses. Each way is a run of its own, so that its peak memory is.
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>

#include "adit/benchmarks/simulated_graph.hpp"
#include "adit/slam/graph/condensation.hpp"
#include "adit/slam/graph/initialization.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/map_products/g2o_file.hpp"

namespace {

using namespace adit;
using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double peak_gib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0);
}

void measure(const SimulatedGraph& simulated, const std::string& way, double tolerance) {
  const Clock::time_point start = Clock::now();
  OptimizationSettings settings;
  settings.cost_tolerance = tolerance;
  settings.on_step = [&](const OptimizationStep& step) {
    std::printf("  %3d  cost %.12g  %.2f s\n", step.iteration, step.cost, since(start));
    std::fflush(stdout);
    return true;
  };
  OptimizedGraph result;
  if (way == "direct") {
    result = optimize(simulated.graph, settings);
  } else if (way == "condensed") {
    result = optimize_condensed(simulated.graph, settings, 0);
  } else {
    PoseGraph graph = simulated.graph;
    graph.set_poses(way == "tree" ? spanning_tree_poses(graph) : chordal_poses(graph));
    std::printf("  initial poses %.2f s\n", since(start));
    result = optimize(graph, settings);
  }
  std::printf("%-9s %s, %d iterations, %.2f s, cost %.12g, %.4f m from the truth, peak %.2f GiB\n",
              way.c_str(), std::string(to_string(result.report.termination)).c_str(),
              result.report.iterations, since(start), result.report.cost_after,
              position_rmse(result.poses, simulated.truth), peak_gib());
}

}  // namespace

int main(int argc, char** argv) {
  const CommandLine line("pose_graph_speed", "Times the optimisation of a simulated pose graph");
  const Command program = line.program();
  SimulatedGraphSettings settings{.nodes = 100000, .loops = 9800};
  std::string way = "direct";
  double tolerance = 1e-7;
  std::filesystem::path file;
  program.option("--nodes", settings.nodes, "");
  program.option("--loops", settings.loops, "");
  program.option("--seed", settings.seed, "");
  program.option("--streets", settings.streets, "");
  program.flag("--planar", settings.planar, "");
  program.option("--way", way, "").one_of({"direct", "condensed", "chordal", "tree"});
  program.option("--tolerance", tolerance, "Of the cost: where iterations end");
  program.option("--write", file, "Write the graph as g2o and do nothing else");
  if (const std::optional<int> ended = line.run(argc, argv)) {
    return *ended;
  }
  try {
    const SimulatedGraph simulated = simulated_graph(settings);
    std::printf("%zu nodes, %zu edges, %.1f m from the truth, %.2f GiB\n",
                simulated.graph.nodes().size(), simulated.graph.edges().size(),
                position_rmse(poses_of(simulated.graph), simulated.truth), peak_gib());
    if (!file.empty()) {
      write_g2o(file, simulated.graph);
    } else {
      measure(simulated, way, tolerance);
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pose_graph_speed: %s\n", error.what());
    return 1;
  }
}
