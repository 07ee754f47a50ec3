// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace adit {

/// How a recording is to be understood, where it does not tell or tells what is wrong. `adit
/// inspect --write-config` finds these.
struct RecordingConfig {
  std::optional<std::string> sweep_topic{};
  std::vector<std::string> further_sweep_topics{};
  std::vector<std::array<double, 7>> T_lidar_further{};
  std::optional<std::string> imu_topic{};
  std::optional<std::string> gnss_topic{};
  std::optional<std::string> velocity_topic{};
  bool velocity_of_poses = false;
  std::optional<std::string> heading_topic{};
  std::optional<std::string> sweep_frame{};
  std::optional<std::string> imu_frame{};
  std::optional<std::string> metadata{};
  std::optional<double> point_time_unit{};   ///< s
  std::optional<double> coordinate_scale{};  ///< m
  int floats_per_point = 0;
  double spin_rate = 0.0;            ///< Hz
  double beam_elevation = 0.0;       ///< rad
  double sweep_time_offset = 0.0;    ///< s
  double imu_time_offset = 0.0;      ///< s
  double accelerometer_scale = 1.0;  ///< m/s² of a step of one
  double gyroscope_scale = 1.0;      ///< rad/s of a step of one

  bool operator==(const RecordingConfig&) const = default;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("sweep_topic", self.sweep_topic, "",
          "the topic of sweeps to map; not given: the only one that has points");
    field("further_sweep_topics", self.further_sweep_topics, "",
          "topics of further range sensors, whose sweeps are merged with those of sweep_topic, in "
          "the axes of its sensor: [\"/rear/points\"]");
    field("T_lidar_further", self.T_lidar_further, "m, quaternion",
          "pose of each further sensor in the axes of the first: [[x, y, z, qx, qy, qz, qw]], in "
          "the order of their topics; where none is given, the recording's static transforms tell "
          "it");
    field("imu_topic", self.imu_topic, "",
          "the topic of the IMU; not given: the best one by its readings, frame and rate");
    field("gnss_topic", self.gnss_topic, "", "the topic of fixes; not given: the first with a fix");
    field("velocity_topic", self.velocity_topic, "",
          "the topic of measured velocities (wheels, radar, another odometry): TwistStamped, "
          "TwistWithCovarianceStamped, the twist of Odometry, or PoseStamped, whose poses give "
          "velocities; not given: none is used, since such messages may be commands");
    field("velocity_of_poses", self.velocity_of_poses, "",
          "true: of Odometry on velocity_topic the poses give velocities, not the twist");
    field("heading_topic", self.heading_topic, "",
          "the topic of headings against true north (two antennas, a compass): QuaternionStamped, "
          "NMEA sentences, or the orientation of an Imu that knows north; not given: none is used, "
          "since an orientation seldom says what it is measured against");
    field("sweep_frame", self.sweep_frame, "",
          "the frame of the sensor to map, where several publish sweeps on one topic; not given: "
          "the one with most messages at the start");
    field("imu_frame", self.imu_frame, "",
          "the frame of the IMU, where several publish on one topic; not given: the best one");
    field("metadata", self.metadata, "",
          "file that tells of the sensor whose packets are recorded (Ouster's JSON, Hesai's angle "
          "correction); not given: what lies beside the recording");
    field("point_time_unit", self.point_time_unit, "s",
          "what one step of the times of points is, such as 1e-9; not given: inferred from their "
          "spread");
    field("coordinate_scale", self.coordinate_scale, "m",
          "what one step of the coordinates of points is, such as 0.001; not given: they are "
          "metres, and integers are refused");
    field("floats_per_point", self.floats_per_point, "",
          "numbers that a point of a .bin file has, 3 to 8; 0: found by the numbers themselves");
    field(
        "spin_rate", self.spin_rate, "Hz",
        "turns a second of a scanner whose points have no times, about its z axis, negative where "
        "it turns clockwise seen from above: each point gets its time from its azimuth, in a turn "
        "that begins and ends behind the scanner, and whose stamp is that of its middle; 0: points "
        "without times are taken to be of one moment");
    field("beam_elevation", self.beam_elevation, "rad",
          "added to the elevation of each point, for scanners whose calibration is off");
    field("sweep_time_offset", self.sweep_time_offset, "s", "added to the times of sweeps");
    field("imu_time_offset", self.imu_time_offset, "s", "added to the times of IMU samples");
    field("accelerometer_scale", self.accelerometer_scale, "",
          "accelerations times this are m/s²: 9.80665 where they are in g, -1 where the sign is "
          "flipped");
    field("gyroscope_scale", self.gyroscope_scale, "",
          "rates times this are rad/s: 0.0174533 where they are in degrees per second");
  }
};

}  // namespace adit
