// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/earlier_run.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "adit/tools/run/config_file.hpp"
#include "adit/tools/support/fingerprint.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

// Where the recording lies is no part of what it is.
constexpr std::string_view kRecording = "recording";

const std::string* told(const MapSession& session, std::string_view key) {
  const auto found =
      std::ranges::find(session.provenance, key, &std::pair<std::string, std::string>::first);
  return found == session.provenance.end() ? nullptr : &found->second;
}

const std::string& require(const std::filesystem::path& map, const MapSession& session,
                           std::string_view key) {
  const std::string* value = told(session, key);
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
    } else if (!line->empty() && !line->starts_with('#')) {
      settings.push_back(section + std::string(*line));
    }
  }
  std::ranges::sort(settings);
  return settings;
}

}  // namespace

MapSession session_of(const RunDescription& run) {
  const Fingerprint print = fingerprint(run.recording);
  return {
      .name = run.recording.filename().string(),
      .configuration = to_toml(run.config),
      .provenance = {{"adit", std::string(version())},
                     {"device", run.device.name},
                     {"driver", run.device.driver},
                     {"driver version", run.device.driver_version},
                     {std::string(kRecording), std::filesystem::absolute(run.recording).string()},
                     {"recording kind", run.recording_description},
                     {"recording bytes", std::to_string(print.bytes)},
                     {"recording fingerprint", print.hash},
                     {"recording sweeps", std::to_string(run.recording_sweeps)},
                     {"topic", run.topic},
                     {"first sweep", std::to_string(run.range.first)},
                     {"sweeps", std::to_string(run.range.count)}}};
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
  return {.map = map,
          .session = session,
          .progress = database.progress(session.id),
          .recording = require(map, session, kRecording),
          .topic = require(map, session, "topic"),
          .first_sweep = require_number(map, session, "first sweep"),
          .sweeps = require_number(map, session, "sweeps")};
}

void require_same(const EarlierRun& earlier, const MapSession& now) {
  std::vector<std::string> differences;
  for (const auto& [key, value] : now.provenance) {
    const std::string* before = told(earlier.session, key);
    if (key != kRecording && (before == nullptr || *before != value)) {
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
