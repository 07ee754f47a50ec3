// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/sweep_table.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

SweepResult fused_sweep() {
  SweepResult sweep;
  sweep.stamp = Nanoseconds(1'700'000'000'123'456'789);
  sweep.state = OdometryState::tracking;
  sweep.registration.status = RegistrationStatus::degenerate;
  sweep.registration.overlap = 0.75;
  sweep.registration.T_target_source.linear() =
      Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  sweep.registration.translation[0] = {.axis = Eigen::Vector3d::UnitX(),
                                       .localizability = Localizability::none,
                                       .information = 4.0,
                                       .support = 0.5};
  sweep.inertial.state = InertialState::fused;
  sweep.inertial.nav = NavState{};
  sweep.inertial.nav->bias.gyro = {0.01, -0.02, 0.03};
  sweep.inertial.nav_covariance.diagonal().setConstant(0.25);
  sweep.inertial.innovation = {.error = Vector6d::LinSpaced(1.0, 6.0), .nis = 7.5, .degrees = 5};
  sweep.inertial.innovation_gate = 205.2;
  const Vector6d any = Vector6d::LinSpaced(0.1, 0.6);
  sweep.uncertainty = {.local = any * any.transpose(), .drift = 0.5 * Matrix6d::Identity()};
  return sweep;
}

std::vector<SweepRecord> written_and_read(const std::vector<SweepRecord>& records,
                                          const std::filesystem::path& file) {
  SweepTableWriter writer(file);
  for (const SweepRecord& record : records) {
    writer.write(record);
  }
  writer.close();
  return read_sweep_table(file);
}

TEST(SweepTable, ComesBackAsItWasWritten) {
  const test::TemporaryFolder folder;
  const auto back = written_and_read({sweep_record(17, fused_sweep())}, folder / "sweeps.csv");
  ASSERT_EQ(back.size(), 1U);
  const SweepRecord& record = back[0];
  EXPECT_EQ(record.index, 17.0);
  EXPECT_EQ(record.stamp, Nanoseconds(1'700'000'000'123'456'789));
  EXPECT_EQ(record.state, "tracking");
  EXPECT_EQ(record.registration, "degenerate");
  EXPECT_EQ(record.overlap, 0.75);
  EXPECT_EQ(record.translation[0].localizability, "none");
  EXPECT_EQ(record.translation[0].sigma, 0.5);
  EXPECT_NEAR(record.translation[0].axis.y(), 1.0, 1e-15) << "in the map's axes";
  EXPECT_EQ(record.imu, "fused");
  EXPECT_EQ(record.gyro_bias, Eigen::Vector3d(0.01, -0.02, 0.03));
  EXPECT_EQ(record.accel_bias_sigma, Eigen::Vector3d::Constant(0.5));
  EXPECT_EQ(record.gravity_sigma, 0.5);
  EXPECT_EQ(record.innovation_rotation, Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_EQ(record.innovation_degrees, 5.0);
  EXPECT_EQ(record.innovation_gate, 205.2);
  EXPECT_EQ(record.uncertainty.local, fused_sweep().uncertainty.local) << "both triangles";
  EXPECT_EQ(record.uncertainty.drift, fused_sweep().uncertainty.drift);
}

TEST(SweepTable, NamesTheColumnsOfCovariances) {
  const test::TemporaryFolder folder;
  written_and_read({}, folder / "sweeps.csv");
  const std::string header = test::content(folder / "sweeps.csv");
  for (const char* name : {",local_cov_x_x,", ",local_cov_x_rz,", ",drift_cov_y_z,"}) {
    EXPECT_NE(header.find(name), std::string::npos) << name;
  }
  EXPECT_TRUE(header.ends_with(",drift_cov_rz_rz\n")) << header;
  EXPECT_EQ(header.find("_cov_y_x"), std::string::npos) << "the upper triangle alone";
}

TEST(SweepTable, WhatIsNotKnownIsAnEmptyCell) {
  const test::TemporaryFolder folder;
  SweepResult first;
  first.state = OdometryState::initializing;
  const auto back = written_and_read({sweep_record(0, first)}, folder / "sweeps.csv");
  EXPECT_EQ(back[0].registration, "");
  EXPECT_TRUE(std::isnan(back[0].overlap));
  EXPECT_EQ(back[0].translation[2].localizability, "");
  EXPECT_TRUE(std::isnan(back[0].rotation[1].support));
  EXPECT_EQ(back[0].imu, "absent");
  EXPECT_TRUE(back[0].gyro_bias.hasNaN());
  EXPECT_TRUE(std::isnan(back[0].innovation_squared));
  const std::string text = test::content(folder / "sweeps.csv");
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
}

std::string complaint(const test::TemporaryFolder& folder, const std::string& text) {
  try {
    read_sweep_table(folder.write("sweeps.csv", text));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(SweepTable, ColumnsOfOtherVersionsAreNoErrorAndBadCellsAre) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(complaint(folder, "stamp_s,colour,overlap\n1.5,red,0.5\n"), "");
  EXPECT_NE(complaint(folder, "time,overlap\n1,2\n").find("no column stamp_s"), std::string::npos);
  EXPECT_NE(complaint(folder, "stamp_s,overlap\n1,0.5\n2,much\n").find("line 3: overlap is"),
            std::string::npos);
  EXPECT_NE(complaint(folder, "stamp_s,overlap\n,0.5\n").find("line 2: stamp_s is"),
            std::string::npos);
  EXPECT_NE(complaint(folder, "stamp_s,overlap\n1,0.5\n2\n").find("line 3: cells found: 1"),
            std::string::npos);
}

TEST(SweepTable, ValuesThatNoRunWritesAreRefused) {
  const test::TemporaryFolder folder;
  written_and_read({sweep_record(17, fused_sweep())}, folder / "whole.csv");
  const std::string whole = test::content(folder / "whole.csv");
  const auto changed = [&](const std::string& column, const std::string& value) {
    const std::size_t line = whole.find('\n') + 1;
    const std::string header = "," + whole.substr(0, line - 1) + ",";
    const std::size_t before = header.find("," + column + ",");
    EXPECT_NE(before, header.npos) << column;
    std::size_t cell = line;
    for (auto n =
             std::count(header.begin(), header.begin() + static_cast<std::ptrdiff_t>(before), ',');
         n > 0; --n) {
      cell = whole.find(',', cell) + 1;
    }
    std::string text = whole;
    return complaint(folder, text.replace(cell, whole.find_first_of(",\n", cell) - cell, value));
  };
  EXPECT_EQ(changed("overlap", "0.5"), "");
  EXPECT_NE(changed("state", "nan").find("line 2: state is 'nan'"), std::string::npos);
  EXPECT_NE(changed("imu", "7").find("line 2: imu is '7'"), std::string::npos);
  EXPECT_NE(changed("translation1_axis_x", "nan").find("has not the length 1"), std::string::npos);
  EXPECT_NE(changed("translation1_axis_x", "1e10").find("has not the length 1"), std::string::npos);
}

}  // namespace
}  // namespace adit
