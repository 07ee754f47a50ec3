// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/tools/map_edits/loop_addition.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {

/// Verifies on a device that is opened for each loop, with the configuration of its keyframes'
/// session. Throws what DeviceSession and verify_by_hand() do.
VerifyLoop loop_verifier(const DeviceOptions& device);

}  // namespace adit
