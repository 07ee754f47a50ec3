// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/declaration_error.hpp"

namespace adit {

DeclarationError wrong_count(const std::filesystem::path& file, const std::string& what,
                             const std::string& topic, uint64_t declared, uint64_t found) {
  const bool fewer = found < declared;
  return {
      file,
      what +
          (declared == 1 ? " declares 1 message on "
                         : " declares " + std::to_string(declared) + " messages on ") +
          topic + ", but " + std::to_string(found) + " can be read",
      fewer ? "The others are lost: copy the recording again from its source"
            : "All are read; the declaration is out of date, or files of two recordings are mixed",
      topic, fewer ? declared - found : uint64_t{0}};
}

}  // namespace adit
