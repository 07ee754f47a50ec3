// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/config.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "adit/shaders/shared/gaussian_cell.h"
#include "adit/slam/core/imu_noise.hpp"
#include "adit/slam/core/text.hpp"

namespace adit {
namespace {

/// Collects the first violated condition; later ones are not looked at.
class Checks {
 public:
  template <class Number>
  void require(bool holds, const char* field, Number value, const std::string& must) {
    if (!holds && !problem_) {
      problem_ =
          ConfigProblem{.field = field, .message = "is " + shortest(value) + "; must be " + must};
    }
  }

  template <class Number>
  void between(const char* field, Number value, Number low, Number high,
               const std::string& unit = "") {
    require(
        value >= low && value <= high, field, value,
        "between " + shortest(low) + " and " + shortest(high) + (unit.empty() ? "" : " " + unit));
  }

  void holds(bool holds, const char* field, const std::string& message) {
    if (!holds && !problem_) {
      problem_ = ConfigProblem{.field = field, .message = message};
    }
  }

  void finite(const std::string& field, double value) {
    if (!std::isfinite(value) && !problem_) {
      problem_ = ConfigProblem{.field = field, .message = "is not a finite number"};
    }
  }

  std::optional<ConfigProblem> problem() const { return problem_; }

 private:
  std::optional<ConfigProblem> problem_;
};

void check_finite(Checks& checks, const Config& config) {
  Config::visit(config, [&](const std::string& section, const auto& fields) {
    std::decay_t<decltype(fields)>::visit(
        fields, [&](const char* name, const auto& value, auto&&...) {
          if constexpr (std::is_floating_point_v<std::decay_t<decltype(value)>>) {
            checks.finite(section + "." + name, value);
          }
        });
  });
}

std::string than(const char* relation, const char* field, double value) {
  return std::string(relation) + " " + field + " (" + shortest(value) + ")";
}

// The device works in float32 in the submap's frame: a millimetre is resolved within about 4 km,
// and a sweep plus the way driven over a submap has to stay well inside of that.
constexpr double kFarthestReturn = 1000.0;

// How far the sensor can at least go before the submap's frame has to follow, m.
constexpr double kShortestReach = 10.0;

void check_preprocess(Checks& checks, const PreprocessConfig& p) {
  checks.between("preprocess.c_min", p.c_min, 0.0, kFarthestReturn, "m");
  checks.require(p.c_max > p.c_min, "preprocess.c_max", p.c_max,
                 than("greater than", "preprocess.c_min", p.c_min));
  checks.require(p.r_input < p.c_max, "preprocess.r_input", p.r_input,
                 than("less than", "preprocess.c_max", p.c_max));
  // Keys of surface cells have 9 bits an axis (shaders/include/surface.glsl).
  checks.require(p.beam_spacing == 0.0 || (p.beam_spacing >= 0.002 && p.beam_spacing <= 0.2),
                 "preprocess.beam_spacing", p.beam_spacing,
                 "0 (as the first sweep shows it), or between 0.002 and 0.2 rad");
  checks.between("preprocess.surface_size", p.surface_size, 0.0, 20.0, "m");
}

void check_registration(Checks& checks, const Config& config) {
  const RegistrationConfig& r = config.registration;
  checks.holds(r.method == "vgicp" || r.method == "ndt", "registration.method",
               "is '" + r.method + "'; must be vgicp or ndt");
  checks.between("registration.r_align", r.r_align, 0.05, 50.0, "m");
  checks.require(r.r_align >= config.preprocess.r_input, "registration.r_align", r.r_align,
                 than("at least", "preprocess.r_input", config.preprocess.r_input));
  const double smallest = (config.preprocess.c_max + kShortestReach) / gpu::kVoxelsUpwards;
  checks.require(r.r_align >= smallest, "registration.r_align", r.r_align,
                 "at least " + shortest(smallest) + " m, or preprocess.c_max (" +
                     shortest(config.preprocess.c_max) + ") smaller");
  const double edge = std::ceil(r.r_align / config.preprocess.r_input) + 1.0;
  const double fullest = edge * edge * edge * config.submap.l;
  checks.require(fullest <= gpu::kMostCellPoints, "registration.r_align", r.r_align,
                 "smaller: a voxel could hold " + shortest(fullest) + " points of " +
                     shortest(config.submap.l) + " clouds, and " + shortest(gpu::kMostCellPoints) +
                     " is the most");
  checks.between("registration.d_max", r.d_max, 0.01, 100.0, "m");
  checks.between("registration.max_iterations", r.max_iterations, 1, 200);
  checks.require(r.translation_epsilon > 0.0, "registration.translation_epsilon",
                 r.translation_epsilon, "greater than 0");
  checks.require(r.translation_epsilon < r.d_max, "registration.translation_epsilon",
                 r.translation_epsilon, than("less than", "registration.d_max", r.d_max));
  checks.require(r.rotation_epsilon > 0.0 && r.rotation_epsilon < 0.1,
                 "registration.rotation_epsilon", r.rotation_epsilon,
                 "greater than 0 and less than 0.1 rad");
  checks.require(r.min_inliers >= 6, "registration.min_inliers", r.min_inliers,
                 "at least 6 (a pose has six degrees of freedom)");
  checks.require(r.min_overlap >= 0.0 && r.min_overlap < 1.0, "registration.min_overlap",
                 r.min_overlap, "at least 0 and less than 1");
}

void check_pose(Checks& checks, const char* field,
                const std::optional<std::array<double, 7>>& pose) {
  double norm = pose ? 0.0 : 1.0;
  for (size_t i = 0; pose && i < pose->size(); ++i) {
    checks.finite(field, (*pose)[i]);
    norm = std::hypot(norm, i < 3 ? 0.0 : (*pose)[i]);
  }
  checks.require(std::abs(norm - 1.0) < 1e-3, field, norm,
                 "a pose x y z qx qy qz qw whose quaternion has the length 1");
}

void check_recording(Checks& checks, const RecordingConfig& r) {
  const double unit = r.point_time_unit.value_or(1.0);
  checks.require(unit > 0.0 && unit <= 1.0, "recording.point_time_unit", unit,
                 "the seconds that a step of one stands for: above 0, 1 at most");
  const double scale = r.coordinate_scale.value_or(1.0);
  checks.require(scale > 0.0 && scale <= 1000.0, "recording.coordinate_scale", scale,
                 "the metres that a step of one stands for: above 0, 1000 at most");
  checks.require(r.floats_per_point == 0 || (r.floats_per_point >= 3 && r.floats_per_point <= 8),
                 "recording.floats_per_point", r.floats_per_point, "0, or 3 to 8");
  checks.require(
      r.spin_rate == 0.0 || (std::abs(r.spin_rate) >= 1.0 && std::abs(r.spin_rate) <= 100.0),
      "recording.spin_rate", r.spin_rate, "0, or of 1 to 100 turns a second");
  checks.between("recording.beam_elevation", r.beam_elevation, -0.2, 0.2, "rad");
  constexpr double kLongest = 4e9;  // s; a clock that counts from its start is 1.7e9 s behind
  checks.between("recording.sweep_time_offset", r.sweep_time_offset, -kLongest, kLongest, "s");
  checks.between("recording.imu_time_offset", r.imu_time_offset, -kLongest, kLongest, "s");
  checks.require(r.accelerometer_scale != 0.0, "recording.accelerometer_scale",
                 r.accelerometer_scale, "other than 0");
  checks.require(r.gyroscope_scale != 0.0, "recording.gyroscope_scale", r.gyroscope_scale,
                 "other than 0");
  checks.holds(r.T_lidar_further.size() <= r.further_sweep_topics.size(),
               "recording.T_lidar_further", "has more poses than there are further_sweep_topics");
  for (const std::array<double, 7>& pose : r.T_lidar_further) {
    check_pose(checks, "recording.T_lidar_further", pose);
  }
}

void check_mapping(Checks& checks, const Config& config) {
  const MappingConfig& m = config.mapping;
  checks.between("mapping.r_submap", m.r_submap, 0.02, 10.0, "m");
  // A keyframe's cells need keys sideways, the voxels that others are aligned with upwards as well.
  const double reach =
      config.preprocess.c_max + std::max(config.keyframe.delta_trans, kShortestReach);
  const auto smaller = [&](double smallest) {
    return "at least " + shortest(smallest) + " m, or preprocess.c_max (" +
           shortest(config.preprocess.c_max) + ") or keyframe.delta_trans (" +
           shortest(config.keyframe.delta_trans) + ") smaller";
  };
  checks.require(!m.enabled || m.r_submap >= reach / gpu::kVoxelsSideways, "mapping.r_submap",
                 m.r_submap, smaller(reach / gpu::kVoxelsSideways));
  checks.require(!m.enabled || config.registration.r_align >= reach / gpu::kVoxelsUpwards,
                 "registration.r_align", config.registration.r_align,
                 smaller(reach / gpu::kVoxelsUpwards));
  checks.between("mapping.delay", m.delay, 0, 1000, "keyframes");
}

void check_rest(Checks& checks, const Config& config) {
  checks.between("submap.l", config.submap.l, 1, 1000, "clouds");
  checks.between("submap.delta_trans", config.submap.delta_trans, 0.0, 100.0, "m");
  checks.between("submap.delta_rot", config.submap.delta_rot, 0.0, std::numbers::pi, "rad");
  checks.require(config.keyframe.delta_trans > 0.0, "keyframe.delta_trans",
                 config.keyframe.delta_trans, "greater than 0");
  checks.require(config.keyframe.delta_rot > 0.0 && config.keyframe.delta_rot <= std::numbers::pi,
                 "keyframe.delta_rot", config.keyframe.delta_rot, "greater than 0 and at most pi");
  checks.between("recovery.max_coasting", config.recovery.max_coasting, 0, 1'000'000, "sweeps");
  checks.between("recovery.max_speed", config.recovery.max_speed, 0.1, 1e6, "m/s");
}

void check_imu(Checks& checks, const ImuConfig& imu) {
  check_pose(checks, "imu.T_imu_lidar", imu.T_imu_lidar);
  std::string known = "custom";
  for (const ImuPreset& preset : imu_presets()) {
    known += ", " + std::string(preset.name);
  }
  checks.holds(imu.sensor == "custom" || imu_preset(imu.sensor, 1.0), "imu.sensor",
               "is '" + imu.sensor + "'; must be one of " + known);
  checks.between("imu.noise_scale", imu.noise_scale, 0.1, 1000.0);
  checks.between("imu.gyro_noise", imu.gyro_noise, 1e-7, 1.0, "rad/s/sqrt(Hz)");
  checks.between("imu.accel_noise", imu.accel_noise, 1e-6, 10.0, "m/s^2/sqrt(Hz)");
  checks.between("imu.gyro_walk", imu.gyro_walk, 1e-9, 1.0, "rad/s^2/sqrt(Hz)");
  checks.between("imu.accel_walk", imu.accel_walk, 1e-9, 10.0, "m/s^3/sqrt(Hz)");
  if (imu.sensor != "custom") {
    const ImuConfig usual;
    const auto unused = [&](const char* field, double value, double usual_value) {
      checks.holds(value == usual_value, field,
                   "is " + shortest(value) +
                       ", which a custom sensor alone has; set imu.sensor=custom, or leave it out");
    };
    unused("imu.gyro_noise", imu.gyro_noise, usual.gyro_noise);
    unused("imu.accel_noise", imu.accel_noise, usual.accel_noise);
    unused("imu.gyro_walk", imu.gyro_walk, usual.gyro_walk);
    unused("imu.accel_walk", imu.accel_walk, usual.accel_walk);
  }
  checks.between("imu.gravity_walk", imu.gravity_walk, 1e-9, 1.0, "rad/sqrt(s)");
  checks.between("imu.gravity_walk_way", imu.gravity_walk_way, 0.0, 1.0, "rad/sqrt(m)");
  checks.between("imu.max_gap", imu.max_gap, 0.001, 1.0, "s");
  checks.between("imu.max_rate", imu.max_rate, 1.0, 1e6, "rad/s");
  checks.between("imu.max_acceleration", imu.max_acceleration, 1.0, 1e6, "m/s^2");
  checks.between("imu.wait", imu.wait, 0.0, 10.0, "s");
  checks.between("imu.lag", imu.lag, 2, 1000, "sweeps");
  checks.require(imu.reset == 0 || imu.reset >= 2, "imu.reset", imu.reset,
                 "0, or at least 2 sweeps");
}

void check_gnss(Checks& checks, const GnssConfig& gnss) {
  constexpr double kFarthestAntenna = 100.0;  // m
  for (std::size_t i = 0; gnss.antenna && i < gnss.antenna->size(); ++i) {
    const double place = (*gnss.antenna)[i];
    checks.require(std::abs(place) <= kFarthestAntenna, "gnss.antenna", place,
                   "a place x y z within 100 m of the lidar");
  }
  checks.between("gnss.noise_scale", gnss.noise_scale, 0.1, 1000.0);
  checks.between("gnss.correlation", gnss.correlation, 0.1, 3600.0, "s");
  checks.between("gnss.time_offset", gnss.time_offset, -4e9, 4e9, "s");
  if (gnss.heading_mounting) {
    checks.between("gnss.heading_mounting", *gnss.heading_mounting, -7.0, 7.0, "rad");
  }
  checks.between("gnss.heading_sigma", gnss.heading_sigma, 1e-4, 1.0, "rad");
  checks.between("gnss.heading_offset", gnss.heading_offset, 1e-4, 1.0, "rad");
}

void check_velocity(Checks& checks, const VelocityConfig& velocity) {
  check_pose(checks, "velocity.T_lidar_sensor", velocity.T_lidar_sensor);
  checks.between("velocity.sigma", velocity.sigma, 1e-4, 100.0, "m/s");
  checks.between("velocity.scale_sigma", velocity.scale_sigma, 1e-6, 1.0);
  checks.between("velocity.turn_sigma", velocity.turn_sigma, 1e-6, 1.0, "rad");
  checks.between("velocity.time_offset", velocity.time_offset, -4e9, 4e9, "s");
}

}  // namespace

Config with_lengths(const Config& stated, double r_input) {
  Config config = stated;
  PreprocessConfig& p = config.preprocess;
  RegistrationConfig& r = config.registration;
  const bool derived = r.r_align == 0.0;
  if (p.r_input == 0.0) {
    p.r_input = derived ? r_input : std::min(r_input, 0.5 * r.r_align);
  }
  const double cells = r.method == "ndt" ? 4.0 : 2.0;
  r.r_align = derived ? cells * p.r_input : r.r_align;
  r.d_max = r.d_max == 0.0 ? r.r_align : r.d_max;
  p.surface_size = p.surface_size == 0.0 ? 2.5 * p.r_input : p.surface_size;
  config.mapping.r_submap = config.mapping.r_submap == 0.0 ? p.r_input : config.mapping.r_submap;
  if (derived) {
    p.c_max = std::min(p.c_max, gpu::kVoxelsUpwards * r.r_align - kShortestReach);
  }
  return config;
}

namespace {

/// Nothing where the setting is no number.
std::optional<double> number_of(const Config& config, const std::string& field) {
  std::optional<double> number;
  Config::visit(config, [&](const std::string& section, const auto& fields) {
    std::decay_t<decltype(fields)>::visit(
        fields, [&](const char* name, const auto& value, auto&&...) {
          if constexpr (std::is_floating_point_v<std::decay_t<decltype(value)>>) {
            number = section + "." + name == field ? value : number;
          }
        });
  });
  return number;
}

/// Whoever stated another length than the one that makes no sense is told which.
ConfigProblem with_origin(ConfigProblem problem, const Config& stated, const Config& filled) {
  const bool derived = number_of(stated, problem.field) != number_of(filled, problem.field);
  for (const char* origin : {"preprocess.r_input", "registration.r_align"}) {
    const double value = number_of(stated, origin).value_or(0.0);
    if (derived && value != 0.0) {
      problem.message += "; it follows from " + std::string(origin) + " (" + shortest(value) + ")";
      break;
    }
  }
  return problem;
}

}  // namespace

std::optional<ConfigProblem> validate(const Config& stated) {
  Checks checks;
  check_finite(checks, stated);
  checks.require(stated.preprocess.c_max <= kFarthestReturn, "preprocess.c_max",
                 stated.preprocess.c_max, "at most " + shortest(kFarthestReturn) + " m");
  if (stated.preprocess.r_input != 0.0) {
    checks.between("preprocess.r_input", stated.preprocess.r_input, 0.01, 10.0,
                   "m, or 0 (derived)");
  }
  const Config config = with_lengths(stated);
  check_recording(checks, config.recording);
  check_preprocess(checks, config.preprocess);
  check_registration(checks, config);
  check_mapping(checks, config);
  check_rest(checks, config);
  check_imu(checks, config.imu);
  check_gnss(checks, config.gnss);
  check_velocity(checks, config.velocity);
  const std::optional<ConfigProblem> problem = checks.problem();
  return problem ? std::optional(with_origin(*problem, stated, config)) : std::nullopt;
}

}  // namespace adit
