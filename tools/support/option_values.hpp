// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Values of options on the command line, with help and complaints in plain words: CLI11's own speak
// of its internals.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace adit {

/// "a, b or c".
std::string listed_words(const std::vector<std::string>& words);

/// Numbers from `low` to `high`; without `high` no bound above.
CLI::Validator number_from(double low);
CLI::Validator number_from(double low, double high);
CLI::Validator number_above(double low);

/// An option whose value is one of a few words. `target` keeps what it is where the option is not
/// given; the help names the words.
template <class Target, class T>
CLI::Option* add_choice(CLI::App& command, const std::string& name, const std::string& description,
                        Target& target, const std::vector<std::pair<std::string, T>>& choices) {
  std::vector<std::string> words;
  std::string type;
  for (const auto& [word, value] : choices) {
    words.push_back(word);
    type += (type.empty() ? "" : "|") + word;
  }
  const auto set = [&target, name, choices, words](const std::string& word) {
    for (const auto& [candidate, value] : choices) {
      if (candidate == word) {
        target = value;
        return;
      }
    }
    throw CLI::ValidationError(name, "'" + word + "' is none of " + listed_words(words));
  };
  return command.add_option_function<std::string>(name, set, description)->type_name(type);
}

/// What CLI11 says of a command line, in plain words.
std::string plain_complaint(const CLI::ParseError& error);

}  // namespace adit
