// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The sweeps and true poses of the real data beside a checkout, for tests of what lies below
// tools/. Plain reading of files that are known to be good; the readers that judge files are tested
// themselves.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "adit/slam/core/types.hpp"

namespace adit::test {

inline std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw std::runtime_error("cannot read " + file.string());
  }
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Points of four float32 each, x y z intensity.
inline std::vector<Point> points_of(std::string_view bytes) {
  std::vector<Point> points(bytes.size() / sizeof(Point));
  std::memcpy(points.data(), bytes.data(), points.size() * sizeof(Point));
  return points;
}

/// Rows of numbers as poses, 12 a pose (3x4) or, in a file of one pose, 16 (4x4).
inline std::vector<Eigen::Isometry3d> read_poses(const std::filesystem::path& file) {
  std::ifstream in(file);
  const std::vector<double> numbers(std::istream_iterator<double>(in), {});
  if (numbers.size() < 12 || (numbers.size() % 12 != 0 && numbers.size() != 16)) {
    throw std::runtime_error(file.string() + " holds no poses");
  }
  std::vector<Eigen::Isometry3d> poses(numbers.size() / 12, Eigen::Isometry3d::Identity());
  for (size_t i = 0; i < poses.size(); ++i) {
    poses[i].matrix().topRows<3>() =
        Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(numbers.data() + 12 * i);
  }
  return poses;
}

/// A drive in KITTI's layout: velodyne/NNNNNN.bin, times.txt (s), poses_velo.txt (T_velo0_velo_i).
struct RecordedDrive {
  std::vector<std::filesystem::path> files;
  std::vector<Nanoseconds> stamps;
  std::vector<Eigen::Isometry3d> truth;

  explicit RecordedDrive(const std::filesystem::path& folder)
      : truth(read_poses(folder / "poses_velo.txt")) {
    std::ifstream times(folder / "times.txt");
    for (double time = 0.0; times >> time;) {
      stamps.emplace_back(std::llround(time * 1e9));
    }
    for (const auto& entry : std::filesystem::directory_iterator(folder / "velodyne")) {
      files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    if (files.size() != stamps.size() || files.size() != truth.size()) {
      throw std::runtime_error(folder.string() + ": files, times and poses do not match");
    }
  }

  Sweep sweep(size_t i) const {
    Sweep sweep;
    sweep.stamp = stamps[i];
    sweep.points = points_of(read_bytes(files[i]));
    sweep.source = files[i].string();
    return sweep;
  }
};

/// The vertices of a binary PLY of four float32 a vertex, with a header nobody checks.
inline Sweep read_four_float_ply(const std::filesystem::path& file) {
  const std::string bytes = read_bytes(file);
  const std::string_view end = "end_header\n";
  const size_t begin = bytes.find(end);
  if (begin == std::string::npos) {
    throw std::runtime_error(file.string() + " is no PLY");
  }
  Sweep sweep;
  sweep.points = points_of(std::string_view(bytes).substr(begin + end.size()));
  sweep.source = file.string();
  return sweep;
}

/// Absolute trajectory error (m): root mean square distance of the positions after the best rigid
/// motion (Umeyama 1991, without scale).
inline double absolute_trajectory_error(std::span<const Eigen::Isometry3d> estimate,
                                        std::span<const Eigen::Isometry3d> truth) {
  const auto n = static_cast<Eigen::Index>(estimate.size());
  Eigen::Matrix3Xd from(3, n);
  Eigen::Matrix3Xd to(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    from.col(i) = estimate[static_cast<size_t>(i)].translation();
    to.col(i) = truth[static_cast<size_t>(i)].translation();
  }
  const Eigen::Matrix4d align = Eigen::umeyama(from, to, false);
  const Eigen::Matrix3Xd moved =
      (align.topLeftCorner<3, 3>() * from).colwise() + align.topRightCorner<3, 1>();
  return std::sqrt((moved - to).colwise().squaredNorm().mean());
}

}  // namespace adit::test
