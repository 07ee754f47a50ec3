// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/loops_page.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/slam/mapping/loop_reason.hpp"
#include "adit/slam/mapping/submap_cache.hpp"
#include "adit/tools/drawing/html_page.hpp"
#include "adit/tools/drawing/map_picture.hpp"
#include "adit/tools/drawing/markup.hpp"
#include "adit/tools/drawing/overlay_picture.hpp"
#include "adit/tools/support/base64.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

constexpr std::size_t kMostDrawn = 60;  // loops of a verdict
constexpr double kSteep = 0.5;          // of a wall's normal, upwards

/// A node where the odometry alone has it, from the first node of its chain.
struct ChainPlace {
  std::size_t chain = 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  double path = 0.0;  ///< m, along the edges
};

std::map<NodeId, ChainPlace> chain_places(const PoseGraph& graph) {
  std::map<NodeId, ChainPlace> places;
  std::size_t chains = 0;
  for (const PoseNode& node : graph.nodes()) {
    const auto edges = graph.edges_of(node.id);
    const auto before = std::ranges::find_if(edges, [&](std::size_t i) {
      const PoseEdge& edge = graph.edges()[i];
      return edge.kind == EdgeKind::odometry && edge.to == node.id && places.contains(edge.from);
    });
    if (before == edges.end()) {
      places[node.id] = {.chain = chains++};
      continue;
    }
    const PoseEdge& edge = graph.edges()[*before];
    const ChainPlace& from = places.at(edge.from);
    places[node.id] = {.chain = from.chain,
                       .pose = from.pose * edge.T_from_to,
                       .path = from.path + edge.T_from_to.translation().norm()};
  }
  return places;
}

/// What the odometry alone says about a loop.
struct OdometrySays {
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();
  double path = 0.0;   ///< m between the two
  double drift = 0.0;  ///< m, that the loop differs by
  double turn = 0.0;   ///< rad
};

std::optional<OdometrySays> odometry_of(const std::map<NodeId, ChainPlace>& places,
                                        const LoopCandidate& loop) {
  const ChainPlace& from = places.at(loop.from);
  const ChainPlace& to = places.at(loop.to);
  if (from.chain != to.chain) {
    return std::nullopt;
  }
  OdometrySays says{.T_from_to = from.pose.inverse() * to.pose, .path = to.path - from.path};
  const Eigen::Isometry3d off = says.T_from_to.inverse() * loop.T_from_to;
  says.drift = off.translation().norm();
  says.turn = rotation_angle(off.linear());
  return says;
}

OverlayCloud cloud_of(const KeyframeSubmap& submap) {
  OverlayCloud cloud;
  for (const SubmapPoint& point : submap.points) {
    cloud.points.push_back(point.position().cast<float>());
    if (is_plane(point.surface) && std::abs(surface_direction(point.surface).z()) < kSteep) {
      cloud.walls.push_back(cloud.points.back());
    }
  }
  return cloud;
}

std::string picture(const Image& image, const std::string& words) {
  const std::string png = png_bytes(image);
  return fmt::format(
      "<figure><img width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">"
      "<figcaption>{}</figcaption></figure>",
      image.width, image.height, escape_markup(words), base64(std::as_bytes(std::span(png))),
      escape_markup(words));
}

std::string reason_of(const LoopCandidate& loop) {
  const bool none = loop.reason.empty() || loop.reason == to_string(LoopReason::none);
  return none ? "" : fmt::format("{} ({:.3g})", loop.reason, loop.figure);
}

/// A loop in words.
std::string words_about(const LoopCandidate& loop, const std::optional<OdometrySays>& odometry) {
  std::string words = fmt::format("overlap {:.0f} %, rms {:.3f} m", 100.0 * loop.overlap, loop.rms);
  if (odometry) {
    words += fmt::format("; after {:.0f} m the odometry alone is {:.3f} m and {:.2f}° off it",
                         odometry->path, odometry->drift, odometry->turn * kDegreesPerRadian);
  }
  if (loop.verdict == CandidateVerdict::accepted) {
    words += fmt::format("; its edge is left with a chi squared of {:.2f}", loop.chi2);
  }
  return words;
}

std::string heading_of(const LoopCandidate& loop) {
  const std::string reason = reason_of(loop);
  return fmt::format("Loop {}: keyframes {} and {}, {}", loop.id, loop.from, loop.to,
                     to_string(loop.verdict)) +
         (reason.empty() ? "" : ": " + reason);
}

std::string drawing_of(const LoopCandidate& loop, const std::optional<OdometrySays>& odometry,
                       SubmapCache& submaps) {
  const OverlayCloud from = cloud_of(*submaps.get(loop.from));
  const OverlayCloud to = cloud_of(*submaps.get(loop.to));
  const OverlayView view = view_of(from, to, loop.T_from_to);
  std::string text = "<h3 id=\"loop" + std::to_string(loop.id) + "\">" +
                     escape_markup(heading_of(loop)) + "</h3><p>" +
                     escape_markup(words_about(loop, odometry)) + "</p><div class=\"pair\">";
  if (odometry) {
    text += picture(overlay_picture(from, to, odometry->T_from_to, view),
                    "where the odometry alone has them");
  }
  return text +
         picture(overlay_picture(from, to, loop.T_from_to, view), "where they were aligned") +
         fmt::format("</div><p><small>from above {:.0f} m wide, below from the side</small></p>\n",
                     2.0F * view.reach);
}

std::string table_of(std::span<const LoopCandidate> loops,
                     const std::map<NodeId, ChainPlace>& places) {
  std::string text =
      "<div class=\"scroll\"><table><tr><th>loop</th><th>from</th><th>to</th><th class=\"left\">"
      "verdict</th><th>overlap</th><th>rms (m)</th><th>odometry off by</th><th>chi squared</th>"
      "<th class=\"left\">reason</th></tr>\n";
  for (const LoopCandidate& loop : loops) {
    const std::optional<OdometrySays> odometry = odometry_of(places, loop);
    text += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"left\">{}</td><td>{:.2f}</td>"
        "<td>{:.3f}</td><td>{}</td><td>{:.2f}</td><td class=\"left\">{}</td></tr>\n",
        loop.id, loop.from, loop.to, to_string(loop.verdict), loop.overlap, loop.rms,
        odometry
            ? fmt::format("{:.3f} m, {:.2f}°", odometry->drift, odometry->turn * kDegreesPerRadian)
            : "-",
        loop.chi2, escape_markup(reason_of(loop)));
  }
  return text + "</table></div>\n";
}

/// How many there are with which reason.
std::string summary_of(std::span<const LoopCandidate> loops) {
  std::map<std::string, std::size_t> counts;
  for (const LoopCandidate& loop : loops) {
    const bool plain = loop.reason.empty() || loop.reason == to_string(LoopReason::none);
    ++counts[std::string(to_string(loop.verdict)) + (plain ? "" : ": " + loop.reason)];
  }
  std::string text = "<dl>";
  for (const auto& [what, count] : counts) {
    text += fmt::format("<dt>{}</dt><dd>{}</dd>", escape_markup(what), count);
  }
  return text + "</dl>\n";
}

std::string graph_from_above(const MapDatabase& map, const PoseGraph& graph,
                             std::span<const LoopCandidate> loops) {
  PictureGraph drawn;
  std::vector<StampedPose> path;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    drawn.keyframes.emplace_back(keyframe.T_map_keyframe.translation().head<2>());
    path.push_back({keyframe.stamp, keyframe.T_map_keyframe});
  }
  for (const LoopCandidate& loop : loops) {
    if (loop.verdict == CandidateVerdict::accepted || loop.verdict == CandidateVerdict::revoked) {
      const auto place = [&](NodeId id) -> Eigen::Vector2d {
        return graph.nodes()[graph.index_of(id)].T_map_node.translation().head<2>();
      };
      drawn.loops.push_back({.from = place(loop.from),
                             .to = place(loop.to),
                             .revoked = loop.verdict == CandidateVerdict::revoked});
    }
  }
  return map_picture({}, path, "Keyframes and loops from above", drawn);
}

/// At most kMostDrawn of a verdict, evenly chosen.
std::string drawings_of(std::span<const LoopCandidate> loops, CandidateVerdict verdict,
                        const std::map<NodeId, ChainPlace>& places, SubmapCache& submaps) {
  std::vector<LoopCandidate> those;
  std::ranges::copy_if(loops, std::back_inserter(those),
                       [&](const LoopCandidate& loop) { return loop.verdict == verdict; });
  if (those.empty()) {
    return "";
  }
  std::string text = fmt::format("<h2>{} {}</h2>\n", those.size(), to_string(verdict));
  const std::size_t drawn = std::min(those.size(), kMostDrawn);
  if (drawn < those.size()) {
    text += fmt::format("<p>{} of them are drawn, evenly chosen.</p>\n", drawn);
  }
  for (std::size_t i = 0; i < drawn; ++i) {
    const LoopCandidate& loop = those[i * those.size() / drawn];
    text += drawing_of(loop, odometry_of(places, loop), submaps);
  }
  return text;
}

}  // namespace

std::string loops_page(const MapDatabase& map) {
  const std::vector<LoopCandidate> loops = map.candidates();
  const PoseGraph graph = map.graph();
  const std::map<NodeId, ChainPlace> places = chain_places(graph);
  for (const LoopCandidate& loop : loops) {
    if (!graph.contains(loop.from) || !graph.contains(loop.to)) {
      throw InputError(map.file(), {},
                       fmt::format("loop {} ties keyframes {} and {}, and one of them is missing",
                                   loop.id, loop.from, loop.to),
                       "The map is damaged: `adit check` says what else is wrong");
    }
  }
  SubmapCache submaps(map, kSubmapBytes);
  const std::string name = map.file().string();
  std::string body =
      "<style>.pair { display: flex; flex-wrap: wrap; gap: 1em; } figure { margin: "
      "0; } figcaption { font-size: 13px; }</style>\n<h1>Loops of " +
      escape_markup(name) + "</h1>\n";
  if (loops.empty()) {
    return html_page("Loops of " + name,
                     body +
                         "<p>There are none: they were not looked for (mapping.loops), or no "
                         "place was seen again.</p>\n");
  }
  body += summary_of(loops) + graph_from_above(map, graph, loops);
  body +=
      "<p>In each pair of pictures the earlier submap is blue and the later one orange; where "
      "both have something it is dark. They lie right where walls and ground are thin and "
      "dark.</p>\n";
  for (const CandidateVerdict verdict : {CandidateVerdict::accepted, CandidateVerdict::revoked,
                                         CandidateVerdict::rejected, CandidateVerdict::waiting}) {
    body += drawings_of(loops, verdict, places, submaps);
  }
  body += "<h2>All candidates</h2>\n" + table_of(loops, places);
  return html_page("Loops of " + name, body);
}

}  // namespace adit
