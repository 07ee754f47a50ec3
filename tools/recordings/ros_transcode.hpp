// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/containers/message_file.hpp"

namespace adit::ros {

/// The name under which ROS 1 and ROS 2 both know a type that is understood: "tf/tfMessage" is
/// "tf2_msgs/TFMessage". Nothing for types that are not.
std::optional<std::string> shared_type_name(std::string_view type);

/// The same message in another encoding, field by field. ROS 1's sequence numbers are lost on the
/// way to ROS 2, which has none. Throws CodecError where the message is damaged, std::logic_error
/// where the type is not understood.
std::vector<std::byte> transcode(std::string_view type, Encoding from,
                                 std::span<const std::byte> bytes, Encoding to);

}  // namespace adit::ros
