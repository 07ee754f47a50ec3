// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/recording_inference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/core.h>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tools/recordings/ros_messages.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/support/utf8.hpp"

namespace adit {
namespace {

/// "field 't' in units of 1e-09 s, from 0.0 ms after the stamp".
std::string times_text(const PointTimeNature& times, const SweepStatistics& s) {
  const std::string field = times.field.empty() ? "times" : "times in field '" + times.field + "'";
  std::string text = field + fmt::format(", unit {:g} s, ", times.unit);
  if (times.absolute) {
    text += "absolute";
  } else {
    text += times.first < -1e-3 ? "up to the stamp, which is the end of the sweep"
                                : "after the stamp, which is the start of the sweep";
  }
  return text + fmt::format(" (a sweep lasts {:.1f} ms)", 1e3 * s.duration.mean());
}

std::string sweeps_text(const TopicStatistics& topic) {
  const SweepStatistics& s = topic.sweeps;
  const double share = s.points.sum > 0 ? s.returns.sum / s.points.sum : 0;
  std::string text = fmt::format(
      "{:.0f} points a sweep, {:.1f} % of them returns; {}; ", s.points.mean(), 100.0 * share,
      s.with_rings > 0 && s.with_rings >= topic.with_points() ? "rings" : "no rings");
  text += s.with_doppler > 0 ? "Doppler speeds; " : "";
  return text + (topic.point_times ? times_text(*topic.point_times, s) : "no times");
}

/// The longest time at rest, and what the sensor read in it; empty without any.
std::string rest_text(const ImuStatistics& s) {
  const std::vector<RestStretch> stretches = rest_stretches(s.timeline);
  if (stretches.empty()) {
    return {};
  }
  const RestStretch& rest = *std::ranges::max_element(
      stretches, {}, [](const RestStretch& one) { return one.end - one.begin; });
  const Eigen::Vector3d bias = 1e3 * rest.gyro_bias;
  const Eigen::Vector3d& up = rest.acceleration;
  return fmt::format(
      "; at rest, or moving evenly, from {:.1f} to {:.1f} s after its first reading: gyroscope "
      "{:.2f}, {:.2f}, {:.2f} mrad/s, gravity {:.3f}, up {:.1f} degrees off its z",
      rest.begin, rest.end, bias.x(), bias.y(), bias.z(), up.norm(),
      std::atan2(std::hypot(up.x(), up.y()), up.z()) * kDegreesPerRadian);
}

std::string imu_text(const ImuStatistics& s) {
  if (s.rotation.count == 0) {
    return fmt::format("acceleration {:.3f} on average ({:.2f} to {:.2f}), no angular velocities",
                       s.acceleration.mean(), s.acceleration.least, s.acceleration.greatest);
  }
  return fmt::format(
             "acceleration {:.3f} on average ({:.2f} to {:.2f}), rotation {:.3f} rad/s (at most "
             "{:.2f})",
             s.acceleration.mean(), s.acceleration.least, s.acceleration.greatest,
             s.rotation.mean(), s.rotation.greatest) +
         rest_text(s);
}

/// What to set for a run to use velocities that it does not use.
std::string use_text(const std::string& topic) {
  return "to fuse it with the IMU: --set recording.velocity_topic=" + topic;
}

std::string velocities_text(const Topic& topic, const TopicStatistics& s, bool used) {
  const Extent& speed = s.velocities.speed;
  const std::string frame = s.frame.empty() ? "" : " of the frame '" + s.frame + "'";
  std::string text = fmt::format("velocities{}, {:.2f} m/s on average (at most {:.2f})", frame,
                                 speed.mean(), speed.greatest);
  return used ? text + "; a run fuses them with the IMU"
              : text + "; a run does not use them, since such messages may be commands; " +
                    use_text(topic.name);
}

std::string headings_text(const Topic& topic, const TopicStatistics& s, bool used) {
  return fmt::format("{} headings", s.headings) +
         (used ? "; a run uses them together with fixes"
               : "; a run does not use them, since an orientation does not say what it is measured "
                 "against; where that is true north: --set recording.heading_topic=" +
                     topic.name);
}

bool found(const Inspection& inspection, const std::string& kind, const std::string& topic) {
  return std::ranges::any_of(inspection.findings,
                             [&](const Finding& f) { return f.kind == kind && f.topic == topic; });
}

/// s to add to a topic's times where its clock is off by whole seconds or more.
double whole_offset(const Inspection& inspection, std::size_t topic) {
  const std::string& name = inspection.topics[topic].name;
  const bool off = std::ranges::any_of(inspection.findings, [&](const Finding& f) {
    return f.kind == "clock_offset" && f.topic == name && f.severity == Severity::problem;
  });
  return off ? std::round(inspection.statistics[topic].clock.typical_delay()) : 0.0;
}

std::optional<std::size_t> first_of(const Inspection& inspection, TopicKind kind,
                                    const std::optional<std::string>& name) {
  for (std::size_t i = 0; i < inspection.topics.size(); ++i) {
    const Topic& topic = inspection.topics[i];
    if (topic.kind == kind && (!name || topic.name == *name)) {
      return i;
    }
  }
  return std::nullopt;
}

void correct_sweeps(const Inspection& inspection, std::size_t topic, Config& config) {
  const TopicStatistics& s = inspection.statistics[topic];
  config.recording.sweep_topic = inspection.topics[topic].name;
  config.recording.sweep_time_offset += whole_offset(inspection, topic);
  if (!s.point_times_fit() && s.better_time_unit()) {
    config.recording.point_time_unit = *s.better_time_unit();
  }
}

/// imu.T_imu_lidar by the motion, where that tells it and the recording does not or is wrong.
std::optional<std::array<double, 7>> mounting_by_motion(const Inspection& inspection,
                                                        const MotionCheck& check) {
  constexpr double kWellKnown = 0.05;  // rad, standard deviation
  constexpr double kAway = 0.09;       // rad, from none: 5 degrees
  const RotationComparison& motion = *check.comparison;
  const bool told = check.pair.R_range_gyro.has_value();
  const bool wrong = told ? found(inspection, "mounting", check.pair.imu.name)
                          : motion.misalignment > kAway + 8.0 * motion.mounting_sigma.maxCoeff();
  if (!wrong || !(motion.mounting_sigma.maxCoeff() < kWellKnown)) {
    return std::nullopt;
  }
  Eigen::Isometry3d T_lidar_imu = Eigen::Isometry3d::Identity();
  if (const auto transform =
          inspection.frames.transform(inspection.statistics[check.pair.sweep_topic].frame,
                                      inspection.statistics[check.pair.imu_topic].frame)) {
    T_lidar_imu = *transform;
  }
  T_lidar_imu.linear() = motion.R_range_gyro;
  return numbers_of(T_lidar_imu.inverse());
}

void correct_imu(const Inspection& inspection, std::size_t topic, Config& config) {
  const std::string& name = inspection.topics[topic].name;
  const ImuStatistics& s = inspection.statistics[topic].imu;
  RecordingConfig& recording = config.recording;
  recording.imu_topic = name;
  recording.imu_time_offset += whole_offset(inspection, topic);
  for (const MotionCheck& check : inspection.motion) {
    if (check.pair.imu_topic != topic || !check.comparison) {
      continue;
    }
    // With rates that are 57 times too large the comparison finds 0.26 s where there are 5 ms: the
    // unit first, and what is left shows when the recording is inspected with it.
    if (found(inspection, "sensor_offset", name) && !found(inspection, "gyroscope_unit", name)) {
      recording.imu_time_offset -= check.comparison->offset;
    }
    if (const auto mounting = mounting_by_motion(inspection, check)) {
      config.imu.T_imu_lidar = mounting;
    }
  }
  if (found(inspection, "accelerometer_unit", name) &&
      s.acceleration.mean() < 0.5 * kStandardGravity) {
    recording.accelerometer_scale *= kStandardGravity;
  }
  const bool sure = std::ranges::any_of(inspection.findings, [&](const Finding& f) {
    return f.kind == "gravity_direction" && f.topic == name && f.severity == Severity::problem;
  });
  if (sure) {
    recording.accelerometer_scale *= -1.0;
  }
  if (found(inspection, "gyroscope_unit", name)) {
    recording.gyroscope_scale *= kDegree;
  }
}

}  // namespace

std::vector<Inference> infer(const Inspection& inspection) {
  std::vector<Inference> all;
  for (std::size_t i = 0; i < inspection.topics.size(); ++i) {
    const Topic& topic = inspection.topics[i];
    const TopicStatistics& s = inspection.statistics[i];
    if (topic.kind == TopicKind::sweeps && s.events > 0) {
      all.push_back({topic.name, sweeps_text(s)});
    } else if (topic.kind == TopicKind::imu && s.imu.acceleration.count > 0) {
      all.push_back({topic.name, imu_text(s.imu)});
    } else if (s.velocities.speed.count > 0) {
      all.push_back({topic.name, velocities_text(topic, s, inspection.sensors.velocity == i)});
    } else if (topic.kind == TopicKind::headings && s.headings > 0) {
      all.push_back({topic.name, headings_text(topic, s, inspection.sensors.heading == i)});
    } else if (has_velocities(topic) && s.events > 0) {
      const bool has_twist = topic.type == std::string_view(ros::Odometry::kType);
      all.push_back({topic.name, (has_twist ? "its twist is a velocity; "
                                            : "from pose to pose it is a velocity; ") +
                                     use_text(topic.name)});
    }
  }
  for (const MotionCheck& check : inspection.motion) {
    all.push_back({check.pair.imu.name, describe(check)});
  }
  for (const LidarMounting& mounting : inspection.lidars) {
    all.push_back({mounting.topic, describe(mounting)});
  }
  return all;
}

Config suggest_config(const Inspection& inspection, const Config& read_with) {
  Config config = read_with;
  const auto chosen = [&](std::optional<std::size_t> by_run, TopicKind kind,
                          const std::optional<std::string>& name) {
    return by_run ? by_run : first_of(inspection, kind, name);
  };
  if (const auto topic =
          chosen(inspection.sweeps, TopicKind::sweeps, read_with.recording.sweep_topic)) {
    correct_sweeps(inspection, *topic, config);
  }
  std::vector<std::array<double, 7>>& mountings = config.recording.T_lidar_further;
  for (std::size_t i = 0; i < inspection.lidars.size(); ++i) {
    const LidarMounting& mounting = inspection.lidars[i];
    const bool wrong = found(inspection, "lidar_mounting", mounting.topic);
    if (wrong || i < mountings.size()) {
      for (std::size_t k = mountings.size(); k <= i; ++k) {
        mountings.push_back(numbers_of(inspection.lidars[k].expected));
      }
      mountings[i] = numbers_of(wrong ? *mounting.found : mounting.expected);
    }
  }
  if (const auto topic =
          chosen(inspection.sensors.imu, TopicKind::imu, read_with.recording.imu_topic)) {
    correct_imu(inspection, *topic, config);
  }
  return config;
}

std::string suggested_toml(const Inspection& inspection, const Config& read_with) {
  std::string text;
  const auto comment = [&](const std::string& line) {
    std::string plain = as_utf8(line);
    std::ranges::replace_if(
        plain, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    text += "# " + plain + "\n";
  };
  comment(inspection.description);
  for (const Inference& one : infer(inspection)) {
    comment(one.topic + ": " + one.text);
  }
  for (const Finding& finding : inspection.findings) {
    comment(std::string(to_string(finding.severity)) + ": " +
            (finding.topic.empty() ? "" : finding.topic + ": ") + finding.found);
  }
  Config config = suggest_config(inspection, read_with);
  // The name of a folder, whose one topic need not be told.
  if (config.recording.sweep_topic &&
      as_utf8(*config.recording.sweep_topic) != *config.recording.sweep_topic) {
    config.recording.sweep_topic.reset();
  }
  return text + "\n" + to_toml(config);
}

}  // namespace adit
