// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/containers/protobuf_schema.hpp"

namespace adit {

/// The message types of Foxglove that a run is shown by, with all that they are made of: names,
/// numbers and types of fields as docs.foxglove.dev publishes them.
std::vector<ProtobufMessageType> foxglove_types();

/// The schema of one of them, or of a type of `known`, for its topics.
McapSchema protobuf_mcap_schema(const std::vector<ProtobufMessageType>& known,
                                const std::string& name);

}  // namespace adit
