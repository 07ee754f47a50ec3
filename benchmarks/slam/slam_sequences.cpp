// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/slam/slam_sequences.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit::bench {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kBeginnings = 5;
constexpr uint64_t kLoopSeed = 501;

SimulationOptions simulation_of(const SlamEntry& entry, const fs::path& recording) {
  SimulationOptions options;
  options.scene = entry.scene;
  options.lidars.front().sensor = entry.sensor;
  options.trajectory = entry.trajectory;
  options.duration = entry.duration;
  options.begin = entry.begin;
  options.seed = entry.seed;
  options.compression = Compression::zstd;
  options.faults = entry.faults;
  if (entry.speed > 0.0) {
    options.speed = entry.speed;
  }
  options.output = recording;
  return options;
}

/// What a recording is made of: it need not be made again where this has not changed.
std::string origin_of(const SlamEntry& entry) {
  std::ostringstream text;
  text << "adit bench slam: simulator revision " << kSimulatorRevision << ", " << entry.scene
       << ", " << entry.sensor << ", " << entry.trajectory << ", " << entry.duration << " s from "
       << entry.begin << " m on, seed " << entry.seed;
  for (const std::string& fault : entry.faults) {
    text << ", " << fault;
  }
  if (entry.speed > 0.0) {
    text << ", " << entry.speed << " m/s";
  }
  text << "\n";
  return text.str();
}

std::string content(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

std::string described(const SlamEntry& entry) {
  std::string text = entry.sensor + ", " + entry.trajectory;
  for (const std::string& setting : entry.settings) {
    text += ", " + setting;
  }
  return text;
}

/// The first of the candidates that exists.
std::optional<fs::path> first_of(const std::vector<fs::path>& candidates) {
  const auto found =
      std::ranges::find_if(candidates, [](const auto& path) { return fs::is_regular_file(path); });
  return found == candidates.end() ? std::nullopt : std::optional(*found);
}

/// Other files may stand beside a recording under its name.
bool may_be_recording(const fs::path& path) {
  constexpr std::array<std::string_view, 9> kEndings = {".mcap", ".bag", ".db3", ".pcap", ".pcapng",
                                                        ".pcd",  ".ply", ".las", ".laz"};
  return fs::is_directory(path) || std::ranges::count(kEndings, path.extension().string()) > 0;
}

fs::path name_of(const fs::path& recording) {
  return fs::is_directory(recording) ? recording.filename() : recording.stem();
}

std::optional<SlamSequence> recorded_sequence(const fs::path& path) {
  if (!may_be_recording(path)) {
    return std::nullopt;
  }
  const bool is_folder = fs::is_directory(path);
  const fs::path name = name_of(path);
  std::vector<fs::path> candidates = {path.parent_path() / (name.string() + ".truth.tum"),
                                      path.parent_path() / (name.string() + ".truth.kitti")};
  if (is_folder) {
    for (const char* inside : {"truth.tum", "truth.kitti", "poses_velo.txt"}) {
      candidates.push_back(path / inside);
    }
  }
  const std::optional<fs::path> truth = first_of(candidates);
  if (!truth) {
    return std::nullopt;
  }
  return SlamSequence{
      .name = name.string(),
      .family = name.string(),
      .description = "recorded",
      .recording = path,
      .truth = *truth,
      .truth_times = is_folder ? first_of({path / "times.txt"}) : std::nullopt,
      .loops = first_of({path.parent_path() / (name.string() + ".truth.loops.csv")})};
}

}  // namespace

std::vector<SlamEntry> slam_catalogue() {
  return {{"mine-vlp16-drive", "mine", "VLP-16", "drive", 60.0, 0.0, 1, true},
          {"mine-vlp16-tunnel", "mine", "VLP-16", "drive", 60.0, 415.0},
          {"mine-os0-walk", "mine", "OS0-128", "walk", 20.0, 0.0, 2},
          {"office-vlp16-walk", "office", "VLP-16", "walk", 60.0, 15.0},
          {"office-mid360-stairs", "office", "Mid-360", "handheld", 30.0, 38.0, 1, true},
          {"city-vlp16-drive", "city", "VLP-16", "drive", 60.0},
          {"city-vlp16-stops", "city", "VLP-16", "stop-and-go", 40.0, 3000.0, 2},
          {"city-hdl64e-drive", "city", "HDL-64E", "drive", 20.0, 1000.0},
          {"forest-vlp16-handheld", "forest", "VLP-16", "handheld", 40.0},
          {"forest-os1-walk", "forest", "OS1-64", "walk", 30.0, 100.0, 2},
          {"field-vlp16-drive", "field", "VLP-16", "drive", 60.0},
          {"field-vlp16-stops", "field", "VLP-16", "stop-and-go", 40.0},
          {"field-vlp16-walk", "field", "VLP-16", "walk", 40.0},
          {"field-hdl32e-drive", "field", "HDL-32E", "drive", 30.0},
          {"field-hdl32e-stops", "field", "HDL-32E", "stop-and-go", 30.0},
          {"field-hdl32e-walk", "field", "HDL-32E", "walk", 30.0},
          {"field-hdl32e-moving", "field", "HDL-32E", "moving-start", 30.0, 200.0, 2},
          {"room-mid360-fast", "room", "Mid-360", "fast-handheld", 20.0},
          {"mine-vlp16-spikes", "mine", "VLP-16", "drive", 30.0, 0.0, 1, false, {"spikes"}},
          {"room-mid360-handheld", "room", "Mid-360", "handheld", 30.0, 0.0, 1, true},
          {"room-avia-walk", "room", "Avia", "walk", 30.0, 0.0, 2},
          {"wings-vlp16-walk", "wings", "VLP-16", "walk", 40.0},
          {"repeated_wing-vlp16-walk", "repeated_wing", "VLP-16", "walk", 40.0},
          {"equal_houses-vlp16-drive", "equal_houses", "VLP-16", "drive", 40.0},
          {"ring_tunnel-vlp16-drive", "ring_tunnel", "VLP-16", "drive", 40.0}};
}

std::vector<SlamEntry> loop_catalogue() {
  const auto entry = [](const char* name, const char* scene, const char* sensor,
                        const char* trajectory, double duration, double begin = 0.0) {
    return SlamEntry{.name = name,
                     .scene = scene,
                     .sensor = sensor,
                     .trajectory = trajectory,
                     .duration = duration,
                     .begin = begin,
                     .seed = kLoopSeed};
  };
  const auto by_lidar = [](SlamEntry mapped, const char* name) {
    mapped.recording = std::exchange(mapped.name, name);
    mapped.settings = {"imu.use=false"};
    return mapped;
  };
  // Faster than the scene's, as in `adit demo`, so that it is soon round the first pillar.
  SlamEntry quick = entry("mine-vlp16-95s", "mine", "VLP-16", "drive", 95.0);
  quick.quick = true;
  quick.speed = 2.4;
  const SlamEntry mine = entry("mine-vlp16-420s", "mine", "VLP-16", "drive", 420.0);
  const SlamEntry office = entry("office-vlp16-260s", "office", "VLP-16", "walk", 260.0);
  const SlamEntry forest = entry("forest-vlp16-480s", "forest", "VLP-16", "walk", 480.0);  // 440 m
  const SlamEntry city = entry("city-vlp16-140s", "city", "VLP-16", "drive", 140.0);
  const SlamEntry wing =
      entry("repeated_wing-vlp16-290s", "repeated_wing", "VLP-16", "drive", 290.0);
  const SlamEntry houses =
      entry("equal_houses-vlp16-130s", "equal_houses", "VLP-16", "drive", 130.0);
  const SlamEntry ring = entry("ring_tunnel-vlp16-170s", "ring_tunnel", "VLP-16", "drive", 170.0);
  return {
      quick, mine, by_lidar(mine, "mine-lidar-420s"), office, by_lidar(office, "office-lidar-260s"),
      entry("office-mid360-260s", "office", "Mid-360", "handheld", 260.0), forest,
      by_lidar(forest, "forest-lidar-480s"), city, by_lidar(city, "city-lidar-140s"),
      // 1560 to 1770 m are driven again in reverse from 2820 m on.
      entry("city-vlp16-reverse", "city", "VLP-16", "drive", 240.0, 1500.0),
      entry("city-vlp16-1010s", "city", "VLP-16", "drive", 1010.0),
      // Places that resemble others: once round, down the street and up again, twice round.
      wing, by_lidar(wing, "repeated_wing-lidar-290s"), houses,
      by_lidar(houses, "equal_houses-lidar-130s"), ring, by_lidar(ring, "ring_tunnel-lidar-170s")};
}

SlamEntry with_seed(SlamEntry entry, uint64_t seed, double apart) {
  entry.name += "@" + std::to_string(seed);
  if (!entry.recording.empty()) {
    entry.recording += "@" + std::to_string(seed);
  }
  entry.seed = seed;
  entry.begin += apart * static_cast<double>(seed % kBeginnings);
  return entry;
}

SlamSequence simulated_sequence(
    const SlamEntry& entry, const fs::path& folder,
    const std::function<void(std::size_t done, std::size_t total)>& progress) {
  const std::string name = entry.recording.empty() ? entry.name : entry.recording;
  const SimulationFiles files(folder / (name + ".mcap"));
  const fs::path origin = folder / (name + ".origin");
  const SlamSequence sequence{.name = entry.name,
                              .family = entry.name.substr(0, entry.name.find('@')),
                              .description = described(entry),
                              .recording = files.recording,
                              .truth = files.trajectory,
                              .truth_times = std::nullopt,
                              .loops = files.loops,
                              .settings = entry.settings};
  if (fs::exists(files.recording) && content(origin) == origin_of(entry)) {
    return sequence;
  }
  std::error_code error;
  fs::create_directories(folder, error);
  fs::remove(origin, error);
  simulate(simulation_of(entry, files.recording), progress);
  // Last: a recording that was cut short by a signal has no origin.
  write_text_file(origin, origin_of(entry));
  return sequence;
}

Trajectory truth_of(const SlamSequence& sequence) {
  const Trajectory truth = read_trajectory(sequence.truth);
  return truth.stamped || !sequence.truth_times
             ? truth
             : read_trajectory(sequence.truth, sequence.truth_times);
}

fs::path file_of(const fs::path& system, const SlamSequence& sequence, const char* ending) {
  return system / (name_of(sequence.recording).string() + ending);
}

std::vector<SlamSequence> recorded_sequences(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw InputError(folder, {}, "it is no folder", "Give a folder of recordings");
  }
  // A name may end in a slash, or be a dot.
  const fs::path clean = (fs::absolute(folder) / ".").lexically_normal().parent_path();
  if (const auto itself = recorded_sequence(clean)) {
    return {*itself};
  }
  std::vector<SlamSequence> sequences;
  for (const fs::directory_entry& entry : fs::directory_iterator(clean)) {
    if (const auto sequence = recorded_sequence(entry.path())) {
      sequences.push_back(*sequence);
    }
  }
  if (sequences.empty()) {
    throw InputError(folder, {}, "there is no recording with its truth beside it",
                     "The truth of NAME.bag is NAME.truth.tum beside it; that of a folder may also "
                     "be truth.tum in it");
  }
  std::ranges::sort(sequences, {}, &SlamSequence::name);
  return sequences;
}

}  // namespace adit::bench
