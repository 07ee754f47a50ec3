// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// sweeps.csv: what a run knows of each sweep, for programs and for the plots of `adit evaluate`.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "adit/slam/odometry/odometry.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
inline const Eigen::Vector3d kUnknownVector = Eigen::Vector3d::Constant(kUnknown);
inline const PoseUncertainty kUnknownUncertainty = {.local = Matrix6d::Constant(kUnknown),
                                                    .drift = Matrix6d::Constant(kUnknown)};

/// A direction of translation or rotation that an alignment was assessed in.
struct SweepDirection {
  std::string localizability;  ///< full, partial, none; empty where nothing was assessed
  double support = kUnknown;
  double sigma = kUnknown;                ///< m or rad, 1 / sqrt(information), the others free
  Eigen::Vector3d axis = kUnknownVector;  ///< unit, map axes
};

/// One line of the table. What is not known is NaN, or an empty text, and an empty cell in the
/// file. No times of the host: the same input gives the same bytes.
struct SweepRecord {
  double index = kUnknown;  ///< in the recording, counted from 0
  Nanoseconds stamp{0};
  Eigen::Vector3d position = kUnknownVector;                       ///< the lidar's, map, m
  Eigen::Vector4d attitude = Eigen::Vector4d::Constant(kUnknown);  ///< R_map_lidar: qx qy qz qw
  std::string state;                                               ///< OdometryState
  std::string registration;  ///< RegistrationStatus; empty where nothing was aligned
  double keyframe = kUnknown;
  double deskewed = kUnknown;
  double raw_points = kUnknown;
  double cloud_points = kUnknown;
  double inliers = kUnknown;
  double overlap = kUnknown;
  double iterations = kUnknown;
  double residual_rms = kUnknown;             ///< m
  std::array<SweepDirection, 3> translation;  ///< weakest first
  std::array<SweepDirection, 3> rotation;
  std::string imu;                                          ///< InertialState
  Eigen::Vector3d velocity = kUnknownVector;                ///< the body's, map axes, m/s
  Eigen::Vector3d gyro_bias = kUnknownVector;               ///< rad/s
  Eigen::Vector3d gyro_bias_sigma = kUnknownVector;         ///< rad/s
  Eigen::Vector3d accel_bias = kUnknownVector;              ///< m/s²
  Eigen::Vector3d accel_bias_sigma = kUnknownVector;        ///< m/s²
  Eigen::Vector3d gravity = kUnknownVector;                 ///< in the map, m/s²
  double gravity_sigma = kUnknown;                          ///< its direction's, rad, the greater
  Eigen::Vector3d innovation_translation = kUnknownVector;  ///< m, body axes
  Eigen::Vector3d innovation_rotation = kUnknownVector;     ///< rad, body axes
  double innovation_squared = kUnknown;                     ///< normalised
  double innovation_degrees = kUnknown;
  double innovation_gate = kUnknown;                  ///< bound of its square
  PoseUncertainty uncertainty = kUnknownUncertainty;  ///< covariances, lidar axes, m and rad
};

/// What the odometry reported of sweep `index`.
SweepRecord sweep_record(std::size_t index, const SweepResult& sweep);

/// A cell of the table with its column's name: a number (NaN: not known), the stamp, or a word.
struct SweepColumn {
  std::string name;
  std::variant<double, Nanoseconds, std::string> value;
};

/// All of a line, in the order of the file.
std::vector<SweepColumn> columns_of(const SweepRecord& sweep);

/// Writes the table as sweeps come. Throws OutputError.
class SweepTableWriter {
 public:
  explicit SweepTableWriter(std::filesystem::path path);
  void write(const SweepRecord& sweep);
  void flush() { file_.flush(); }
  void close() { file_.close(); }

 private:
  OutputFile file_;
};

/// Reads it back; columns that it does not know are passed over, and those that are not there are
/// unknown. Throws InputError with the line.
std::vector<SweepRecord> read_sweep_table(const std::filesystem::path& file);

}  // namespace adit
