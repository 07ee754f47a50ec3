// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What happens to an inertial sensor, for people: with figures, and what to do.
#pragma once

#include <string>

#include "adit/slam/fusion/inertial_event.hpp"

namespace adit {

std::string describe(const InertialEvent& event);
std::string describe(const InertialHindrance& hindrance);
std::string describe(const ImuStartReason& reason);

/// "the gyroscope's z stays at 0 for 0.5 s while its other axes move".
std::string describe(const StuckAxis& stuck);
/// "the gyroscope is saturated: 3 readings stand at 2 rad/s, the end of its range".
std::string describe(const Saturation& saturation);
/// What the sweeps say against a gyroscope; empty where its fault is `none`.
std::string describe(const GyroCheck& check);

/// Roll, pitch and yaw about the lidar's axes that the motion does not tell, "roll, yaw"; empty if
/// it tells all.
std::string names_of_unobserved_axes(const RotationComparison& comparison);

}  // namespace adit
