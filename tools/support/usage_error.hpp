// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace adit {

/// The command line asks for something that cannot be: exit code 2. what() says what and what would
/// do.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace adit
