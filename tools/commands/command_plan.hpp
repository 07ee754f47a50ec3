// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit plan`: the recordings of a fleet as shards that any machine can run.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <ostream>

#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/fleet/job_scripts.hpp"

namespace adit {

struct PlanCommandOptions {
  std::filesystem::path what{};    ///< a fleet's file, or the folder of a plan
  std::filesystem::path output{};  ///< with a fleet's file: the plan's folder
  bool status = false;
  bool retry = false;
  bool slurm = false;
  bool parallel = false;
  bool json = false;
  JobSettings jobs{};
};

/// The whole command. Returns its exit code.
int plan_command(const PlanCommandOptions& options, std::ostream& out, std::ostream& err);
/// Adds the command to `app`; `done` gets the exit code.
void add_plan_command(Command app, std::function<void(int)> done);

}  // namespace adit
