// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_guard.hpp"

#include <exception>
#include <new>
#include <ostream>

#include "adit/tools/support/usage_error.hpp"

namespace adit {

int guarded(const std::string& command, std::ostream& err, const std::function<int()>& body) {
  try {
    return body();
  } catch (const UsageError& error) {
    err << command << ": " << error.what() << std::endl;
    return 2;
  } catch (const std::bad_alloc&) {
    err << command << ": the machine's memory is exhausted." << std::endl;
  } catch (const std::exception& error) {
    err << command << ": " << error.what() << std::endl;
  }
  return 1;
}

}  // namespace adit
