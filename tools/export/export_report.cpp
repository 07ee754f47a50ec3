// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/export_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/core/median.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/drawing/html_page.hpp"
#include "adit/tools/drawing/markup.hpp"
#include "adit/tools/export/export_poses.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_database/odometry_chain.hpp"
#include "adit/tools/map_edits/control_points.hpp"
#include "adit/tools/map_products/cloud_raster.hpp"
#include "adit/tools/map_products/tiled_cloud.hpp"
#include "adit/tools/map_products/trajectory_products.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

constexpr double kCoverageCell = 0.5;  // m

/// A list of what there is, line by line.
class Facts {
 public:
  void add(std::string_view name, const std::string& value) {
    html_ += "<dt>" + escape_markup(name) + "</dt><dd>" + escape_markup(value) + "</dd>\n";
  }
  std::string list() const { return "<dl>\n" + html_ + "</dl>\n"; }
  std::string section(std::string_view title) const {
    return "<h2>" + escape_markup(title) + "</h2>\n" + list();
  }

 private:
  std::string html_;
};

std::string finding(const std::string& text) {
  return "<div class=\"finding\"><p>" + escape_markup(text) + "</p></div>\n";
}

/// Standard deviations by a covariance: of the first three or the last three coordinates.
std::string deviations(const Matrix6d& covariance, Eigen::Index first, double unit,
                       const char* text) {
  const Eigen::Vector3d sigma =
      covariance.diagonal().segment<3>(first).cwiseMax(0.0).cwiseSqrt() * unit;
  return fmt::format("{:.3f}, {:.3f}, {:.3f} {}", sigma.x(), sigma.y(), sigma.z(), text);
}

std::string place_section(const ExportJob& job) {
  Facts facts;
  if (!job.georeference) {
    facts.add("georeference", "none: coordinates are those of the map's own frame");
    return facts.section("Coordinates");
  }
  const ProductCoordinates coordinates = coordinates_of(job, true);
  const Geodetic& origin = job.georeference->origin;
  facts.add("coordinate reference system", coordinates.name());
  facts.add("heights", coordinates.has_geoid()
                           ? "above the geoid of " + job.options->geoid->filename().string()
                           : "above the ellipsoid, no geoid applied");
  facts.add("origin", fmt::format("{:.9f}, {:.9f} degrees, {:.3f} m", origin.latitude,
                                  origin.longitude, origin.altitude));
  const Eigen::Vector3d begin = coordinates.from_map(Eigen::Vector3d(Eigen::Vector3d::Zero()));
  facts.add("map's origin",
            fmt::format("{:.3f} E, {:.3f} N, {:.3f} m", begin.x(), begin.y(), begin.z()));
  if (coordinates.frame() == ProductFrame::utm) {
    const UtmPosition there = coordinates.place(Eigen::Vector3d::Zero()).utm;
    facts.add("convergence, scale there",
              fmt::format("{:.6f} degrees from true to grid north, {:.8f}",
                          there.convergence * kDegreesPerRadian, there.scale));
  }
  if (job.options->origin) {
    facts.add("placed", "by hand (--origin): its accuracy is not known");
  } else {
    const Matrix6d& covariance = job.georeference->covariance;
    const bool has_control = std::ranges::any_of(
        job.map->control_points(),
        [](const ControlPoint& point) { return point.role == ControlRole::control; });
    facts.add("placed", !has_control               ? "by GNSS"
                        : job.map->fixes().empty() ? "by ground control"
                                                   : "by GNSS and ground control");
    facts.add("standard deviation",
              deviations(covariance, 0, 1.0, "m along the map's x, y, z; ") +
                  deviations(covariance, 3, kDegreesPerRadian, "degrees about them"));
  }
  return facts.section("Coordinates");
}

/// Times a second, by the median of the time between stamps in order; nothing of fewer than two.
std::string rate_of(const std::vector<Nanoseconds>& stamps) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    gaps.push_back(seconds(stamps[i] - stamps[i - 1]));
  }
  const double gap = gaps.empty() ? 0.0 : median(std::move(gaps));
  return gap > 0.0 ? fmt::format(", {:.1f} Hz", 1.0 / gap) : std::string();
}

using Verticals = std::map<Vertical, std::size_t>;

/// How many keyframes know their vertical by what.
Verticals verticals_of(const MapDatabase& map) {
  Verticals verticals;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    ++verticals[load_sweeps(map, keyframe.id, map.file()).vertical];
  }
  return verticals;
}

/// What the map was measured with, as far as it shows that.
std::string sensors_section(const MapDatabase& map, const MapPath& path, Verticals verticals) {
  std::vector<Nanoseconds> sweeps;
  std::ranges::transform(path.sweeps, std::back_inserter(sweeps), &MapSweep::stamp);
  std::vector<Nanoseconds> fixes;
  std::ranges::transform(map.fixes(), std::back_inserter(fixes), &MapFix::stamp);
  const std::size_t levelled = verticals[Vertical::gravity];
  Facts facts;
  facts.add("range sensor", fmt::format("{} sweeps{}", sweeps.size(), rate_of(sweeps)));
  facts.add("inertial sensor", levelled + verticals[Vertical::rough_gravity] == 0
                                   ? "no keyframe is levelled by one"
                                   : fmt::format("{} of {} keyframes are levelled by it", levelled,
                                                 map.keyframes().size()));
  facts.add("GNSS receiver", fixes.empty()
                                 ? std::string("no fixes")
                                 : fmt::format("{} fixes{}", fixes.size(), rate_of(fixes)));
  return facts.section("Sensors");
}

std::string sessions_section(const ExportJob& job, const MapPath& path) {
  std::string html;
  for (const MapSession& session : job.map->sessions()) {
    Facts facts;
    const auto is_of_it = [&](const MapSweep& sweep) { return sweep.session == session.id; };
    const auto first = std::ranges::find_if(path.sweeps, is_of_it);
    if (first != path.sweeps.end()) {
      const auto last = std::find_if(path.sweeps.rbegin(), path.sweeps.rend(), is_of_it);
      const auto when = [](Nanoseconds stamp) {
        std::string text;
        if (is_unix_time(stamp)) {
          return iso_time(stamp);
        }
        append_stamp(text, stamp);
        return text + " s";
      };
      facts.add("first and last sweep", when(first->stamp) + ", " + when(last->stamp));
    }
    for (const auto& [name, value] : session.provenance) {
      facts.add(name, value);
    }
    html += facts.section(fmt::format("Session {}: {}", session.id, session.name));
  }
  return html;
}

/// What was measured of the place: points, cells of a grid with points in them, extent.
std::string coverage_section(const ExportJob& job, const ProductCoordinates& coordinates,
                             const MapPath& path) {
  CloudRaster raster(RasterValue::height, kCoverageCell);
  uint64_t points = 0;
  uint64_t moving = 0;
  Eigen::AlignedBox3d box;
  visit_cloud(*job.map, coordinates, {.moved = job.moved}, [&](std::span<const CloudPoint> some) {
    raster.add(some);
    points += some.size();
    for (const CloudPoint& point : some) {
      moving += point.moving ? 1U : 0U;
      box.extend(point.position);
    }
    require_within(job);
  });
  double length = 0.0;
  for (std::size_t i = 1; i < path.sweeps.size(); ++i) {
    length +=
        (path.sweeps[i].T_map_lidar.translation() - path.sweeps[i - 1].T_map_lidar.translation())
            .norm();
  }
  Facts facts;
  facts.add("path", fmt::format("{:.1f} m, {} sweeps", length, path.sweeps.size()));
  facts.add("points", fmt::format("{}, of which {} moved and are class 64", points, moving));
  facts.add("area with points",
            fmt::format("{:.0f} m² in cells of {} m",
                        static_cast<double>(raster.filled()) * kCoverageCell * kCoverageCell,
                        kCoverageCell));
  if (!box.isEmpty()) {
    facts.add("extent", fmt::format("{:.3f} to {:.3f}, {:.3f} to {:.3f}, {:.3f} to {:.3f} m",
                                    box.min().x(), box.max().x(), box.min().y(), box.max().y(),
                                    box.min().z(), box.max().z()));
  }
  facts.add("of the extent", coordinates.name());
  return facts.section("Coverage");
}

std::string text_of(const PlaceSpread& spread) {
  return fmt::format("rmse level {:.3f} m, up {:.3f} m; largest {:.3f} m", spread.level, spread.up,
                     spread.largest);
}

/// What of fixes is used: where the map has the antenna less where the receiver had it.
std::map<GnssFixKind, std::vector<Eigen::Vector3d>> fix_residuals(
    const MapDatabase& map, const std::vector<MapFix>& fixes) {
  std::map<GnssFixKind, std::vector<Eigen::Vector3d>> residuals;
  const std::optional<Georeference> world = map.georeference();
  if (!world) {
    return residuals;
  }
  const WorldFrame frame(world->origin);
  const PoseGraph graph = map.graph();
  for (const MapFix& fix : fixes) {
    if (fix.verdict == FixVerdict::used) {
      const Eigen::Isometry3d& T_map_keyframe =
          graph.nodes()[graph.index_of(fix.keyframe)].T_map_node;
      const Eigen::Vector3d antenna =
          world->T_world_map * (T_map_keyframe * fix.p_keyframe_antenna);
      residuals[fix.kind].push_back(antenna - frame.position_of(fix.place));
    }
  }
  return residuals;
}

std::string gnss_section(const MapDatabase& map) {
  const std::vector<MapFix> fixes = map.fixes();
  if (fixes.empty()) {
    return "";
  }
  constexpr std::array kKinds = {"none", "single", "satellite-augmented", "ground-augmented (RTK)"};
  std::map<GnssFixKind, std::pair<std::size_t, std::size_t>> kinds;  // all, used
  std::map<FixVerdict, std::size_t> verdicts;
  for (const MapFix& fix : fixes) {
    auto& [all, used] = kinds[fix.kind];
    ++all;
    used += fix.verdict == FixVerdict::used ? 1U : 0U;
    ++verdicts[fix.verdict];
  }
  Facts facts;
  for (const auto& [kind, counts] : kinds) {
    const auto& [all, used] = counts;
    facts.add(
        kKinds.at(static_cast<std::size_t>(kind)),
        fmt::format("{} fixes, {:.0f} % of all, of which {} are used", all,
                    100.0 * static_cast<double>(all) / static_cast<double>(fixes.size()), used));
  }
  for (const auto& [verdict, count] : verdicts) {
    facts.add(to_string(verdict), std::to_string(count));
  }
  for (const auto& [kind, errors] : fix_residuals(map, fixes)) {
    facts.add(fmt::format("map less fixes, {}", kKinds.at(static_cast<std::size_t>(kind))),
              text_of(*spread_of(errors)));
  }
  return facts.section("GNSS");
}

/// Nothing of a map that is placed elsewhere by hand.
std::string control_section(const ExportJob& job, const ProductCoordinates& coordinates) {
  const ControlTable table = job.options->origin ? ControlTable() : control_table(*job.map);
  if (table.points.empty() || coordinates.frame() == ProductFrame::map) {
    return "";
  }
  std::string html =
      "<h2>Ground control</h2>\n<p>Where the map has each point less where it was surveyed. "
      "The map was adjusted to control points; check points it was only measured "
      "against. Places are in " +
      escape_markup(coordinates.name()) +
      ", m.</p>\n<table><tr><th>point</th><th>role</th><th>easting</th><th>northing</th>"
      "<th>height</th><th>east off</th><th>north off</th><th>up off</th></tr>\n";
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    const ControlPoint& point = table.points[i];
    const Eigen::Vector3d& error = table.errors[i];
    const Eigen::Vector3d place = coordinates.from_geodetic(point.place);
    html += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{:.3f}</td><td>{:.3f}</td><td>{:.3f}</td><td>{:.3f}</td>"
        "<td>{:.3f}</td><td>{:.3f}</td></tr>\n",
        escape_markup(point.name), to_string(point.role), place.x(), place.y(), place.z(),
        error.x(), error.y(), error.z());
  }
  html += "</table>\n";
  Facts facts;
  for (const ControlRole role : {ControlRole::control, ControlRole::check}) {
    const auto spread = spread_of(table, role);
    facts.add(std::string(to_string(role)) + " points",
              spread ? fmt::format("{}; {}", spread->count, text_of(*spread))
                     : "none: nothing independent says how good the map is");
  }
  return html + facts.list();
}

std::string graph_section(const MapDatabase& map) {
  std::size_t odometry = 0;
  std::size_t loops = 0;
  std::size_t revoked = 0;
  const PoseGraph graph = map.graph();
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind == EdgeKind::start) {
      continue;  // expected, not measured
    }
    ++(edge.status == EdgeStatus::revoked ? revoked
       : edge.kind == EdgeKind::loop      ? loops
                                          : odometry);
  }
  std::map<std::string, std::size_t> reasons;
  double correction = 0.0;
  double turn = 0.0;
  for (const LoopCandidate& candidate : map.candidates()) {
    if (candidate.verdict == CandidateVerdict::accepted) {
      correction = std::max(correction, candidate.correction);
      turn = std::max(turn, candidate.turn);
    } else {
      ++reasons[candidate.reason.empty() ? std::string(to_string(candidate.verdict))
                                         : candidate.reason];
    }
  }
  Facts facts;
  facts.add("keyframes", std::to_string(graph.nodes().size()));
  facts.add("edges",
            fmt::format("{} of the odometry, {} loops, {} revoked", odometry, loops, revoked));
  if (loops > 0) {
    facts.add("largest correction by a loop",
              fmt::format("{:.3f} m, {:.3f} degrees", correction, turn * kDegreesPerRadian));
  }
  const std::vector<MapKeyframe> placed = map.keyframes();
  const std::vector<Eigen::Isometry3d> alone = odometry_chain(placed, graph);
  double farthest = 0.0;
  double last = 0.0;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    last = (placed[i].T_map_keyframe.translation() - alone[i].translation()).norm();
    farthest = std::max(farthest, last);
  }
  facts.add("the odometry alone",
            fmt::format("from the first keyframe on up to {:.3f} m elsewhere, {:.3f} m at the end",
                        farthest, last));
  for (const auto& [reason, count] : reasons) {
    facts.add("candidates not taken: " + reason, std::to_string(count));
  }
  return facts.section("Pose graph");
}

std::string warnings(const ExportJob& job, const MapPath& path, Verticals verticals) {
  std::string html;
  if (!job.georeference) {
    html += finding("The map has no place on the Earth.");
  } else if (job.options->origin) {
    html += finding("The map was placed by hand. Nothing measured says how well.");
  }
  const std::size_t parts = connected_components(job.map->graph()).components.size();
  if (parts > 1) {
    html +=
        finding(fmt::format("The map has {} parts without an edge between them: how they lie "
                            "to each other is a guess.",
                            parts));
  }
  for (const MapSession& session : job.map->sessions()) {
    const SessionProgress run = job.map->progress(session.id);
    if (!run.complete) {
      html +=
          finding(fmt::format("The run of session {} is not known to be complete.", session.id));
    } else if (run.edited) {
      html += finding(fmt::format("Session {} was edited after its run.", session.id));
    }
  }
  if (const std::size_t unknown = verticals[Vertical::unknown]) {
    html += finding(fmt::format("{} of {} keyframes have nothing that tells which way is up.",
                                unknown, job.map->keyframes().size()));
  }
  if (!std::ranges::all_of(path.sweeps,
                           [](const MapSweep& sweep) { return is_unix_time(sweep.stamp); })) {
    html += finding("The recording's stamps are not UNIX times: no date is known.");
  }
  return html.empty() ? "" : "<h2>To be watched</h2>\n" + html;
}

}  // namespace

std::string export_report(const ExportJob& job) {
  const MapPath path = map_path(*job.map, {});
  const ProductCoordinates coordinates = coordinates_of(job, true);
  const ProductCoordinates picture =
      job.georeference ? ProductCoordinates(*job.georeference, ProductFrame::local)
                       : ProductCoordinates();
  const std::string name = job.options->map.filename().string();
  const std::string title = "Report on " + name;
  const Verticals verticals = verticals_of(*job.map);
  Facts made;
  made.add("map", name);
  made.add("report by", "adit " + std::string(version()));
  std::string body = "<h1>" + escape_markup(title) + "</h1>\n" + warnings(job, path, verticals) +
                     place_section(job) + control_section(job, coordinates) +
                     sensors_section(*job.map, path, verticals) + gnss_section(*job.map) +
                     coverage_section(job, coordinates, path) + "<h2>From above</h2>\n" +
                     drawing_of(job, picture,
                                job.georeference ? "North is up; m east and north of the origin"
                                                 : "In the map's frame, m",
                                PictureFormat::svg) +
                     graph_section(*job.map) + sessions_section(job, path) +
                     made.section("Made by");
  write_text_file(job.file, html_page(title, body));
  return "a page for printing" + in_coordinates(coordinates);
}

}  // namespace adit
