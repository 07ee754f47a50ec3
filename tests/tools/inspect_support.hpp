// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the tests of `adit inspect` share.
#pragma once

#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/moving_rig.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/commands/command_inspect.hpp"

namespace adit::test {

/// Six seconds without a fault.
inline std::vector<Recorded> clean_recording() {
  static const std::vector<Recorded> events = MovingRig{}.record();
  return events;
}

inline std::filesystem::path write(const TemporaryFolder& folder,
                                   const std::vector<Recorded>& events) {
  return write_mcap(folder / "drive.mcap", events);
}

/// "kind topic" of each finding.
inline std::vector<std::string> kinds(const std::filesystem::path& file,
                                      const ConfigSource& config = {}) {
  std::ostringstream out;
  std::ostringstream err;
  InspectCommandOptions options;
  options.recording = file;
  options.config = config;
  options.json = true;
  const int code = inspect_command(options, out, err);
  EXPECT_EQ(err.str(), "");
  std::vector<std::string> found;
  bool problem = false;
  const nlohmann::json report = nlohmann::json::parse(out.str());
  for (const auto& finding : report["findings"]) {
    const std::string topic = finding["topic"];
    found.push_back(finding["kind"].get<std::string>() + (topic.empty() ? "" : " " + topic));
    problem = problem || finding["severity"] == "problem";
  }
  EXPECT_EQ(code, problem ? 1 : 0);
  return found;
}

using Kinds = std::vector<std::string>;

/// What is found once `spoil` was let at every event.
inline Kinds kinds_after(const std::function<void(Recorded&)>& spoil) {
  const TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  for (Recorded& event : events) {
    spoil(event);
  }
  return kinds(write(folder, events));
}

}  // namespace adit::test
