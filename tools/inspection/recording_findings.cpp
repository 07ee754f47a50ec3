// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/recording_findings.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "adit/slam/core/config.hpp"
#include "adit/slam/core/text.hpp"
#include "adit/slam/core/units.hpp"

#include "adit/tools/clouds/cloud_origin.hpp"
#include "adit/tools/containers/declaration_error.hpp"
#include "adit/tools/inspection/clock_findings.hpp"
#include "adit/tools/inspection/topic_findings.hpp"
#include "adit/tools/report/inertial_text.hpp"

namespace adit {
namespace {

constexpr double kLongUnchanged = 5.0;  // s
constexpr double kScaleError = 0.04;    // share of gravity: sensors that are right stay below
/// Measurements that arrive out of order are sorted within this (SensorFeed).
constexpr double kSorted = 0.5;  // s

std::string of(uint64_t part, uint64_t whole) {
  return std::to_string(part) + " of " + std::to_string(whole);
}

/// Whether a run makes up for stamps of that kind.
struct StampsHandled {
  bool repeats = false;
  bool order = false;
  bool gaps = false;
};

StampsHandled handled_stamps(const Topic& topic, const StampStatistics& s) {
  const bool imu = topic.kind == TopicKind::imu;
  return {.repeats = (imu || topic.kind == TopicKind::gnss) && 2 * s.repeated <= s.events,
          .order = imu && s.farthest_back < kSorted,
          .gaps = topic.kind == TopicKind::gnss || topic.kind == TopicKind::velocities ||
                  topic.kind == TopicKind::headings ||
                  (imu && s.largest_interval <= ImuConfig{}.max_gap)};
}

/// Checks one series of a topic, `of_what` for people. Poses are only looked at, not mapped with:
/// what is odd about their stamps is no problem.
void check_stamps(const Topic& topic, const TopicStatistics& statistics, const StampStatistics& s,
                  const std::string& of_what, TopicFindings& findings) {
  const bool poses = topic.kind == TopicKind::poses && statistics.velocities.speed.count == 0;
  const auto add = [&](const char* kind, const std::string& found, bool handled, const char* how,
                       const char* effect, const char* remedy) {
    if (poses) {
      findings.notice(kind, of_what + found, "none for mapping, which does not use them", remedy);
    } else if (handled) {
      findings.handled(kind, of_what + found, how);
    } else {
      findings.problem(kind, of_what + found, effect, remedy);
    }
  };
  const StampsHandled handled = handled_stamps(topic, s);
  if (s.repeated > 0) {
    add("repeated_stamps", of(s.repeated, s.events) + " messages have the time of the one before",
        handled.repeats, "the repeats are left out",
        "measurements counted twice, or a clock that stands still",
        "Record without the second publisher, or leave the repeats out");
  }
  uint64_t ahead = 0;
  uint64_t back = 0;
  bool step_is_longest = false;
  for (const ClockStep& step : poses ? std::vector<ClockStep>{} : statistics.clock.steps()) {
    (step.seconds > 0.0 ? ahead : back) += 1;
    step_is_longest = step_is_longest || std::abs(s.largest_interval - step.seconds) < 1.0;
  }
  if (s.backwards > back) {
    add("stamps_go_back", of(s.backwards, s.events) + " messages have a time before the one before",
        handled.order, "they are put in order", "their order cannot be told",
        "Check the sensor's clock and its publishers");
  }
  // A leap of the clock is no gap.
  const uint64_t gaps = s.gaps() - (step_is_longest ? std::min(s.gaps(), ahead) : 0U);
  if (gaps > 0 && s.tells_gaps()) {
    const std::chrono::duration<double> at = s.largest_interval_at - statistics.stamps->begin;
    add("gaps",
        std::to_string(gaps) + (gaps == 1 ? " gap" : " gaps") + ", the longest of " +
            with_decimals(s.largest_interval, 3) + " s, where " + with_decimals(s.period(), 4) +
            " s is usual; it starts " + with_decimals(at.count(), 3) + " s after the first",
        handled.gaps,
        topic.kind == TopicKind::gnss         ? "the map continues without fixes meanwhile"
        : topic.kind == TopicKind::velocities ? "mapping continues without velocities meanwhile"
        : topic.kind == TopicKind::headings   ? "the map continues without headings meanwhile"
                                              : "gaps up to imu.max_gap are bridged",
        "the motion within is guessed", "Check the connection and the recorder's load");
  }
}

/// Gravity's direction in the frame that all others are mounted to and in that of the range sensor.
/// Either sensor may be mounted upside down, but both frames are only where the sign is wrong.
void check_gravity(const TopicStatistics& topic, const FrameTree& frames,
                   const std::string& range_frame, TopicFindings& findings) {
  const Eigen::Vector3d& a = topic.imu.mean_acceleration;
  if (a.norm() < 0.5 * topic.imu.acceleration.mean()) {
    return;  // no direction
  }
  const auto is_down = [](const Eigen::Vector3d& v) { return v.normalized().z() < -0.7; };
  const bool known = frames.knows(topic.frame);
  const auto mounting = known ? std::optional(frames.mounting(topic.frame)) : std::nullopt;
  const auto T_range_imu = known ? frames.transform(range_frame, topic.frame) : std::nullopt;
  if (!is_down(mounting ? Eigen::Vector3d(mounting->T_root_frame.linear() * a) : a) ||
      (T_range_imu && !is_down(T_range_imu->linear() * a))) {
    return;
  }
  if (mounting) {
    findings.problem("gravity_direction",
                     "as /tf_static mounts it, it reads gravity along -z of " + mounting->root +
                         " (the usual reading is +9.8 along z)",
                     "the sweeps contradict it once the sensor moves, and it is left out",
                     "Negate its accelerations if the driver flips the sign "
                     "(recording.accelerometer_scale = -1), else correct the transform");
  } else {
    findings.notice("gravity_direction",
                    "at rest it reads gravity along -z: it is mounted upside down, or its driver "
                    "flips the sign (the usual reading is +9.8 along z)",
                    "with the wrong sign the sweeps contradict it, and it is left out",
                    "Compare with how it is mounted");
  }
}

/// What it read in its longest time at rest, or moving evenly.
std::optional<double> gravity_at_rest(const ImuStatistics& s) {
  const std::vector<RestStretch> stretches = rest_stretches(s.timeline);
  if (stretches.empty()) {
    return std::nullopt;
  }
  const RestStretch& longest = *std::ranges::max_element(
      stretches, {}, [](const RestStretch& one) { return one.end - one.begin; });
  return longest.acceleration.norm();
}

void check_imu(const ImuStatistics& s, TopicFindings& findings) {
  const uint64_t readings = s.acceleration.count + s.spikes + s.impossible;
  if (s.not_finite > 0) {
    findings.left_out("not_finite", s.not_finite, readings + s.not_finite,
                      std::to_string(s.not_finite) + " samples have no finite numbers",
                      "Check the driver");
  }
  if (s.spikes > 0) {
    findings.left_out("spikes", s.spikes, readings,
                      of(s.spikes, readings) +
                          " samples are spikes: far from those before and after them, which agree",
                      "Check the sensor's cable, supply and driver");
  }
  if (s.stuck) {
    findings.problem("stuck_axis", describe(*s.stuck), "mapping goes on without it meanwhile",
                     "Check the sensor and its driver");
  } else if (s.unchanged && s.unchanged->duration > kLongUnchanged) {
    findings.notice("unchanged_axis",
                    describe(*s.unchanged) + ", though little: it may be stuck, or its driver " +
                        "rounds what is small",
                    "where it is stuck, mapping goes on without it meanwhile",
                    "Turn the sensor about that axis, and see whether it shows");
  }
  if (s.impossible > 0) {
    findings.left_out("impossible_readings", s.impossible, readings,
                      of(s.impossible, readings) +
                          " samples are beyond what sensors read (imu.max_rate, "
                          "imu.max_acceleration)",
                      "Check the sensor's cable, supply and driver");
  }
  if (s.acceleration.count == 0) {
    return;
  }
  if (s.rotation.count == 0) {
    findings.notice("no_gyroscope", "it has no angular velocities",
                    "it is not used: the motion between sweeps needs them",
                    "Record a whole inertial sensor");
  }
  const double norm = s.acceleration.mean();
  const bool stuck_accelerometer = s.stuck && !s.stuck->gyroscope;
  const std::string mean = "the acceleration is " + with_decimals(norm, 3) + " on average";
  if (norm > 0.8 && norm < 1.3) {
    findings.handled("accelerometer_unit", mean + ": it is in g, not in m/s²",
                     "the start of the IMU finds the unit");
  } else if (norm > 1.3 * kStandardGravity ||
             (norm < 0.8 * kStandardGravity && !stuck_accelerometer)) {
    findings.problem("accelerometer_unit", mean + ", neither 1 g nor 9.8 m/s²",
                     "gravity cannot be told", "Check the accelerometer's unit and range");
  }
  if (const auto gravity = gravity_at_rest(s);
      gravity && norm >= 0.8 * kStandardGravity &&
      std::abs(*gravity / kStandardGravity - 1.0) > kScaleError) {
    findings.problem(
        "accelerometer_scale",
        "it reads " + with_decimals(*gravity, 3) + " m/s² at rest, " +
            with_decimals(100.0 * (*gravity / kStandardGravity - 1.0), 1) +
            " % off gravity: its scale is off",
        "velocities and heights drift, or it is left out",
        "Set recording.accelerometer_scale = " + with_decimals(kStandardGravity / *gravity, 4));
  }
  // 35 rad/s are 2000 degrees/s, the range of most sensors; a tenth of that on average is no
  // motion.
  if (s.rotation.mean() > 3.5) {
    findings.problem("gyroscope_unit",
                     "it turns at " + with_decimals(s.rotation.mean(), 1) +
                         " rad/s on average: its rates may be in degrees per second",
                     "the sweeps contradict it, and it is left out",
                     "Set recording.gyroscope_scale = 0.0174533 where they are");
  }
}

/// For a remedy: the unit that would make the times fit, if one does.
std::string better_unit(const TopicStatistics& topic) {
  const std::optional<double> unit = topic.better_time_unit();
  return unit ? fmt::format("Set recording.point_time_unit = {:g}", *unit)
              : "Set recording.point_time_unit to the seconds that a step of the times is";
}

void check_sweeps(const TopicStatistics& topic, TopicFindings& findings) {
  const SweepStatistics& s = topic.sweeps;
  if (s.empty > 0) {
    findings.problem("empty_sweeps", of(s.empty, topic.events) + " sweeps are empty: no return",
                     "they cannot be placed", "Check the sensor and its filters");
  }
  if (!s.offset.isZero(0.0)) {
    findings.notice("large_coordinates",
                    "its points lie about " + offset_text(s.offset) + " from the origin",
                    "adit subtracts that from all clouds, so that they keep their millimetres: "
                    "ranges are measured from there, and results are relative to it",
                    "Add it to the results for the coordinates of the recording");
  }
  if (s.coordinate_step > 0.0) {
    findings.problem("coarse_coordinates", coarse_note(s.coordinate_step),
                     "surfaces are rounded away", "Export the clouds again");
  }
  // Sweeps without points have no times for want of points.
  if (s.with_times < topic.with_points()) {
    findings.notice(
        "no_point_times",
        of(topic.with_points() - s.with_times, topic.with_points()) +
            " sweeps have no time per point",
        "motion within a sweep cannot be corrected",
        "Record with a driver that writes them (a field time, t or timestamp). A scanner that "
        "turns "
        "about its z axis, and whose sweeps nobody has corrected, can be told: "
        "recording.spin_rate = -10 (turns a second, clockwise seen from above)");
  }
  if (s.duration.count > 1 && s.duration.greatest <= 0.0 && s.points.greatest > 1.0) {
    findings.notice("no_point_times", "all points of a sweep have the same time",
                    "motion within a sweep cannot be corrected",
                    "Sensors that measure all at once have it so. Of a scanner the driver has left "
                    "the field empty: set the model of the sensor in its parameters");
  }
  if (const std::optional<Sector> sector = s.blocked_sector()) {
    findings.notice("blocked_sector",
                    "nothing is seen from azimuth " + with_decimals(sector->begin, 0) + " to " +
                        with_decimals(sector->end, 0) + " degrees (from x towards y)",
                    "none as long as the other directions tell the motion",
                    "Expected where the vehicle or its carrier hides them, or where the sensor is "
                    "set so; else clean the sensor");
  }
  if (s.not_finite > 0) {
    findings.notice("nan_points",
                    with_decimals(100.0 * static_cast<double>(s.not_finite) / s.points.sum, 2) +
                        " % of the points are not finite (NaN): the driver's no-returns",
                    "none, they are left out", "Nothing need be done");
  }
  if (!topic.point_times_fit()) {
    findings.problem("point_time_unit",
                     "by its points' times a sweep lasts " + with_decimals(s.duration.mean(), 6) +
                         " s, but the sweeps follow each other every " +
                         with_decimals(topic.period(), 4) + " s",
                     "motion within a sweep would be corrected wrongly", better_unit(topic));
  }
}

void check_gnss(const TopicStatistics& topic, TopicFindings& findings) {
  const GnssStatistics& s = topic.gnss;
  if (s.without_fix > 0) {
    findings.notice("no_fix", of(s.without_fix, topic.events) + " messages are without a fix",
                    "they are not used", "Expected where the sky is not seen");
  }
  if (s.without_covariance > 0) {
    findings.notice("no_covariance",
                    of(s.without_covariance, topic.events) + " messages have no covariance",
                    "how far they can be trusted is guessed", "Configure the receiver's driver");
  }
}

void check_velocities(const TopicStatistics& topic, TopicFindings& findings) {
  const VelocityStatistics& s = topic.velocities;
  if (s.not_finite > 0) {
    findings.left_out("not_finite", s.not_finite, topic.events,
                      of(s.not_finite, topic.events) + " velocities have no finite number",
                      "Check the driver");
  }
  if (s.speed.count > 0 && s.moving == 0) {
    findings.notice("velocities_zero", "all of its velocities are zero",
                    "where the sensor moves meanwhile they are wrong",
                    "Check the driver, or leave recording.velocity_topic unset");
  }
  if (s.without_covariance > 0) {
    findings.notice("no_covariance",
                    of(s.without_covariance, topic.events) +
                        " velocities have no covariance, or an impossible one",
                    "their standard deviation is velocity.sigma",
                    "Set velocity.sigma to what the source is worth");
  }
}

}  // namespace

std::string_view to_string(Severity severity) {
  return severity == Severity::problem ? "problem" : "notice";
}

bool has_simulated_time(const std::vector<Topic>& topics) {
  return std::ranges::any_of(
      topics, [](const Topic& topic) { return topic.type == "rosgraph_msgs/Clock"; });
}

std::vector<Finding> find_in_topic(const Topic& topic, const TopicStatistics& statistics,
                                   const FrameTree& frames, const OtherTopics& others) {
  std::vector<Finding> all;
  TopicFindings findings(topic, all);
  if (statistics.events == 0 && topic.kind == TopicKind::sweeps && topic.messages != 0U) {
    findings.problem("no_events", "not one sweep could be made of what it holds",
                     "there is nothing to map with",
                     "Look at the damage that is listed; else the sensor has sent no valid data");
  }
  if (statistics.events == 0 || topic.kind == TopicKind::transforms) {
    return all;
  }
  if (!others.simulated_time) {
    check_clock(topic, statistics, others.shared_clock, findings);
  }
  for (const auto& [name, one] : statistics.series) {
    const bool named = statistics.series.size() > 1;
    check_stamps(topic, statistics, one, named ? "of frame '" + name + "' " : "", findings);
  }
  if (topic.kind == TopicKind::imu) {
    check_imu(statistics.imu, findings);
    check_gravity(statistics, frames, others.range_frame, findings);
  } else if (topic.kind == TopicKind::sweeps) {
    check_sweeps(statistics, findings);
  } else if (topic.kind == TopicKind::gnss) {
    check_gnss(statistics, findings);
  } else if (statistics.velocities.speed.count + statistics.velocities.not_finite > 0) {
    check_velocities(statistics, findings);
  }
  return all;
}

std::vector<Finding> find_in_recording(const std::vector<Topic>& topics) {
  std::vector<Finding> findings;
  const auto sweeps = std::ranges::find(topics, TopicKind::sweeps, &Topic::kind);
  if (sweeps == topics.end()) {
    findings.push_back(
        {Severity::problem, "no_sweeps", "", "there are no sweeps of a range sensor in it",
         "there is nothing to map with", "Record a topic of sensor_msgs/PointCloud2"});
  } else if (std::ranges::all_of(topics, [](const Topic& topic) {
               return topic.kind != TopicKind::sweeps || topic.messages == 0U;
             })) {
    findings.push_back({Severity::problem, "no_sweeps", sweeps->name, "it holds no sweep",
                        "there is nothing to map with",
                        "Check the sensor and its driver; of a recording that was cut to a part, "
                        "take a longer one"});
  }
  if (has_simulated_time(topics)) {
    findings.push_back({Severity::notice, "simulated_time", "",
                        "it has a clock (rosgraph_msgs/Clock): its stamps are of simulated or "
                        "replayed time (use_sim_time)",
                        "none; stamps are not compared with the recorder's clock",
                        "Nothing need be done"});
  }
  for (const Topic& topic : topics) {
    const bool depth = topic.name.find("depth") != std::string::npos;
    if (topic.type == "sensor_msgs/CompressedImage" && topic.name.ends_with("/compressedDepth")) {
      findings.push_back({Severity::notice, "compressed_depth", topic.name,
                          "its depth images are compressed, which is not read",
                          "they are no sweeps",
                          "Record the topic without /compressedDepth, or let image_transport's "
                          "republish write it"});
    } else if (topic.type == "sensor_msgs/Image" && topic.kind == TopicKind::other && depth) {
      findings.push_back({Severity::notice, "depth_without_camera", topic.name,
                          "its images have no calibration that makes sense "
                          "(sensor_msgs/CameraInfo on camera_info beside it), or are no depths",
                          "they are no sweeps", "Record the camera's camera_info too"});
    }
  }
  return findings;
}

Finding damage_finding(const InputError& error) {
  const std::string place = error.place().empty() ? "" : " (" + error.place() + ")";
  if (const auto* declared = dynamic_cast<const DeclarationError*>(&error)) {
    return {
        Severity::problem,
        "declaration",
        declared->topic(),
        error.file().filename().string() + ": " + error.found(),
        !declared->loses() ? "nothing that is there is lost" : "what is missing cannot be mapped",
        error.remedy()};
  }
  return {Severity::problem,
          "damage",
          "",
          error.file().filename().string() + place + ": " + error.found(),
          "what lies there is missing",
          error.remedy()};
}

}  // namespace adit
