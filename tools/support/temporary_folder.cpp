// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/temporary_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include "adit/tools/support/input_error.hpp"

namespace adit {

TemporaryFolder::TemporaryFolder(std::string_view prefix) {
  std::error_code none;
  const std::filesystem::path where = std::filesystem::temp_directory_path(none);
  std::string name = (where / (std::string(prefix) + "-XXXXXX")).string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw OutputError(where, where.string() + ": no temporary folder can be made: " +
                                 std::generic_category().message(errno) +
                                 ". TMPDIR names another folder.");
  }
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace adit
