// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cli/given_option.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "adit/tools/cli/readable_error.hpp"
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

/// ".html" of "page.HTML".
std::string ending_of(const std::string& name) {
  std::string ending = std::filesystem::path(name).extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

void require_endings(std::span<const GivenOption> options) {
  for (const GivenOption& option : options) {
    for (const std::string& name : option.values) {
      const std::string ending = ending_of(name);
      if (!option.endings.empty() && !ending.empty() &&
          std::ranges::count(option.endings, ending) == 0) {
        throw UsageError(option.name + ": '" + name + "' does not end in " +
                         listed_words(option.endings) + ", which is what is written there.");
      }
    }
  }
}

void keep_inputs(std::span<const GivenOption> options) {
  for (const GivenOption& output : options) {
    for (const GivenOption& input : options) {
      if (output.written && !output.values.empty() && !input.written) {
        keep(input, output);
      }
    }
  }
  const bool asks = std::ranges::any_of(
      options, [](const GivenOption& option) { return option.name == "--overwrite"; });
  for (const GivenOption& output : options) {
    if (!asks) {  // others decide by themselves
      keep_recordings(output);
    }
  }
}

}  // namespace adit
