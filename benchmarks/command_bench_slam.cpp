// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/command_bench_slam.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/core.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "adit/benchmarks/slam/slam_families.hpp"
#include "adit/benchmarks/slam/slam_loops_report.hpp"
#include "adit/benchmarks/slam/slam_report.hpp"
#include "adit/benchmarks/slam/slam_run.hpp"
#include "adit/benchmarks/slam/slam_sequences.hpp"
#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit::bench {
namespace {

namespace fs = std::filesystem;

/// A sequence to come: simulated on demand, or there.
struct Candidate {
  std::string name;
  std::string description;
  std::optional<SlamEntry> entry;  ///< none: recorded
  SlamSequence sequence;
};

std::string described(const SlamEntry& entry) {
  return fmt::format("{:<7} {:<8} {:<13} {:>3.0f} s from {:>4.0f} m on, seed {}{}", entry.scene,
                     entry.sensor, entry.trajectory, entry.duration, entry.begin, entry.seed,
                     entry.quick ? ", quick" : "") +
         (entry.settings.empty() ? "" : fmt::format(", {}", fmt::join(entry.settings, ", ")));
}

std::vector<Candidate> candidates(const BenchSlamOptions& options) {
  std::vector<Candidate> all;
  const bool seeds = options.seeds > 0 || options.first_seed || options.apart;
  if (!options.recordings.empty()) {
    if (options.quick || seeds) {
      throw UsageError(
          "--quick, --seeds, --first-seed and --apart choose of the catalogue, and --recordings "
          "takes its place; leave one of them out.");
    }
    for (const SlamSequence& sequence : recorded_sequences(options.recordings)) {
      all.push_back({.name = sequence.name,
                     .description = sequence.recording.string(),
                     .entry = std::nullopt,
                     .sequence = sequence});
    }
    return all;
  }
  for (const SlamEntry& entry : options.loops ? loop_catalogue() : slam_catalogue()) {
    if (options.quick && !entry.quick) {
      continue;
    }
    const auto add = [&](const SlamEntry& one) {
      all.push_back(
          {.name = one.name, .description = described(one), .entry = one, .sequence = {}});
    };
    if (!seeds) {
      add(entry);
      continue;
    }
    for (uint64_t k = 0; k < std::max<uint64_t>(options.seeds, 1); ++k) {
      add(with_seed(entry, options.first_seed.value_or(1) + k,
                    options.apart.value_or(kBetweenBeginnings)));
    }
  }
  return all;
}

/// Those whose names begin with what was asked for, in the list's order. Throws UsageError for a
/// name that is none's beginning.
std::vector<Candidate> chosen(std::vector<Candidate> all, const std::vector<std::string>& only) {
  const auto begins = [](const Candidate& one, const std::string& wanted) {
    return one.name.starts_with(wanted);
  };
  for (const std::string& wanted : only) {
    if (std::ranges::none_of(all, [&](const Candidate& one) { return begins(one, wanted); })) {
      std::vector<std::string> names;
      for (const Candidate& one : all) {
        names.push_back(one.name);
      }
      throw UsageError("there is no sequence '" + wanted + "'. " + suggestion(wanted, names) +
                       ". --list names all.");
    }
  }
  std::erase_if(all, [&](const Candidate& one) {
    return !only.empty() &&
           std::ranges::none_of(only, [&](const auto& wanted) { return begins(one, wanted); });
  });
  return all;
}

/// "adit" with the common settings, then the variants in the order in which they are named first.
std::vector<SlamVariant> variants_of(const BenchSlamOptions& options) {
  std::vector<SlamVariant> variants = {{.name = "adit", .config = options.config}};
  for (const std::string& text : options.variants) {
    const std::size_t colon = text.find(':');
    const std::string name = text.substr(0, colon);
    if (colon == std::string::npos || name.empty() || name == "adit" ||
        name.find('/') != std::string::npos) {
      throw UsageError("--variant " + text +
                       ": must be NAME:section.key=value, with a name of its own, e.g. "
                       "--variant lidar:imu.use=false.");
    }
    auto found = std::ranges::find(variants, name, &SlamVariant::name);
    if (found == variants.end()) {
      found = variants.insert(found, {.name = name, .config = options.config});
    }
    found->config.overrides.push_back(text.substr(colon + 1));
  }
  for (const SlamVariant& variant : variants) {
    load_config(variant.config);  // complains before anything is simulated
  }
  return variants;
}

std::string origin_of(const SlamVariant& variant) {
  std::string text = variant.config.preset.empty() ? "" : "preset " + variant.config.preset;
  if (variant.config.file) {
    text += (text.empty() ? "" : ", ") + variant.config.file->string();
  }
  for (const std::string& setting : variant.config.overrides) {
    text += (text.empty() ? "" : ", ") + setting;
  }
  return text.empty() ? "default settings" : text;
}

/// The folders of other systems' trajectories, by name.
std::vector<fs::path> peers_in(const fs::path& folder) {
  std::vector<fs::path> peers;
  if (folder.empty()) {
    return peers;
  }
  if (!fs::is_directory(folder)) {
    throw InputError(folder, {}, "it is no folder", "Give a folder with SYSTEM/SEQUENCE.tum");
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory()) {
      peers.push_back(entry.path());
    }
  }
  if (peers.empty()) {
    throw InputError(folder, {}, "there is no folder of a system in it",
                     "Give a folder with SYSTEM/SEQUENCE.tum");
  }
  std::ranges::sort(peers);
  return peers;
}

SlamSequence sequence_of(const Candidate& candidate, const fs::path& folder, std::ostream& err) {
  if (!candidate.entry) {
    return candidate.sequence;
  }
  std::optional<Progress> progress;
  SlamSequence sequence =
      simulated_sequence(*candidate.entry, folder, [&](std::size_t done, std::size_t total) {
        if (!progress) {
          progress.emplace(err, progress_style_of_stderr(), "simulating " + candidate.name, total);
        }
        progress->update(done, 0);
      });
  if (progress) {
    progress->finish();
  }
  return sequence;
}

SlamReport measure_all(const BenchSlamOptions& options, const std::vector<Candidate>& sequences,
                       std::ostream& out, std::ostream& err) {
  const std::vector<SlamVariant> variants = variants_of(options);
  const std::vector<fs::path> peers = peers_in(options.trajectories);
  SlamReport report;
  {
    const engine::Context context = open_device(options.device);
    report.setting = setting_of(context.device());
    if (context.software_fallback()) {
      err << software_note(context.device()) << std::endl;
    }
  }
  for (const SlamVariant& variant : variants) {
    report.systems.push_back({.name = variant.name, .origin = origin_of(variant)});
  }
  for (const fs::path& peer : peers) {
    report.systems.push_back({.name = peer.filename().string(), .origin = peer.string()});
  }
  print_setting(report, sequences.size(), out);
  options.loops ? print_loop_head(report, out) : print_head(report, out);
  out << std::flush;
  for (const Candidate& candidate : sequences) {
    SlamSequence sequence = sequence_of(candidate, options.output / "recordings", err);
    if (!options.loops) {
      sequence.loops.reset();
    }
    SlamRow& row = report.rows.emplace_back();
    row.sequence = sequence.name;
    row.family = sequence.family;
    row.description = sequence.description;
    const auto add = [&](SlamResult result) {
      row.results.push_back(judged(std::move(result), report.limits));
      (options.loops ? print_loop_result : print_result)(report, row, row.results.size() - 1, out);
      out << std::flush;
    };
    for (const SlamVariant& variant : variants) {
      add(map_sequence(sequence, variant, options.device,
                       options.output / "runs" / variant.name / sequence.name));
    }
    for (const fs::path& peer : peers) {
      add(judge_system(sequence, peer));
    }
  }
  return report;
}

int bench_slam(const BenchSlamOptions& options, std::ostream& out, std::ostream& err) {
  const std::vector<Candidate> sequences = chosen(candidates(options), options.only);
  if (options.list) {
    for (const Candidate& one : sequences) {
      out << one.name << std::string(one.name.size() < 22 ? 22 - one.name.size() : 1, ' ')
          << one.description << "\n";
    }
    return 0;
  }
  const SlamReport report = measure_all(options, sequences, out, err);
  if (options.loops) {
    print_loop_spreads(report, out);
  } else {
    print_table(report, out);
    print_families(report, out);
  }
  out << "\n";
  if (!options.json.empty()) {
    constexpr auto kReplaceBadText = nlohmann::ordered_json::error_handler_t::replace;
    write_text_file(options.json, to_json(report).dump(1, ' ', false, kReplaceBadText) + "\n");
    out << "wrote    " << options.json.string() << "\n";
  }
  if (!options.html.empty()) {
    write_text_file(options.html, to_html(report));
    out << "wrote    " << options.html.string() << "\n";
  }
  out << "kept     " << options.output.string() << " (recordings, trajectories)" << std::endl;
  return 0;
}

}  // namespace

int bench_slam_command(const BenchSlamOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit bench slam", out, err, [&] { return bench_slam(options, out, err); });
}

void add_bench_slam_command(Command bench, std::function<void(int)> done) {
  const auto options = std::make_shared<BenchSlamOptions>();
  const Command command = bench.add_command(
      "slam", "How accurate: simulated or recorded sequences, mapped and compared with the truth");
  command.footer(
      "Each sequence is mapped as `adit run` does it and compared as `adit evaluate` does it.\n"
      "Simulated recordings are kept in OUT and made but once.\n\n"
      "Examples:\n"
      "  adit bench slam --quick                       a few sequences\n"
      "  adit bench slam --json a.json --html a.html   the whole catalogue, some minutes\n"
      "  adit bench slam --only mine --variant lidar:imu.use=false\n"
      "  adit bench slam --trajectories others         others/SYSTEM/SEQUENCE.tum, a column a "
      "system\n"
      "  adit bench slam --seeds 5                     the whole catalogue five times: median, "
      "worst\n"
      "  adit bench slam --recordings data             data/NAME.bag with data/NAME.truth.tum\n"
      "  adit bench slam --loops --quick               loop closing, on one recording of a mine\n\n"
      "Exit codes: 0 done, whatever failed is in the table; 1 the device or a file failed, 2 "
      "usage.");
  command.flag("--list", options->list, "Name the sequences and do nothing");
  command.option("--only", options->only, "Names of sequences, or how they begin")
      .value_name("NAME");
  command.flag("--quick", options->quick, "Few sequences of the catalogue");
  command.flag("--loops", options->loops,
               "Loop closing: maps with loops, on long recordings of places seen again");
  command
      .option("--seeds", options->seeds,
              "Each sequence of the catalogue so many times, with other seeds and beginnings")
      .from(1, 1000)
      .value_name("N");
  command.option("--first-seed", options->first_seed, "The first of these [1]; alone: that one")
      .from(1, 1'000'000)
      .value_name("SEED");
  command
      .option("--apart", options->apart,
              fmt::format("How far apart along the scene's route five seeds begin (m) [{:.0f}]",
                          kBetweenBeginnings))
      .from(0.0, 10'000.0)
      .value_name("M");
  command
      .option("--recordings", options->recordings,
              "Your recordings, their truth beside them, instead of the catalogue")
      .value_name("DIR");
  command
      .option("--trajectories", options->trajectories,
              "Other systems' trajectories of the sequences: DIR/SYSTEM/SEQUENCE.tum")
      .value_name("DIR");
  command
      .option("--variant", options->variants,
              "One more column of ours, NAME:section.key=value; may be given again, also for "
              "the same NAME")
      .one_value_each()
      .value_name("SETTING");
  add_config_options(command, options->config);
  add_device_options(command, options->device);
  command
      .option("-o,--output", options->output,
              "Folder for simulated recordings and our trajectories")
      .value_name("OUT")
      .show_default();
  command.option("--json", options->json, "Write all figures").value_name("FILE").written();
  command.option("--html", options->html, "Write a page with every trajectory")
      .value_name("FILE")
      .written();
  command.action([options, done = std::move(done)] {
    done(bench_slam_command(*options, std::cout, std::cerr));
  });
}

}  // namespace adit::bench
