// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/kept_inputs.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <system_error>

#include "adit/tools/results/output_folder.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// What SQLite keeps beside a database while it is written to, or after a writer was killed.
constexpr std::array kBesideDatabases = {"-wal", "-shm", "-journal"};

fs::path resolved(const fs::path& path) {
  std::error_code unknown;
  return fs::weakly_canonical(fs::absolute(path, unknown), unknown);
}

bool is_file(const fs::path& path) {
  std::error_code unknown;
  return fs::is_regular_file(path, unknown);
}

bool belongs_to_folder(const fs::path& output, const fs::path& folder) {
  if (!is_file(output) || drawn_by_us(output)) {
    return false;
  }
  if (!is_run(folder)) {
    return is_within(output, folder);
  }
  return std::ranges::any_of(result_files(folder),
                             [&](const fs::path& file) { return same_file(file, output); });
}

}  // namespace

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code unknown;
  return fs::equivalent(a, b, unknown) && !unknown;
}

bool is_within(const fs::path& path, const fs::path& other) {
  fs::path at = resolved(path);
  for (; at.has_relative_path(); at = at.parent_path()) {
    if (same_file(at, other)) {
      return true;
    }
  }
  return same_file(at, other);
}

bool would_change(const fs::path& output, const fs::path& input) {
  std::error_code unknown;
  if (fs::is_directory(input, unknown)) {
    return same_file(output, input) || belongs_to_folder(output, input);
  }
  if (!is_file(input)) {
    return false;  // devices and pipes hold nothing that could be lost
  }
  const fs::path file = resolved(output);
  return same_file(output, input) || same_file(Draft::path_of(output), input) ||
         std::ranges::any_of(kBesideDatabases, [&](const char* end) {
           return file == resolved(input).string() + end;
         });
}

bool is_recording_or_map(const fs::path& file) {
  constexpr std::array<std::string_view, 3> kBegins = {"\x89MCAP", "#ROSBAG V", "SQLite format 3"};
  if (!is_file(file)) {
    return false;
  }
  constexpr std::size_t kApplication = 68;  // where SQLite names the program that a file is of
  std::array<char, kApplication + 4> bytes{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), bytes.size());
  const std::string_view begin(bytes.data(), static_cast<std::size_t>(stream.gcount()));
  const bool is_geopackage = begin.size() == bytes.size() && begin.substr(kApplication) == "GPKG";
  return !is_geopackage &&
         std::ranges::any_of(kBegins, [&](std::string_view one) { return begin.starts_with(one); });
}

void keep_input(const std::string& option, const fs::path& output, const fs::path& input) {
  if (would_change(output, input)) {
    const std::string what = same_file(output, input)
                                 ? "is what is read"
                                 : "belongs to " + input.string() + ", which is read";
    throw UsageError(option + ": " + output.string() + " " + what +
                     ", and cannot be written over. Name another file.");
  }
}

}  // namespace adit
