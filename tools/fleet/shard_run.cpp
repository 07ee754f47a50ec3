// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/shard_run.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <exception>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/fleet/fleet_stages.hpp"
#include "adit/tools/fleet/map_places.hpp"
#include "adit/tools/fleet/shared_files.hpp"
#include "adit/tools/support/child_process.hpp"
#include "adit/tools/support/fingerprint.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/temporary_folder.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr int kKilled = 128;      // and above: by a signal
constexpr int kNotStarted = 127;  // run_child(): no such program, or no such folder

std::string replaced(std::string text, std::string_view what, const std::string& by) {
  const std::size_t at = text.find(what);
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

/// What a shard's command has printed.
class ShardLog {
 public:
  explicit ShardLog(fs::path file) : file_(std::move(file)) {
    std::error_code error;
    const uintmax_t size = fs::file_size(file_, error);
    begin_ = error ? 0 : static_cast<std::size_t>(size);
  }

  const fs::path& file() const { return file_; }

  std::string text() const {
    const std::string whole = read_whole_file(file_);
    return whole.substr(std::min(begin_, whole.size()));
  }
  /// The last line with this in it.
  std::string last_line(std::string_view part = "") const {
    const std::string said = text();
    LineReader lines(said);
    std::string last;
    while (const auto line = lines.next()) {
      const bool says = line->find_first_not_of(" \t") != std::string::npos;
      last = says && line->find(part) != std::string::npos ? std::string(*line) : last;
    }
    return last;
  }
  /// The line that reports a full disk; empty if there is none.
  std::string line_of_a_full_disk() const {
    for (const std::string& words :
         {std::generic_category().message(ENOSPC), std::generic_category().message(EDQUOT),
          std::string("disk is full")}) {
      const std::string line = last_line(words);
      if (!line.empty()) {
        return line;
      }
    }
    return {};
  }

 private:
  fs::path file_;
  std::size_t begin_ = 0;  ///< of this run's part
};

/// A shard while it runs: in a folder on a disk of this machine.
class ShardRun {
 public:
  ShardRun(const FleetPlan& plan, const Shard& shard, std::string key, const ShardProgram& program,
           std::ostream& out, std::ostream& err)
      : plan_(&plan),
        shard_(&shard),
        ledger_(plan.folder),
        key_(std::move(key)),
        program_(&program),
        out_(&out),
        err_(&err),
        log_(ledger_.log(shard.id)),
        scratch_("adit-shard-"),
        made_(scratch_.path() / "out") {}

  int run() {
    const StopSignal stop;
    const bool is_run = shard_->stage == FleetStage::map;
    const ChildProcess child = {.program = program_->program,
                                .words = words(),
                                .folder = is_run ? plan_->fleet_folder : plan_->folder,
                                .log = log_.file()};
    ledger_.note_start(shard_->id, key_);
    try {
      outcome_ = run_child(child);
    } catch (const OutputError&) {
      ledger_.note_end(shard_->id, key_);
      throw;
    }
    if (StopSignal::received() != 0) {
      ledger_.note_end(shard_->id, key_);
      *err_ << "adit shard: " << shard_->id << " was stopped\n";
      return kKilled + StopSignal::received();
    }
    if (outcome_.code >= kKilled) {
      return again(fmt::format("it was killed (signal {})", outcome_.code - kKilled));
    }
    ledger_.note_end(shard_->id, key_);
    if (outcome_.code == kNotStarted) {
      return again(program_->program.string() + " cannot be run in " +
                   plan_->fleet_folder.string() + " on this machine");
    }
    if (const std::string line = log_.line_of_a_full_disk(); !line.empty()) {
      return again("a disk is full: " + line);
    }
    return outcome_.code == 0 ? take_result() : fail(log_.last_line());
  }

  int again(const std::string& why) const {
    *err_ << "adit shard: " << shard_->id << ": " << why << ". Run it again; its log is "
          << log_.file().string() << "\n";
    return kShardAgain;
  }

  int fail(const std::string& reason) const {
    ledger_.set_failed(shard_->id, result({}, reason));
    *err_ << "adit shard: " << shard_->id << " has failed: " << reason << "\n  its log is "
          << log_.file().string() << "\n";
    return kShardFailed;
  }

 private:
  std::vector<std::string> words() const {
    const fs::path map = scratch_.path() / "map.adit";
    std::vector<std::string> words;
    for (const std::string& word : shard_->words) {
      if (word == "{map}") {
        put_copy(plan_->folder / "site" / "map.adit", map);
      }
      words.push_back(
          replaced(replaced(replaced(word, "{out}", made_.string()), "{map}", map.string()),
                   "{plan}", plan_->folder.string()));
    }
    if (shard_->stage == FleetStage::map || shard_->stage == FleetStage::pairs) {
      words.insert(words.end(), program_->device_words.begin(), program_->device_words.end());
    }
    if (shard_->stage != FleetStage::map) {
      fs::create_directories(made_);
    }
    return words;
  }

  ShardResult result(const std::string& hash, const std::string& reason) const {
    return {.key = key_,
            .hash = hash,
            .reason = reason,
            .host = host_name(),
            .seconds = outcome_.seconds,
            .processor_seconds = outcome_.processor_seconds,
            .peak_memory = outcome_.peak_memory};
  }

  /// Another machine may have run it, and somebody may have planned anew, in the meantime.
  ShardStanding standing_now() const {
    try {
      const FleetPlan plan = read_plan(plan_->folder);
      const auto shard = std::ranges::find(plan.shards, shard_->id, &Shard::id);
      return shard == plan.shards.end() ? ShardStanding{} : standing_of(plan, *shard);
    } catch (const InputError&) {
      return {};  // it is being written
    }
  }

  int take_result() const {
    const ShardStanding now = standing_now();
    if (now.key != key_) {
      return again("what it is made of has changed meanwhile");
    }
    if (now.state == ShardState::done) {
      *out_ << "kept   " << shard_->id << "\n";
      return kShardDone;
    }
    std::string hash;
    std::string left_out;
    if (shard_->stage == FleetStage::product) {
      hash = take_product();
      left_out = hash.empty() ? log_.last_line("left out") : "";
      if (hash.empty() && left_out.empty()) {
        return fail("it has written nothing");
      }
    } else {
      hash = take_files();
    }
    ledger_.set_done(shard_->id, result(hash, left_out));
    *out_ << fmt::format("done   {} in {:.1f} s\n", shard_->id, outcome_.seconds);
    return kShardDone;
  }

  /// Puts the results where later stages read them. Returns the hash of what these read.
  std::string take_files() const {
    switch (shard_->stage) {
      case FleetStage::map:
        return take_map();
      case FleetStage::index:
        return take_file("pairs.json", shard_->result);
      case FleetStage::pairs:
        return take_file("pairs.txt", shard_->result);
      case FleetStage::solve: {
        put_copy(made_, plan_->folder / shard_->result);
        return whole_hash(made_ / "map.adit");
      }
      case FleetStage::report:
        remove_stale_products(*plan_);
        take_file("README.md", fs::path("delivery") / "README.md");
        return take_file("report.md", shard_->result);
      case FleetStage::product:
        break;
    }
    return {};
  }

  std::string take_file(const char* name, const fs::path& to) const {
    put_copy(made_ / name, plan_->folder / to);
    return whole_hash(made_ / name);
  }

  std::string take_map() const {
    const fs::path map = made_ / "map.adit";
    std::error_code error;
    const MapPlaces places =
        fs::exists(map, error) ? places_of(MapDatabase(map, MapAccess::read)) : MapPlaces{};
    if (places.keyframes == 0) {
      throw InputError(shard_->inputs.front(), {}, "its run has made no map",
                       "See the log of its shard");
    }
    write_text_file(made_ / "places.json", to_json(places));
    put_copy(made_, plan_->folder / shard_->result);
    return whole_hash(map);
  }

  /// Empty: the map has nothing for it.
  std::string take_product() const {
    const fs::path delivery = plan_->folder / "delivery";
    for (const fs::path& old : product_files(*plan_, *shard_, delivery)) {
      std::error_code ignored;
      fs::remove(old, ignored);
    }
    std::string hashes;
    for (const fs::path& file : product_files(*plan_, *shard_, made_)) {
      put_copy(file, delivery / file.filename());
      hashes += file.filename().string() + " " + whole_hash(file) + "\n";
    }
    return hashes.empty() ? hashes : text_hash(hashes);
  }

  const FleetPlan* plan_;
  const Shard* shard_;
  ShardLedger ledger_;
  std::string key_;
  const ShardProgram* program_;
  std::ostream* out_;
  std::ostream* err_;
  ShardLog log_;
  TemporaryFolder scratch_;
  fs::path made_;
  ChildOutcome outcome_;
};

/// How often the shard was killed on this machine. Of others nobody knows whether they still work.
std::size_t kills_of(const ShardLedger& ledger, const Shard& shard, const std::string& key) {
  const std::string host = host_name();
  const std::vector<ShardStart> starts = ledger.starts(shard.id);
  return static_cast<std::size_t>(std::ranges::count_if(starts, [&](const ShardStart& one) {
    return one.key == key && !one.ended && one.host == host &&
           kill(static_cast<pid_t>(one.process), 0) != 0 && errno == ESRCH;
  }));
}

int wait_for_others(const FleetPlan& plan, const Shard& shard, std::ostream& err) {
  const std::vector<ShardStanding> standings = standings_of(plan, shard.stage);
  const std::size_t missing = missing_for(plan, shard, standings).value_or(0);
  const bool has_failed = standings[missing].state == ShardState::failed;
  err << "adit shard: " << shard.id << " waits for " << plan.shards[missing].id
      << (has_failed ? ", which has failed\n" : ", which is not done\n");
  return has_failed ? kShardFailed : kShardAgain;
}

int run_in_turn(const FleetPlan& plan, const Shard& shard, const ShardProgram& program,
                std::ostream& out, std::ostream& err) {
  const ShardLedger ledger(plan.folder);
  ledger.prepare();
  const auto& [key, state] = standing_of(plan, shard);
  if (!key) {
    return wait_for_others(plan, shard, err);
  }
  if (state == ShardState::done) {
    out << "kept   " << shard.id << "\n";
    return kShardDone;
  }
  if (state == ShardState::failed) {
    err << "adit shard: " << shard.id << " has failed before: " << ledger.failed(shard.id)->reason
        << "\n  `adit plan " << plan.folder.string() << " --retry` lets it be tried again\n";
    return kShardFailed;
  }
  ShardRun run(plan, shard, *key, program, out, err);
  try {
    if (shard.stage == FleetStage::map && fingerprint(shard.inputs).hash != shard.input_hash) {
      return run.fail(shard.inputs.front().string() +
                      " has changed since the plan was made. Make the plan again");
    }
    if (kills_of(ledger, shard, *key) >= kMostKills) {
      return run.fail(
          fmt::format("it was killed {} times: it needs more memory, perhaps", kMostKills));
    }
    return run.run();
  } catch (const InputError& error) {
    return run.fail(error.what());
  }
}

}  // namespace

int run_shard(const FleetPlan& plan, const Shard& shard, const ShardProgram& program,
              std::ostream& out, std::ostream& err) {
  try {
    return run_in_turn(plan, shard, program, out, err);
  } catch (const FileError& error) {
    err << "adit shard: " << shard.id << ": " << error.what() << " Run it again\n";
    return kShardAgain;
  } catch (const fs::filesystem_error& error) {
    err << "adit shard: " << shard.id << ": " << error.what() << ". Run it again\n";
    return kShardAgain;
  }
}

}  // namespace adit
