// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit bench slam` maps: recordings with the truth, simulated or the user's own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/results/trajectory_io.hpp"

namespace adit::bench {

/// A line of the catalogue: the arguments of `adit simulate`.
struct SlamEntry {
  std::string name{};
  std::string scene{};
  std::string sensor{};
  std::string trajectory{};
  double duration = 0.0;  ///< s
  double begin = 0.0;     ///< m along the scene's route
  uint64_t seed = 1;
  bool quick = false;  ///< one among the few that --quick maps
  std::vector<std::string> faults{};
  double speed = 0.0;  ///< m/s; 0: the scene's
  /// The entry whose recording is mapped, with `settings` of ours ("section.key=value"); empty:
  /// its own.
  std::string recording{};
  std::vector<std::string> settings{};
};

/// How far apart along the route seeds begin by default, m: what a sequence is about stays in it.
inline constexpr double kBetweenBeginnings = 7.0;
/// The same with another seed, from another of five places on, `apart` m from each other:
/// "NAME@SEED".
SlamEntry with_seed(SlamEntry entry, uint64_t seed, double apart = kBetweenBeginnings);

/// Everything that is simulated for the benchmark, by scene.
std::vector<SlamEntry> slam_catalogue();

/// What --loops maps: places seen again the same way, in reverse and from another floor, after some
/// hundred metres and after some thousand, with the IMU and by the lidar alone.
std::vector<SlamEntry> loop_catalogue();

/// A recording and its truth.
struct SlamSequence {
  std::string name{};
  std::string family{};       ///< the name without a seed
  std::string description{};  ///< for people: the sensor and how it was carried, or "recorded"
  std::filesystem::path recording{};
  std::filesystem::path truth{};                       ///< TUM or KITTI format
  std::optional<std::filesystem::path> truth_times{};  ///< stamps for a truth in KITTI format
  std::optional<std::filesystem::path> loops{};        ///< places that see the same
  std::vector<std::string> settings{};                 ///< of ours, for this one
};

/// The sequence of an entry, in `folder`. Simulates it unless what lies there is of the same entry
/// and of the same revision of the simulator. Throws UsageError for names the simulator does not
/// know, OutputError.
SlamSequence simulated_sequence(
    const SlamEntry& entry, const std::filesystem::path& folder,
    const std::function<void(std::size_t done, std::size_t total)>& progress);

/// Throws InputError.
Trajectory truth_of(const SlamSequence& sequence);

/// A file of another system's on the sequence's recording: SYSTEM/NAME.tum.
std::filesystem::path file_of(const std::filesystem::path& system, const SlamSequence& sequence,
                              const char* ending = ".tum");

/// The recordings in a folder, or the folder itself where it is one, by name. The truth of NAME.bag
/// (or any other file) is NAME.truth.tum or NAME.truth.kitti beside it; that of a folder NAME is
/// one of these, or truth.tum, truth.kitti or poses_velo.txt in it, with times.txt beside it. The
/// poses are those of the range sensor. NAME.truth.loops.csv, if it is there, has the places that
/// see the same. Throws InputError where there is none.
std::vector<SlamSequence> recorded_sequences(const std::filesystem::path& folder);

}  // namespace adit::bench
