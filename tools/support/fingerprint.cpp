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

constexpr int kDeepest = 8;  // folders in folders: links may lead round

struct Part {
  fs::path path;
  std::string name;  ///< in the folder
  uint64_t size = 0;
};

/// What can be read of a piece of the parts one after the other.
void add_piece(Hash& hash, const std::vector<Part>& parts, uint64_t offset, uint64_t size) {
  std::vector<char> bytes;
  for (const Part& part : parts) {
    if (offset < part.size && size > 0) {
      bytes.resize(std::min(size, part.size - offset));
      std::ifstream stream(part.path, std::ios::binary);
      stream.seekg(static_cast<std::streamoff>(offset));
      stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
      hash.add(std::string_view(
          bytes.data(), static_cast<std::size_t>(std::max<std::streamsize>(0, stream.gcount()))));
      size -= bytes.size();
      offset = part.size;
    }
    offset -= std::min(offset, part.size);
  }
}

std::vector<Part> parts_of(const fs::path& path) {
  std::vector<Part> parts;
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    parts.push_back({.path = path, .name = {}, .size = fs::file_size(path, error)});
    if (error) {
      throw InputError(path, {}, "it cannot be read: " + error.message(),
                       "Check that it exists and may be read");
    }
    return parts;
  }
  constexpr auto kOptions = fs::directory_options::follow_directory_symlink |
                            fs::directory_options::skip_permission_denied;
  fs::recursive_directory_iterator at(path, kOptions, error);
  for (; !error && at != fs::recursive_directory_iterator(); at.increment(error)) {
    std::error_code unknown;
    if (at.depth() >= kDeepest) {
      at.disable_recursion_pending();
    }
    if (at->is_regular_file(unknown)) {
      parts.push_back({.path = at->path(),
                       .name = at->path().lexically_relative(path).generic_string(),
                       .size = at->file_size(unknown)});
    }
  }
  std::ranges::sort(parts, {}, &Part::name);
  return parts;
}

}  // namespace

Fingerprint fingerprint(const fs::path& path) {
  const std::vector<Part> parts = parts_of(path);
  Hash hash;
  Fingerprint result;
  for (const Part& part : parts) {
    hash.add(part.name);
    hash.add(&part.size, sizeof part.size);
    result.bytes += part.size;
  }
  if (result.bytes <= kPlaces * kPiece) {
    add_piece(hash, parts, 0, result.bytes);
  } else {
    for (uint64_t i = 0; i < kPlaces; ++i) {
      add_piece(hash, parts, (result.bytes - kPiece) * i / (kPlaces - 1), kPiece);
    }
  }
  result.hash = hash.text();
  return result;
}

Fingerprint fingerprint(const std::vector<fs::path>& paths) {
  if (paths.size() == 1) {
    return fingerprint(paths.front());
  }
  std::vector<std::string> hashes;
  Fingerprint result;
  for (const fs::path& path : paths) {
    const Fingerprint one = fingerprint(path);
    hashes.push_back(one.hash);
    result.bytes += one.bytes;
  }
  std::ranges::sort(hashes);
  Hash hash;
  for (const std::string& one : hashes) {
    hash.add(one);
  }
  result.hash = hash.text();
  return result;
}

std::string whole_hash(const fs::path& file) {
  std::ifstream input(file, std::ios::binary);
  Hash hash;
  std::vector<char> piece(kPiece);
  while (input.read(piece.data(), static_cast<std::streamsize>(piece.size())) ||
         input.gcount() > 0) {
    hash.add(piece.data(), static_cast<std::size_t>(input.gcount()));
  }
  if (!input.eof()) {
    throw InputError(file, {}, "it cannot be read", "Check that it is there and readable");
  }
  return hash.text();
}

std::string text_hash(std::string_view text) {
  Hash hash;
  hash.add(text.data(), text.size());
  return hash.text();
}

}  // namespace adit
