// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_plan.hpp"

#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/fleet/fleet_file.hpp"
#include "adit/tools/fleet/fleet_status.hpp"
#include "adit/tools/fleet/shard_run.hpp"
#include "adit/tools/support/child_process.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

FleetPlan made_plan(const PlanCommandOptions& options) {
  if (options.output.empty()) {
    throw UsageError("say where the plan goes: adit plan FLEET.toml -o PLAN.");
  }
  std::error_code error;
  if (fs::exists(options.output, error) && !fs::is_empty(options.output, error) &&
      !has_plan(options.output)) {
    throw UsageError("-o " + options.output.string() +
                     ": there is something else of that name. Name another folder.");
  }
  const FleetPlan plan = plan_fleet(read_fleet(options.what), options.output);
  write_plan(plan);
  return plan;
}

/// Lets all shards that have failed be tried again. Returns how many.
std::size_t forgive_failures(const FleetPlan& plan) {
  const ShardLedger ledger(plan.folder);
  const std::vector<ShardStanding> standings = standings_of(plan, FleetStage::report);
  std::size_t forgiven = 0;
  for (std::size_t i = 0; i < plan.shards.size(); ++i) {
    if (standings[i].state == ShardState::failed) {
      ledger.forgive(plan.shards[i].id);
      ++forgiven;
    }
  }
  return forgiven;
}

void write_scripts(const FleetPlan& plan, const std::vector<JobScript>& scripts,
                   std::ostream& out) {
  for (const JobScript& script : scripts) {
    const fs::path file = plan.folder / script.name;
    replace_text_file(file, script.text);
    fs::permissions(file, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                    fs::perm_options::add);
    out << "wrote  " << file.string() << "\n";
  }
}

int run(const PlanCommandOptions& options, std::ostream& out, std::ostream& err) {
  std::error_code error;
  const bool makes = !fs::is_directory(options.what, error);
  if (!makes && !options.output.empty()) {
    throw UsageError("-o is for a fleet's file; " + options.what.string() + " is a plan already.");
  }
  const FleetPlan plan = makes ? made_plan(options) : read_plan(options.what);
  if (options.retry) {
    err << fmt::format("{} shards that had failed are tried again\n", forgive_failures(plan));
  }
  const fs::path program = own_program();
  std::ostream& said = options.json ? err : out;
  if (options.slurm) {
    write_scripts(plan, slurm_scripts(plan, program, options.jobs), said);
  }
  if (options.parallel) {
    write_scripts(plan, parallel_scripts(plan, program, options.jobs), said);
  }
  if (options.json) {
    out << fleet_json(plan);
  } else if (options.status || !(options.slurm || options.parallel)) {
    out << describe_fleet(plan);
    if (makes) {
      out << "next     adit shard " << options.output.string() << " --all\n";
    }
  }
  return 0;
}

}  // namespace

int plan_command(const PlanCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit plan", out, err, [&] { return run(options, out, err); });
}

void add_plan_command(Command app, std::function<void(int)> done) {
  const Command command = app.add_command("plan", "Plan how many recordings become one map");
  const auto options = std::make_shared<PlanCommandOptions>();
  command.footer(
      "FLEET.toml names the recordings (docs/fleets.md). The plan is a folder: shards.jsonl has a "
      "line for each piece of work, which `adit shard` does on whatever machine sees the folder. "
      "Plan again after a change of FLEET.toml: only what depends on the change is done again.\n\n"
      "Examples:\n"
      "  adit plan fleet.toml -o plan\n"
      "  adit plan plan --status\n"
      "  adit plan plan --slurm --at-once 64 && plan/submit.sh\n"
      "  adit plan plan --parallel --at-once 4 && plan/run_parallel.sh\n"
      "  adit plan plan --retry\n\n"
      "Exit codes: 0 done, 1 a file cannot be read or written, 2 usage.");
  command.option("fleet", options->what, "The fleet's file, or the folder of a plan")
      .required()
      .value_name("FLEET.toml|PLAN");
  command
      .option("-o,--output", options->output,
              "The folder of the plan; one that is there is updated")
      .value_name("PLAN");
  command.flag("--status", options->status, "Say what is done, running, waiting and failed");
  command.flag("--retry", options->retry, "Let shards that have failed be tried again");
  command.flag("--slurm", options->slurm,
               "Write submit.sh and shard.sbatch into the plan's folder");
  command.flag("--parallel", options->parallel,
               "Write run_parallel.sh, for GNU parallel, into the plan's folder");
  command.option("--at-once", options->jobs.at_once, "In scripts: shards at the same time, at most")
      .value_name("N");
  command.option("--cores", options->jobs.cores, "In scripts: processor cores a shard")
      .value_name("N")
      .from(1)
      .show_default();
  command
      .option("--sbatch", options->jobs.extra,
              "For Slurm: further words for sbatch, e.g. '--partition=gpu --gres=gpu:1'")
      .value_name("WORDS");
  command.flag("--json", options->json, "The state of each shard as JSON");
  command.action(
      [options, done = std::move(done)] { done(plan_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
