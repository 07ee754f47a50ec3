// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/optimize_report.hpp"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace adit {
namespace {

constexpr std::size_t kComponentsTold = 5;

std::string convention_text(ResidualConvention convention, bool planar) {
  switch (convention) {
    case ResidualConvention::quaternion:
      return planar ? "(t, yaw), as g2o has it" : "(t, q_vec), as g2o has it";
    case ResidualConvention::rotation:
      return planar ? "(t, yaw)" : "(t, Log R)";
    default:
      return planar ? "Log of SE(2)" : "Log of SE(3)";
  }
}

std::size_t loops_in(const PoseGraph& graph) {
  return static_cast<std::size_t>(
      std::ranges::count(graph.edges(), EdgeKind::loop, &PoseEdge::kind));
}

std::string initial_text(InitialPoses initial) {
  return initial == InitialPoses::file   ? "file"
         : initial == InitialPoses::tree ? "tree"
                                         : "chordal";
}

/// Components beyond the first ones are counted only.
std::string describe_components(const OptimizationReport& report) {
  const std::vector<GraphComponent>& components = report.components.components;
  if (components.size() < 2) {
    return report.held.empty() ? std::string()
                               : "held         node " + std::to_string(report.held.front()) +
                                     ", since none is fixed\n";
  }
  std::string text =
      "components   " + std::to_string(components.size()) +
      ", without an edge between them; their places relative to each other mean nothing\n";
  for (std::size_t i = 0; i < std::min(components.size(), kComponentsTold); ++i) {
    const GraphComponent& component = components[i];
    text += "             from node " + std::to_string(component.first) + ": " +
            std::to_string(component.nodes) + " nodes, " + std::to_string(component.edges) +
            " edges" + (component.has_fixed_node ? "" : ", held at its first node") + "\n";
  }
  if (components.size() > kComponentsTold) {
    text += "             and " + std::to_string(components.size() - kComponentsTold) + " more\n";
  }
  return text;
}

}  // namespace

ResidualConvention convention_of(const OptimizeCommandOptions& options,
                                 const OptimizeOutcome& outcome) {
  return outcome.is_map ? ResidualConvention::rotation
                        : options.convention.value_or(ResidualConvention::quaternion);
}

std::string describe(const OptimizeCommandOptions& options, const OptimizeOutcome& outcome) {
  const PoseGraph& graph = outcome.file.graph;
  const OptimizationReport& report = outcome.optimized.report;
  const std::size_t loops = loops_in(graph);
  std::string text =
      fmt::format("graph        {} nodes, {} edges ({} loops), SE({})\n", graph.nodes().size(),
                  graph.edges().size(), loops, graph.planar() ? 2 : 3);
  text += describe_components(report);
  if (outcome.file.parameter_lines > 0) {
    text +=
        fmt::format("left out     {} lines with parameters, which edges between poses do not use\n",
                    outcome.file.parameter_lines);
  }
  if (!outcome.file.indefinite_lines.empty()) {
    text += fmt::format(
        "information  of {} edges has negative eigenvalues, which count as zero (line {} first)\n",
        outcome.file.indefinite_lines.size(), outcome.file.indefinite_lines.front());
  }
  if (!graph.levels().empty() || !graph.fixes().empty()) {
    text += fmt::format(
        "world        {} verticals and {} positions (GNSS, control) are in the cost, too\n",
        graph.levels().size(), graph.fixes().size());
  }
  text += "residual     " + convention_text(convention_of(options, outcome), graph.planar()) + "\n";
  if (outcome.odometry_scale) {
    text += "model        as in its run: loops under a kernel that takes influence from wrong ones";
    if (*outcome.odometry_scale > 1.0) {
      text += fmt::format(", the odometry's covariances times {:.3g}", *outcome.odometry_scale);
    }
    if (outcome.all_drift) {
      text += ", all its edges squared";
    }
    if (outcome.level_drift_scale != 1.0) {
      text += fmt::format(", those of its level drift times {:.3g}", outcome.level_drift_scale);
    }
    text += "\n";
  }
  text += outcome.control ? describe(*outcome.control) : std::string();
  text += fmt::format("cost         {:.10g} in the file", outcome.file_cost);
  if (outcome.initial != InitialPoses::file) {
    text += fmt::format(", {:.10g} at the start ({})", report.cost_before,
                        initial_text(outcome.initial));
  }
  text += fmt::format(", {:.10g} optimized\n", report.cost_after);
  text += fmt::format("iterations   {}, {:.2f} s{}: {}\n", report.iterations, report.seconds,
                      report.restarted ? ", begun again with a small trust region" : "",
                      std::string(to_string(report.termination)));
  for (const std::size_t i : outcome.worst) {
    const PoseEdge& edge = graph.edges()[i];
    const EdgeResult& result = *report.edges[i];
    text += fmt::format("{}  {} to {}: chi squared {:.6g}",
                        i == outcome.worst.front() ? "worst edges" : "           ", edge.from,
                        edge.to, result.chi2);
    text += result.weight < 1.0 ? fmt::format(", weight {:.3g}", result.weight) : "";
    text += fmt::format(" ({} {})\n", outcome.is_map ? "edge" : "line", outcome.file.edge_lines[i]);
  }
  return text;
}

std::string to_json(const OptimizeCommandOptions& options, const OptimizeOutcome& outcome) {
  const PoseGraph& graph = outcome.file.graph;
  const OptimizationReport& report = outcome.optimized.report;
  nlohmann::ordered_json json;
  json["schema"] = "optimize/1";
  json["file"] = options.input.string();
  json["nodes"] = graph.nodes().size();
  json["edges"] = graph.edges().size();
  json["loops"] = loops_in(graph);
  json["planar"] = graph.planar();
  json["verticals"] = graph.levels().size();
  json["fixes"] = graph.fixes().size();
  json["indefinite_edges"] = outcome.file.indefinite_lines.size();
  json["residual"] = convention_text(convention_of(options, outcome), graph.planar());
  json["initial"] = initial_text(outcome.initial);
  json["odometry_scale"] = outcome.odometry_scale ? nlohmann::ordered_json(*outcome.odometry_scale)
                                                  : nlohmann::ordered_json(nullptr);
  json["level_drift_scale"] = outcome.level_drift_scale;
  json["all_drift"] = outcome.all_drift;
  json["cost_file"] = outcome.file_cost;
  json["cost_before"] = report.cost_before;
  json["cost_after"] = report.cost_after;
  json["iterations"] = report.iterations;
  json["seconds"] = report.seconds;
  json["termination"] = to_string(report.termination);
  json["message"] = report.message;
  json["restarted"] = report.restarted;
  json["held"] = report.held;
  json["components"] = nlohmann::ordered_json::array();
  for (const GraphComponent& component : report.components.components) {
    json["components"].push_back({{"first", component.first},
                                  {"nodes", component.nodes},
                                  {"edges", component.edges},
                                  {"has_fixed_node", component.has_fixed_node}});
  }
  if (outcome.control) {
    json["control"] = to_json(*outcome.control);
  }
  json["worst_edges"] = nlohmann::ordered_json::array();
  for (const std::size_t i : outcome.worst) {
    json["worst_edges"].push_back({{"from", graph.edges()[i].from},
                                   {"to", graph.edges()[i].to},
                                   {"line", outcome.file.edge_lines[i]},
                                   {"chi2", report.edges[i]->chi2},
                                   {"weight", report.edges[i]->weight}});
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace adit
