// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A lidar with an IMU and a GNSS receiver that drive swaying down a made-up street, as events: what
// a recorder would store of them. Every reading follows from one closed form of the motion.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/core/lie.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/recordings/ros_events.hpp"

namespace adit::test {

/// One event and the topic it goes to.
struct Recorded {
  std::string topic;
  Nanoseconds received{0};
  EventValue value;
};

struct MovingRig {
  uint64_t seed = 0;  ///< seed of the street, the motion and the noise
  int tenths = 60;    ///< s/10, one sweep each
  Eigen::Isometry3d T_lidar_imu = Eigen::Isometry3d::Identity();
  Lidar lidar{.beams = 24, .columns = 300};
  double sway = 1.0;  ///< factor on its turning

  static constexpr Nanoseconds kBegin{1623370000000000000};

  /// T_world_lidar, s after kBegin.
  Eigen::Isometry3d pose(double t) const {
    const double phase = 0.7 * static_cast<double>(seed);
    const double yaw = 0.35 * std::sin(0.9 * t + phase) + 0.1 * std::sin(2.3 * t + 2.0 * phase);
    const double pitch = 0.06 * std::sin(1.7 * t + phase);
    const double roll = 0.08 * std::sin(2.1 * t - phase);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = so3_exp({0.0, 0.0, sway * yaw}) * so3_exp({0.0, sway * pitch, 0.0}) *
                 so3_exp({sway * roll, 0.0, 0.0});
    T.translation() << 3.0 * t, 0.4 * std::sin(0.5 * t), 1.8;
    return T;
  }

  /// Columns one after the other, each from where the lidar is by then.
  Sweep sweep(const World& world, int tenth) const {
    Random random(1000 * seed + static_cast<uint64_t>(tenth));
    Sweep sweep;
    sweep.stamp = kBegin + Nanoseconds(100000000LL * tenth);
    for (int column = 0; column < lidar.columns; ++column) {
      const double after = 0.1 * column / lidar.columns;
      const Eigen::Isometry3d T = pose(0.1 * tenth + after);
      const double azimuth = 2.0 * std::numbers::pi * column / lidar.columns;
      for (int beam = 0; beam < lidar.beams; ++beam) {
        const double elevation =
            lidar.lowest + (lidar.highest - lidar.lowest) * beam / (lidar.beams - 1);
        const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth),
                                  std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
        const double distance = cast(world, T.translation(), T.linear() * ray);
        const bool hit = distance < lidar.max_range;
        const double measured = hit ? distance + lidar.range_noise * random.gaussian() : 0.0;
        const Eigen::Vector3f p = (measured * ray).cast<float>();
        sweep.points.push_back({p.x(), p.y(), p.z(), 0.5F});
        sweep.times.push_back(static_cast<float>(after));
        sweep.rings.push_back(static_cast<uint16_t>(beam));
      }
    }
    return sweep;
  }

  ImuSample imu(Nanoseconds stamp, Random& random) const {
    const double t = std::chrono::duration<double>(stamp - kBegin).count();
    const auto at = [&](double time) { return pose(time) * T_lidar_imu; };
    constexpr double kStep = 1e-3;
    const Eigen::Isometry3d here = at(t);
    const Eigen::Isometry3d before = at(t - kStep);
    const Eigen::Isometry3d after = at(t + kStep);
    const auto noise = [&](double sigma) {
      return Eigen::Vector3d(sigma * random.gaussian(), sigma * random.gaussian(),
                             sigma * random.gaussian());
    };
    const Eigen::Vector3d acceleration =
        (after.translation() - 2.0 * here.translation() + before.translation()) / (kStep * kStep);
    return {
        .stamp = stamp,
        .angular_velocity = so3_log(before.linear().transpose() * after.linear()) / (2.0 * kStep) +
                            Eigen::Vector3d(0.004, -0.003, 0.002) + noise(0.002),
        .linear_acceleration =
            here.linear().transpose() * (acceleration + Eigen::Vector3d(0.0, 0.0, 9.80665)) +
            noise(0.02)};
  }

  /// Sweeps at 10 Hz, an IMU at 200 Hz whose clock jitters by 0.2 ms, GNSS at 1 Hz and how the
  /// sensors are mounted. All is received a little late, by different amounts.
  std::vector<Recorded> record() const {
    const World world = make_street(0.3 * tenths, seed + 1);
    Random random(seed + 77);
    std::vector<Recorded> events;
    for (const auto& [child, T] :
         {std::pair{"lidar", Eigen::Isometry3d::Identity()}, std::pair{"imu", T_lidar_imu}}) {
      events.push_back({"/tf_static", kBegin, StaticTransform{"base_link", child, T}});
    }
    for (int i = 0; i < 20 * tenths; ++i) {
      const Nanoseconds stamp =
          kBegin +
          Nanoseconds(5000000LL * i + static_cast<int64_t>(random.uniform(-200000.0, 200000.0)));
      const Nanoseconds received =
          stamp + Nanoseconds(static_cast<int64_t>(random.uniform(1e6, 3e6)));
      events.push_back({"/imu", received, imu(stamp, random)});
      if (i % 20 == 19) {
        Sweep turn = sweep(world, i / 20);
        const Nanoseconds end = turn.stamp + Nanoseconds(102000000);
        events.push_back({"/points", end, std::move(turn)});
      }
      if (i % 200 == 100) {
        events.push_back({"/fix", received,
                          GnssFix{.stamp = stamp,
                                  .kind = GnssFixKind::single,
                                  .latitude = 41.65,
                                  .longitude = -0.88,
                                  .altitude = 220.0,
                                  .covariance = Eigen::Matrix3d::Identity()}});
      }
    }
    return events;
  }
};

/// The frame of a topic is its name without the slash; that of /points is "lidar". `clocks` are
/// topics of rosgraph_msgs/Clock, with one message each.
inline std::filesystem::path write_mcap(const std::filesystem::path& file,
                                        const std::vector<Recorded>& events,
                                        const std::vector<std::string>& clocks = {}) {
  McapWriter writer(file, {.chunk_bytes = 200000});
  for (const std::string& clock : clocks) {
    const std::size_t channel = writer.add_channel({.topic = clock,
                                                    .type = "rosgraph_msgs/Clock",
                                                    .encoding = Encoding::cdr,
                                                    .definition = {},
                                                    .messages = std::nullopt});
    const std::array<std::byte, 12> time{std::byte{0}, std::byte{1}};
    writer.write(channel, events.front().received, time);
  }
  std::map<std::string, std::size_t> channels;
  for (const Recorded& event : events) {
    const std::string frame = event.topic == "/points" ? "lidar" : event.topic.substr(1);
    const ros::EncodedEvent message = ros::from_event(event.value, Encoding::cdr, frame);
    if (!channels.contains(event.topic)) {
      channels[event.topic] = writer.add_channel({.topic = event.topic,
                                                  .type = message.type,
                                                  .encoding = Encoding::cdr,
                                                  .definition = {},
                                                  .messages = std::nullopt});
    }
    writer.write(channels[event.topic], event.received, message.bytes);
  }
  writer.close();
  return file;
}

}  // namespace adit::test
