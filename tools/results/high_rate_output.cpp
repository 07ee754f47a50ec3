// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/high_rate_output.hpp"

#include <string_view>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/text.hpp"

namespace adit {
namespace {

constexpr double kInterruption = 0.1;  // s

std::string header() {
  std::string line =
      "stamp_s,x_m,y_m,z_m,qx,qy,qz,qw,vx_m_per_s,vy_m_per_s,vz_m_per_s,wx_rad_per_s,wy_rad_per_s,"
      "wz_rad_per_s";
  for (std::size_t i = 0; i < kTangentNames.size(); ++i) {
    for (std::size_t j = i; j < kTangentNames.size(); ++j) {
      line += ",cov_" + std::string(kTangentNames[i]) + "_" + std::string(kTangentNames[j]);
    }
  }
  return line + "\n";
}

/// A millionth of a part is enough for rates and covariances: half the length of a double's text.
void append_single(std::string& line, double value) {
  line += shortest(static_cast<float>(value));
}

std::string csv_line(const LidarMotion& motion) {
  std::string line;
  append_stamp(line, motion.stamp);
  const auto put = [&](double value) {
    line += ',';
    append_single(line, value);
  };
  Eigen::Quaterniond q(motion.T_map_lidar.linear());
  q.normalize();
  if (q.w() < 0.0) {
    q.coeffs() = -q.coeffs();
  }
  const Eigen::Vector3d p = motion.T_map_lidar.translation();
  for (const double value : {p.x(), p.y(), p.z()}) {
    line += fmt::format(",{:.6f}", value);  // a micrometre, however far from the origin
  }
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) {
    put(value);
  }
  for (const Eigen::Vector3d& vector : {motion.v_map_lidar, motion.angular_velocity}) {
    put(vector.x());
    put(vector.y());
    put(vector.z());
  }
  for (Eigen::Index i = 0; i < 9; ++i) {
    for (Eigen::Index j = i; j < 9; ++j) {
      put(motion.covariance(i, j));
    }
  }
  return line + "\n";
}

}  // namespace

void HighRateStatistics::add(Nanoseconds stamp) {
  if (poses_ > 0) {
    const double interval = seconds(stamp - last_);
    const bool interrupted = interval > kInterruption;
    interruptions_ += interrupted ? 1 : 0;
    intervals_ += interrupted ? 0 : 1;
    span_ += interrupted ? 0.0 : interval;
  }
  ++poses_;
  last_ = stamp;
}

std::optional<double> HighRateStatistics::rate() const {
  return intervals_ > 0 ? std::optional(static_cast<double>(intervals_) / span_) : std::nullopt;
}

HighRateOutput::HighRateOutput(const std::filesystem::path& folder)
    : tum_(HighRateFiles(folder).tum, TrajectoryFormat::tum), csv_(HighRateFiles(folder).csv) {
  csv_.write(header());
}

void HighRateOutput::write(const LidarMotion& motion) {
  // Times in a trajectory rise: where the clock was set back, they do again once it is past that.
  if (statistics_.last() && motion.stamp <= *statistics_.last()) {
    return;
  }
  tum_.write({.stamp = motion.stamp, .pose = motion.T_map_lidar});
  csv_.write(csv_line(motion));
  statistics_.add(motion.stamp);
}

void HighRateOutput::flush() {
  tum_.flush();
  csv_.flush();
}

void HighRateOutput::close() {
  tum_.close();
  csv_.close();
}

nlohmann::ordered_json to_json(const HighRateStatistics& statistics) {
  const std::optional<double> rate = statistics.rate();
  return {{"poses", statistics.poses()},
          {"rate_hz", rate ? nlohmann::ordered_json(*rate) : nlohmann::ordered_json()},
          {"interruptions", statistics.interruptions()}};
}

std::string describe(const HighRateStatistics& statistics) {
  std::string text = std::to_string(statistics.poses()) + " poses";
  if (const std::optional<double> rate = statistics.rate()) {
    text += fmt::format(" at {:.1f} Hz", *rate);
  }
  if (statistics.poses() == 0) {
    return text + ": the IMU was never fused";
  }
  return statistics.interruptions() == 0
             ? text
             : text + ", " + std::to_string(statistics.interruptions()) +
                   " interruption(s) while it was not fused";
}

}  // namespace adit
