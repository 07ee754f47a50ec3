// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

namespace adit {

/// Looks for `wait_s` seconds at what a map can be made of: ROS 2 topics that are published, and
/// packets that arrive at the ports which sensors send to by default, at any address of this
/// machine. Prints it, and a command that maps it. Returns 0, or 1 where there are no sweeps.
int list_sources(double wait_s, std::ostream& out);

}  // namespace adit
