// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/earlier_run.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/support/commit.hpp"
#include "adit/tools/support/fingerprint.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

// Where the recording and what tells of its sensor lie is no part of what they are.
constexpr std::string_view kRecording = "recording";
constexpr std::string_view kFurtherRecording = "recording part ";  // and its number, from 2
constexpr std::string_view kTopic = "topic";
constexpr std::string_view kGraphBytes = "graph bytes at most";
constexpr std::string_view kFingerprint = "recording fingerprint";
// What another commit makes of a recording is compared, keyframe by keyframe.
constexpr std::string_view kCommit = "commit";
constexpr std::string_view kMetadataSetting = "recording.metadata = ";

const std::string* provenance_value(const MapSession& session, std::string_view key) {
  const auto found =
      std::ranges::find(session.provenance, key, &std::pair<std::string, std::string>::first);
  return found == session.provenance.end() ? nullptr : &found->second;
}

const std::string& require(const std::filesystem::path& map, const MapSession& session,
                           std::string_view key) {
  const std::string* value = provenance_value(session, key);
  if (value == nullptr) {
    throw InputError(map, {}, "it does not say its \"" + std::string(key) + "\"",
                     "Name the recording, and map it anew");
  }
  return *value;
}

int64_t require_number(const std::filesystem::path& map, const MapSession& session,
                       std::string_view key) {
  const auto number = parse_unsigned(require(map, session, key));
  if (!number) {
    throw InputError(map, {}, "its \"" + std::string(key) + "\" is no number",
                     "The map is damaged; map the recording anew");
  }
  return static_cast<int64_t>(*number);
}

/// Lines of settings that one has and the other has not, without comments.
std::vector<std::string> settings_of(const std::string& toml) {
  std::vector<std::string> settings;
  LineReader lines(toml);
  std::string section;
  while (const auto line = lines.next()) {
    if (line->starts_with('[')) {
      section = std::string(line->substr(1, line->find(']') - 1)) + ".";
    } else if (const std::string setting = section + std::string(*line);
               !line->empty() && !line->starts_with('#') &&
               !setting.starts_with(kMetadataSetting)) {
      settings.push_back(setting);
    }
  }
  std::ranges::sort(settings);
  return settings;
}

std::vector<std::filesystem::path> recordings_of(const RunDescription& run) {
  std::vector<std::filesystem::path> all = {run.recording};
  all.insert(all.end(), run.further_recordings.begin(), run.further_recordings.end());
  return all;
}

/// What the recording is, without its name.
std::string kind_of(const RunDescription& run) {
  const std::string& text = run.recording_description;
  const std::string name = text_of(recordings_of(run)) + ": ";
  return text.starts_with(name) ? text.substr(name.size()) : text;
}

/// Folders of sweeps have no topic but their own name.
bool is_named_by_its_folder(const RunDescription& run) {
  const std::filesystem::path recording = std::filesystem::absolute(run.recording);
  return run.topic == recording.filename() || run.topic == recording.parent_path().filename();
}

}  // namespace

std::vector<std::pair<std::string, std::string>> provenance_of(const engine::DeviceInfo& device) {
  return {{"adit", std::string(version())},
          {std::string(kCommit), std::string(commit())},
          {"device", device.name},
          {"driver", device.driver},
          {"driver version", device.driver_version}};
}

MapSession session_of(const RunDescription& run) {
  const Fingerprint print = fingerprint(recordings_of(run));
  Config config = run.config;
  std::optional<std::string>& metadata = config.recording.metadata;
  if (metadata) {
    metadata = std::filesystem::absolute(*metadata).string();
  }
  MapSession session{.name = run.recording.filename().string(),
                     .configuration = to_toml(config),
                     .provenance = provenance_of(run.device)};
  session.provenance.insert(
      session.provenance.end(),
      {{std::string(kRecording), std::filesystem::absolute(run.recording).string()},
       {"recording kind", kind_of(run)},
       {"recording bytes", std::to_string(print.bytes)},
       {std::string(kFingerprint), print.hash},
       {"recording sweeps", std::to_string(run.recording_sweeps)},
       {"first sweep", std::to_string(run.range.first)},
       {"sweeps", std::to_string(run.range.count)}});
  for (std::size_t i = 0; i < run.further_recordings.size(); ++i) {
    session.provenance.emplace_back(std::string(kFurtherRecording) + std::to_string(i + 2),
                                    std::filesystem::absolute(run.further_recordings[i]).string());
  }
  if (!is_named_by_its_folder(run)) {
    session.provenance.emplace_back(kTopic, run.topic);
  }
  if (run.graph_bytes) {
    session.provenance.emplace_back(kGraphBytes, std::to_string(*run.graph_bytes));
  }
  if (metadata) {
    session.provenance.emplace_back("metadata fingerprint", fingerprint(*metadata).hash);
  }
  return session;
}

EarlierRun earlier_run(const std::filesystem::path& map) {
  const MapDatabase database(map, MapAccess::read);
  const std::vector<MapSession> sessions = database.sessions();
  if (sessions.empty()) {
    throw InputError(map, {}, "it holds nothing: its run was stopped before it had begun",
                     "Start the run again");
  }
  if (sessions.size() != 1) {
    throw InputError(map, {},
                     "it is made of " + std::to_string(sessions.size()) + " recordings, not of one",
                     "Name the recording, and map it anew");
  }
  const MapSession& session = sessions.front();
  if (const std::string* other = provenance_value(session, kLocalizedIn)) {
    throw InputError(map, {}, "its run was localised in another map, " + *other,
                     "Run the recording again with --map");
  }
  const std::string* topic = provenance_value(session, kTopic);
  const std::vector<std::filesystem::path> recordings = recordings_of(session);
  require(map, session, kRecording);
  return {
      .map = map,
      .session = session,
      .progress = database.progress(session.id),
      .recording = recordings.front(),
      .further_recordings = {recordings.begin() + 1, recordings.end()},
      .topic = topic == nullptr ? std::nullopt : std::optional(*topic),
      .first_sweep = require_number(map, session, "first sweep"),
      .sweeps = require_number(map, session, "sweeps"),
      .graph_bytes =
          provenance_value(session, kGraphBytes) == nullptr
              ? std::nullopt
              : std::optional(static_cast<uint64_t>(require_number(map, session, kGraphBytes)))};
}

bool is_recording_of(const MapSession& session,
                     const std::vector<std::filesystem::path>& recordings) {
  const std::string* before = provenance_value(session, kFingerprint);
  return before == nullptr || *before == fingerprint(recordings).hash;
}

bool has_same_recording(const MapSession& one, const MapSession& other) {
  const std::string* first = provenance_value(one, kFingerprint);
  const std::string* second = provenance_value(other, kFingerprint);
  return first != nullptr && second != nullptr && *first == *second;
}

std::vector<std::filesystem::path> recordings_of(const MapSession& session) {
  std::vector<std::filesystem::path> paths;
  for (const auto& [key, value] : session.provenance) {
    if (key == kRecording || key.starts_with(kFurtherRecording)) {
      paths.emplace_back(value);
    }
  }
  return paths;
}

void require_same(const EarlierRun& earlier, const MapSession& now) {
  std::vector<std::string> differences;
  for (const auto& [key, value] : now.provenance) {
    const std::string* before = provenance_value(earlier.session, key);
    if (key != kRecording && !key.starts_with(kFurtherRecording) && key != kCommit &&
        (before == nullptr || *before != value)) {
      differences.push_back(key + ": " + (before == nullptr ? "not known" : *before) + " then, " +
                            value + " now");
    }
  }
  std::vector<std::string> settings;
  std::ranges::set_symmetric_difference(settings_of(earlier.session.configuration),
                                        settings_of(now.configuration),
                                        std::back_inserter(settings));
  for (const std::string& setting : settings) {
    differences.push_back("the setting " + setting);
  }
  if (differences.empty()) {
    return;
  }
  std::string text;
  for (const std::string& difference : differences) {
    text += (text.empty() ? "" : "; ") + difference;
  }
  throw InputError(earlier.map, {}, "the run that made it was another one (" + text + ")",
                   "Use what it used, or map anew into another folder; adit run --from takes other "
                   "settings");
}

}  // namespace adit
