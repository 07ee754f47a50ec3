// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/tools/recordings/merged_sweeps.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/setup/static_transforms.hpp"

namespace adit {

/// A topic that is not used, and why.
struct PassedOver {
  std::string topic;
  std::string why;  ///< a clause
};

/// The sensors that a run uses besides the range sensor, and how all are mounted.
struct RecordedSensors {
  std::vector<MergedTopic>
      sweeps{};  ///< the topic that is mapped, and those that are merged with it
  std::optional<std::size_t> imu{};   ///< its topic; none: there is none, or imu.use is off
  std::optional<std::size_t> gnss{};  ///< likewise, with gnss.use
  /// Velocities, or odometry whose twist they are; none unless recording.velocity_topic names it.
  std::optional<std::size_t> velocity{};
  /// Headings, or readings of an IMU whose orientations they are; none unless
  /// recording.heading_topic names it.
  std::optional<std::size_t> heading{};
  /// By topic: the frame whose messages are used, of the sweeps, too; empty names are left out.
  std::map<std::size_t, std::string> frames{};
  RecordedTransforms transforms{};
  std::vector<PassedOver> passed_over{};  ///< those of sweeps first, then of IMUs and receivers
};

/// Chooses by the first messages, not by names. Topics without messages are passed over. Of several
/// IMUs the one is chosen whose readings can be used, whose frame transforms connect with that of
/// the sweeps, and whose rate is higher, in this order; of several receivers the first with a fix.
/// recording.imu_topic and recording.gnss_topic choose themselves. Velocities are used of
/// recording.velocity_topic alone: such messages may be commands; headings likewise of
/// recording.heading_topic. Throws UsageError where the
/// recording lacks a topic that is named, or a further range sensor has no mounting.
RecordedSensors choose_sensors(const Recording& recording, std::size_t sweeps,
                               const Config& config);

/// Whether velocities can be read of a topic: it has messages of them, or poses of one frame.
bool has_velocities(const Topic& topic);

/// Whether headings can be read of a topic: it has messages of them, or readings of an IMU.
bool has_headings(const Topic& topic);

/// "/camera/imu is not used: it has no messages".
std::string describe(const PassedOver& passed_over);

/// What is not used and what is odd about the transforms, a sentence each.
std::vector<std::string> notes_of(const RecordedSensors& sensors);

}  // namespace adit
