// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A real inertial sensor (EuRoC V1_01: 200 Hz, beside the checkout) against motion capture.
#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "adit/slam/inertial/imu_buffer.hpp"
#include "adit/slam/inertial/imu_start.hpp"
#include "adit/slam/inertial/preintegration.hpp"
#include "adit/tests/support/shared_data.hpp"

namespace adit {
namespace {

using std::chrono::milliseconds;

constexpr ImuNoise kRecordedNoise{
    .gyro = 1.6968e-4, .accel = 2.0e-3, .gyro_walk = 1.9393e-5, .accel_walk = 3.0e-3};

/// A stamp in nanoseconds and `n` numbers a line, separated by commas; lines with # are comments.
template <int n>
std::vector<std::pair<Nanoseconds, Eigen::Matrix<double, n, 1>>> read_csv(
    const std::filesystem::path& file) {
  std::vector<std::pair<Nanoseconds, Eigen::Matrix<double, n, 1>>> rows;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#') {
      continue;
    }
    std::ranges::replace(line, ',', ' ');
    std::istringstream fields(line);
    int64_t stamp = 0;
    Eigen::Matrix<double, n, 1> values;
    fields >> stamp;
    for (int i = 0; i < n; ++i) {
      fields >> values[i];
    }
    EXPECT_TRUE(fields) << file << ": " << line;
    rows.emplace_back(Nanoseconds(stamp), values);
  }
  return rows;
}

struct Flight {
  ImuBuffer imu;
  std::vector<NavState> truth;  ///< at 20 Hz, with biases
};

Flight read_flight(const std::filesystem::path& folder) {
  Flight flight;
  for (const auto& [stamp, v] : read_csv<6>(folder / "imu.csv")) {
    EXPECT_EQ(flight.imu.push({stamp, v.head<3>(), v.tail<3>()}), ImuArrival::appended);
  }
  for (const auto& [stamp, v] : read_csv<16>(folder / "ground_truth.csv")) {
    NavState state;
    state.stamp = stamp;
    state.T_map_body.translation() = v.head<3>();
    state.T_map_body.linear() =
        Eigen::Quaterniond(v[3], v[4], v[5], v[6]).normalized().toRotationMatrix();
    state.v_map_body = v.segment<3>(7);
    state.bias = {v.segment<3>(10), v.segment<3>(13)};
    flight.truth.push_back(state);
  }
  return flight;
}

struct Medians {
  double rotation = 0.0;  ///< rad
  double velocity = 0.0;  ///< m/s
  double position = 0.0;  ///< m
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Errors of predictions from each true state over `steps` of the truth's 50 ms.
Medians prediction_errors(const Flight& flight, size_t steps) {
  std::vector<double> rotation;
  std::vector<double> velocity;
  std::vector<double> position;
  for (size_t i = 0; i + steps < flight.truth.size(); ++i) {
    const NavState& from = flight.truth[i];
    const NavState& to = flight.truth[i + steps];
    const ImuInterval interval = flight.imu.between(from.stamp, to.stamp);
    const Preintegration sum = preintegrate(interval.samples, from.bias, kRecordedNoise);
    const StateVector error = difference(to, predict(from, sum));
    rotation.push_back(error.segment<3>(kRotationAt).norm());
    velocity.push_back(error.segment<3>(kVelocityAt).norm());
    position.push_back(error.segment<3>(kPositionAt).norm());
  }
  return {median(rotation), median(velocity), median(position)};
}

void record(const std::string& name, const Medians& medians) {
  testing::Test::RecordProperty(name, std::to_string(1e3 * medians.rotation) + " mrad " +
                                          std::to_string(1e3 * medians.velocity) + " mm/s " +
                                          std::to_string(1e3 * medians.position) + " mm");
}

void record(const std::string& name, double bias_off, double up_off) {
  testing::Test::RecordProperty(
      name, std::to_string(bias_off) + " rad/s, up " + std::to_string(up_off) + " rad");
}

TEST(RecordedImu, PredictsATenthOfASecondAndASecond) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "imu_euroc_v1_01");
  const Flight flight = read_flight(folder);
  const Medians tenth = prediction_errors(flight, 2);
  const Medians whole = prediction_errors(flight, 20);
  record("tenth", tenth);
  record("second", whole);
  EXPECT_LE(tenth.rotation, 2e-3);
  EXPECT_LE(tenth.velocity, 0.02);
  EXPECT_LE(tenth.position, 0.005);
  EXPECT_LE(whole.rotation, 5e-3);
  EXPECT_LE(whole.velocity, 0.1);
  EXPECT_LE(whole.position, 0.05);
}

// It rests with its motors running before it takes off and after it has landed.
TEST(RecordedImu, FromRestTheGyroBiasIsTheTruths) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "imu_euroc_v1_01");
  const Flight flight = read_flight(folder);
  for (const auto& [begin, end] : {std::pair{1500, 2500}, std::pair{144'000, 145'500}}) {
    const Nanoseconds zero = flight.truth.front().stamp;
    const ImuStart start = start_at_rest(
        flight.imu.between(zero + milliseconds(begin), zero + milliseconds(end)).samples,
        kRecordedNoise);
    ASSERT_EQ(start.status, ImuStartStatus::at_rest) << to_string(start.status);
    const auto same_time = [&](const NavState& state) {
      return state.stamp >= zero + milliseconds(end) || &state == &flight.truth.back();
    };
    const NavState& truth = *std::ranges::find_if(flight.truth, same_time);
    const double bias_off = (start.bias.gyro - truth.bias.gyro).norm();
    const double up_off =
        std::acos((truth.T_map_body.linear() * start.up_body).dot(Eigen::Vector3d::UnitZ()));
    record("rest " + std::to_string(begin), bias_off, up_off);
    EXPECT_LE(bias_off, 5e-3);
    EXPECT_LE(up_off, 0.03);
  }
}

// Every start within the flight, with the truth's poses in place of alignments.
TEST(RecordedImu, StartsInFlight) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "imu_euroc_v1_01");
  const Flight flight = read_flight(folder);
  int started = 0;
  int tried = 0;
  std::vector<double> tilt;
  std::vector<double> velocity;
  std::vector<double> bias;
  for (size_t i = 200; i + 32 < flight.truth.size(); i += 100) {
    std::vector<StampedPose> poses;
    std::vector<std::vector<ImuSample>> readings;
    for (size_t k = i; k <= i + 30; k += 2) {
      poses.push_back({flight.truth[k].stamp, flight.truth[k].T_map_body});
      if (k > i) {
        readings.push_back(
            flight.imu.between(flight.truth[k - 2].stamp, flight.truth[k].stamp).samples);
      }
    }
    const ImuStart start = start_in_motion(poses, readings, kRecordedNoise);
    ++tried;
    if (!is_started(start.status)) {
      continue;
    }
    ++started;
    const NavState& truth = flight.truth[i + 30];
    tilt.push_back(std::acos(-start.gravity_map.normalized().z()));
    velocity.push_back((start.v_map_body - truth.v_map_body).norm());
    bias.push_back((start.bias.gyro - truth.bias.gyro).norm());
    EXPECT_EQ(start.accel_scale, 1.0) << i;
  }
  RecordProperty("started", std::to_string(started) + " of " + std::to_string(tried));
  RecordProperty("tilt", std::to_string(median(tilt)));
  RecordProperty("velocity", std::to_string(median(velocity)));
  RecordProperty("gyro_bias", std::to_string(median(bias)));
  EXPECT_GE(started, tried - 1);
  EXPECT_LE(median(tilt), 0.02);
  EXPECT_LE(median(velocity), 0.1);
  EXPECT_LE(median(bias), 5e-3);
}

}  // namespace
}  // namespace adit
