// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adit/tools/inspection/topic_findings.hpp"
#include "adit/tools/topics/topic_statistics.hpp"

namespace adit {

/// Steps of a topic's clock, and its offset to the recorder's. `shared`: as share_a_clock() says.
void check_clock(const Topic& topic, const TopicStatistics& statistics, bool shared,
                 TopicFindings& findings);

}  // namespace adit
