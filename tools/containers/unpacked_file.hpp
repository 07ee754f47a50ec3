// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

namespace adit {

/// A temporary file, removed with the object.
class UnpackedFile {
 public:
  explicit UnpackedFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~UnpackedFile();
  UnpackedFile(const UnpackedFile&) = delete;
  UnpackedFile& operator=(const UnpackedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// An empty file of its own in the system's folder for such (TMPDIR). Throws OutputError where none
/// can be made.
std::unique_ptr<UnpackedFile> make_temporary_file();

/// Unpacks a Zstandard file piece by piece into a file in the system's folder for such (TMPDIR).
/// Throws InputError where it is damaged or cut off, OutputError where there is no room.
std::unique_ptr<UnpackedFile> unpack_file(const std::filesystem::path& packed);

}  // namespace adit
