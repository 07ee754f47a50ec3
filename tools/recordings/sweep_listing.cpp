// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/sweep_listing.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>
#include <utility>

#include "adit/tools/clouds/bin_reader.hpp"
#include "adit/tools/clouds/las_reader.hpp"
#include "adit/tools/clouds/pcd_reader.hpp"
#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/clouds/sweep_times.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr Nanoseconds kAssumedPeriod = std::chrono::milliseconds(100);

constexpr std::array<SweepFileKind, 5> kKinds = {{
    {".bin", "KITTI .bin", read_bin, describe_bin},
    {".pcd", "PCD", read_pcd, nullptr},
    {".ply", "PLY", read_ply, nullptr},
    {".las", "LAS", read_las, nullptr},
    {".laz", "LAZ", read_las, nullptr},
}};

/// For a message: the first number that is missing in names that are numbers ("000177"), or
/// nothing.
std::string first_gap(const std::vector<fs::path>& files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string stem = files[i].stem().string();
    const bool digits =
        !stem.empty() && stem.size() < 19 &&
        std::all_of(stem.begin(), stem.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
    if (!digits) {
      return {};
    }
    if (std::stoull(stem) != i) {
      return " (the first number missing in their names is " + std::to_string(i) + ")";
    }
  }
  return {};
}

}  // namespace

const SweepFileKind* sweep_file_kind(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const SweepFileKind& kind : kKinds) {
    if (kind.extension == extension) {
      return &kind;
    }
  }
  return nullptr;
}

SweepFiles list_sweeps(const fs::path& folder) {
  SweepFiles sweeps;
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error) {
    throw InputError(folder, {}, "the folder cannot be read: " + error.message(),
                     "Check the permissions");
  }
  for (const fs::directory_iterator end; entries != end; entries.increment(error)) {
    if (error) {
      throw InputError(folder, {}, "the folder cannot be read: " + error.message(),
                       "Check the disk");
    }
    const fs::path& file = entries->path();
    const SweepFileKind* kind = sweep_file_kind(file);
    std::error_code ignored;
    if (kind == nullptr || !entries->is_regular_file(ignored) ||
        file.filename().string().front() == '.') {
      continue;
    }
    if (sweeps.kind != nullptr && sweeps.kind != kind) {
      throw InputError(folder, {},
                       "it holds " + std::string(sweeps.kind->extension) + " and " +
                           std::string(kind->extension) + " files (" +
                           sweeps.files.front().filename().string() + ", " +
                           file.filename().string() + ")",
                       "Keep the sweeps of a recording in a folder of their own");
    }
    sweeps.kind = kind;
    sweeps.files.push_back(file);
  }
  std::sort(sweeps.files.begin(), sweeps.files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return sweeps;
}

SweepFiles stamped_by(const fs::path& times, SweepFiles sweeps) {
  sweeps.stamps = read_times(times);
  require_matching_times(
      times, sweeps.stamps.size(), sweeps.files.size(),
      "sweeps in " + sweeps.files.front().parent_path().string() + first_gap(sweeps.files));
  sweeps.times_from = "times from " + times.filename().string();
  return sweeps;
}

SweepFiles stamped_by_assumption(const std::string& reason, SweepFiles sweeps) {
  sweeps.stamps.clear();
  sweeps.stamps.reserve(sweeps.files.size());
  for (std::size_t i = 0; i < sweeps.files.size(); ++i) {
    sweeps.stamps.push_back(kAssumedPeriod * static_cast<int64_t>(i));
  }
  sweeps.times_from = reason + ": 10 Hz assumed";
  sweeps.times_assumed = true;
  return sweeps;
}

std::optional<SweepFiles> stamped_by_names(const SweepFiles& sweeps) {
  std::vector<std::pair<Nanoseconds, fs::path>> stamped;
  for (const fs::path& file : sweeps.files) {
    const std::optional<Nanoseconds> stamp = time_from_name(file.stem().string());
    if (!stamp) {
      return std::nullopt;
    }
    stamped.emplace_back(*stamp, file);
  }
  std::sort(stamped.begin(), stamped.end());
  SweepFiles result = sweeps;
  for (std::size_t i = 0; i < stamped.size(); ++i) {
    if (i > 0 && stamped[i].first == stamped[i - 1].first) {
      throw InputError(
          stamped[i].second, {},
          "its name tells the same time as " + stamped[i - 1].second.filename().string(),
          "Give the sweeps a times.txt, or distinct times");
    }
    result.files[i] = stamped[i].second;
    result.stamps.push_back(stamped[i].first);
  }
  result.times_from = "times from the file names";
  return result;
}

}  // namespace adit
