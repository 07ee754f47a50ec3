// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/map_records.hpp"

namespace adit {
namespace {

using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

}  // namespace

PoseNumbers pose_numbers(const Eigen::Isometry3d& pose) {
  PoseNumbers numbers{};
  Eigen::Map<Rows>(numbers.data()) = pose.matrix().topRows<3>();
  return numbers;
}

Eigen::Isometry3d pose_from(const PoseNumbers& numbers) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.matrix().topRows<3>() = Eigen::Map<const Rows>(numbers.data());
  return pose;
}

MatrixNumbers matrix_numbers(const Matrix6d& matrix) {
  MatrixNumbers numbers{};
  Eigen::Map<Matrix6d>(numbers.data()) = matrix;
  return numbers;
}

Matrix6d matrix_from(const MatrixNumbers& numbers) {
  return Eigen::Map<const Matrix6d>(numbers.data());
}

VectorNumbers vector_numbers(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Eigen::Vector3d vector_from(const VectorNumbers& numbers) {
  return Eigen::Vector3d(numbers.data());
}

SquareNumbers square_numbers(const Eigen::Matrix3d& matrix) {
  SquareNumbers numbers{};
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data()) = matrix;
  return numbers;
}

Eigen::Matrix3d square_from(const SquareNumbers& numbers) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
}

}  // namespace adit
