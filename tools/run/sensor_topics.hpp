// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "adit/slam/core/config.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// The topic of the IMU that a run uses: the one that recording.imu_topic names, else the first.
/// None where there is none, or imu.use is off. Throws UsageError where the recording has not what
/// is named.
std::optional<std::size_t> imu_topic(const Recording& recording, const Config& config);

/// The same of GNSS fixes: recording.gnss_topic, gnss.use.
std::optional<std::size_t> gnss_topic(const Recording& recording, const Config& config);

}  // namespace adit
