// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_info.hpp"

#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_database/writer_lock.hpp"
#include "adit/tools/map_edits/control_points.hpp"

namespace adit {
namespace {

/// A map in figures.
struct Figures {
  std::vector<MapSession> sessions;
  std::vector<SessionProgress> runs;  ///< that have filled them
  std::size_t keyframes = 0;
  std::size_t sweeps = 0;
  std::size_t edges = 0;
  std::size_t loops = 0;
  std::size_t revoked = 0;
  std::size_t candidates = 0;
  std::size_t components = 0;
  std::optional<Georeference> georeference;
  std::size_t fixes = 0;
  std::size_t fixes_used = 0;
  ControlTable control;
  std::map<std::string, std::size_t> verticals;  ///< keyframes by what the vertical comes from
  double length = 0.0;                           ///< m, along the sweeps
  double seconds = 0.0;                          ///< from the first sweep to the last
  Eigen::AlignedBox3d box;                       ///< box around the sensor's positions, m
  uintmax_t bytes = 0;
  std::optional<std::string> writer;  ///< who writes to it at this moment
};

Figures figures_of(const std::filesystem::path& file) {
  const MapDatabase map(file, MapAccess::read);
  Figures figures;
  figures.writer = writer_of(file);
  figures.sessions = map.sessions();
  for (const MapSession& session : figures.sessions) {
    figures.runs.push_back(map.progress(session.id));
  }
  const PoseGraph graph = map.graph();
  figures.keyframes = graph.nodes().size();
  figures.components = connected_components(graph).components.size();
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind == EdgeKind::start) {
      continue;  // expected, not measured
    }
    ++(edge.status == EdgeStatus::revoked ? figures.revoked
       : edge.kind == EdgeKind::loop      ? figures.loops
                                          : figures.edges);
  }
  figures.candidates = map.candidates().size();
  figures.georeference = map.georeference();
  figures.control = control_table(map);
  for (const MapFix& fix : map.fixes()) {
    ++figures.fixes;
    figures.fixes_used += fix.verdict == FixVerdict::used ? 1U : 0U;
  }
  for (const PoseNode& node : graph.nodes()) {
    const KeyframeSubmap submap = load_sweeps(map, node.id, file);
    ++figures.verticals[std::string(to_string(submap.vertical))];
  }
  const std::vector<StampedPose> poses = map_trajectory(map, file);
  figures.sweeps = poses.size();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    figures.box.extend(poses[i].pose.translation());
    figures.length +=
        i > 0 ? (poses[i].pose.translation() - poses[i - 1].pose.translation()).norm() : 0.0;
  }
  if (!poses.empty()) {
    figures.seconds = seconds(poses.back().stamp - poses.front().stamp);
  }
  std::error_code ignored;
  figures.bytes = std::filesystem::file_size(file, ignored);
  const uintmax_t log = std::filesystem::file_size(file.string() + "-wal", ignored);
  figures.bytes += ignored ? 0 : log;  // what a run has stored lately lies there
  return figures;
}

/// What has become of the run that fills a session.
std::string text_of(const SessionProgress& run, const std::filesystem::path& map, bool is_written) {
  if (run.complete) {
    return run.edited ? "complete, and edited since" : "complete";
  }
  if (run.edited) {
    return "not known to be complete: the map was made by an older adit, or edited or recovered";
  }
  const std::string copy =
      ". To copy the map take " + map.filename().string() + "-wal, too, where it is";
  return is_written ? "not complete: the map is being written" + copy
                    : "not complete: it was stopped or killed, and `adit run --continue` goes on "
                      "with it" +
                          copy;
}

/// Where the map lies on the Earth, and by what; nothing where it does not.
std::string place_text(const Figures& figures) {
  std::string text;
  if (figures.georeference) {
    const Geodetic& origin = figures.georeference->origin;
    text += fmt::format("place      {:.8f}, {:.8f} degrees, {:.3f} m\n", origin.latitude,
                        origin.longitude, origin.altitude);
  }
  if (figures.fixes > 0) {
    text += fmt::format("fixes      {}, of which {} are used\n", figures.fixes, figures.fixes_used);
  }
  for (const ControlRole role : {ControlRole::control, ControlRole::check}) {
    if (const auto spread = spread_of(figures.control, role)) {
      text += fmt::format("{:<10} {} points, rms level {:.3f} m, up {:.3f} m\n", to_string(role),
                          spread->count, spread->level, spread->up);
    }
  }
  return text;
}

std::string text_of(const InfoCommandOptions& options, const Figures& figures) {
  std::string text = fmt::format("map        {}, {:.1f} MiB\n", options.map.string(),
                                 static_cast<double>(figures.bytes) / (1024.0 * 1024.0));
  if (figures.writer) {
    text += "writer     " + *figures.writer + ": the map is being written\n";
  }
  if (figures.keyframes == 0) {
    text += figures.writer
                ? "keyframes  none yet\n"
                : "keyframes  none: the run that made it ended before its first sweep was placed\n";
  } else {
    const Eigen::Vector3d size = figures.box.sizes();
    text += fmt::format("keyframes  {}, of {} sweeps in {:.1f} s\n", figures.keyframes,
                        figures.sweeps, figures.seconds);
    text += fmt::format("way        {:.1f} m, within {:.1f} x {:.1f} x {:.1f} m\n", figures.length,
                        size.x(), size.y(), size.z());
    text += "upright    by";
    for (const auto& [name, count] : figures.verticals) {
      text += fmt::format(" {}: {}", name, count);
    }
    text += fmt::format("\nedges      {} of the odometry, {} loops, {} revoked; {} candidates\n",
                        figures.edges, figures.loops, figures.revoked, figures.candidates);
  }
  text += place_text(figures);
  if (figures.components > 1) {
    text += fmt::format(
        "parts      {}, without an edge between them: how they lie to each other is a guess{}\n",
        figures.components,
        std::ranges::all_of(figures.runs,
                            [](const SessionProgress& run) { return run.ending || run.edited; })
            ? ""
            : "; the last keyframes of a run that has not ended get theirs later");
  }
  for (std::size_t i = 0; i < figures.sessions.size(); ++i) {
    const MapSession& session = figures.sessions[i];
    text += fmt::format("session    {}: {}\n", session.id, session.name);
    text += fmt::format("           {:<18} {}\n", "run",
                        text_of(figures.runs[i], options.map, figures.writer.has_value()));
    for (const auto& [key, value] : session.provenance) {
      text += fmt::format("           {:<18} {}\n", key, value);
    }
  }
  return text;
}

std::string json_of(const InfoCommandOptions& options, const Figures& figures) {
  using Json = nlohmann::ordered_json;
  nlohmann::ordered_json json = {{"schema", "info/1"},
                                 {"map", options.map.string()},
                                 {"writer", figures.writer ? Json(*figures.writer) : Json()},
                                 {"bytes", figures.bytes},
                                 {"keyframes", figures.keyframes},
                                 {"sweeps", figures.sweeps},
                                 {"seconds", figures.seconds},
                                 {"length_m", figures.length},
                                 {"edges", figures.edges},
                                 {"loops", figures.loops},
                                 {"revoked", figures.revoked},
                                 {"candidates", figures.candidates},
                                 {"components", figures.components},
                                 {"verticals", figures.verticals},
                                 {"fixes", figures.fixes},
                                 {"fixes_used", figures.fixes_used}};
  if (figures.georeference) {
    const Geodetic& origin = figures.georeference->origin;
    json["origin"] = {{"latitude", origin.latitude},
                      {"longitude", origin.longitude},
                      {"altitude_m", origin.altitude}};
  }
  for (const ControlRole role : {ControlRole::control, ControlRole::check}) {
    if (const auto spread = spread_of(figures.control, role)) {
      json[std::string(to_string(role))] = to_json(*spread);
    }
  }
  json["sessions"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < figures.sessions.size(); ++i) {
    const MapSession& session = figures.sessions[i];
    nlohmann::ordered_json provenance = nlohmann::ordered_json::object();
    for (const auto& [key, value] : session.provenance) {
      provenance[key] = value;
    }
    json["sessions"].push_back({{"id", session.id},
                                {"name", session.name},
                                {"complete", figures.runs[i].complete},
                                {"edited", figures.runs[i].edited},
                                {"provenance", provenance},
                                {"configuration", session.configuration}});
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

/// What is wrong with a map, beyond what its database knows: submaps that are none, sweeps in two
/// of them.
std::vector<std::string> problems_of(const MapDatabase& map) {
  const std::filesystem::path& file = map.file();
  std::vector<std::string> problems = map.check();
  if (!problems.empty()) {
    return problems;
  }
  std::map<std::pair<SessionId, Nanoseconds>, NodeId> owners;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    try {
      for (const SubmapSweep& sweep : load_submap(map, keyframe.id, file).sweeps) {
        const auto [owner, is_new] =
            owners.emplace(std::pair(keyframe.session, sweep.stamp), keyframe.id);
        if (!is_new) {
          problems.push_back("a sweep of keyframe " + std::to_string(keyframe.id) +
                             " is in keyframe " + std::to_string(owner->second) + ", too");
        }
      }
    } catch (const InputError& error) {
      problems.emplace_back(error.what());
    }
  }
  return problems;
}

int check(const InfoCommandOptions& options, std::ostream& out) {
  const MapDatabase map(options.map, MapAccess::read);
  const std::vector<std::string> problems = problems_of(map);
  if (options.json) {
    out << nlohmann::ordered_json{{"schema", "check/1"},
                                  {"map", options.map.string()},
                                  {"whole", problems.empty()},
                                  {"checksums", map.has_checksums()},
                                  {"problems", problems}}
               .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
        << "\n";
    return problems.empty() ? 0 : 1;
  }
  for (const std::string& problem : problems) {
    out << problem << "\n";
  }
  if (problems.empty()) {
    out << options.map.string()
        << (map.has_checksums()
                ? " is whole\n"
                : " is whole as far as its structure shows: an older adit wrote it, and its rows "
                  "have no checksums. The next command that writes to it adds them.\n");
  } else {
    out << options.map.string() << " is damaged: " << problems.size()
        << (problems.size() == 1 ? " finding" : " findings") << ". `adit recover "
        << options.map.string() << " -o NEW` writes what is whole into a new map.\n";
  }
  return problems.empty() ? 0 : 1;
}

InfoCommandOptions with_map(InfoCommandOptions options) {
  options.map = find_map(options.map);
  return options;
}

void add(Command app, const char* name, const char* what, const char* codes,
         int (*command)(const InfoCommandOptions&, std::ostream&, std::ostream&),
         std::function<void(int)> done) {
  const Command added = app.add_command(name, what);
  const auto options = std::make_shared<InfoCommandOptions>();
  added.footer(
      "OUT is the folder of a run, MAP the map in it, OUT/map.adit. A run that goes on is no "
      "hindrance.\n"
      "\nExamples:\n  adit " +
      std::string(name) + " out\n  adit " + name + " out/map.adit --json\n\nExit codes: " + codes);
  added.option("map", options->map, "The map, or the folder of its run")
      .required()
      .value_name("MAP|OUT");
  added.flag("--json", options->json, "Print JSON instead of text");
  added.action([options, command, done = std::move(done)] {
    done(command(*options, std::cout, std::cerr));
  });
}

}  // namespace

int info_command(const InfoCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit info", out, err, [&] {
    const InfoCommandOptions found = with_map(options);
    const Figures figures = figures_of(found.map);
    out << (found.json ? json_of(found, figures) : text_of(found, figures));
    return 0;
  });
}

int check_command(const InfoCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit check", out, err, [&] { return check(with_map(options), out); });
}

void add_info_command(Command app, std::function<void(int)> done) {
  add(app, "info", "Say what a map holds and where it comes from",
      "0 done, 1 no map that can be read, 2 usage.", info_command, std::move(done));
}

void add_check_command(Command app, std::function<void(int)> done) {
  add(app, "check", "Read all of a map and say whether it is whole",
      "0 whole, 1 damaged or no map, 2 usage.", check_command, std::move(done));
}

}  // namespace adit
