// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/run_outputs.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <utility>

#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// Opens for appending: says whether the file could be written and changes nothing in it.
void check_file(const fs::path& file, const fs::path& folder) {
  std::error_code ignored;
  const bool existed = fs::exists(fs::symlink_status(file, ignored));
  std::FILE* stream = std::fopen(file.c_str(), "ab");
  if (stream == nullptr) {
    throw OutputError(file, file.string() + ": cannot be written: " + std::strerror(errno) +
                                (file.parent_path() == folder ? ". Choose another folder with -o."
                                                              : ". Name another file."));
  }
  std::fclose(stream);
  if (!existed) {
    fs::remove(file, ignored);
  }
}

/// A write that failed half-way may have left the beginning of a line.
void cut_half_line(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    return;
  }
  const auto size = static_cast<int64_t>(fs::file_size(file, error));
  std::ifstream stream(file, std::ios::binary);
  int64_t end = size;
  for (char letter = 0; end > 0; --end) {
    if (!stream.seekg(end - 1).get(letter) || letter == '\n') {
      break;
    }
  }
  if (end < size) {
    fs::resize_file(file, static_cast<uintmax_t>(end), error);
  }
}

}  // namespace

RunFiles::RunFiles(const fs::path& folder)
    : tum(folder / "trajectory.tum"),
      kitti(folder / "trajectory.kitti"),
      sweeps(folder / "sweeps.csv"),
      map(folder / "map.ply"),
      page(folder / "map.html"),
      odometry(folder / "odometry.tum"),
      online(folder / "online.tum"),
      database(folder / "map.adit"),
      localization(folder / "localization.csv"),
      summary(folder / "summary.json") {}

void make_output_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  std::error_code unknown;
  if (!fs::is_directory(folder, unknown)) {
    const std::string reason =
        error ? error.message() : std::string("there is a file of that name");
    throw OutputError(folder, folder.string() + ": the output folder cannot be made: " + reason +
                                  ". Choose another one with -o.");
  }
}

void check_writable(const fs::path& folder, const MapOptions& map,
                    const std::vector<fs::path>& others) {
  make_output_folder(folder);
  const RunFiles files(folder);
  for (const fs::path& file : {files.tum, files.kitti, files.sweeps, files.page, files.summary}) {
    check_file(file, folder);
  }
  if (map.enabled) {
    check_file(files.map, folder);
  }
  for (const fs::path& file : others) {
    check_file(file, folder);
  }
}

RunOutputs::RunOutputs(const fs::path& folder, const MapOptions& map, bool odometry)
    : files_(folder),
      tum_(std::in_place, files_.tum, TrajectoryFormat::tum),
      kitti_(std::in_place, files_.kitti, TrajectoryFormat::kitti),
      sweeps_(std::in_place, files_.sweeps) {
  if (map.enabled) {
    map_.emplace(files_.map);
  }
  if (odometry) {
    odometry_.emplace(files_.odometry, TrajectoryFormat::tum);
  }
  if (map.resolution) {
    thinning_.emplace(*map.resolution);
  }
}

void RunOutputs::write(const SweepResult& sweep, std::size_t index,
                       const std::optional<MapPlacement>& mapped) {
  const StampedPose pose{.stamp = sweep.stamp,
                         .pose = mapped ? mapped->T_map_lidar : sweep.T_map_lidar};
  const bool apart = sweep.state == OdometryState::restarted && poses_ > 0;
  if (apart) {
    tum_->begin_part();
  }
  tum_->write(pose);
  tum_->flush();
  kitti_->write(pose);
  kitti_->flush();
  if (odometry_) {
    if (apart) {
      odometry_->begin_part();
    }
    odometry_->write({.stamp = sweep.stamp, .pose = sweep.T_map_lidar});
    odometry_->flush();
  }
  sweeps_->write(sweep_record(index, sweep));
  sweeps_->flush();
  if (mapped && mapped->localization.any()) {
    if (!localization_) {
      localization_.emplace(files_.localization);
    }
    localization_->write(sweep.stamp, mapped->localization);
    localization_->flush();
  }
  if (map_ && sweep.keyframe) {
    page_cloud_.add(sweep.cloud, sweep.T_map_lidar, poses_);
    write_map(sweep);
  }
  ++poses_;
}

void RunOutputs::write_map(const SweepResult& keyframe) {
  points_.clear();
  for (const Point& point : keyframe.cloud) {
    const Eigen::Vector3d p = keyframe.T_map_lidar * Eigen::Vector3d(point.x, point.y, point.z);
    if (!thinning_ || thinning_->take(p)) {
      const Eigen::Vector3f single = p.cast<float>();
      points_.push_back(
          {.x = single.x(), .y = single.y(), .z = single.z(), .intensity = point.intensity});
    }
  }
  map_->write(points_);
  map_->flush();
  map_parts_.push_back(
      {.stamp = keyframe.stamp, .T_map_lidar = keyframe.T_map_lidar, .points = points_.size()});
}

void RunOutputs::close() {
  std::exception_ptr first_failure;
  const auto attempt = [&](auto& writer) {
    try {
      writer->close();
    } catch (const OutputError&) {
      if (!first_failure) {
        first_failure = std::current_exception();
      }
    }
  };
  const auto end = [&](auto& writer, const fs::path& file) {
    if (writer) {
      attempt(writer);
      writer.reset();  // so that nothing is written after the cut
      cut_half_line(file);
    }
  };
  end(tum_, files_.tum);
  end(kitti_, files_.kitti);
  end(odometry_, files_.odometry);
  end(sweeps_, files_.sweeps);
  end(localization_, files_.localization);
  if (map_) {
    attempt(map_);
  }
  if (first_failure) {
    std::rethrow_exception(first_failure);
  }
}

}  // namespace adit
