// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Every setting of the system, with its default and unit. A field is listed twice: as a member, and
// in the visit() below it, which is what reads, writes, documents and validates configurations.
// Names with a paper symbol (c_min, r_input, ...) are those of LG-SLAM, Table I.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "adit/slam/core/recording_config.hpp"

namespace adit {

/// What happens to a sweep before registration.
struct PreprocessConfig {
  double c_min = 0.5;         ///< m
  double c_max = 100.0;       ///< m
  double r_input = 0.0;       ///< m; 0: derived
  double beam_spacing = 0.0;  ///< rad
  double surface_size = 0.0;  ///< m; 0: derived
  bool deskew = true;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("c_min", self.c_min, "m", "returns nearer than this are dropped");
    field("c_max", self.c_max, "m", "returns farther than this are dropped");
    field("r_input", self.r_input, "m",
          "voxel size of the sweep's down-sampling (one centroid a voxel); 0: a sixtieth of "
          "the range that nine in ten points of the first sweep stay below, 0.05 to 0.25 m");
    field("beam_spacing", self.beam_spacing, "rad",
          "angle between neighbouring beams, the wider of the two directions; the neighbourhood of "
          "normal estimation grows with range times this; 0: as the first sweep shows it");
    field("surface_size", self.surface_size, "m",
          "edge of the neighbourhood that a normal is estimated from near the sensor; 0, and at "
          "least: 2.5 r_input");
    field("deskew", self.deskew, "",
          "true: points that have times are moved to the sweep's start, by the IMU where it is "
          "fused, else at constant velocity; false: they are taken as they are");
  }
};

/// The inertial sensor, and its fusion with alignments (docs/theory/inertial.md).
struct ImuConfig {
  bool use = true;
  std::optional<std::array<double, 7>> T_imu_lidar{};
  std::string sensor = "generic";
  double noise_scale = 5.0;
  double gyro_noise = 1e-3;          ///< rad/s/√Hz
  double accel_noise = 1e-2;         ///< m/s²/√Hz
  double gyro_walk = 3e-5;           ///< rad/s²/√Hz
  double accel_walk = 1e-3;          ///< m/s³/√Hz
  double gravity_walk = 1e-4;        ///< rad/√s
  double gravity_walk_way = 3.5e-4;  ///< rad/√m
  double max_gap = 0.15;             ///< s
  double max_rate = 5000.0;          ///< rad/s
  double max_acceleration = 2000.0;  ///< m/s²
  int lag = 20;                      ///< sweeps
  int reset = 0;                     ///< sweeps
  double wait = 0.5;                 ///< s
  bool refine_time_offset = false;
  bool refine_rotation = false;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("use", self.use, "",
          "true: an IMU that the recording has is used; false: it is left alone");
    field("T_imu_lidar", self.T_imu_lidar, "m, quaternion",
          "pose of the lidar in the IMU's axes: x y z qx qy qz qw; maps lidar coordinates to the "
          "IMU's; where it is not given, the recording's static transforms tell it, or else the "
          "axes are taken to be the same");
    field("sensor", self.sensor, "",
          "whose noise to assume: generic, bmi088, icm20948, adis16448, vn100, mti300; or custom: "
          "the four densities below");
    field("noise_scale", self.noise_scale, "",
          "the sensor's densities are its data sheet's times this, for vibration");
    field("gyro_noise", self.gyro_noise, "rad/s/sqrt(Hz)", "white noise, of a custom sensor");
    field("accel_noise", self.accel_noise, "m/s^2/sqrt(Hz)", "white noise, of a custom sensor");
    field("gyro_walk", self.gyro_walk, "rad/s^2/sqrt(Hz)",
          "random walk of the bias, of a custom sensor");
    field("accel_walk", self.accel_walk, "m/s^3/sqrt(Hz)",
          "random walk of the bias, of a custom sensor");
    field("gravity_walk", self.gravity_walk, "rad/sqrt(s)",
          "how fast the direction of gravity may wander in the map, as the map drifts");
    field("gravity_walk_way", self.gravity_walk_way, "rad/sqrt(m)",
          "and how much of that is by the way made");
    field(
        "max_gap", self.max_gap, "s",
        "a longer time without readings is not bridged: the lidar goes on alone; one of more than "
        "50 ms is, with noise for what was missed");
    field("max_rate", self.max_rate, "rad/s",
          "a reading beyond, on any axis, is impossible and dropped (the default leaves room for "
          "gyroscopes that are in degrees a second)");
    field("max_acceleration", self.max_acceleration, "m/s^2", "and so is one beyond this");
    field("lag", self.lag, "sweeps", "the sliding graph optimises the states of the last sweeps");
    field("reset", self.reset, "sweeps",
          "greater than 0: instead of the lag, the graph is reduced to its newest state every so "
          "many sweeps (the paper: 100)");
    field("wait", self.wait, "s",
          "a measurement waits for earlier ones until one has arrived that is so much later; `adit "
          "live` takes 0.02 s, unless --set says otherwise");
    field(
        "refine_time_offset", self.refine_time_offset, "",
        "true: the IMU's clock is corrected whenever its turns and the sweeps' differ; false: only "
        "where they prove it wrong");
    field("refine_rotation", self.refine_rotation, "",
          "true: so is the rotation of T_imu_lidar, as far as the motion tells it");
  }
};

/// Alignment of a sweep with the submap, and of consecutive keyframes' submaps.
struct RegistrationConfig {
  std::string method = "vgicp";
  double r_align = 0.0;  ///< m; 0: derived
  double d_max = 0.0;    ///< m; 0: derived
  int max_iterations = 60;
  double translation_epsilon = 2e-3;  ///< m
  double rotation_epsilon = 5e-4;     ///< rad
  int min_inliers = 100;
  double min_overlap = 0.3;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("method", self.method, "",
          "vgicp: points with their surfaces to those of voxels; ndt: points to the voxels' "
          "Gaussians (needs larger voxels, and knows less of weak directions)");
    field("r_align", self.r_align, "m",
          "voxel size of the submap's Gaussian voxel map; 0: twice preprocess.r_input, with ndt "
          "four times");
    field("d_max", self.d_max, "m", "matches farther apart than this are not used; 0: r_align");
    field("max_iterations", self.max_iterations, "", "Gauss-Newton iterations at most");
    field("translation_epsilon", self.translation_epsilon, "m",
          "converged when a step is shorter than this");
    field("rotation_epsilon", self.rotation_epsilon, "rad", "and turns less than this");
    field("min_inliers", self.min_inliers, "", "fewer matched points are a failure");
    field("min_overlap", self.min_overlap, "", "a smaller fraction of matched points is a failure");
  }
};

/// The rolling submap that sweeps are aligned with.
struct SubmapConfig {
  int l = 20;                ///< clouds
  double delta_trans = 0.5;  ///< m
  double delta_rot = 0.3;    ///< rad

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("l", self.l, "clouds", "the submap holds the last l clouds that joined it");
    field("delta_trans", self.delta_trans, "m",
          "an aligned sweep joins the submap after this distance from the last that did; 0: every "
          "sweep joins");
    field("delta_rot", self.delta_rot, "rad", "or after this rotation");
  }
};

/// What the map keeps.
struct KeyframeConfig {
  double delta_trans = 1.0;      ///< m
  double delta_rot = 0.3926991;  ///< rad

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("delta_trans", self.delta_trans, "m", "a sweep becomes a keyframe after this distance");
    field("delta_rot", self.delta_rot, "rad", "or after this rotation");
  }
};

/// The map that is made of the keyframes.
struct MappingConfig {
  bool enabled = true;
  double r_submap = 0.0;  ///< m; 0: derived
  int delay = 5;          ///< keyframes
  bool loops = true;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("enabled", self.enabled, "",
          "true: keyframes become a map with their submaps; false: odometry alone");
    field("r_submap", self.r_submap, "m",
          "voxel size that the sweeps of a keyframe are merged in (one centroid a voxel); 0: "
          "preprocess.r_input");
    field("delay", self.delay, "keyframes",
          "what is worked out for a keyframe moves the map once so many more have come");
    field("loops", self.loops, "",
          "true: places seen before are found again and the map is corrected; false: drift stays; "
          "without a map it has no effect");
  }
};

/// Positions by satellite, which tie the map to the world (docs/theory/gnss.md).
struct GnssConfig {
  bool use = true;
  std::optional<std::array<double, 3>> antenna{};  ///< m
  bool height = true;
  double noise_scale = 1.0;
  double correlation = 60.0;  ///< s
  double time_offset = 0.0;   ///< s
  bool heading = true;
  std::optional<double> heading_mounting{};  ///< rad
  double heading_sigma = 0.035;              ///< rad: 2 degrees, as compasses' data sheets have it
  double heading_offset = 0.0175;            ///< rad: 1 degree

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& field) {
    field(
        "use", self.use, "",
        "true: fixes that the recording has tie the map to the world; false: they are left alone");
    field("antenna", self.antenna, "m",
          "place of the antenna in the lidar's axes: x y z; where it is not given, the recording's "
          "static transforms tell it, or else it is taken to be the lidar's own");
    field("height", self.height, "", "true: altitudes count; false: only latitude and longitude");
    field("noise_scale", self.noise_scale, "",
          "the receiver's standard deviations are multiplied by this, and are never taken to be "
          "below what its kind of fix can have");
    field("correlation", self.correlation, "s",
          "how long a receiver's errors stay much the same: fixes within that time count together "
          "as about one");
    field("time_offset", self.time_offset, "s",
          "is added to the stamps of fixes, of a receiver that reports late or by another clock");
    field(
        "heading", self.heading, "",
        "true: headings of recording.heading_topic count together with the fixes; false: they are "
        "not used");
    field("heading_mounting", self.heading_mounting, "rad",
          "yaw of the heading sensor's x axis in the lidar's axes, counter-clockwise; where it is "
          "not given, that of the recording's static transforms, or else 0");
    field("heading_sigma", self.heading_sigma, "rad",
          "standard deviation of a heading that comes without one");
    field("heading_offset", self.heading_offset, "rad",
          "standard deviation of the error that all headings have in common: of the mounting, and "
          "of a compass's declination");
  }
};

/// Velocities that wheels, a radar or another odometry measure, and those of points that have a
/// Doppler speed; fused with the inertial sensor (docs/theory/velocity.md).
struct VelocityConfig {
  bool use = true;
  bool doppler = true;
  std::optional<std::array<double, 7>> T_lidar_sensor{};
  double sigma = 0.05;  ///< m/s
  double scale_sigma = 0.05;
  double turn_sigma = 0.05;  ///< rad
  double time_offset = 0.0;  ///< s

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& field) {
    field(
        "use", self.use, "",
        "true: the velocities of recording.velocity_topic are fused with the IMU; false: they are "
        "left alone");
    field("doppler", self.doppler, "",
          "true: Doppler speeds that points have are, too, and points that move are left out; "
          "false: they are left alone");
    field("T_lidar_sensor", self.T_lidar_sensor, "m, quaternion",
          "pose of the sensor of velocities in the lidar's axes: x y z qx qy qz qw; where it is "
          "not given, the recording's static transforms tell it, or else its axes are taken to be "
          "the lidar's");
    field("sigma", self.sigma, "m/s",
          "standard deviation of a measured velocity that comes without covariance, the same "
          "throughout a sweep");
    field("scale_sigma", self.scale_sigma, "",
          "share by which a source may read too much or too little at first; it is estimated");
    field("turn_sigma", self.turn_sigma, "rad",
          "by which its mounting may be turned at first, about its y and z axes; it is estimated");
    field("time_offset", self.time_offset, "s",
          "is added to the stamps of velocities, of a source that reports late or by another "
          "clock");
  }
};

/// What to do when a sweep cannot be aligned.
struct RecoveryConfig {
  int max_coasting = 5;      ///< sweeps
  double max_speed = 500.0;  ///< m/s

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("max_coasting", self.max_coasting, "sweeps",
          "failed sweeps in a row that are bridged by the predicted motion; after them the submap "
          "starts anew");
    field("max_speed", self.max_speed, "m/s",
          "an alignment that asks for more since the last sweep is a failure");
  }
};

/// All settings, by section.
struct Config {
  RecordingConfig recording;
  PreprocessConfig preprocess;
  RegistrationConfig registration;
  SubmapConfig submap;
  KeyframeConfig keyframe;
  MappingConfig mapping;
  RecoveryConfig recovery;
  ImuConfig imu;
  GnssConfig gnss;
  VelocityConfig velocity;

  /// Calls section(name, struct) for each section, in the order of the file.
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& section) {
    section("recording", self.recording);
    section("preprocess", self.preprocess);
    section("registration", self.registration);
    section("submap", self.submap);
    section("keyframe", self.keyframe);
    section("mapping", self.mapping);
    section("recovery", self.recovery);
    section("imu", self.imu);
    section("gnss", self.gnss);
    section("velocity", self.velocity);
  }
};

/// preprocess.r_input where ranges are those of outdoors and large rooms, m.
inline constexpr double kUsualInput = 0.25;

/// The configuration with every length that it leaves at 0 filled in: preprocess.r_input with this
/// one (m), the others from it. With a voxel size that was derived preprocess.c_max is at most what
/// voxels that small reach.
Config with_lengths(const Config& config, double r_input = kUsualInput);

/// The first setting that makes no sense: its dotted name and what would.
struct ConfigProblem {
  std::string field;    ///< e.g. "preprocess.c_max"
  std::string message;  ///< e.g. "is 0.2; must be greater than preprocess.c_min (0.5)"
};

/// Checks ranges and relations between fields. Empty when the configuration can be used.
std::optional<ConfigProblem> validate(const Config& config);

}  // namespace adit
