// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/shared_files.hpp"

#include <array>
#include <chrono>
#include <random>
#include <string>
#include <system_error>

#include <unistd.h>

#include <fmt/core.h>

#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::hours kOld{24};

/// A name beside the file that no other process uses, on whatever machine.
fs::path draft_of(const fs::path& file) {
  std::random_device random;
  return file.parent_path() /
         fmt::format(".{}.{:08x}{:08x}.draft", file.filename().string(), random(), random());
}

void require(const std::error_code& error, const fs::path& file) {
  if (error) {
    throw OutputError(file, file.string() + ": cannot be written: " + error.message());
  }
}

void make_folder_of(const fs::path& file) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  require(error, file);
}

/// Drafts of the same file that killed processes have left: no copy takes a day.
void remove_orphans(const fs::path& file) {
  const std::string begin = "." + file.filename().string() + ".";
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(file.parent_path(), error)) {
    const std::string name = entry.path().filename().string();
    std::error_code ignored;
    if (name.starts_with(begin) && name.ends_with(".draft") &&
        fs::file_time_type::clock::now() - entry.last_write_time(ignored) > kOld) {
      fs::remove_all(entry.path(), ignored);
    }
  }
}

/// A draft that goes away unless it took its place.
class SharedDraft {
 public:
  explicit SharedDraft(const fs::path& file) : file_(file), path_(draft_of(file)) {
    make_folder_of(file);
    remove_orphans(file);
  }
  ~SharedDraft() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  SharedDraft(const SharedDraft&) = delete;
  SharedDraft& operator=(const SharedDraft&) = delete;

  const fs::path& path() const { return path_; }

  void take_its_place() const {
    std::error_code error;
    fs::rename(path_, file_, error);
    if (error && fs::is_directory(path_)) {
      // A folder does not replace one that holds something.
      const fs::path old = path_.string() + ".old";
      fs::rename(file_, old, error);
      fs::rename(path_, file_, error);
      std::error_code ignored;
      fs::remove_all(old, ignored);
    }
    require(error, file_);
  }

 private:
  fs::path file_;
  fs::path path_;
};

}  // namespace

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

void put_text(const fs::path& file, std::string_view text) {
  const SharedDraft draft(file);
  write_text_file(draft.path(), text);
  draft.take_its_place();
}

void put_copy(const fs::path& from, const fs::path& to) {
  const SharedDraft draft(to);
  std::error_code error;
  fs::copy(from, draft.path(), fs::copy_options::recursive, error);
  require(error, to);
  draft.take_its_place();
}

}  // namespace adit
