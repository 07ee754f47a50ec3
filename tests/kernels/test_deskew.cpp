// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "adit/benchmarks/reference/deskew.hpp"
#include "adit/benchmarks/verify/cases.hpp"
#include "adit/benchmarks/verify/device_runs.hpp"
#include "adit/benchmarks/verify/verify.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/shared_data.hpp"

namespace adit {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

class DeskewKernel : public test::DeviceTest {
 protected:
  static std::vector<Point> moved(const std::vector<Point>& raw, const std::vector<float>& times,
                                  const SweepMotion& motion,
                                  const engine::DeskewSettings& settings) {
    test::DeskewRun deskew(context(), settings, raw, times, motion);
    deskew.run();
    return deskew.moved();
  }
};

engine::DeskewSettings settings_of(const SweepMotion& motion) {
  return test::deskew_settings(motion, 0.5);
}

TEST_F(DeskewKernel, PointsAreTheTwinsOnEveryCase) {
  for (const test::SweepCase& sweep : test::sweep_cases()) {
    for (const SweepMotion& motion : test::sweep_motions()) {
      SCOPED_TRACE(sweep.name);
      const std::vector<float> times = test::spread_times(sweep.raw.size(), motion);
      const engine::DeskewSettings settings = test::deskew_settings(motion, sweep.settings.c_min);
      const auto device = moved(sweep.raw, times, motion, settings);
      const auto twin = reference::deskew(sweep.raw, times, motion.T_start_lidar, settings);
      const test::Verdict verdict = test::verify_deskew(sweep.raw, twin, device);
      EXPECT_TRUE(verdict.passed()) << verdict.text();
      const auto again = moved(sweep.raw, times, motion, settings);
      EXPECT_TRUE(device.empty() ||
                  std::memcmp(device.data(), again.data(), device.size() * sizeof(Point)) == 0);
    }
  }
}

TEST_F(DeskewKernel, AWrongPointIsNoticed) {
  const SweepMotion motion = test::sweep_motions()[0];
  const test::SweepCase sweep = test::street_sweep(1000);
  const std::vector<float> times = test::spread_times(sweep.raw.size(), motion);
  const engine::DeskewSettings settings = settings_of(motion);
  const auto twin = reference::deskew(sweep.raw, times, motion.T_start_lidar, settings);
  std::vector<Point> device = moved(sweep.raw, times, motion, settings);
  ASSERT_TRUE(test::verify_deskew(sweep.raw, twin, device).passed());
  device[500].x += 1e-3F;
  device[501].intensity += 1.0F;
  EXPECT_EQ(test::verify_deskew(sweep.raw, twin, device).problems.size(), 2U);
  device[7].y = kNan;
  EXPECT_EQ(test::verify_deskew(sweep.raw, twin, device).problems.size(), 3U);
}

TEST_F(DeskewKernel, AStraightDriveIsKnownByHand) {
  Vector6d twist = Vector6d::Zero();
  twist[0] = 10.0;
  const SweepMotion motion = steady_motion(twist, 0.0, 0.1);
  const std::vector<Point> raw = {
      {5.0F, 1.0F, 2.0F, 9.0F}, {5.0F, 1.0F, 2.0F, 8.0F}, {5.0F, 1.0F, 2.0F, 7.0F}};
  const auto device = moved(raw, {0.0F, 0.05F, 0.1F}, motion, settings_of(motion));
  EXPECT_NEAR(device[0].x, 5.0, 1e-6);
  EXPECT_NEAR(device[1].x, 5.5, 1e-6);
  EXPECT_NEAR(device[2].x, 6.0, 1e-6);
  EXPECT_NEAR(device[2].y, 1.0, 1e-6);
  EXPECT_EQ(device[1].intensity, 8.0F);
}

TEST_F(DeskewKernel, TimesBeyondTheMotionAreHeldAndPointsWithoutATimeDropped) {
  Vector6d twist = Vector6d::Zero();
  twist[0] = 10.0;
  const SweepMotion motion = steady_motion(twist, 0.0, 0.1);
  const std::vector<Point> raw(4, {5.0F, 1.0F, 2.0F, 9.0F});
  const auto device = moved(raw, {-1.0F, 5.0F, kNan, std::numeric_limits<float>::infinity()},
                            motion, settings_of(motion));
  EXPECT_NEAR(device[0].x, 5.0, 1e-6);
  EXPECT_NEAR(device[1].x, 6.0, 1e-6);
  for (const size_t i : {size_t{2}, size_t{3}}) {
    EXPECT_EQ(device[i].x, 0.0F) << i;
    EXPECT_EQ(device[i].y, 0.0F) << i;
    EXPECT_EQ(device[i].z, 0.0F) << i;
  }
}

// ---- a real sensor (Newer College, beside the checkout) ----

std::vector<float> floats_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
  return values;
}

/// Rigid motion of `from` onto `to` with the least squares (Arun et al., 1987).
Eigen::Isometry3d fitted(const std::vector<Eigen::Vector3d>& from,
                         const std::vector<Eigen::Vector3d>& to) {
  Eigen::Matrix3Xd a(3, from.size());
  Eigen::Matrix3Xd b(3, to.size());
  for (size_t i = 0; i < from.size(); ++i) {
    a.col(static_cast<Eigen::Index>(i)) = from[i];
    b.col(static_cast<Eigen::Index>(i)) = to[i];
  }
  return Eigen::Isometry3d(Eigen::umeyama(a, b, false));
}

/// A sweep with its stored answer, all in the lidar's frame.
struct Answered {
  std::vector<Point> raw;
  std::vector<Eigen::Vector3d> lidar;
  std::vector<Eigen::Vector3d> expected;
  std::vector<float> times;
  double last = 0.0;  ///< s
};

Answered read_answered(const std::filesystem::path& folder, const std::string& name) {
  Eigen::Isometry3d T_answer_lidar = Eigen::Isometry3d::Identity();
  T_answer_lidar.linear().diagonal() << -1.0, -1.0, 1.0;
  T_answer_lidar.translation() << -0.009, 0.009, -0.029;
  const auto raw = floats_of(folder / ("raw_" + name + ".bin"));
  const auto answers = floats_of(folder / ("deskewed_" + name + ".bin"));
  Answered sweep;
  sweep.times = floats_of(folder / ("times_" + name + ".bin"));
  EXPECT_EQ(raw.size(), 3 * sweep.times.size());
  EXPECT_EQ(answers.size(), raw.size());
  for (size_t i = 0; i < sweep.times.size(); ++i) {
    const Eigen::Vector3f p(raw[3 * i], raw[3 * i + 1], raw[3 * i + 2]);
    const Eigen::Vector3f q(answers[3 * i], answers[3 * i + 1], answers[3 * i + 2]);
    sweep.raw.push_back({p.x(), p.y(), p.z(), 0.0F});
    sweep.lidar.push_back(p.cast<double>());
    sweep.expected.push_back(T_answer_lidar.inverse() * q.cast<double>());
    sweep.last = std::max(sweep.last, static_cast<double>(sweep.times[i]));
  }
  return sweep;
}

/// The motion that the answer was made with, as far as it shows: at each of the knots, what moves
/// the points of that time to where they are in the answer.
SweepMotion fitted_motion(const Answered& sweep) {
  SweepMotion motion{.first = 0.0, .last = sweep.last, .T_start_lidar = {}};
  const double step = sweep.last / (kMotionKnots - 1);
  for (int k = 0; k < kMotionKnots; ++k) {
    std::vector<Eigen::Vector3d> from;
    std::vector<Eigen::Vector3d> to;
    for (size_t i = 0; i < sweep.times.size(); ++i) {
      if (std::abs(static_cast<double>(sweep.times[i]) - k * step) < 0.25 * step) {
        from.push_back(sweep.lidar[i]);
        to.push_back(sweep.expected[i]);
      }
    }
    motion.T_start_lidar.push_back(from.size() >= 6               ? fitted(from, to)
                                   : motion.T_start_lidar.empty() ? Eigen::Isometry3d::Identity()
                                                                  : motion.T_start_lidar.back());
  }
  return motion;
}

double rms(const std::vector<Point>& points, const std::vector<Eigen::Vector3d>& expected) {
  double squares = 0.0;
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p(points[i].x, points[i].y, points[i].z);
    squares += (p.cast<double>() - expected[i]).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(points.size()));
}

// With the motion given, de-skewed points are the stored ones. (A constant twist, from the sweep's
// end, is not what a hand does: 10 to 20 cm.)
TEST_F(DeskewKernel, NewerCollegeSweepsAgreeWithTheStoredAnswer) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "deskew_newer_college");
  for (const std::string name : {"00", "01", "02"}) {
    SCOPED_TRACE(name);
    const Answered sweep = read_answered(folder, name);
    const SweepMotion motion = fitted_motion(sweep);
    const SweepMotion steady =
        steady_motion(se3_log(motion.T_start_lidar.back()) / sweep.last, 0.0, sweep.last);
    const engine::DeskewSettings settings{
        .c_min = 0.0, .c_max = 1000.0, .first_time = 0.0, .last_time = sweep.last};
    const double before = rms(sweep.raw, sweep.expected);
    const double after = rms(moved(sweep.raw, sweep.times, motion, settings), sweep.expected);
    const double constant = rms(moved(sweep.raw, sweep.times, steady, settings), sweep.expected);
    RecordProperty("rms_" + name, std::to_string(before) + " m raw, " + std::to_string(after) +
                                      " m de-skewed, " + std::to_string(constant) +
                                      " m at a constant twist");
    EXPECT_LE(after, 0.02);
    EXPECT_LE(constant, 0.15 * before);
  }
}

}  // namespace
}  // namespace adit
