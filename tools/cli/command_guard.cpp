// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cli/command_guard.hpp"

#include <exception>
#include <new>
#include <ostream>

#include "adit/tools/setup/device_session.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {

int reported(const std::string& command, std::ostream& out, std::ostream& err, int code) {
  if (out.flush()) {
    return code;
  }
  err << command
      << ": the report could not be written to the standard output. Free some space, or send it "
         "elsewhere."
      << std::endl;
  return code == 0 ? 1 : code;
}

int guarded(const std::string& command, std::ostream& out, std::ostream& err,
            const std::function<int()>& body) {
  try {
    return reported(command, out, err, body());
  } catch (const UsageError& error) {
    err << command << ": " << error.what() << std::endl;
    return 2;
  } catch (const engine::OutOfMemory& error) {
    err << command << ": " << describe(error) << "." << std::endl;
  } catch (const std::bad_alloc&) {
    err << command << ": the machine's memory is exhausted." << std::endl;
  } catch (const std::exception& error) {
    err << command << ": " << error.what() << std::endl;
  }
  return 1;
}

}  // namespace adit
