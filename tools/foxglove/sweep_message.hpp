// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A line of sweeps.csv as a message, for plots.
#pragma once

#include <string>

#include "adit/tools/containers/protobuf_message.hpp"
#include "adit/tools/containers/protobuf_schema.hpp"
#include "adit/tools/results/sweep_table.hpp"

namespace adit {

/// "adit.Sweep": the columns of sweeps.csv by their names, doubles and texts, with the stamp as
/// `timestamp`, and at the end `position_sigma_m` and `attitude_sigma_rad`, roots of the traces of
/// the pose's covariance in the map.
ProtobufMessageType sweep_message_type();

/// Such a message. What is not known is NaN, which plots leave a gap for, or an empty text.
ProtobufMessage sweep_message(const SweepRecord& sweep);

}  // namespace adit
