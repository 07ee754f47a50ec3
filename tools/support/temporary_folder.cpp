// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/temporary_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include "adit/tools/support/input_error.hpp"

namespace adit {

std::filesystem::path temporary_place() {
  std::error_code error;
  std::filesystem::path where = std::filesystem::temp_directory_path(error);
  if (error) {
    const char* const named = std::getenv("TMPDIR");
    where = named != nullptr ? named : "/tmp";
    throw OutputError(where, where.string() + ": nothing temporary can be kept there: " +
                                 error.message() + ". TMPDIR names another folder.");
  }
  return where;
}

TemporaryFolder::TemporaryFolder(std::string_view prefix) {
  const std::filesystem::path where = temporary_place();
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
