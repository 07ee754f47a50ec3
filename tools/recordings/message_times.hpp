// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "adit/tools/containers/message_file.hpp"

namespace adit {

/// The stamp in the header of a measurement, without decoding the rest; of transforms that of the
/// first. Nothing for static transforms, for types without a header, where it is zero, and where
/// the message is damaged.
std::optional<Nanoseconds> stamp_in(const Channel& channel, const RawMessage& message);

}  // namespace adit
