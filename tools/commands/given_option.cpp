// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/given_option.hpp"

#include <filesystem>

#include "adit/tools/results/kept_inputs.hpp"

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

}  // namespace

void keep_inputs(std::span<const GivenOption> options) {
  for (const GivenOption& output : options) {
    for (const GivenOption& input : options) {
      if (output.written && !output.values.empty() && !input.written) {
        keep(input, output);
      }
    }
  }
}

}  // namespace adit
