// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/command_bench_consistency.hpp"

#include <algorithm>
#include <iostream>
#include <iterator>
#include <memory>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/benchmarks/consistency/consistency.hpp"
#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit::bench {
namespace {

std::vector<ConsistencyCase> chosen(const BenchConsistencyOptions& options) {
  std::vector<ConsistencyCase> cases = consistency_cases();
  std::vector<std::string> names;
  for (ConsistencyCase& one : cases) {
    names.push_back(one.name);
    one.duration = options.duration;
    one.sensor = options.sensor.empty() ? one.sensor : options.sensor;
  }
  for (const std::string& wanted : options.only) {
    if (std::ranges::find(names, wanted) == names.end()) {
      throw UsageError("there is no case '" + wanted + "'. " + suggestion(wanted, names));
    }
  }
  std::erase_if(cases, [&](const ConsistencyCase& one) {
    return !options.only.empty() && std::ranges::find(options.only, one.name) == options.only.end();
  });
  return cases;
}

/// Throws UsageError for settings that these runs have no use for.
void require_use(const std::vector<std::string>& settings) {
  for (const std::string& one : settings) {
    if (one.starts_with("recording.") || one.starts_with("mapping.") || one.starts_with("gnss.") ||
        one.starts_with("imu.T_imu_lidar=")) {
      throw UsageError(
          one +
          " has no effect here: the odometry alone runs, on simulated sweeps, and knows "
          "how its IMU is mounted. Leave it out.");
    }
  }
}

int runs_a_case(const BenchConsistencyOptions& options, std::size_t cases) {
  const int count = static_cast<int>(cases);
  if (options.runs % count != 0) {
    throw UsageError(fmt::format("--runs {}: {} cases share them evenly; make it {}.", options.runs,
                                 count, count * (options.runs / count + 1)));
  }
  return options.runs / count;
}

int bench_consistency(const BenchConsistencyOptions& options, std::ostream& out,
                      std::ostream& err) {
  const std::vector<ConsistencyCase> cases = chosen(options);
  const int runs_each = runs_a_case(options, cases.size());
  const Config config = load_config(options.config);
  const std::vector<std::string> settings = changed_settings(config);
  require_use(settings);
  engine::Context context = open_device(options.device);
  if (context.software_fallback()) {
    err << software_note(context.device()) << std::endl;
  }
  ConsistencyReport report{.setting = setting_of(context.device()), .settings = settings};
  print_consistency_head(report, out);
  out << std::flush;
  std::vector<std::vector<ConsistencySweep>> all;
  for (const ConsistencyCase& what : cases) {
    std::vector<std::vector<ConsistencySweep>> runs;
    for (int i = 0; i < runs_each; ++i) {
      runs.push_back(
          consistency_run(context, config, what,
                          {.index = i, .runs = runs_each, .first_seed = options.first_seed}));
    }
    report.rows.push_back({.what = what, .found = consistency_of(runs)});
    print_consistency_row(what.name, report.rows.back().found, out);
    out << std::flush;
    std::ranges::move(runs, std::back_inserter(all));
  }
  report.all = consistency_of(all);
  print_consistency_row("all", report.all, out);
  print_consistency_verdict(report.all, out);
  if (!options.json.empty()) {
    write_text_file(options.json, to_json(report).dump(1) + "\n");
    out << "wrote    " << options.json.string() << "\n";
  }
  return 0;
}

}  // namespace

int bench_consistency_command(const BenchConsistencyOptions& options, std::ostream& out,
                              std::ostream& err) {
  return guarded("adit bench consistency", out, err,
                 [&] { return bench_consistency(options, out, err); });
}

void add_bench_consistency_command(Command bench, std::function<void(int)> done) {
  const auto options = std::make_shared<BenchConsistencyOptions>();
  const Command command = bench.add_command(
      "consistency", "How honest: simulated runs, their errors beside what covariances say");
  command.footer(
      "Each run begins elsewhere on its scene's route, with other noise. Nothing is written but "
      "--json.\n\n"
      "Examples:\n"
      "  adit bench consistency                       60 runs, some minutes\n"
      "  adit bench consistency --only mine --runs 5 --sensor OS0-128\n"
      "  adit bench consistency --json consistency.json\n\n"
      "Exit codes: 0 done, whatever the figures are; 1 the device or a file failed, 2 usage.");
  command.option("--only", options->only, "Names of cases: room, office, mine, city, forest, field")
      .value_name("NAME");
  command.option("--sensor", options->sensor, "This range sensor instead of the cases' own")
      .value_name("NAME");
  command.option("--runs", options->runs, "Runs in all, shared evenly among the cases")
      .from(1, 100'000)
      .value_name("N")
      .show_default();
  command.option("--first-seed", options->first_seed, "The first run's seed of each case")
      .from(1, 1'000'000)
      .value_name("SEED")
      .show_default();
  command.option("--duration", options->duration, "Time of a run (s)")
      .from(2.0, 600.0)
      .value_name("S")
      .show_default();
  add_config_options(command, options->config);
  command.option("--device", options->device.device, "Index, UUID or part of the name")
      .value_name("DEVICE");
  command.option("--json", options->json, "Write all figures").value_name("FILE").written();
  command.action([options, done = std::move(done)] {
    done(bench_consistency_command(*options, std::cout, std::cerr));
  });
}

}  // namespace adit::bench
