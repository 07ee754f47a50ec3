// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Numbers as they stand in a map's blobs: doubles in the machine's order of bytes, little-endian on
// all that adit runs on.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>

#include "adit/slam/core/lie.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

static_assert(std::endian::native == std::endian::little, "maps are little-endian files");

/// The upper three rows of a pose, row by row.
using PoseNumbers = std::array<double, 12>;
PoseNumbers pose_numbers(const Eigen::Isometry3d& pose);
Eigen::Isometry3d pose_from(const PoseNumbers& numbers);

using MatrixNumbers = std::array<double, 36>;
MatrixNumbers matrix_numbers(const Matrix6d& matrix);
Matrix6d matrix_from(const MatrixNumbers& numbers);

using VectorNumbers = std::array<double, 3>;
VectorNumbers vector_numbers(const Eigen::Vector3d& vector);
Eigen::Vector3d vector_from(const VectorNumbers& numbers);

using SquareNumbers = std::array<double, 9>;
SquareNumbers square_numbers(const Eigen::Matrix3d& matrix);
Eigen::Matrix3d square_from(const SquareNumbers& numbers);

template <std::size_t kSize>
std::span<const std::byte> as_bytes(const std::array<double, kSize>& numbers) {
  return std::as_bytes(std::span(numbers));
}

/// Throws InputError where the blob has another size: "WHAT ID has N bytes".
template <std::size_t kSize>
std::array<double, kSize> numbers(std::span<const std::byte> blob,
                                  const std::filesystem::path& file, const std::string& what,
                                  int64_t id) {
  std::array<double, kSize> result{};
  if (blob.size() != sizeof(result)) {
    throw InputError(file, {},
                     what + " " + std::to_string(id) + " has " + std::to_string(blob.size()) +
                         " bytes, expected " + std::to_string(sizeof(result)),
                     "The map is damaged");
  }
  std::memcpy(result.data(), blob.data(), sizeof(result));
  return result;
}

}  // namespace adit
