// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a command line takes, as plain values: manual pages and completions are made of them.
#pragma once

#include <string>
#include <vector>

namespace adit {

struct OptionDescription {
  std::vector<std::string> names{};  ///< "-o", "--output"; of an argument none
  std::string value{};               ///< what the help calls its value; of a flag empty
  std::string text{};
  std::string default_value{};       ///< as the help names it, or empty
  std::vector<std::string> words{};  ///< what its value may be, for shells to offer
  bool file = false;                 ///< its value may name a file or folder
  bool required = false;
  bool repeats = false;  ///< may be given again, or takes any number of values
};

struct CommandDescription {
  std::string name{};  ///< with those above it: "adit bench slam"
  std::string text{};  ///< one line
  std::string footer{};
  std::vector<OptionDescription> options{};
  std::vector<OptionDescription> arguments{};
  std::vector<CommandDescription> commands{};

  /// Its own name, without those above it.
  std::string own_name() const { return name.substr(name.rfind(' ') + 1); }
};

}  // namespace adit
