// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/recordings/sweep_files.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "tools/recordings/kitti_bin.hpp"
#include "tools/recordings/kitti_raw.hpp"
#include "tools/recordings/las_reader.hpp"
#include "tools/recordings/pcd_reader.hpp"
#include "tools/recordings/ply_reader.hpp"
#include "tools/recordings/point_time_vote.hpp"
#include "tools/recordings/sweep_times.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr Nanoseconds kAssumedPeriod = std::chrono::milliseconds(100);

constexpr const char* kWhatIsRead =
    "A recording is an MCAP file, a ROS bag, a rosbag2 folder, a folder with velodyne/*.bin "
    "(KITTI), with "
    "velodyne_points/data/*.bin (KITTI raw), with .bin, .pcd, .ply or .las files, or one such file";

CloudFile read_bin_cloud(const fs::path& file, double) {
  return {read_kitti_bin(file), false};
}

struct FileKind {
  std::string_view extension;
  std::string_view name;
  CloudFile (*read)(const fs::path&, double time_unit);
};
constexpr std::array<FileKind, 4> kKinds = {{
    {".bin", "KITTI .bin", read_bin_cloud},
    {".pcd", "PCD", read_pcd},
    {".ply", "PLY", read_ply},
    {".las", "LAS", read_las},
}};

const FileKind* kind_of(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const FileKind& kind : kKinds) {
    if (kind.extension == extension) {
      return &kind;
    }
  }
  return nullptr;
}

/// The sweeps of a recording and when they were taken.
struct SweepFiles {
  const FileKind* kind = nullptr;
  std::vector<fs::path> files;
  std::vector<Nanoseconds> stamps;  // one a file
  std::string layout;               // for people
  std::string times_from;           // for people
  bool times_assumed = false;
};

/// What the first sweeps tell of the unit of their points' times (s); 0 for nothing. Damaged ones
/// do not count.
double told_time_unit(const SweepFiles& sweeps) {
  PointTimeVote vote;
  const std::size_t count = std::min(sweeps.files.size(), PointTimeVote::kSweeps);
  for (std::size_t i = 0; i < count; ++i) {
    try {
      const CloudFile cloud = sweeps.kind->read(sweeps.files[i], 0.0);
      if (!cloud.times) {
        break;  // none of them has any, as a rule
      }
      vote.add(cloud.sweep, *cloud.times);
    } catch (const InputError&) {
      // reported where the events are read
    }
  }
  return vote.unit();
}

class SweepFileStream final : public EventStream {
 public:
  SweepFileStream(const SweepFiles& sweeps, const EventSelection& selection)
      : sweeps_(&sweeps), end_(selection.end) {
    if (selection.point_time_unit > 0.0) {
      time_unit_ = selection.point_time_unit;
    }
    const auto& stamps = sweeps.stamps;
    const auto first = std::lower_bound(stamps.begin(), stamps.end(), selection.begin);
    const auto rest = static_cast<uint64_t>(stamps.end() - first);
    index_ = stamps.size() - rest + std::min(rest, selection.skip);
  }

  std::optional<Event> next() override {
    if (index_ == sweeps_->files.size() || sweeps_->stamps[index_] > end_) {
      return std::nullopt;
    }
    const fs::path& file = sweeps_->files[index_];
    CloudFile cloud = read(index_++);
    const Nanoseconds stamp = cloud.sweep.stamp;
    std::error_code ignored;
    return Event{.topic = 0,
                 .received = stamp,
                 .value = std::move(cloud.sweep),
                 .bytes = fs::file_size(file, ignored),
                 .frame = {},
                 .point_times = std::move(cloud.times)};
  }

 private:
  CloudFile read(std::size_t index) {
    const fs::path& file = sweeps_->files[index];
    if (!time_unit_) {
      time_unit_ = told_time_unit(*sweeps_);
    }
    CloudFile cloud = sweeps_->kind->read(file, *time_unit_);
    if (!cloud.absolute_stamp) {
      cloud.sweep.stamp += sweeps_->stamps[index];
    }
    require_later(index, cloud.sweep.stamp);
    return cloud;
  }

  /// Times inside the sweeps can contradict the order of the files.
  void require_later(std::size_t index, Nanoseconds stamp) {
    if (last_ && stamp <= last_->second) {
      throw InputError(
          sweeps_->files[index], {},
          "its sweep starts " +
              std::to_string(std::chrono::duration<double>(last_->second - stamp).count()) +
              " s before that of " + sweeps_->files[last_->first].filename().string() +
              " (or at the same time)",
          "Sweeps must follow each other in time; correct the point times or the order of the "
          "names");
    }
    last_ = {index, stamp};
  }

  const SweepFiles* sweeps_;
  Nanoseconds end_;
  std::optional<double> time_unit_;  // s, of the times of points; 0 where it is not known
  std::size_t index_ = 0;
  std::optional<std::pair<std::size_t, Nanoseconds>>
      last_;  // sweep that was read last, and its stamp
};

class FileRecording final : public Recording {
 public:
  FileRecording(fs::path path, SweepFiles sweeps)
      : path_(std::move(path)),
        sweeps_(std::move(sweeps)),
        topics_({{.name = sweeps_.files.front().parent_path().filename().string(),
                  .type = std::string(sweeps_.kind->name),
                  .kind = TopicKind::sweeps,
                  .messages = sweeps_.files.size()}}) {}

  const std::vector<Topic>& topics() const override { return topics_; }
  bool times_are_assumed() const override { return sweeps_.times_assumed; }

  std::unique_ptr<EventStream> events(const EventSelection& selection) const override {
    return std::make_unique<SweepFileStream>(sweeps_, selection);
  }

  std::string description() const override {
    const std::size_t n = sweeps_.files.size();
    std::string text = path_.string() + ": " + sweeps_.layout + ", " + std::to_string(n) +
                       (n == 1 ? " sweep" : " sweeps");
    if (n > 1) {
      const std::chrono::duration<double> duration = sweeps_.stamps.back() - sweeps_.stamps.front();
      const std::string seconds = std::to_string(duration.count());
      text += " over " + seconds.substr(0, seconds.find('.') + 2) + " s";
    }
    return text + "; " + sweeps_.times_from;
  }

 private:
  fs::path path_;
  SweepFiles sweeps_;
  std::vector<Topic> topics_;
};

/// The sweeps in a folder by natural order, all of one kind; none where there are none.
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
    const FileKind* kind = kind_of(file);
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

void stamp_from_file(SweepFiles& sweeps, const fs::path& times) {
  sweeps.stamps = read_times(times);
  require_matching_times(
      times, sweeps.stamps.size(), sweeps.files.size(),
      "sweeps in " + sweeps.files.front().parent_path().string() + first_gap(sweeps.files));
  sweeps.times_from = "times from " + times.filename().string();
}

void assume_times(SweepFiles& sweeps, const std::string& reason) {
  sweeps.stamps.clear();
  sweeps.stamps.reserve(sweeps.files.size());
  for (std::size_t i = 0; i < sweeps.files.size(); ++i) {
    sweeps.stamps.push_back(kAssumedPeriod * static_cast<int64_t>(i));
  }
  sweeps.times_from = reason + ": 10 Hz assumed";
  sweeps.times_assumed = true;
}

/// Times from names, where every name tells one.
bool stamp_from_names(SweepFiles& sweeps) {
  std::vector<std::pair<Nanoseconds, fs::path>> stamped;
  for (const fs::path& file : sweeps.files) {
    const std::optional<Nanoseconds> stamp = time_from_name(file.stem().string());
    if (!stamp) {
      return false;
    }
    stamped.emplace_back(*stamp, file);
  }
  std::sort(stamped.begin(), stamped.end());
  for (std::size_t i = 0; i < stamped.size(); ++i) {
    if (i > 0 && stamped[i].first == stamped[i - 1].first) {
      throw InputError(
          stamped[i].second, {},
          "its name tells the same time as " + stamped[i - 1].second.filename().string(),
          "Give the sweeps a times.txt, or distinct times");
    }
    sweeps.files[i] = stamped[i].second;
    sweeps.stamps.push_back(stamped[i].first);
  }
  sweeps.times_from = "times from the file names";
  return true;
}

std::unique_ptr<Recording> open_file(const fs::path& path) {
  SweepFiles sweeps;
  sweeps.kind = kind_of(path);
  if (sweeps.kind == nullptr) {
    throw InputError(path, {},
                     "a file that ends in " + path.extension().string() + " is no recording",
                     kWhatIsRead);
  }
  sweeps.files = {path};
  sweeps.layout = std::string(sweeps.kind->name) + " file";
  if (!stamp_from_names(sweeps)) {
    assume_times(sweeps, "no times");
    sweeps.times_from = "no time in its name: it starts at 0 s";
  }
  return std::make_unique<FileRecording>(path, std::move(sweeps));
}

std::unique_ptr<Recording> open_kitti(const fs::path& path, const fs::path& folder,
                                      const fs::path& times, std::string layout) {
  SweepFiles sweeps = list_sweeps(folder);
  if (sweeps.files.empty()) {
    throw InputError(folder, {}, "there are no .bin files in it", kWhatIsRead);
  }
  sweeps.layout = std::move(layout);
  if (fs::exists(times)) {
    stamp_from_file(sweeps, times);
  } else {
    assume_times(sweeps, "no " + times.lexically_relative(path).string());
  }
  return std::make_unique<FileRecording>(path, std::move(sweeps));
}

std::unique_ptr<Recording> open_plain_folder(const fs::path& path) {
  SweepFiles sweeps = list_sweeps(path);
  if (sweeps.files.empty()) {
    const bool sequences = fs::is_directory(path / "sequences");
    throw InputError(path, {},
                     sequences ? "it holds a whole KITTI data set, not one sequence"
                               : "there are no sweeps in it",
                     sequences
                         ? "Name one sequence, such as " + (path / "sequences" / "00").string()
                         : kWhatIsRead);
  }
  sweeps.layout = "folder of " + std::string(sweeps.kind->name) + " files";
  // KITTI keeps the times beside the folder of the sweeps: found too when that folder itself is
  // named.
  const fs::path normal = fs::absolute(path / "").lexically_normal().parent_path();
  std::vector<fs::path> candidates = {path / "times.txt", path / "timestamps.txt"};
  if (normal.filename() == "velodyne") {
    candidates.push_back(normal.parent_path() / "times.txt");
  } else if (normal.filename() == "data" && normal.parent_path().filename() == "velodyne_points") {
    candidates.push_back(normal.parent_path() / "timestamps.txt");
  }
  const auto times = std::find_if(candidates.begin(), candidates.end(),
                                  [](const fs::path& file) { return fs::exists(file); });
  if (times != candidates.end()) {
    stamp_from_file(sweeps, *times);
  } else if (!stamp_from_names(sweeps)) {
    assume_times(sweeps, "no times.txt and no times in the names");
  }
  return std::make_unique<FileRecording>(path, std::move(sweeps));
}

}  // namespace

std::unique_ptr<Recording> open_sweep_files(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    throw InputError(path, {}, "there is no such file or folder", "Check the path");
  }
  if (fs::is_regular_file(status)) {
    return open_file(path);
  }
  if (!fs::is_directory(status)) {
    throw InputError(
        path, {},
        error ? "cannot be looked at: " + error.message() : "is neither a folder nor a file",
        kWhatIsRead);
  }
  try {
    if (fs::is_directory(path / "velodyne")) {
      return open_kitti(path, path / "velodyne", path / "times.txt", "KITTI folder");
    }
    if (fs::is_directory(path / "velodyne_points" / "data")) {
      return with_kitti_raw_series(
          path, open_kitti(path, path / "velodyne_points" / "data",
                           path / "velodyne_points" / "timestamps.txt", "KITTI raw drive"));
    }
    return open_plain_folder(path);
  } catch (const fs::filesystem_error& failure) {
    throw InputError(path, {}, std::string("cannot be looked into: ") + failure.code().message(),
                     "Check the permissions");
  }
}

}  // namespace adit
