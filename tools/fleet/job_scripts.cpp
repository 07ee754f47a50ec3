// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/job_scripts.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "adit/tools/fleet/shard_run.hpp"
#include "adit/tools/support/shell_word.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr double kRoom = 1.5;           // memory beside what is expected
constexpr double kTimeRoom = 4.0;       // a slower machine, a disk that others use
constexpr double kLeastMinutes = 10.0;  // a first start compiles kernels
constexpr std::size_t kMostTries = 4;   // of a shard that was not at fault

struct StageNeeds {
  std::size_t shards = 0;
  uint64_t megabytes = 0;
  long minutes = 0;
};

/// Of the largest shard of a stage.
StageNeeds needs_of(const FleetPlan& plan, FleetStage stage) {
  StageNeeds needs;
  for (const Shard& shard : plan.of(stage)) {
    ++needs.shards;
    const double megabytes = kRoom * static_cast<double>(shard.memory) / 1e6;
    const double minutes = std::max(kLeastMinutes, kTimeRoom * shard.seconds / 60.0);
    needs.megabytes = std::max(needs.megabytes, static_cast<uint64_t>(std::ceil(megabytes)));
    needs.minutes = std::max(needs.minutes, std::lround(std::ceil(minutes)));
  }
  return needs;
}

std::string shard_command(const FleetPlan& plan, const fs::path& program) {
  return shell_word(program.string()) + " shard " + shell_word(plan.folder.string());
}

}  // namespace

std::vector<JobScript> slurm_scripts(const FleetPlan& plan, const fs::path& program,
                                     const JobSettings& settings) {
  const std::string logs = (plan.folder / "slurm").string();
  const std::string job = fmt::format(
      "#!/bin/sh\n"
      "# One shard of the stage $1, by SLURM_ARRAY_TASK_ID. Written by `adit plan --slurm`.\n"
      "#SBATCH --requeue\n"
      "# Mesa's driver in software; a GPU's takes no notice.\n"
      "export LP_NUM_THREADS=\"${{SLURM_CPUS_PER_TASK:-{}}}\"\n"
      "{} --stage \"$1\"\n"
      "code=$?\n"
      "# Killed, or nothing that the shard is at fault for: back into the queue.\n"
      "if {{ [ $code -eq {} ] || [ $code -ge 128 ]; }} && [ \"${{SLURM_RESTART_COUNT:-0}}\" -lt "
      "{} ]; then\n"
      "  scontrol requeue \"${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}\"\n"
      "fi\n"
      "exit $code\n",
      settings.cores, shard_command(plan, program), kShardAgain, kMostTries - 1);
  std::string submit =
      "#!/bin/sh\n"
      "# Hands in an array job a stage. A recording that fails does not stop the others: each\n"
      "# stage begins when the one before has ended, and looks for itself whether all is there.\n"
      "# Hand it in again after a failure: what is done is kept.\n"
      "set -e\n";
  submit +=
      "mkdir -p " + shell_word(logs) + "\ncd " + shell_word(plan.folder.string()) + "\nafter=\n";
  for (const FleetStage stage : kFleetStages) {
    const StageNeeds needs = needs_of(plan, stage);
    if (needs.shards == 0) {
      continue;
    }
    const std::string limit = settings.at_once > 0 ? fmt::format("%{}", settings.at_once) : "";
    submit += fmt::format(
        "job=$(sbatch --parsable $after --job-name=adit-{0} --array=0-{1}{2} --cpus-per-task={3} "
        "--mem={4}M --time={5} --output={6}{7} shard.sbatch {0})\n"
        "echo \"{0}: job $job\"\n"
        "after=\"--dependency=afterany:${{job%%;*}}\"\n",
        to_string(stage), needs.shards - 1, limit, settings.cores, needs.megabytes, needs.minutes,
        shell_word(logs + "/%x-%a.out"), settings.extra.empty() ? "" : " " + settings.extra);
  }
  return {{.name = "shard.sbatch", .text = job}, {.name = "submit.sh", .text = submit}};
}

std::vector<JobScript> parallel_scripts(const FleetPlan& plan, const fs::path& program,
                                        const JobSettings& settings) {
  std::string text =
      "#!/bin/sh\n"
      "# Runs all shards by GNU parallel, stage by stage. Run it again after a failure: what is\n"
      "# done is kept. The exit code is that of the last stage.\n" +
      fmt::format("export LP_NUM_THREADS={}\n", settings.cores);
  const std::string jobs = settings.at_once > 0 ? fmt::format(" --jobs {}", settings.at_once) : "";
  for (const FleetStage stage : kFleetStages) {
    const std::size_t shards = plan.of(stage).size();
    if (shards == 0) {
      continue;
    }
    text += fmt::format("seq 0 {} | parallel -q{} {} --stage {} {{}}\n", shards - 1, jobs,
                        shard_command(plan, program), to_string(stage));
  }
  return {{.name = "run_parallel.sh", .text = text}};
}

}  // namespace adit
