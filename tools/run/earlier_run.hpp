// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a map tells of the run that made it: for runs that go on with it, and for runs that map its
// recording again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/report/run_summary.hpp"

namespace adit {

/// What makes a map: this program, and the device; sessions keep it.
std::vector<std::pair<std::string, std::string>> provenance_of(const engine::DeviceInfo& device);

/// The same with the run's recording.
MapSession session_of(const RunDescription& run);

struct EarlierRun {
  std::filesystem::path map;
  MapSession session;
  SessionProgress progress;
  std::filesystem::path recording;
  std::vector<std::filesystem::path> further_recordings;  ///< parts of it that follow in time
  std::optional<std::string> topic;  ///< the sweeps'; none: the only one there is
  int64_t first_sweep = 0;           ///< of the recording
  int64_t sweeps = 0;                ///< from there on
  /// MapMemory::graph_bytes of the run; none: no limit.
  std::optional<uint64_t> graph_bytes{};
};

/// Throws InputError: no map, one of several recordings, one that does not say where it comes from.
EarlierRun earlier_run(const std::filesystem::path& map);

/// Whether the recording, in one or several parts, is the one that the session is of, by its
/// fingerprint. Of sessions that do not say: yes. Throws InputError where there is no such
/// recording.
bool is_recording_of(const MapSession& session,
                     const std::vector<std::filesystem::path>& recordings);

/// Both are of the same recording, by its fingerprint; false where one does not say.
bool has_same_recording(const MapSession& one, const MapSession& other);

/// The session was localised in another map, which its own is nothing without.
inline constexpr std::string_view kLocalizedIn = "localized in";

/// The paths of the session's recording; none where it does not say.
std::vector<std::filesystem::path> recordings_of(const MapSession& session);

/// Throws InputError where the run could not go on with the earlier one's map, with all that
/// differs.
void require_same(const EarlierRun& earlier, const MapSession& now);

}  // namespace adit
