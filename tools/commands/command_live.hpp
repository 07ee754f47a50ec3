// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit live SOURCE... -o OUT`.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "adit/tools/commands/command_run.hpp"

namespace adit {

/// What `adit live` is asked for.
struct LiveCommandOptions {
  std::vector<std::string> sources{};  ///< udp://ADDRESS:PORT, or one recording
  RunCommandOptions run{};             ///< its recording is set by the command
  double wait_s = 10.0;                ///< for the first packets
  double speed = 1.0;                  ///< of a recording; 0: no pace
  double duration_s = 0.0;             ///< of receiving; 0: until a signal
  bool record = true;                  ///< the packets stay in OUT/recording.pcap
};

/// Maps what arrives. Returns the exit code: 0 done or ended by a signal, 1 failed on the data or
/// the device, or nothing arrived, 2 usage.
int live_command(const LiveCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command; see add_run_command().
void add_live_command(Command app, std::function<void(int)> done);

}  // namespace adit
