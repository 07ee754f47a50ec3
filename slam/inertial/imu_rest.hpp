// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What an inertial sensor reads while nothing moves.
#pragma once

namespace adit {

inline constexpr double kRestGyroBias = 0.2;  ///< rad/s, of the mean; more than that is a rotation

/// The norm of the standard deviations of the three axes, with motors running; somebody who walks
/// makes ten times as much.
inline constexpr double kRestGyro = 0.02;  ///< rad/s
inline constexpr double kRestAccel = 0.3;  ///< m/s²

}  // namespace adit
