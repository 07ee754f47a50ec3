// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_merge/merge_inputs.hpp"

#include <algorithm>
#include <compare>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/map_database/map_records.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_database/writer_lock.hpp"
#include "adit/tools/run/earlier_run.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

bool is_same_file(const fs::path& one, const fs::path& other) {
  std::error_code unknown;
  return fs::equivalent(one, other, unknown) && !unknown;
}

/// Throws LockedError where another process writes to the map: its poses may change on the way.
void require_no_writer_of(const fs::path& file) {
  if (const std::optional<std::string> writer = writer_of(file)) {
    throw LockedError(
        file, file.string() + ": is being written by " + *writer + ". Merge it when that is done.");
  }
}

MergeInput opened(const fs::path& file) {
  require_no_writer_of(file);
  MergeInput input{.file = file, .map = std::make_unique<MapDatabase>(file, MapAccess::read)};
  input.sessions = input.map->sessions();
  input.keyframes = input.map->keyframes();
  if (input.keyframes.empty()) {
    throw InputError(file, {}, "it holds no keyframe: there is nothing to merge", "Leave it out");
  }
  for (const MapSession& session : input.sessions) {
    const SessionProgress run = input.map->progress(session.id);
    if (!run.complete && !run.edited) {
      input.incomplete.push_back(session.id);
    }
  }
  for (const MapKeyframe& keyframe : input.keyframes) {  // damage shows now, not on the way
    input.r_submap = load_submap(*input.map, keyframe.id, file).r_submap;
  }
  static_cast<void>(input.map->graph());
  return input;
}

/// What a map is, but for where it lies and when it was made.
struct MapIdentity {
  std::size_t keyframes = 0;
  std::vector<std::string> recordings{};
  std::vector<double> poses{};

  std::partial_ordering operator<=>(const MapIdentity& other) const {
    if (const auto order = other.keyframes <=> keyframes; order != 0) {  // more come first
      return order;
    }
    if (const auto order = recordings <=> other.recordings; order != 0) {
      return order;
    }
    return poses <=> other.poses;
  }
};

MapIdentity identity_of(const MergeInput& input) {
  MapIdentity identity{.keyframes = input.keyframes.size()};
  for (const MapSession& session : input.sessions) {
    for (const auto& [key, value] : session.provenance) {
      if (key == "recording fingerprint") {
        identity.recordings.push_back(value);
      }
    }
  }
  for (const MapKeyframe& keyframe : input.keyframes) {
    identity.poses.push_back(static_cast<double>(keyframe.stamp.count()));
    const PoseNumbers numbers = pose_numbers(keyframe.T_map_keyframe);
    identity.poses.insert(identity.poses.end(), numbers.begin(), numbers.end());
  }
  return identity;
}

/// Throws InputError where two maps hold the same recording.
void require_other_recordings(const MergeInput& one, const MergeInput& other) {
  for (const MapSession& session : one.sessions) {
    for (const MapSession& same : other.sessions) {
      if (has_same_recording(session, same)) {
        throw InputError(other.file, {},
                         "its session " + std::to_string(same.id) +
                             " is of the same recording as session " + std::to_string(session.id) +
                             " of " + one.file.string(),
                         "A recording counts once: leave one of the two maps out");
      }
    }
  }
}

}  // namespace

std::vector<MergeInput> open_merge_inputs(const std::vector<fs::path>& maps) {
  if (maps.size() < 2) {
    throw UsageError("name two maps or more: adit merge A B -o MERGED.adit");
  }
  std::vector<std::pair<MapIdentity, MergeInput>> inputs;
  for (const fs::path& map : maps) {
    const fs::path file = find_map(map);
    for (const auto& [identity, other] : inputs) {
      if (is_same_file(file, other.file)) {
        throw UsageError(map.string() + " is named twice.");
      }
    }
    MergeInput input = opened(file);
    MapIdentity identity = identity_of(input);
    for (const auto& [known, other] : inputs) {
      require_other_recordings(other, input);
      if ((known <=> identity) == 0) {
        throw InputError(file, {}, "it holds the same as " + other.file.string(),
                         "Leave one of the two out");
      }
    }
    inputs.emplace_back(std::move(identity), std::move(input));
  }
  std::ranges::sort(inputs, [](const auto& a, const auto& b) { return (a.first <=> b.first) < 0; });
  std::vector<MergeInput> sorted;
  for (auto& [identity, input] : inputs) {
    require_no_writer_of(input.file);
    sorted.push_back(std::move(input));
  }
  return sorted;
}

void require_free_output(const std::vector<fs::path>& maps, const fs::path& output) {
  std::error_code unknown;
  if (!fs::exists(output, unknown)) {
    return;
  }
  const bool is_input = std::ranges::any_of(maps, [&](const fs::path& map) {
    return is_same_file(map, output) || is_same_file(map_file(map), output);
  });
  throw UsageError("-o " + output.string() +
                   (is_input ? ": it is one of the maps to merge, and they stay as they are. "
                               "Name another file."
                             : ": there is a file of that name. Name one that is not there yet."));
}

}  // namespace adit
