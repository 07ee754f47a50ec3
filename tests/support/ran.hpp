// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <sstream>
#include <string>
#include <type_traits>

namespace adit::test {

/// What a command has done: its exit code, and what it has printed.
struct Ran {
  int code = 0;
  std::string out;
  std::string err;
};

/// Runs a command on its options.
template <class Options>
Ran ran(int (*command)(const Options&, std::ostream&, std::ostream&),
        const std::type_identity_t<Options>& options) {
  std::ostringstream out;
  std::ostringstream err;
  const int code = command(options, out, err);
  return {code, out.str(), err.str()};
}

}  // namespace adit::test
