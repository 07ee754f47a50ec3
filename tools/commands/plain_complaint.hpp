// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Words for complaints about a command line.
#pragma once

#include <string>
#include <vector>

namespace adit {

/// "a, b or c".
std::string listed_words(const std::vector<std::string>& words);

/// What CLI11 says of a command line, in plain words.
std::string plain_complaint(const std::string& text);

/// Of an option that is written before the command that it is meant for.
std::string place_of_option(const std::string& command);

}  // namespace adit
