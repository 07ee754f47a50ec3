// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace adit {

/// The system's place for what is temporary (TMPDIR). Throws OutputError where it is no folder.
std::filesystem::path temporary_place();

/// A folder of its own in the system's place for what is temporary (TMPDIR), which goes away with
/// all that it holds.
class TemporaryFolder {
 public:
  /// `prefix`: how its name begins. Throws OutputError where none can be made.
  explicit TemporaryFolder(std::string_view prefix);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace adit
