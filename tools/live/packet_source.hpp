// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <vector>

#include "adit/tools/live/live_options.hpp"
#include "adit/tools/live/udp_receiver.hpp"
#include "adit/tools/run/run_view.hpp"

namespace adit {

/// Maps the packets of a sensor that arrive at the endpoints. Returns the exit code: that of
/// run_job(), or 1 where receiving ended early. Throws InputError where nothing arrives.
int map_packets(const LiveOptions& options, const std::vector<UdpEndpoint>& endpoints,
                RunView* view, std::ostream& out, std::ostream& err);

}  // namespace adit
