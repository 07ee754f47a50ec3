// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_shard.hpp"

#include <algorithm>
#include <charconv>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/fleet/array_index.hpp"
#include "adit/tools/fleet/fleet_stages.hpp"
#include "adit/tools/fleet/shard_run.hpp"
#include "adit/tools/support/child_process.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

/// The index that whatever started this process has given it.
std::string given_index() {
  if (const std::optional<std::string> index = array_index()) {
    return *index;
  }
  throw UsageError(
      "say which shard: adit shard PLAN N, or --all. None of SLURM_ARRAY_TASK_ID, "
      "AWS_BATCH_JOB_ARRAY_INDEX and JOB_COMPLETION_INDEX is set.");
}

const Shard& chosen(const FleetPlan& plan, const ShardCommandOptions& options) {
  const std::string which = options.which.empty() ? given_index() : options.which;
  std::span<const Shard> shards = plan.shards;
  if (!options.stage.empty()) {
    const auto stage = stage_named(options.stage);
    if (!stage) {
      throw UsageError("--stage " + options.stage +
                       ": the stages are map, index, pairs, solve, product and report.");
    }
    shards = plan.of(*stage);
  }
  std::size_t number = 0;
  const char* const end = which.data() + which.size();
  const auto [rest, error] = std::from_chars(which.data(), end, number);
  if (error == std::errc() && rest == end) {
    if (number >= shards.size()) {
      throw UsageError(fmt::format("there is no shard {}: they are numbered 0 to {}.", number,
                                   shards.empty() ? 0 : shards.size() - 1));
    }
    return shards[number];
  }
  const auto found = std::ranges::find(plan.shards, which, &Shard::id);
  if (found == plan.shards.end()) {
    throw UsageError("there is no shard '" + which +
                     "'; shards.jsonl in the plan's folder has all.");
  }
  return *found;
}

std::vector<std::string> device_words(const DeviceOptions& device) {
  std::vector<std::string> words;
  if (!device.device.empty()) {
    words.insert(words.end(), {"--device", device.device});
  }
  if (device.max_vram_bytes > 0) {
    words.insert(words.end(), {"--max-vram", std::to_string(device.max_vram_bytes)});
  }
  if (device.validation) {
    words.emplace_back("--validation");
  }
  return words;
}

/// The work itself, in this process.
void work(const FleetPlan& plan, const Shard& shard, const ShardCommandOptions& options) {
  const StopSignal stop;
  switch (shard.stage) {
    case FleetStage::index:
      return index_maps(plan, options.into);
    case FleetStage::pairs:
      return search_pairs(plan, shard, options.device, options.into);
    case FleetStage::solve:
      return solve_fleet(plan, options.into);
    case FleetStage::report:
      return report_fleet(plan, options.into);
    case FleetStage::map:
    case FleetStage::product:
      break;
  }
  throw UsageError(
      "--into is for the stages index, pairs, solve and report; shards.jsonl has the "
      "commands of the others.");
}

int run(const ShardCommandOptions& options, std::ostream& out, std::ostream& err) {
  const FleetPlan plan = read_plan(options.plan);
  const ShardProgram program = {
      .program = options.program.empty() ? own_program() : options.program,
      .device_words = device_words(options.device)};
  if (!options.all) {
    const Shard& shard = chosen(plan, options);
    if (!options.into.empty()) {
      work(plan, shard, options);
      return 0;
    }
    const int code = run_shard(plan, shard, program, out, err);
    return options.tolerant && code == kShardFailed ? kShardDone : code;
  }
  bool has_failed = false;
  bool has_waited = false;
  for (const Shard& shard : plan.shards) {
    const int code = run_shard(plan, shard, program, out, err);
    if (code > kShardAgain) {
      return code;  // stopped
    }
    has_failed = has_failed || code == kShardFailed;
    has_waited = has_waited || code == kShardAgain;
  }
  return has_failed && !options.tolerant ? kShardFailed : has_waited ? kShardAgain : kShardDone;
}

}  // namespace

int shard_command(const ShardCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit shard", out, err, [&] { return run(options, out, err); });
}

void add_shard_command(Command app, std::function<void(int)> done) {
  const Command command = app.add_command("shard", "Do one piece of a plan's work");
  const auto options = std::make_shared<ShardCommandOptions>();
  command.footer(
      "PLAN is the folder that `adit plan` wrote. Without WHICH, the shard is the one that "
      "SLURM_ARRAY_TASK_ID, AWS_BATCH_JOB_ARRAY_INDEX or JOB_COMPLETION_INDEX names. A shard that "
      "is done is left as it is; it can be killed, and run twice or on two machines at once. It "
      "works in the system's folder for what is temporary (TMPDIR), which should be a disk of the "
      "machine.\n\n"
      "Examples:\n"
      "  adit shard plan --all               everything, one after another\n"
      "  adit shard plan map-drive_7\n"
      "  adit shard plan 3 --stage pairs\n\n"
      "Exit codes: 0 done, 1 failed, 2 usage, 75 nothing that it is at fault for (an earlier stage "
      "is not done, a disk is full, it was killed): run it again; 129, 130 or 143 stopped.");
  command.option("plan", options->plan, "The folder of the plan").required().value_name("PLAN");
  command.option("which", options->which, "Its number, from 0, or its id").value_name("WHICH");
  command.option("--stage", options->stage, "Numbers count within this stage")
      .one_of({"map", "index", "pairs", "solve", "product", "report"})
      .value_name("STAGE");
  command.flag("--all", options->all, "All shards, one after another");
  command.flag("--tolerant", options->tolerant,
               "Exit 0 also where a shard has failed: its record says so, and the others go on");
  command
      .option("--into", options->into,
              "Do the work in this process, without a record, and leave its result in this folder")
      .value_name("FOLDER");
  add_device_options(command, options->device);
  command.action(
      [options, done = std::move(done)] { done(shard_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
