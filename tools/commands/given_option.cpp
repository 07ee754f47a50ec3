// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/given_option.hpp"

#include <algorithm>
#include <filesystem>

#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

/// The files that a value may name: KEY=FILE, FILE@NUMBER.
std::vector<std::filesystem::path> files_named(const std::string& value) {
  std::vector<std::filesystem::path> files = {value};
  if (const std::size_t equals = value.find('='); equals != value.npos) {
    files.emplace_back(value.substr(equals + 1));
  }
  if (const std::size_t at = value.rfind('@'); at != value.npos) {
    files.emplace_back(value.substr(0, at));
  }
  return files;
}

void keep(const GivenOption& input, const GivenOption& output) {
  for (const std::string& value : input.values) {
    for (const std::filesystem::path& file : files_named(value)) {
      keep_input(output.name, output.values.back(), file);
    }
  }
}

/// Reports and products are made again as often as one likes. Recordings and maps are not.
void keep_recordings(const GivenOption& output) {
  if (output.written && !output.values.empty() && is_recording_or_map(output.values.back())) {
    throw UsageError(
        output.name + ": " + output.values.back() +
        " is a recording or a map, and is not replaced. Name another file, or remove it "
        "first.");
  }
}

}  // namespace

void keep_inputs(std::span<const GivenOption> options) {
  const bool asks = std::ranges::any_of(
      options, [](const GivenOption& option) { return option.name == "--overwrite"; });
  for (const GivenOption& output : options) {
    if (!asks) {  // others decide by themselves
      keep_recordings(output);
    }
  }
  for (const GivenOption& output : options) {
    for (const GivenOption& input : options) {
      if (output.written && !output.values.empty() && !input.written) {
        keep(input, output);
      }
    }
  }
}

}  // namespace adit
