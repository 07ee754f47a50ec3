// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Scripts that hand a plan's shards to what starts jobs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "adit/tools/fleet/fleet_plan.hpp"

namespace adit {

/// How many shards run at the same time, and what they are given.
struct JobSettings {
  std::size_t at_once = 0;  ///< at most; 0: as many as there is room for
  std::size_t cores = 2;    ///< a shard
  std::string extra{};      ///< further words for sbatch, such as "--partition=gpu --gres=gpu:1"
};

/// A script's name and text.
struct JobScript {
  std::string name{};
  std::string text{};
};

/// For Slurm: submit.sh hands in an array job a stage, each of which waits for the one before;
/// shard.sbatch is what they run. Memory and time are the plan's, with room to spare. A shard that
/// was killed, or found a disk full, is put back in the queue.
std::vector<JobScript> slurm_scripts(const FleetPlan& plan, const std::filesystem::path& program,
                                     const JobSettings& settings);

/// For GNU parallel: run_parallel.sh.
std::vector<JobScript> parallel_scripts(const FleetPlan& plan, const std::filesystem::path& program,
                                        const JobSettings& settings);

}  // namespace adit
