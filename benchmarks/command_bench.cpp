// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/command_bench.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "adit/benchmarks/command_bench_consistency.hpp"
#include "adit/benchmarks/command_bench_slam.hpp"
#include "adit/benchmarks/kernels/cases.hpp"
#include "adit/benchmarks/kernels/compile_table.hpp"
#include "adit/benchmarks/kernels/device_report.hpp"
#include "adit/benchmarks/kernels/inputs.hpp"
#include "adit/benchmarks/kernels/report.hpp"
#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit::bench {
namespace {

constexpr double kLimitSeconds = 0.2;

/// Those whose names begin with what was asked for, in the list's order. Throws UsageError for a
/// name that is none's beginning.
std::vector<Case> chosen(const std::vector<Case>& cases, const BenchCommandOptions& options) {
  std::vector<std::string> names;
  for (const Case& one : cases) {
    names.push_back(one.name);
  }
  for (const std::string& wanted : options.cases) {
    if (std::ranges::none_of(names, [&](const auto& name) { return name.starts_with(wanted); })) {
      throw UsageError("there is no case '" + wanted + "'. " + suggestion(wanted, names) +
                       ". --list names all.");
    }
  }
  std::vector<Case> result;
  for (const Case& one : cases) {
    const bool asked =
        options.cases.empty() || std::ranges::any_of(options.cases, [&](const auto& wanted) {
          return one.name.starts_with(wanted);
        });
    if (asked && (options.peers || one.kind != CaseKind::peer)) {
      result.push_back(one);
    }
  }
  // A peer is measured before the case that is compared with it.
  std::ranges::stable_partition(result, [](const Case& c) { return c.kind == CaseKind::peer; });
  return result;
}

Row measured(const Case& one, int size, Bench& bench, double seconds) {
  const Work work = one.make(bench, size);
  Row row{.name = one.name,
          .kind = one.kind,
          .size = size,
          .item = one.item,
          .peer = one.peer,
          .items = work.items,
          .cost = work.cost,
          .verified_by = work.verified_by,
          .problem = work.problem,
          .figures = work.figures};
  if (row.problem.empty()) {
    row.timing = measure(work, {.seconds = seconds});
  }
  return row;
}

/// Why there is no row.
std::string nothing_measured(const std::vector<Case>& cases) {
  if (cases.empty()) {
    return "no case is left to measure: --no-peers leaves out those that were asked for.";
  }
  const Case& one = cases.front();
  return "no case takes one of these sizes: " + one.name + " takes " + std::to_string(one.least) +
         " to " + std::to_string(one.most) + " points. Choose other --sizes, or another --input.";
}

Report run_cases(const BenchCommandOptions& options, const std::vector<Case>& cases,
                 engine::Context& context, std::ostream& out) {
  Bench bench(context, options.input, options.r_input);
  Report report{.setting = setting_of(context.device()),
                .limits = measure_limits(context, kLimitSeconds)};
  report.setting.input = bench.description();
  report.setting.seconds = options.seconds;
  print_setting(report, out);
  print_head(out);
  out << std::flush;
  for (const Case& one : cases) {
    const bool batch = one.kind == CaseKind::batch;
    for (const int size : batch ? options.batches : bench.sizes(options.sizes)) {
      if (!batch && (size < one.least || size > one.most)) {
        continue;
      }
      report.rows.push_back(measured(one, size, bench, options.seconds));
      print_row(report.rows.back(), report, out);
      out << std::flush;
    }
  }
  if (report.rows.empty()) {
    throw UsageError(nothing_measured(cases));
  }
  const DeviceLimits again = measure_limits(context, kLimitSeconds);
  report.limits_moved = moved(report.limits, again);
  report.limits = best_of(report.limits, again);
  print_limits(report, out);
  return report;
}

int bench_device(const BenchCommandOptions& options, std::ostream& out, std::ostream& err) {
  const std::vector<Case> all = all_cases();
  const std::vector<Case> cases = chosen(all, options);
  if (options.list) {
    for (const Case& one : cases) {
      out << one.name << "  (" << to_string(one.kind) << ")\n";
    }
    return 0;
  }
  engine::Context context = open_device(options.device);
  if (context.software_fallback()) {
    err << software_note(context.device()) << std::endl;
  }
  const Report report = run_cases(options, cases, context, out);
  if (!options.json.empty()) {
    write_text_file(options.json, to_json(report).dump(1) + "\n");
    out << "\nwrote    " << options.json.string() << "\n";
  }
  if (!options.report.empty()) {
    write_text_file(options.report, device_report(report, context.device(), err).dump(1) + "\n");
    out << "wrote    " << options.report.string()
        << ", which tells of this machine its device, driver and processor\n";
  }
  if (!options.html.empty()) {
    write_text_file(options.html, to_html(report));
    out << "wrote    " << options.html.string() << "\n";
  }
  return std::ranges::all_of(report.rows, [](const Row& row) { return row.problem.empty(); }) ? 0
                                                                                              : 1;
}

int compile_for(const BenchCommandOptions& options, std::ostream& out) {
  std::vector<CompileTable> tables;
  for (const std::string& family : options.compile) {
    tables.push_back(compile_table(family));
    print(tables.back(), out);
    out << std::endl;
  }
  if (!options.json.empty()) {
    write_text_file(options.json, tables_to_json(tables).dump(1) + "\n");
    out << "wrote    " << options.json.string() << "\n";
  }
  return 0;
}

/// What does something else takes few of the options.
void refuse_besides(const Command& command, bool chosen, const std::vector<std::string>& known,
                    const std::string& does) {
  const std::string other = chosen ? command.given_besides(known) : "";
  if (!other.empty()) {
    refuse_option(other,
                  "is of no use with " + known.front() + ", which " + does + "; leave it out");
  }
}

}  // namespace

int bench_command(const BenchCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit bench", out, err, [&] {
    if (!options.compare.empty()) {
      const Report before = read_report(options.compare[0]);
      const Report after = read_report(options.compare[1]);
      print_comparison(before, after, out);
      return 0;
    }
    if (!options.compile.empty()) {
      return compile_for(options, out);
    }
    return bench_device(options, out, err);
  });
}

void add_bench_command(Command app, std::function<void(int)> done) {
  const auto options = std::make_shared<BenchCommandOptions>();
  const Command command =
      app.add_command("bench", "How fast a device is: kernels, registrations, batches");
  command.footer(
      "Every case is verified before it is timed. `of its limit` is the least time that the\n"
      "device's measured limits allow over the time measured, with the limit that binds.\n\n"
      "Examples:\n"
      "  adit bench                                   all, some minutes\n"
      "  adit bench linearize align --sizes 30000     two families, one size\n"
      "  adit bench --html page.html --json a.json  with roofline and scaling plots\n"
      "  adit bench --report my_gpu.json              one file to send to somebody\n"
      "  adit bench --input sweep.pcd downsample      on your own cloud\n"
      "  adit bench --compare a.json b.json\n"
      "  adit bench --compile NAVI21 VEGA10           what AMD's GPUs would get, without one\n"
      "  adit bench slam                              how accurate, see `adit bench slam "
      "--help`\n"
      "  adit bench consistency                       whether it knows how accurate it is\n\n"
      "Exit codes: 0 done, 1 a case is wrong or the device failed, 2 usage.");
  command.option("cases", options->cases, "Names of cases, or how they begin").value_name("CASE");
  command.flag("--list", options->list, "Name the cases and do nothing");
  const CommandOption sizes =
      command.option("--sizes", options->sizes, "Raw points of the simulated sweeps")
          .with_commas()
          .from(100, 2e6)
          .value_name("N")
          .show_default();
  command.option("--batches", options->batches, "Pairs of the batches")
      .with_commas()
      .from(1, 4096)
      .value_name("N")
      .show_default();
  command.option("--seconds", options->seconds, "Time for each case and size, at least (s)")
      .from(0.0, 600.0)
      .value_name("S")
      .show_default();
  command
      .option("--input", options->input,
              "A recording or one or two point clouds instead of the simulated sweeps")
      .values(1, 2)
      .value_name("FILE");
  const CommandOption r_input =
      command.option("--r-input", options->r_input, "Down-sampling of --input (m)")
          .from(0.01, 10.0)
          .value_name("M")
          .show_default();
  command.flag(
      "--no-peers", [options] { options->peers = false; }, "Leave out what others need");
  command.option("--json", options->json, "Write all figures")
      .value_name("FILE.json")
      .written({".json"});
  command.option("--html", options->html, "Write a page with plots")
      .value_name("FILE.html")
      .written({".html", ".htm"});
  command
      .option("--report", options->report,
              "Write one file for those who lack this device: the figures, its limits, its "
              "self-test, and what its driver tells of the kernels")
      .value_name("FILE")
      .written();
  command.option("--compare", options->compare, "Compare two files of --json, measure nothing")
      .values(2, 2)
      .value_name("BEFORE AFTER");
  command
      .option("--compile", options->compile,
              "Registers, spills and waves of every kernel on these families of GPUs (by Mesa's "
              "RADV, without hardware), measure nothing")
      .values(1, 16)
      .value_name("FAMILY");
  command.option("--device", options->device.device, "Index, UUID or part of the name")
      .value_name("DEVICE");
  add_bench_slam_command(command, done);
  add_bench_consistency_command(command, done);
  command.action([command, options, sizes, r_input, done = std::move(done)] {
    if (command.has_chosen()) {
      return;
    }
    refuse_besides(command, !options->compare.empty(), {"--compare"}, "reads two reports");
    refuse_besides(command, !options->compile.empty(), {"--compile", "--json"}, "measures nothing");
    if (r_input.given() && options->input.empty()) {
      refuse_option("--r-input", "needs --input");
    }
    if (sizes.given() && !options->input.empty()) {
      refuse_option("--sizes", "is of simulated sweeps; --input has the size that it has");
    }
    done(bench_command(*options, std::cout, std::cerr));
  });
}

}  // namespace adit::bench
