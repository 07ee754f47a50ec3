// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/sweep_files.hpp"

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "adit/tools/clouds/point_time_vote.hpp"
#include "adit/tools/clouds/returns.hpp"
#include "adit/tools/recordings/kitti_raw.hpp"
#include "adit/tools/recordings/sweep_listing.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWhatIsRead =
    "A recording is an MCAP file, a ROS 1 bag, a rosbag2 folder or its .db3 file, a capture of "
    "packets (.pcap, .pcapng); a folder of KITTI (velodyne/*.bin), KITTI raw "
    "(velodyne_points/data/*.bin), EuRoC (mav0/) or TUM RGB-D (depth.txt); a folder of .bin, .pcd, "
    ".ply, .las or .laz files, or one such file";

/// How the sweeps are to be read, all alike, by what the first of them tell: the unit of their
/// points' times, where they lie, and how many numbers a point has. Damaged ones do not count.
CloudReading told_reading(const SweepFiles& sweeps, const EventSelection& selection) {
  CloudReading reading{.time_unit = selection.point_time_unit,
                       .coordinate_scale = selection.coordinate_scale,
                       .floats_per_point = selection.floats_per_point};
  PointTimeVote vote;
  const std::size_t count = std::min(sweeps.files.size(), PointTimeVote::kSweeps);
  for (std::size_t i = 0; i < count; ++i) {
    try {
      const CloudFile cloud = sweeps.kind->read(sweeps.files[i], reading);
      if (std::ranges::any_of(cloud.sweep.points, is_return)) {
        reading.offset = reading.offset.value_or(cloud.sweep.offset);
        reading.floats_per_point =
            reading.floats_per_point ? reading.floats_per_point : cloud.floats_per_point;
      }
      if (!cloud.times && reading.offset) {
        break;  // none of them has any, as a rule
      }
      if (cloud.times) {
        vote.add(cloud.sweep, *cloud.times);
      }
    } catch (const InputError&) {
      // reported where the events are read
    }
  }
  if (!reading.time_unit) {
    reading.time_unit = vote.unit();
  }
  return reading;
}

class SweepFileStream final : public EventStream {
 public:
  SweepFileStream(const SweepFiles& sweeps, const EventSelection& selection)
      : sweeps_(&sweeps), selection_(selection) {
    const auto& stamps = sweeps.stamps;
    const auto first = std::lower_bound(stamps.begin(), stamps.end(), selection.begin);
    const auto rest = static_cast<uint64_t>(stamps.end() - first);
    index_ = stamps.size() - rest + std::min(rest, selection.skip);
  }

  std::optional<Event> next() override {
    if (cloud_ && next_fault_ < cloud_->faults.size()) {
      throw InputError(cloud_->faults[next_fault_++]);
    }
    if (!cloud_) {
      if (index_ == sweeps_->files.size() || sweeps_->stamps[index_] > selection_.end) {
        return std::nullopt;
      }
      cloud_ = read(index_++);
      next_fault_ = 0;
      return next();
    }
    const fs::path& file = sweeps_->files[index_ - 1];
    CloudFile cloud = std::move(*std::exchange(cloud_, std::nullopt));
    const Nanoseconds stamp = cloud.sweep.stamp;
    std::error_code ignored;
    return Event{.topic = 0,
                 .received = stamp,
                 .value = std::move(cloud.sweep),
                 .bytes = fs::file_size(file, ignored),
                 .frame = {},
                 .point_times = std::move(cloud.times),
                 .number = index_ - 1,
                 .has_intensity = cloud.has_intensity,
                 .coordinate_step = cloud.coordinate_step};
  }

 private:
  CloudFile read(std::size_t index) {
    const fs::path& file = sweeps_->files[index];
    if (!reading_) {
      reading_ = told_reading(*sweeps_, selection_);
    }
    CloudFile cloud = sweeps_->kind->read(file, *reading_);
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
          "its sweep starts " + std::to_string(seconds(last_->second - stamp)) +
              " s before that of " + sweeps_->files[last_->first].filename().string() +
              " (or at the same time)",
          "Sweeps must follow each other in time; correct the point times or the order of the "
          "names");
    }
    last_ = {index, stamp};
  }

  const SweepFiles* sweeps_;
  EventSelection selection_;
  std::optional<CloudReading> reading_;  // once it was asked for
  std::size_t index_ = 0;                // of the next file
  std::optional<CloudFile> cloud_;       // was read and is to come
  std::size_t next_fault_ = 0;           // of its faults
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
    const std::string layout =
        sweeps_.kind->describe != nullptr ? sweeps_.kind->describe(sweeps_.files.front()) : "";
    return text + "; " + sweeps_.times_from + (layout.empty() ? "" : "; " + layout);
  }

 private:
  fs::path path_;
  SweepFiles sweeps_;
  std::vector<Topic> topics_;
};

std::unique_ptr<Recording> open_file(const fs::path& path) {
  SweepFiles sweeps{.kind = sweep_file_kind(path), .files = {path}};
  std::error_code unknown;
  if (sweeps.kind == nullptr && fs::is_empty(path, unknown)) {
    throw InputError(path, {}, "it is empty", "Copy it again, or record anew");
  }
  if (sweeps.kind == nullptr) {
    const std::string suffix = path.extension().string();
    throw InputError(path, {},
                     suffix.empty() ? "it is no recording, by its content, and has no suffix"
                                    : "it is no recording, by its content or its suffix " + suffix,
                     kWhatIsRead);
  }
  sweeps.layout = std::string(sweeps.kind->name) + " file";
  if (std::optional<SweepFiles> stamped = stamped_by_names(sweeps)) {
    return std::make_unique<FileRecording>(path, std::move(*stamped));
  }
  sweeps = stamped_by_assumption("no times", std::move(sweeps));
  sweeps.times_from = "no time in its name: it starts at 0 s";
  return std::make_unique<FileRecording>(path, std::move(sweeps));
}

std::unique_ptr<Recording> open_kitti(const fs::path& path, const fs::path& folder,
                                      const fs::path& times, std::string layout) {
  SweepFiles sweeps = list_sweeps(folder);
  if (sweeps.files.empty()) {
    throw InputError(folder, {}, "there are no .bin files in it", kWhatIsRead);
  }
  sweeps.layout = std::move(layout);
  sweeps = fs::exists(times)
               ? stamped_by(times, std::move(sweeps))
               : stamped_by_assumption("no " + times.lexically_relative(path).string(),
                                       std::move(sweeps));
  return std::make_unique<FileRecording>(path, std::move(sweeps));
}

/// What `adit run` leaves, whose map.ply would pass for a sweep.
bool is_folder_of_a_run(const fs::path& path) {
  return fs::exists(path / "summary.json") && fs::exists(path / "sweeps.csv") &&
         fs::exists(path / "trajectory.tum");
}

std::unique_ptr<Recording> open_plain_folder(const fs::path& path) {
  if (is_folder_of_a_run(path)) {
    throw InputError(path, {}, "it is the folder of a run, not a recording",
                     "Name the recording that was mapped. Runs are for `adit inspect`, `evaluate`, "
                     "`view` and `export`; `adit convert OUT run.mcap --as foxglove` shows one in "
                     "other viewers");
  }
  SweepFiles sweeps = list_sweeps(path);
  if (sweeps.files.empty()) {
    if (fs::is_empty(path)) {
      throw InputError(path, {}, "the folder is empty",
                       "A run leaves its folder so where it was killed before it had begun: start "
                       "that again. " +
                           std::string(kWhatIsRead));
    }
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
    sweeps = stamped_by(*times, std::move(sweeps));
  } else if (std::optional<SweepFiles> stamped = stamped_by_names(sweeps)) {
    sweeps = std::move(*stamped);
  } else {
    sweeps = stamped_by_assumption("no times.txt and no times in the names", std::move(sweeps));
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
