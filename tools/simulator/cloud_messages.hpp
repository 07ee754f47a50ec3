// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "adit/slam/core/types.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/simulator/range_simulator.hpp"

namespace adit {

/// The type of message that a layout comes in: "sensor_msgs/PointCloud2".
std::string_view message_type(CloudLayout layout);

/// A sweep as the driver of such a sensor publishes it, stamped with its start; `epoch` is the time
/// at which the recording starts.
ros::EncodedEvent cloud_message(const RangeSweep& sweep, CloudLayout layout, Nanoseconds epoch,
                                const std::string& frame);

}  // namespace adit
