// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/loops_page.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <span>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/core/units.hpp"
#include "adit/slam/loops/loop_reason.hpp"
#include "adit/slam/submaps/submap_cache.hpp"
#include "adit/tools/drawing/html_page.hpp"
#include "adit/tools/drawing/markup.hpp"
#include "adit/tools/drawing/overlay_picture.hpp"
#include "adit/tools/map_edits/loop_drift.hpp"
#include "adit/tools/map_edits/loops_picture.hpp"
#include "adit/tools/support/base64.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

constexpr std::size_t kMostDrawn = 60;  // loops of a verdict
constexpr double kSteep = 0.5;          // of a wall's normal, upwards
constexpr double kSamePlace = 0.02;     // m, that drawings do not show
constexpr double kSameTurn = 0.003;     // rad

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
std::string words_about(const LoopCandidate& loop, const LoopDrift& drift) {
  std::string words = fmt::format("overlap {:.0f} %, rms {:.3f} m", 100.0 * loop.overlap, loop.rms);
  if (drift.odometry) {
    words += fmt::format("; after {:.0f} m the odometry alone is {:.3f} m and {:.2f}° off it",
                         drift.path, drift.odometry->metres,
                         drift.odometry->radians * kDegreesPerRadian);
  }
  words += fmt::format("; the map is {:.3f} m and {:.2f}° off it", drift.map.metres,
                       drift.map.radians * kDegreesPerRadian);
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

/// Before, after, and the measured pose where the map does not have it.
std::string drawing_of(const LoopCandidate& loop, const LoopDrift& drift, SubmapCache& submaps) {
  const OverlayCloud from = cloud_of(*submaps.get(loop.from));
  const OverlayCloud to = cloud_of(*submaps.get(loop.to));
  const OverlayView view = view_of(from, to, loop.T_from_to);
  std::string text = "<h3 id=\"loop" + std::to_string(loop.id) + "\">" +
                     escape_markup(heading_of(loop)) + "</h3><p>" +
                     escape_markup(words_about(loop, drift)) + "</p><div class=\"pair\">";
  if (drift.odometry) {
    text += picture(overlay_picture(from, to, drift.odometry->T_from_to, view),
                    "before: where the odometry alone has them");
  }
  text += picture(overlay_picture(from, to, drift.map.T_from_to, view),
                  "after: where the map has them");
  if (drift.map.metres > kSamePlace || drift.map.radians > kSameTurn) {
    text += picture(overlay_picture(from, to, loop.T_from_to, view), "where they were aligned");
  }
  return text +
         fmt::format("</div><p><small>from above {:.0f} m wide, below from the side</small></p>\n",
                     2.0F * view.reach);
}

std::string off_by(const PoseBeside& pose) {
  return fmt::format("{:.3f} m, {:.2f}°", pose.metres, pose.radians * kDegreesPerRadian);
}

std::string table_of(std::span<const LoopCandidate> loops,
                     const std::map<NodeId, ChainPlace>& places, const PoseGraph& graph) {
  std::string text =
      "<div class=\"scroll\"><table><tr><th>loop</th><th>from</th><th>to</th><th class=\"left\">"
      "verdict</th><th>overlap</th><th>rms (m)</th><th>odometry off by</th>"
      "<th>map off by</th><th>chi squared</th>"
      "<th class=\"left\">reason</th></tr>\n";
  for (const LoopCandidate& loop : loops) {
    const LoopDrift drift = drift_of(loop, places, graph);
    text += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"left\">{}</td><td>{:.2f}</td>"
        "<td>{:.3f}</td><td>{}</td><td>{}</td><td>{:.2f}</td><td class=\"left\">{}</td></tr>\n",
        loop.id, loop.from, loop.to, to_string(loop.verdict), loop.overlap, loop.rms,
        drift.odometry ? off_by(*drift.odometry) : "-", off_by(drift.map), loop.chi2,
        escape_markup(reason_of(loop)));
  }
  return text + "</table></div>\n";
}

/// So many of them, evenly chosen.
std::vector<LoopCandidate> evenly(const std::vector<LoopCandidate>& loops, std::size_t most) {
  const std::size_t count = std::min(loops.size(), most);
  std::vector<LoopCandidate> chosen;
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(loops[i * loops.size() / count]);
  }
  return chosen;
}

bool is_among(std::span<const int64_t> ids, int64_t id) {
  return std::ranges::count(ids, id) > 0;
}

/// Those of a verdict: the ones that were asked for, or at most kMostDrawn.
std::string drawings_of(std::span<const LoopCandidate> loops, CandidateVerdict verdict,
                        std::span<const int64_t> shown, const std::map<NodeId, ChainPlace>& places,
                        const PoseGraph& graph, SubmapCache& submaps) {
  std::vector<LoopCandidate> those;
  std::ranges::copy_if(loops, std::back_inserter(those), [&](const LoopCandidate& loop) {
    return loop.verdict == verdict && (shown.empty() || is_among(shown, loop.id));
  });
  if (those.empty()) {
    return "";
  }
  std::string text = fmt::format("<h2>{} {}</h2>\n", those.size(), to_string(verdict));
  const std::size_t most = shown.empty() ? kMostDrawn : those.size();
  if (most < those.size()) {
    text += fmt::format(
        "<p>{} of them are drawn, evenly chosen; `adit loops MAP --html FILE --show ID` draws "
        "others.</p>\n",
        most);
  }
  for (const LoopCandidate& loop : evenly(those, most)) {
    text += drawing_of(loop, drift_of(loop, places, graph), submaps);
  }
  return text;
}

}  // namespace

std::string loops_page(const MapDatabase& map, std::span<const int64_t> shown) {
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
  SubmapCache submaps(submap_loader(map), kSubmapBytes);
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
  body += loop_counts(loops) + loops_from_above(map, graph, loops);
  body +=
      "<p>In each picture the earlier submap is blue and the later one orange; where both have "
      "something it is dark. They lie right where walls and ground are thin and dark.</p>\n";
  for (const CandidateVerdict verdict : {CandidateVerdict::accepted, CandidateVerdict::revoked,
                                         CandidateVerdict::rejected, CandidateVerdict::waiting}) {
    body += drawings_of(loops, verdict, shown, places, graph, submaps);
  }
  body += "<h2>All candidates</h2>\n" + table_of(loops, places, graph);
  return html_page("Loops of " + name, body);
}

}  // namespace adit
