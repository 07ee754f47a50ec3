// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/run_end.hpp"

#include "adit/tools/support/input_error.hpp"

namespace adit {

RunEnd end_of(const std::exception& error) {
  return dynamic_cast<const InputError*>(&error) != nullptr  ? RunEnd::input_error
         : dynamic_cast<const FileError*>(&error) != nullptr ? RunEnd::output_error
                                                             : RunEnd::failed;
}

std::string_view to_string(RunEnd end) {
  switch (end) {
    case RunEnd::completed:
      return "completed";
    case RunEnd::interrupted:
      return "interrupted";
    case RunEnd::input_error:
      return "input_error";
    case RunEnd::output_error:
      return "output_error";
    case RunEnd::device_error:
      return "device_error";
    case RunEnd::memory_limit:
      return "memory_limit";
    case RunEnd::failed:
      return "failed";
  }
  return "unknown";
}

}  // namespace adit
