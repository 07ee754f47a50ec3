// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/sweep_table.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string_view>
#include <utility>

#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};

template <class Vector, class Visitor>
void visit_vector(Vector& vector, const std::string& name, const std::string& unit,
                  Visitor&& field) {
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    field(name + "_" + std::string(kAxes[i]) + unit, vector[static_cast<Eigen::Index>(i)]);
  }
}

/// As read_any_trajectory() finds them.
template <class Position, class Attitude, class Visitor>
void visit_pose(Position& position, Attitude& attitude, Visitor&& field) {
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    field(std::string(kAxes[i]) + "_m", position[static_cast<Eigen::Index>(i)]);
  }
  constexpr std::array<std::string_view, 4> kParts = {"qx", "qy", "qz", "qw"};
  for (std::size_t i = 0; i < kParts.size(); ++i) {
    field(kParts[i], attitude[static_cast<Eigen::Index>(i)]);
  }
}

template <class Directions, class Visitor>
void visit_directions(Directions& directions, const std::string& name, const std::string& unit,
                      Visitor&& field) {
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const std::string which = name + std::to_string(i + 1);
    field(which + "_localizability", directions[i].localizability);
    field(which + "_support", directions[i].support);
    field(which + "_sigma" + unit, directions[i].sigma);
    visit_vector(directions[i].axis, which + "_axis", "", field);
  }
}

/// The upper triangle, row by row.
template <class Matrix, class Visitor>
void visit_covariance(Matrix& covariance, const std::string& name, Visitor&& field) {
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = i; j < covariance.cols(); ++j) {
      const auto row = static_cast<std::size_t>(i);
      const auto column = static_cast<std::size_t>(j);
      field(name + "_" + std::string(kTangentNames[row]) + "_" + std::string(kTangentNames[column]),
            covariance(i, j));
    }
  }
}

/// Calls field(name, member) for each column, in the order of the file.
template <class Record, class Visitor>
void visit(Record& record, Visitor&& field) {
  field("index", record.index);
  field("stamp_s", record.stamp);
  visit_pose(record.position, record.attitude, field);
  field("state", record.state);
  field("registration", record.registration);
  field("keyframe", record.keyframe);
  field("deskewed", record.deskewed);
  field("raw_points", record.raw_points);
  field("cloud_points", record.cloud_points);
  field("inliers", record.inliers);
  field("overlap", record.overlap);
  field("iterations", record.iterations);
  field("residual_rms_m", record.residual_rms);
  visit_directions(record.translation, "translation", "_m", field);
  visit_directions(record.rotation, "rotation", "_rad", field);
  field("imu", record.imu);
  visit_vector(record.velocity, "velocity", "_m_per_s", field);
  visit_vector(record.gyro_bias, "gyro_bias", "_rad_per_s", field);
  visit_vector(record.gyro_bias_sigma, "gyro_bias_sigma", "_rad_per_s", field);
  visit_vector(record.accel_bias, "accel_bias", "_m_per_s2", field);
  visit_vector(record.accel_bias_sigma, "accel_bias_sigma", "_m_per_s2", field);
  visit_vector(record.gravity, "gravity", "_m_per_s2", field);
  field("gravity_sigma_rad", record.gravity_sigma);
  visit_vector(record.innovation_translation, "innovation", "_m", field);
  visit_vector(record.innovation_rotation, "innovation", "_rad", field);
  field("innovation_squared", record.innovation_squared);
  field("innovation_degrees", record.innovation_degrees);
  field("innovation_gate", record.innovation_gate);
  visit_covariance(record.uncertainty.local, "local_cov", field);
  visit_covariance(record.uncertainty.drift, "drift_cov", field);
}

void append(std::string& line, double value) {
  if (!std::isnan(value)) {
    append_number(line, value);
  }
}
void append(std::string& line, Nanoseconds stamp) {
  append_stamp(line, stamp);
}
void append(std::string& line, const std::string& word) {
  line += word;
}

/// True where the cell is what the column holds.
bool parse(std::string_view cell, double& value) {
  const std::optional<double> number = parse_double(cell);
  value = number.value_or(kUnknown);
  return number.has_value() || cell.empty();
}
bool parse(std::string_view cell, Nanoseconds& stamp) {
  const std::optional<Nanoseconds> parsed = parse_seconds(cell);
  stamp = parsed.value_or(Nanoseconds(0));
  return parsed.has_value();
}
bool parse(std::string_view cell, std::string& word) {
  word = cell;
  return true;
}

std::vector<std::string_view> table_cells(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return cells;
}

void describe_directions(const std::array<ObservedDirection, 3>& found,
                         const Eigen::Matrix3d& R_map_source, std::array<SweepDirection, 3>& into) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].axis.isZero() || !found[i].axis.allFinite()) {
      continue;  // so few points determine nothing
    }
    into[i].localizability = to_string(found[i].localizability);
    into[i].support = found[i].support;
    into[i].sigma = found[i].information > 0.0 ? 1.0 / std::sqrt(found[i].information) : kUnknown;
    into[i].axis = R_map_source * found[i].axis;
  }
}

void describe_alignment(const SweepResult& sweep, SweepRecord& record) {
  const RegistrationResult& r = sweep.registration;
  record.registration = to_string(r.status);
  record.inliers = r.inliers;
  record.overlap = r.overlap;
  record.iterations = r.iterations;
  record.residual_rms = r.residual_rms;
  if (is_usable(r.status)) {
    const Eigen::Matrix3d& R_map_lidar = r.T_target_source.linear();
    describe_directions(r.translation, R_map_lidar, record.translation);
    describe_directions(r.rotation, R_map_lidar, record.rotation);
  }
}

Eigen::Vector3d sigma_of(const StateMatrix& covariance, int at) {
  return covariance.diagonal().segment<3>(at).cwiseMax(0.0).cwiseSqrt();
}

void describe_inertial(const InertialReport& report, SweepRecord& record) {
  record.imu = to_string(report.state);
  if (report.nav) {
    record.velocity = report.nav->v_map_body;
    record.gyro_bias = report.nav->bias.gyro;
    record.gyro_bias_sigma = sigma_of(report.nav_covariance, kGyroBiasAt);
    record.accel_bias = report.nav->bias.accel;
    record.accel_bias_sigma = sigma_of(report.nav_covariance, kAccelBiasAt);
    record.gravity = report.nav->gravity_map;
    record.gravity_sigma = gravity_sigma(report);
  }
  if (report.innovation.degrees > 0) {
    record.innovation_translation = report.innovation.error.head<3>();
    record.innovation_rotation = report.innovation.error.tail<3>();
    record.innovation_squared = report.innovation.nis;
    record.innovation_degrees = report.innovation.degrees;
    record.innovation_gate = report.innovation_gate;
  }
}

template <class Enum, std::size_t kCount>
bool is_one_of(const std::string& word, const std::array<Enum, kCount>& values) {
  return word.empty() ||
         std::ranges::any_of(values, [&](Enum value) { return word == to_string(value); });
}

bool is_axis(const Eigen::Vector3d& axis) {
  constexpr double kRounded = 0.01;
  return std::abs(axis.norm() - 1.0) < kRounded;
}

/// Values that `adit run` does not write: somebody or something has changed them since.
std::optional<std::string> impossible_value(const SweepRecord& record) {
  using enum OdometryState;
  if (!is_one_of(record.state, std::array{initializing, tracking, coasting, restarted})) {
    return "state is '" + record.state + "', which no sweep is in";
  }
  using enum InertialState;
  if (!is_one_of(record.imu, std::array{absent, starting, fused, lost, refused})) {
    return "imu is '" + record.imu + "', which no sensor is";
  }
  for (const auto* directions : {&record.translation, &record.rotation}) {
    for (const SweepDirection& direction : *directions) {
      if (!direction.localizability.empty() && !is_axis(direction.axis)) {
        return std::string("the axis of a direction has not the length 1");
      }
    }
  }
  for (const Matrix6d* covariance : {&record.uncertainty.local, &record.uncertainty.drift}) {
    const bool known = !covariance->diagonal().array().isNaN().all();
    if (known && !(covariance->diagonal().array() >= 0.0).all()) {
      return std::string("a variance is negative or missing");
    }
  }
  return std::nullopt;
}

}  // namespace

SweepRecord sweep_record(std::size_t index, const SweepResult& sweep) {
  SweepRecord record;
  record.index = static_cast<double>(index);
  record.stamp = sweep.stamp;
  record.position = sweep.T_map_lidar.translation();
  Eigen::Quaterniond attitude(sweep.T_map_lidar.linear());
  attitude.coeffs() *= attitude.w() < 0.0 ? -1.0 : 1.0;
  record.attitude = attitude.normalized().coeffs();
  record.state = to_string(sweep.state);
  record.keyframe = sweep.keyframe ? 1.0 : 0.0;
  record.deskewed = sweep.deskewed ? 1.0 : 0.0;
  record.raw_points = sweep.raw_points;
  record.cloud_points = sweep.cloud_points;
  if (sweep.state != OdometryState::initializing) {
    describe_alignment(sweep, record);
  }
  describe_inertial(sweep.inertial, record);
  record.uncertainty = sweep.uncertainty;
  return record;
}

std::vector<SweepColumn> columns_of(const SweepRecord& sweep) {
  std::vector<SweepColumn> columns;
  visit(sweep, [&](std::string_view name, const auto& value) {
    columns.push_back({.name = std::string(name), .value = value});
  });
  return columns;
}

SweepTableWriter::SweepTableWriter(std::filesystem::path path) : file_(std::move(path)) {
  std::string header;
  const SweepRecord record;
  visit(record, [&](std::string_view name, const auto&) {
    header += (header.empty() ? "" : ",") + std::string(name);
  });
  file_.write(header + "\n");
}

void SweepTableWriter::write(const SweepRecord& sweep) {
  std::string line;
  bool first = true;
  visit(sweep, [&](std::string_view, const auto& value) {
    line += first ? "" : ",";
    first = false;
    append(line, value);
  });
  file_.write(line + "\n");
}

std::vector<SweepRecord> read_sweep_table(const std::filesystem::path& file) {
  std::string text = read_text_file(file);
  text.resize(text.rfind('\n') + 1);  // a kill may have cut the last line off
  LineReader lines(text);
  std::map<std::string_view, std::size_t> columns;
  const std::vector<std::string_view> names = table_cells(lines.next().value_or(""));
  for (std::size_t i = 0; i < names.size(); ++i) {
    columns[names[i]] = i;
  }
  if (!columns.contains("stamp_s")) {
    throw InputError(file, Place::line(1), "there is no column stamp_s: it is no table of sweeps",
                     "Give the folder that `adit run` wrote");
  }
  std::vector<SweepRecord> records;
  while (const std::optional<std::string_view> line = lines.next()) {
    const std::vector<std::string_view> cells = table_cells(*line);
    if (cells.size() != names.size()) {
      throw InputError(file, Place::line(lines.number()),
                       "cells found: " + std::to_string(cells.size()) + ", expected " +
                           std::to_string(names.size()) + " as in the first line",
                       "Run `adit run` again, or delete the line");
    }
    SweepRecord& record = records.emplace_back();
    visit(record, [&](std::string_view name, auto& value) {
      const auto column = columns.find(name);
      if (column != columns.end() && !parse(cells[column->second], value)) {
        throw InputError(file, Place::line(lines.number()),
                         std::string(name) + " is " + in_quotes(cells[column->second]),
                         "Run `adit run` again, or delete the line");
      }
    });
    for (Matrix6d* covariance : {&record.uncertainty.local, &record.uncertainty.drift}) {
      *covariance = Matrix6d(covariance->selfadjointView<Eigen::Upper>());
    }
    if (const std::optional<std::string> wrong = impossible_value(record)) {
      throw InputError(file, Place::line(lines.number()), *wrong,
                       "Run `adit run` again, or delete the line");
    }
  }
  return records;
}

}  // namespace adit
