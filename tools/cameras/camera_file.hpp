// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Files of cameras: their calibration, where they are mounted and where their images are.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "adit/slam/core/camera_model.hpp"

namespace adit {

/// A camera as a file lists it.
struct ListedCamera {
  std::string name;                                   ///< for people
  std::string topic{};                                ///< of its images; empty: unknown
  std::filesystem::path folder{};                     ///< of its images; empty: on a topic
  std::optional<CameraModel> model{};                 ///< none: the recording's
  std::optional<Eigen::Isometry3d> T_lidar_camera{};  ///< of its optical frame; none: unknown
  std::optional<Eigen::Isometry3d> T_imu_camera{};    ///< likewise
  std::string frame{};                                ///< of the transforms; empty: unknown
  double time_offset = 0.0;  ///< s that images were taken after their stamps
};

/// Reads a file of cameras, by its ending:
///
/// - .toml, adit's own: a table [[camera]] for each (docs/recordings.md).
/// - .yaml or .yml of Kalibr (camchain): pinhole cameras cam0, cam1 ... with radtan, equidistant or
///   no distortion, T_cam_imu or T_cn_cnm1, timeshift_cam_imu.
/// - .yaml or .yml of one camera, as ROS's camera_calibration and OpenCV write it: image_width,
///   image_height, camera_matrix, distortion_coefficients, distortion_model.
///
/// Throws InputError: it cannot be read, or something in it makes no sense.
std::vector<ListedCamera> read_camera_file(const std::filesystem::path& file);

/// True for numbers of coefficients that a lens can have; none of them is no distortion.
bool is_distortion(std::size_t numbers, Lens lens);
/// Which they are, for people.
std::string expected_distortion(Lens lens);

/// What is wrong with a model; empty: nothing.
std::string problem_of(const CameraModel& model);

/// A rigid transform of 16 numbers, row by row, or of 7: x y z (m) and a quaternion x y z w. None
/// where it is no such transform.
std::optional<Eigen::Isometry3d> rigid_transform(std::span<const double> numbers);

/// The cameras of a text in YAML; `file` is for messages. Throws InputError.
std::vector<ListedCamera> parse_camera_yaml(std::string_view text,
                                            const std::filesystem::path& file);

/// The cameras of adit's own TOML; folders count from that of `file`. Throws InputError.
std::vector<ListedCamera> parse_camera_toml(std::string_view text,
                                            const std::filesystem::path& file);

}  // namespace adit
