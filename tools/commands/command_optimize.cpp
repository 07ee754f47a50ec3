// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_optimize.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/graph/condensation.hpp"
#include "adit/slam/graph/initialization.hpp"
#include "adit/slam/graph/loop_optimization.hpp"
#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/commands/optimize_report.hpp"
#include "adit/tools/export/wanted_system.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/map_edits/control_points.hpp"
#include "adit/tools/map_products/g2o_file.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kWorstEdges = 5;
constexpr int kSignalExit = 128;
// Chordal poses of larger graphs take some of the time that is saved.
constexpr std::size_t kMostNodesTriedTwice = 20'000;

/// Says how far the work is, at most once a second, and ends it after a signal.
class IterationProgress {
 public:
  explicit IterationProgress(std::ostream& err) : err_(err) {}

  bool operator()(const OptimizationStep& step) {
    const Clock::time_point now = Clock::now();
    if (now - told_ >= std::chrono::seconds(1)) {
      told_ = now;
      err_ << fmt::format("optimize iteration {}: cost {:.9g}, {:.1f} s", step.iteration, step.cost,
                          std::chrono::duration<double>(now - start_).count())
           << std::endl;
    }
    return StopSignal::received() == 0;
  }

 private:
  std::ostream& err_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point told_ = start_;
};

std::vector<std::size_t> worst_edges(const OptimizationReport& report) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < report.edges.size(); ++i) {
    if (report.edges[i]) {
      order.push_back(i);
    }
  }
  const std::size_t count = std::min(order.size(), kWorstEdges);
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(count);
  std::ranges::partial_sort(order, end, [&](std::size_t a, std::size_t b) {
    return std::pair(-report.edges[a]->chi2, a) < std::pair(-report.edges[b]->chi2, b);
  });
  order.resize(count);
  return order;
}

bool is_map(const std::filesystem::path& file) {
  constexpr std::string_view kSqlite = "SQLite format 3";
  std::string head(kSqlite.size(), ' ');
  std::ifstream(file, std::ios::binary)
      .read(head.data(), static_cast<std::streamsize>(head.size()));
  return head == kSqlite || file.extension() == ".adit";
}

G2oFile graph_of_map(const std::filesystem::path& file) {
  G2oFile read;
  read.graph = MapDatabase(file, MapAccess::read).graph();
  for (uint64_t edge = 0; edge < read.graph.edges().size(); ++edge) {
    read.edge_lines.push_back(edge);
  }
  return read;
}

int most_iterations(const OptimizeCommandOptions& options) {
  return options.max_iterations.value_or(OptimizationSettings{}.max_iterations);
}

/// Gives the graph the poses to start from. Returns which they are.
InitialPoses begin(PoseGraph& graph, const OptimizationSettings& settings,
                   const OptimizeOutcome& outcome, InitialPoses wanted) {
  if (wanted == InitialPoses::better) {
    if (outcome.is_map || graph.nodes().size() > kMostNodesTriedTwice) {
      return InitialPoses::file;
    }
    PoseGraph chordal = graph;
    chordal.set_poses(chordal_poses(graph));
    if (!(graph_cost(chordal, settings) < outcome.file_cost)) {
      return InitialPoses::file;
    }
    graph = std::move(chordal);
    return InitialPoses::chordal;
  }
  if (wanted == InitialPoses::tree) {
    graph.set_poses(spanning_tree_poses(graph));
  } else if (wanted == InitialPoses::chordal) {
    graph.set_poses(chordal_poses(graph));
  }
  return wanted;
}

/// Apart by more than the solver's own accuracy.
bool differ(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  constexpr double kSame = 1e-6;  // m, rad
  const Eigen::Isometry3d step = a.inverse() * b;
  return step.translation().norm() > kSame || rotation_angle(step.linear()) > kSame;
}

/// A node is not where `before` has it, or the map not where it lies in the world.
bool is_moved(const PoseGraph& before, const OptimizedGraph& optimized) {
  bool moved = differ(before.T_world_map(), optimized.T_world_map);
  for (std::size_t i = 0; i < optimized.poses.size() && !moved; ++i) {
    moved = differ(before.nodes()[i].T_map_node, optimized.poses[i]);
  }
  return moved;
}

/// A map without wishes about how: as the run that wrote it, and as `adit loops`.
bool is_as_its_run(const OptimizeCommandOptions& options, bool map) {
  return map && !options.loop_kernel && !options.initial && !options.direct;
}

/// Throws UsageError for what would have no effect.
void check_options(const OptimizeCommandOptions& options, bool map) {
  std::error_code ignored;
  if (options.output && std::filesystem::equivalent(options.input, *options.output, ignored)) {
    throw UsageError("the graph cannot be written over itself. Name another file with -o.");
  }
  if (options.output && options.output->extension() == ".adit") {
    throw UsageError("-o " + options.output->string() +
                     ": a graph is written in g2o's format; name it *.g2o. Without -o the map gets "
                     "the poses itself.");
  }
  if (options.kernel_width && options.loop_kernel.value_or(Kernel::none) == Kernel::none) {
    throw UsageError("--kernel-width needs --loop-kernel pseudo-huber or dcs.");
  }
  if (options.control && (!map || options.output || !is_as_its_run(options, map))) {
    throw UsageError(
        !map ? "--control: a graph in g2o's format has no places of points; name a map."
             : "--control: a map is adjusted as its run optimises it, and keeps the points itself; "
               "leave --output, --loop-kernel, --initial and --direct out.");
  }
  if (!options.control && (options.utm || options.crs || options.geoid)) {
    throw UsageError("--utm, --crs and --geoid say what the places of --control are in.");
  }
  if (options.utm && options.crs) {
    throw UsageError("--utm and --crs both say what places are in: leave one of the two out.");
  }
  if (map && options.convention) {
    throw UsageError("--convention: a map has one of its own, angle; leave it out.");
  }
  if (options.max_iterations && is_as_its_run(options, map)) {
    throw UsageError(
        "--max-iterations: a map is optimised as its run does it; say how with --loop-kernel, "
        "--initial or --direct.");
  }
}

OptimizeOutcome optimize_file(const OptimizeCommandOptions& options, std::ostream& err) {
  OptimizeOutcome outcome;
  outcome.is_map = is_map(options.input);
  outcome.file = outcome.is_map ? graph_of_map(options.input) : read_g2o(options.input);
  PoseGraph& graph = outcome.file.graph;
  OptimizationSettings settings;
  settings.convention = convention_of(options, outcome);
  if (graph.planar() && settings.convention == ResidualConvention::quaternion) {
    settings.convention = ResidualConvention::rotation;  // g2o's EDGE_SE2 has the whole angle
  }
  settings.loop_kernel.kernel = options.loop_kernel.value_or(Kernel::none);
  settings.loop_kernel.width = options.kernel_width.value_or(RobustLoss{}.width);
  settings.max_iterations = most_iterations(options);
  settings.on_step = IterationProgress(err);
  if (outcome.is_map) {
    // What a map without a place on the Earth does not keep.
    graph.set_T_world_map(levelled_world(graph));
  }
  outcome.file_cost = graph_cost(graph, settings);
  const PoseGraph before = graph;
  if (options.control) {
    outcome.control =
        adjust_to_control(MapDatabase(options.input, MapAccess::read), *options.control,
                          wanted_system(options.utm, options.crs, options.geoid), settings.on_step);
    graph = outcome.control->found.graph;
    outcome.odometry_scale = outcome.control->found.optimum.odometry_scale;
    outcome.level_drift_scale = outcome.control->found.optimum.level_drift_scale;
    outcome.all_drift = outcome.control->found.optimum.all_drift;
    outcome.optimized = outcome.control->found.optimum;
  } else if (is_as_its_run(options, outcome.is_map)) {
    LoopOptimum optimum = optimize_with_loops(graph, settings.on_step);
    outcome.odometry_scale = optimum.odometry_scale;
    outcome.level_drift_scale = optimum.level_drift_scale;
    outcome.all_drift = optimum.all_drift;
    outcome.file_cost = optimum.report.cost_before;
    outcome.optimized = std::move(optimum);
  } else {
    outcome.initial =
        begin(graph, settings, outcome, options.initial.value_or(InitialPoses::better));
    outcome.optimized =
        options.direct ? optimize(graph, settings) : optimize_condensed(graph, settings);
  }
  outcome.moved = is_moved(before, outcome.optimized);
  graph.set_poses(outcome.optimized.poses);
  graph.set_T_world_map(outcome.optimized.T_world_map);
  outcome.worst = worst_edges(outcome.optimized.report);
  return outcome;
}

bool has_open_run(const MapDatabase& map) {
  return std::ranges::any_of(map.sessions(), [&](const MapSession& session) {
    const SessionProgress run = map.progress(session.id);
    return !run.complete && !run.edited;
  });
}

int run(const OptimizeCommandOptions& options, std::ostream& out, std::ostream& err) {
  check_options(options, is_map(options.input));
  const StopSignal stop;
  const OptimizeOutcome outcome = optimize_file(options, err);
  const Termination termination = outcome.optimized.report.termination;
  if (StopSignal::received() != 0) {
    err << "adit optimize: stopped; nothing was written" << std::endl;
    return kSignalExit + StopSignal::received();
  }
  const bool failed = termination == Termination::failed;
  const bool revises =
      outcome.is_map && !options.output && !failed && (outcome.moved || outcome.control);
  if (options.output && !failed) {
    write_g2o(*options.output, outcome.file.graph);
  } else if (revises) {
    MapDatabase map(options.input, MapAccess::write);
    if (has_open_run(map)) {
      err << "adit optimize: its run has not ended; as poses are written now, adit run --continue "
             "can no longer go on with it"
          << std::endl;
    }
    MapRevision revision{
        .poses = outcome.file.graph.nodes(),
        .georeference = placed(map.georeference(), outcome.file.graph.T_world_map())};
    if (outcome.control) {
      revision.georeference = outcome.control->found.georeference;
      revision.control = outcome.control->table.points;
    }
    map.revise(revision);
  }
  out << (options.json ? to_json(options, outcome) : describe(options, outcome));
  if (options.output && !failed && !options.json) {
    out << "wrote        " << options.output->string() << "\n";
  } else if (revises && !options.json) {
    out << "wrote        the poses of " << options.input.string()
        << (outcome.control ? ", its place on the Earth and the points\n" : "\n");
  } else if (outcome.is_map && !options.output && !failed && !options.json) {
    out << "wrote        nothing: the poses are at the minimum\n";
  }
  if (failed) {
    err << "adit optimize: " << options.input.string()
        << " could not be optimised: " << outcome.optimized.report.message
        << ". Try --initial chordal; nothing was written." << std::endl;
  } else if (termination == Termination::iteration_limit) {
    err << "adit optimize: not converged after " << most_iterations(options)
        << " iterations. Try --initial chordal, or more with --max-iterations." << std::endl;
  }
  const bool done =
      termination == Termination::converged || termination == Termination::nothing_to_do;
  return done && out.flush() ? 0 : 1;
}

}  // namespace

int optimize_command(const OptimizeCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit optimize", out, err, [&] {
    OptimizeCommandOptions found = options;
    found.input = map_file(options.input);
    if (is_map(found.input)) {
      found.input = find_map(found.input);
    }
    return run(found, out, err);
  });
}

void add_optimize_command(Command app, std::function<void(int)> done) {
  const Command command =
      app.add_command("optimize", "Optimise the pose graph of a map, or one in g2o's format");
  const auto options = std::make_shared<OptimizeCommandOptions>();
  command.footer(
      "A map (MAP, or OUT, the folder of its run) gets the optimised poses, unless -o names "
      "another file for the graph.\n"
      "It is optimised as its run does it, unless --loop-kernel, --initial or --direct say how.\n"
      "GRAPH.g2o holds VERTEX_SE3:QUAT and EDGE_SE3:QUAT, or VERTEX_SE2 and EDGE_SE2; FIX names\n"
      "nodes that stay. Where none is fixed the first node of each connected part is held.\n"
      "The cost is the sum of chi squared, not halved. Programs differ in what a file's "
      "information\n"
      "about rotations belongs to: half the angle (g2o), the angle, or the logarithm of SE(3).\n\n"
      "Examples:\n"
      "  adit optimize sphere2500.g2o -o optimized.g2o\n"
      "  adit optimize out\n"
      "  adit optimize out --control points.csv --utm 32N\n"
      "  adit optimize torus3D.g2o --initial chordal --convention angle --json\n\n"
      "Exit codes: 0 converged, 1 failed or not converged, 2 usage.");
  command.option("graph", options->input, "The graph, the map or the folder of its run")
      .required()
      .value_name("GRAPH|MAP|OUT");
  command.option("-o,--output", options->output, "Write the optimised graph here")
      .value_name("OUT.g2o");
  command.choice<ResidualConvention>(
      "--convention",
      "What residuals are: g2o (t, q_vec), the default; angle (t, Log R); se3 (Log)",
      options->convention,
      {{"g2o", ResidualConvention::quaternion},
       {"angle", ResidualConvention::rotation},
       {"se3", ResidualConvention::logarithm}});
  command.choice<InitialPoses>(
      "--initial",
      "Start from the poses of the file, along a tree of the best edges, rotations first "
      "(chordal), or from the better of file and chordal (better, the default; large graphs and "
      "maps from the file's)",
      options->initial,
      {{"better", InitialPoses::better},
       {"file", InitialPoses::file},
       {"tree", InitialPoses::tree},
       {"chordal", InitialPoses::chordal}});
  command.choice<Kernel>(
      "--loop-kernel", "Robust kernel of loops: none (default), pseudo-huber, dcs",
      options->loop_kernel,
      {{"none", Kernel::none}, {"pseudo-huber", Kernel::pseudo_huber}, {"dcs", Kernel::dcs}});
  command
      .option("--kernel-width", options->kernel_width,
              "Where the kernel begins, in standard deviations")
      .above(0.0)
      .show_default(fmt::format("{:g}", RobustLoss{}.width))
      .value_name("SIGMAS");
  command.option("--max-iterations", options->max_iterations, "At most this many")
      .from(1, 100'000)
      .show_default(std::to_string(most_iterations(*options)))
      .value_name("N");
  command.flag("--direct", options->direct,
               "Large graphs too are optimised as they are, without condensing their chains");
  command
      .option("--control", options->control,
              "Adjust a map to surveyed points (docs/georeferencing.md), which it keeps")
      .value_name("POINTS.csv");
  command.option("--utm", options->utm, "The zone of UTM that the points are in, such as 32N")
      .value_name("ZONE");
  command
      .option("--crs", options->crs,
              "The projected system that the points are in, by its name in PROJ")
      .value_name("EPSG:25832");
  command
      .option("--geoid", options->geoid,
              "The points' heights are above the sea: GeographicLib's file of the geoid")
      .value_name("FILE.pgm");
  command.flag("--json", options->json, "Report as JSON");
  command.action([options, done = std::move(done)] {
    done(optimize_command(*options, std::cout, std::cerr));
  });
}

}  // namespace adit
