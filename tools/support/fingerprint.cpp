// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/fingerprint.hpp"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <memory>
#include <string_view>
#include <system_error>
#include <vector>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <fmt/core.h>

#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kPlaces = 16;
constexpr uint64_t kPiece = uint64_t{1} << 20U;

struct FreeState {
  void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};

class Hash {
 public:
  Hash() : state_(XXH3_createState()) {
    if (!state_ || XXH3_128bits_reset(state_.get()) == XXH_ERROR) {
      throw std::bad_alloc();
    }
  }

  void add(const void* data, std::size_t bytes) {
    static_cast<void>(XXH3_128bits_update(state_.get(), data, bytes));
  }
  // With its length, so that no two lists of texts are the same bytes.
  void add(std::string_view text) {
    const uint64_t size = text.size();
    add(&size, sizeof size);
    add(text.data(), text.size());
  }

  std::string text() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  }

 private:
  std::unique_ptr<XXH3_state_t, FreeState> state_;
};

[[noreturn]] void fail(const fs::path& file) {
  throw InputError(file, {}, "it cannot be read", "Check that it exists and may be read");
}

/// A file that shrinks while it is read has another hash.
void add_content(Hash& hash, const fs::path& file, uint64_t size) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    fail(file);
  }
  std::vector<char> piece(kPiece);
  const bool whole = size <= kPlaces * kPiece;
  const uint64_t pieces = whole ? (size + kPiece - 1) / kPiece : kPlaces;
  for (uint64_t i = 0; i < pieces; ++i) {
    const uint64_t offset = whole ? i * kPiece : (size - kPiece) / (kPlaces - 1) * i;
    stream.seekg(static_cast<std::streamoff>(offset));
    stream.read(piece.data(), static_cast<std::streamsize>(kPiece));
    if (stream.bad()) {
      fail(file);
    }
    hash.add(std::string_view(piece.data(), static_cast<std::size_t>(stream.gcount())));
    stream.clear();
  }
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  fs::recursive_directory_iterator at(folder, error);
  for (; !error && at != fs::recursive_directory_iterator(); at.increment(error)) {
    std::error_code unknown;
    if (at->is_regular_file(unknown)) {
      files.push_back(at->path());
    }
  }
  if (error) {
    fail(folder);
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

Fingerprint fingerprint(const fs::path& path) {
  std::error_code unknown;
  const bool folder = fs::is_directory(path, unknown);
  Hash hash;
  Fingerprint result;
  for (const fs::path& file : folder ? files_below(path) : std::vector{path}) {
    std::error_code error;
    const uint64_t size = fs::file_size(file, error);
    if (error) {
      fail(file);
    }
    hash.add(folder ? file.lexically_relative(path).generic_string() : std::string());
    hash.add(&size, sizeof size);
    add_content(hash, file, size);
    result.bytes += size;
  }
  result.hash = hash.text();
  return result;
}

}  // namespace adit
