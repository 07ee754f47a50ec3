// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Words for complaints about a command line.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "adit/tools/cli/command_description.hpp"

namespace adit {

/// "a, b or c".
std::string listed_words(const std::vector<std::string>& words);

/// Why a word is no number that `fits`, which is one `wanted` ("of 0 or more"); empty where it is.
std::string number_complaint(const std::string& word, const std::string& wanted,
                             const std::function<bool(double)>& fits);

/// Behind a complaint about an option that takes several values: how many, and where others go.
/// `names` are what the help calls them. Empty for options that take one.
std::string wanted_values(int least, int most, const std::string& names);

/// What CLI11 says of a command line, in plain words.
std::string readable_error(const std::string& text);

/// Of an option that is written before the command that it is meant for.
std::string place_of_option(const std::string& command);

/// The complaint about the first word that the parser would take for something else than what was
/// meant: "-out" for -o with the value "ut", "--json=out.json" for a flag's number. Empty where
/// there is none.
std::string mistaken_words(const CommandDescription& program, std::span<const char* const> words);

}  // namespace adit
