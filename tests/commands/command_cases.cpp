// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tests/commands/command_cases.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <iterator>
#include <memory>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "adit/tests/commands/map_cases.hpp"
#include "adit/tests/commands/small_room.hpp"
#include "adit/tools/commands/command_align.hpp"
#include "adit/tools/commands/command_config.hpp"
#include "adit/tools/commands/command_convert.hpp"
#include "adit/tools/commands/command_evaluate.hpp"
#include "adit/tools/commands/command_inspect.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/commands/command_simulate.hpp"
#include "adit/tools/simulator/scene_file.hpp"

namespace adit::test {
namespace {

namespace fs = std::filesystem;

// Healthy input takes a tenth of a second of the processor; a command that takes this much is held
// up by something that the input made up.
constexpr double kMostSeconds = 30.0;

double processor_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

constexpr const char* kTables = "tables";  // tables of poses
constexpr const char* kScenes = "scenes";
constexpr const char* kMaps = "maps";
constexpr const char* kGraphs = "graphs";
constexpr const char* kConfigs = "configs";

// How long a healthy scene is, and a damaged one at most: one that asks for an hour rightly takes
// its time, and is left out.
constexpr double kSceneSeconds = 0.5;
constexpr double kMostSceneSeconds = 3.0;

/// What a person wrote or a program prints: numbers in it can be damaged, or looked for.
bool is_text(const fs::path& file) {
  constexpr std::array kSuffixes = {".txt",   ".csv",  ".tum",  ".json",
                                    ".kitti", ".yaml", ".toml", ".g2o"};
  return std::ranges::count(kSuffixes, file.extension()) > 0;
}

/// Where nothing but text is read: half of the damage lets it be read.
void damage_words(std::string& text, Dice& dice) {
  dice.one_in(2) ? damage_numbers(text, dice) : damage_text(text, dice);
}

void damage_file(const fs::path& file, Dice& dice) {
  std::string bytes = content(file);
  if (file.extension() == ".g2o") {
    damage_words(bytes, dice);
  } else if (is_text(file)) {
    damage_text(bytes, dice);
  } else {
    damage_bytes(bytes, dice);
  }
  write(file, bytes);
}

/// As on a command line: an option that is not given is none.
std::optional<std::string> given(const fs::path& file) {
  return file.empty() ? std::nullopt : std::optional(file.string());
}

/// Files in the folder and below, in the order of their names.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  return files;
}

/// The first number in it that is none; empty where all are. What is quoted is the input's.
std::string no_number(const std::string& told) {
  // Nor is the name of a file that a damaged list of files asks for ("/tmp/-inf").
  static const std::regex kQuoted("'[^'\n]*'|[^ \n]*: there is no such file|/[^ \n]*/[^ \n]*");
  const std::string text = std::regex_replace(told, kQuoted, "''");
  static const std::regex kNone("(^|[^A-Za-z_/.])-?(nan|inf)([^A-Za-z_/.]|$)");
  std::smatch found;
  if (!std::regex_search(text, found, kNone)) {
    return {};
  }
  const auto at = static_cast<std::size_t>(found.position());
  return text.substr(at < 80 ? 0 : at - 80, 160);
}

}  // namespace

std::string_view to_string(FuzzedCommand command) {
  constexpr std::array<std::string_view, 8> kNames = {"inspect", "run",      "convert", "evaluate",
                                                      "align",   "simulate", "maps",    "config"};
  return kNames[static_cast<std::size_t>(command)];
}

CommandCases::CommandCases(engine::Context& context)
    : context_(&context), events_(small_drive()), run_(folder_ / "run") {
  formats_ = write_healthy_recordings(folder_ / "formats", events_);
  std::ostringstream told;
  RunCommandOptions options;
  drive_ = write_messages(folder_ / "drive", "mcap", 0, events_).path();
  options.recording = drive_;
  options.output = run_;
  options.overwrite = true;
  options.device.opened = context_;
  if (run_command(options, told, told) != 0) {
    throw std::runtime_error("the healthy recording could not be mapped: " + told.str());
  }
  write_healthy_map(folder_ / "map");
  // The run's poses as other programs write them.
  const Trajectory trajectory = read_trajectory(run_ / "trajectory.tum");
  std::string euroc = "#timestamp,p_RS_R_x [m],p_y [m],p_z [m],q_w,q_x,q_y,q_z\n";
  for (const StampedPose& pose : trajectory.poses) {
    const Eigen::Vector3d p = pose.pose.translation();
    euroc += std::to_string(pose.stamp.count());
    for (const double number : {p.x(), p.y(), p.z(), 1.0, 0.0, 0.0, 0.0}) {
      euroc += "," + std::to_string(number);
    }
    euroc += "\n";
  }
  write(run_ / "data.csv", euroc);
}

std::vector<std::string> CommandCases::formats() const {
  std::vector<std::string> names;
  for (const HealthyFormat& format : formats_) {
    names.push_back(format.name);
  }
  names.insert(names.end(), {kTables, kScenes, kMaps, kGraphs, kConfigs});
  return names;
}

bool CommandCases::reads(FuzzedCommand command, const std::string& format) {
  constexpr std::array<std::pair<std::string_view, FuzzedCommand>, 5> kOwn = {
      {{kTables, FuzzedCommand::evaluate},
       {kScenes, FuzzedCommand::simulate},
       {kMaps, FuzzedCommand::maps},
       {kGraphs, FuzzedCommand::maps},
       {kConfigs, FuzzedCommand::config}}};
  const auto own = std::ranges::find(kOwn, format, [](const auto& of) { return of.first; });
  if (own != kOwn.end()) {
    return command == own->second;
  }
  return command != FuzzedCommand::simulate && command != FuzzedCommand::maps &&
         command != FuzzedCommand::config;
}

CommandCases::Damaged CommandCases::damaged_recording(const std::string& name,
                                                      const fs::path& folder, Dice& dice) const {
  // In half of the cases whole messages, or the numbers in them, within a container that is sound.
  if (holds_messages(name) && dice.one_in(2)) {
    std::vector<Recorded> events = events_;
    const bool in_fields = !dice.one_in(3);
    if (in_fields) {
      damage_events(events, dice);
    }
    const auto change = [&](std::string& bytes) {
      if (!in_fields && dice.one_in(20)) {
        damage_bytes(bytes, dice);
      }
    };
    const std::size_t variant = dice.below(12);
    return {write_messages(folder / "drive", name, variant, events, change).path(), {}};
  }
  const auto format = std::ranges::find(formats_, name, &HealthyFormat::name);
  const HealthyRecording& healthy = format->recordings[dice.below(format->recordings.size())];
  const HealthyRecording copy = {
      .folder = folder / "copy", .opened = healthy.opened, .metadata = healthy.metadata};
  fs::copy(healthy.folder, copy.folder, fs::copy_options::recursive);
  std::vector<fs::path> files = files_in(copy.folder);
  for (std::size_t change = 0; change <= dice.below(4); ++change) {
    const fs::path& file = files[dice.below(files.size())];
    if (files.size() > 1 && dice.one_in(20) && !dice.is_harmless()) {
      fs::remove(file);
    } else {
      damage_file(file, dice);
    }
  }
  return {copy.path(), copy.metadata.empty() ? fs::path() : copy.folder / copy.metadata};
}

int CommandCases::simulate(const fs::path& folder, Dice& dice, std::ostream& told) const {
  const auto put = [](std::string& text, const std::string& what, const std::string& instead) {
    text.replace(text.find(what), what.size(), instead);
  };
  std::string scene = scene_file_example();
  put(scene, "\"mine\"", dice.one_in(2) ? "\"room\"" : "\"mine\"");
  put(scene, "duration = 60.0", fmt::format("duration = {}", kSceneSeconds));
  put(scene, "use = false", dice.one_in(2) ? "use = true" : "use = false");
  put(scene, "doppler = false", dice.one_in(2) ? "doppler = true" : "doppler = false");
  put(scene, "receiver = \"none\"", dice.one_in(2) ? "receiver = \"rtk\"" : "receiver = \"none\"");
  if (dice.one_in(2)) {
    put(scene, "# waypoints =", "waypoints =");
    put(scene, "# corner_radius =", "corner_radius =");
  }
  damage_words(scene, dice);
  SimulateCommandOptions options;
  options.simulation.scene = folder / "scene.toml";
  options.simulation.output = folder / "out" / "drive.mcap";
  options.simulation.picture = dice.one_in(10);
  write(options.simulation.scene, scene);
  fs::create_directories(folder / "out");
  try {
    const double seconds = read_scene_file(options.simulation.scene).duration;
    if (seconds > kMostSceneSeconds) {
      told << "asks for " << seconds << " s\n";
      return 0;
    }
  } catch (const std::exception&) {  // for the command to tell
  }
  return simulate_command(options, told, told);
}

int CommandCases::config(const fs::path& folder, Dice& dice, std::ostream& told) {
  std::ostringstream healthy;
  config_command({}, healthy, healthy);
  std::string text = healthy.str();
  damage_words(text, dice);
  ConfigSource source;
  source.file = folder / "adit.toml";
  write(*source.file, text);
  return config_command(source, told, told);
}

int CommandCases::maps(const std::string& format, const fs::path& folder, Dice& dice,
                       std::ostream& told) const {
  const fs::path copy = folder / (format == kMaps ? "map.adit" : "graph.g2o");
  const fs::path healthy = folder_ / "map" / copy.filename();
  fs::copy(healthy, copy);
  if (format == kMaps && dice.one_in(2)) {
    damage_row(copy, dice);
  } else {
    damage_file(copy, dice);
  }
  return format == kMaps ? call_on_map(copy, healthy, folder, *context_, dice, told)
                         : call_on_graph(copy, folder, dice, told);
}

int CommandCases::evaluate_tables(const fs::path& folder, Dice& dice, std::ostream& told) const {
  const fs::path copy = folder / "run";
  fs::copy(run_, copy, fs::copy_options::recursive);
  const std::array<const char*, 5> names = {"sweeps.csv", "trajectory.tum", "trajectory.kitti",
                                            "summary.json", "data.csv"};
  const fs::path damaged = copy / names[dice.below(names.size())];
  damage_file(damaged, dice);

  EvaluateCommandOptions options;
  options.json = dice.one_in(2);
  options.evaluation.tolerance = 0.06;
  switch (dice.below(4)) {
    case 0:
      options.estimates = {copy};
      options.truth = run_ / "trajectory.tum";
      break;
    case 1:
      options.estimates = {copy};
      break;
    case 2:
      options.json = false;
      options.table = TableFormat::csv;
      options.estimates = {damaged, copy / "trajectory.tum"};
      options.truth = run_ / "trajectory.tum";
      break;
    default:
      options.estimates = {damaged};
      options.truth = run_ / "trajectory.tum";
      options.plot = folder / "plot.svg";
      if (dice.one_in(2)) {
        std::swap(options.estimates.front(), options.truth);
      }
  }
  return evaluate_command(options, told, told);
}

int CommandCases::evaluate(const fs::path& recording, Dice& dice, std::ostream& told) const {
  EvaluateCommandOptions options;
  options.json = dice.one_in(2);
  options.evaluation.tolerance = 0.06;
  options.estimates = {run_ / "trajectory.tum"};
  options.truth = recording;
  if (dice.one_in(2)) {
    std::swap(options.estimates.front(), options.truth);
  }
  return evaluate_command(options, told, told);
}

int CommandCases::align(const std::string& cloud, const fs::path& folder, Dice& dice,
                        std::ostream& told) const {
  AlignCommandOptions options;
  options.device.opened = context_;
  options.json = dice.one_in(2);
  const std::string healthy = drive_.string() + "@" + std::to_string(dice.below(kSweeps));
  if (dice.one_in(3)) {
    std::string list = healthy + " " + cloud + " 0.1 0 0 2\n" + healthy + " " + healthy + "\n";
    if (dice.one_in(2)) {
      damage_text(list, dice);
    }
    options.pairs = folder / "pairs.txt";
    write(*options.pairs, list);
    return align_command(options, told, told);
  }
  options.clouds = {healthy, cloud};
  if (dice.one_in(2)) {
    std::swap(options.clouds[0], options.clouds[1]);
  }
  if (dice.one_in(2)) {
    options.guess = {0.1, 0.0, 0.0, 2.0};
  }
  options.picture = folder / "both.png";
  return align_command(options, told, told);
}

int CommandCases::call(FuzzedCommand command, const std::string& format, const fs::path& folder,
                       Dice& dice, std::ostream& told) const {
  if (format == kTables) {
    return evaluate_tables(folder, dice, told);
  }
  if (command == FuzzedCommand::simulate) {
    return simulate(folder, dice, told);
  }
  if (command == FuzzedCommand::config) {
    return config(folder, dice, told);
  }
  if (command == FuzzedCommand::maps) {
    return maps(format, folder, dice, told);
  }
  const auto [recording, metadata] = damaged_recording(format, folder, dice);
  if (command == FuzzedCommand::evaluate) {
    return evaluate(recording, dice, told);
  }
  if (command == FuzzedCommand::align) {
    return align(recording.string(), folder, dice, told);
  }
  if (command == FuzzedCommand::convert) {
    const std::array<const char*, 3> names = {"out.mcap", "out.bag", "out"};
    ConvertOptions options;
    options.input = recording;
    options.output = folder / names[dice.below(names.size())];
    options.metadata = given(metadata);
    if (dice.one_in(2)) {
      options.repair.emplace().metadata = given(metadata);
    }
    return convert_command(options, told, told);
  }
  ConfigSource config;
  config.metadata = given(metadata);
  if (command == FuzzedCommand::inspect) {
    InspectCommandOptions options;
    options.recording = recording;
    options.config = config;
    options.device.opened = context_;
    options.json = dice.one_in(2);
    options.html = folder / "page.html";
    options.write_config = folder / "written.toml";
    return inspect_command(options, told, told);
  }
  RunCommandOptions options;
  options.recording = recording;
  options.config = config;
  options.output = folder / "out";
  options.overwrite = true;
  options.device.opened = context_;
  options.high_rate.enabled = dice.one_in(2);
  options.json = dice.one_in(2);
  options.odometry = dice.one_in(2);
  return run_command(options, told, told);
}

CommandOutcome CommandCases::run(FuzzedCommand command, const std::string& format, uint64_t number,
                                 Damage damage) const {
  Dice dice(4 * number + static_cast<uint64_t>(command), damage);
  const TemporaryFolder folder;
  std::ostringstream told;
  CommandOutcome outcome;
  const double before = processor_seconds();
  outcome.code = call(command, format, folder.path(), dice, told);
  const double taken = processor_seconds() - before;
  outcome.told = told.str();
  if (outcome.code < 0 || outcome.code > 2) {
    outcome.complaint = "it ended with " + std::to_string(outcome.code);
  } else if (taken > kMostSeconds) {
    outcome.complaint = "it took " + std::to_string(taken) + " s of the processor";
  } else if (outcome.told.empty()) {
    outcome.complaint = "it said nothing";
  } else if (const std::string found = no_number(outcome.told); !found.empty()) {
    outcome.complaint = "it says: " + found;
  }
  if (fs::exists(folder / "out")) {
    for (const fs::path& file : files_in(folder / "out")) {
      if (const std::string found = is_text(file) ? no_number(content(file)) : ""; !found.empty()) {
        outcome.complaint = file.filename().string() + " has: " + found;
      }
    }
  }
  return outcome;
}

}  // namespace adit::test
