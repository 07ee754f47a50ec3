// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/shard_run.hpp"

#include <algorithm>
#include <array>
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
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr int kKilled = 128;             // and above: by a signal
constexpr uintmax_t kNoRoom = 64 << 20;  // bytes: a disk with less room is full

/// A recording without a map and a product that could not be written are results: others go on.
bool is_settled(FleetStage stage, ShardState state) {
  return state == ShardState::done || (state == ShardState::failed &&
                                       (stage == FleetStage::map || stage == FleetStage::product));
}

std::string replaced(std::string text, std::string_view what, const std::string& by) {
  const std::size_t at = text.find(what);
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

/// The last line of a log that says something.
std::string last_line(const fs::path& log) {
  const std::string text = read_text_file(log);
  LineReader lines(text);
  std::string last;
  while (const auto line = lines.next()) {
    if (line->find_first_not_of(" \t") != std::string::npos) {
      last = *line;
    }
  }
  return last;
}

bool is_full(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  return !error && space.available < kNoRoom;
}

/// A shard while it runs: in a folder on a disk of this machine.
class ShardRun {
 public:
  ShardRun(const FleetPlan& plan, const Shard& shard, std::string key, fs::path program)
      : plan_(&plan),
        shard_(&shard),
        ledger_(plan.folder),
        key_(std::move(key)),
        program_(std::move(program)),
        scratch_("adit-shard-"),
        out_(scratch_.path() / "out") {}

  int run(std::ostream& out, std::ostream& err) {
    const StopSignal stop;
    ledger_.note_start(shard_->id, key_);
    outcome_ = run_child({.program = program_,
                          .words = words(),
                          .folder = plan_->fleet_folder,
                          .log = ledger_.log(shard_->id)});
    if (StopSignal::received() != 0) {
      ledger_.note_end(shard_->id, key_);
      err << "adit shard: " << shard_->id << " was stopped\n";
      return kKilled + StopSignal::received();
    }
    if (outcome_.code == kShardAgain || is_full(scratch_.path()) || is_full(plan_->folder)) {
      ledger_.note_end(shard_->id, key_);
      return again("a disk is full, or a result of an earlier stage is gone", err);
    }
    if (outcome_.code >= kKilled) {  // its start counts
      return again(fmt::format("it was killed (signal {})", outcome_.code - kKilled), err);
    }
    return outcome_.code == 0 ? take_result(out, err) : fail(last_line(log()), err);
  }

 private:
  fs::path log() const { return ledger_.log(shard_->id); }

  std::vector<std::string> words() const {
    const fs::path map = scratch_.path() / "map.adit";
    std::vector<std::string> words;
    for (const std::string& word : shard_->words) {
      if (word.find("{map}") != std::string::npos) {
        put_copy(plan_->folder / "site" / "map.adit", map);
      }
      words.push_back(replaced(replaced(word, "{out}", out_.string()), "{map}", map.string()));
    }
    if (shard_->stage != FleetStage::map) {
      fs::create_directories(out_);
    }
    return words;
  }

  int again(const std::string& why, std::ostream& err) const {
    err << "adit shard: " << shard_->id << ": " << why << ". Run it again; its log is "
        << log().string() << "\n";
    return kShardAgain;
  }

  ShardResult result(const std::string& hash, const std::string& reason) const {
    return {.key = key_,
            .hash = hash,
            .reason = reason,
            .host = host_name(),
            .code = outcome_.code,
            .seconds = outcome_.seconds,
            .processor_seconds = outcome_.processor_seconds,
            .peak_memory = outcome_.peak_memory};
  }

  int fail(const std::string& reason, std::ostream& err) const {
    ledger_.set_failed(shard_->id, result({}, reason));
    ledger_.note_end(shard_->id, key_);
    err << "adit shard: " << shard_->id << " has failed: " << reason << "\n  its log is "
        << log().string() << "\n";
    return kShardFailed;
  }

  int take_result(std::ostream& out, std::ostream& err) const {
    std::string hash;
    std::string left_out;
    try {
      if (shard_->stage == FleetStage::product) {
        hash = take_product();
        left_out = hash.empty() ? "left out: the map has nothing for it" : "";
      } else {
        hash = take_files();
      }
    } catch (const InputError& error) {
      return fail(error.what(), err);
    } catch (const OutputError& error) {
      ledger_.note_end(shard_->id, key_);
      return again(error.what(), err);
    }
    ledger_.set_done(shard_->id, result(hash, left_out));
    ledger_.note_end(shard_->id, key_);
    out << fmt::format("done   {} in {:.1f} s\n", shard_->id, outcome_.seconds);
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
        put_copy(out_, plan_->folder / shard_->result);
        return fingerprint(out_ / "map.adit").hash;
      }
      case FleetStage::report:
        take_file("README.md", fs::path("delivery") / "README.md");
        return take_file("report.md", shard_->result);
      case FleetStage::product:
        break;
    }
    return {};
  }

  std::string take_file(const char* name, const fs::path& to) const {
    put_copy(out_ / name, plan_->folder / to);
    return fingerprint(out_ / name).hash;
  }

  std::string take_map() const {
    const fs::path map = out_ / "map.adit";
    std::error_code error;
    if (!fs::exists(map, error)) {
      throw InputError(shard_->inputs.front(), {}, "its run has made no map",
                       "See the log of its shard");
    }
    write_text_file(out_ / "places.json", to_json(places_of(MapDatabase(map, MapAccess::read))));
    put_copy(out_, plan_->folder / shard_->result);
    return fingerprint(map).hash;
  }

  /// Empty: the map has nothing for it.
  std::string take_product() const {
    const DeliveryProduct product{.file = shard_->result.filename().string()};
    const fs::path delivery = plan_->folder / "delivery";
    for (const fs::path& old : files_of_product(product, delivery)) {
      std::error_code ignored;
      fs::remove(old, ignored);
    }
    std::string hashes;
    for (const fs::path& file : files_of_product(product, out_)) {
      put_copy(file, delivery / file.filename());
      hashes += file.filename().string() + " " + fingerprint(file).hash + "\n";
    }
    return hashes.empty() ? hashes : text_hash(hashes);
  }

  const FleetPlan* plan_;
  const Shard* shard_;
  ShardLedger ledger_;
  std::string key_;
  fs::path program_;
  TemporaryFolder scratch_;
  fs::path out_;
  ChildOutcome outcome_;
};

std::string key_of(const FleetPlan& plan, const Shard& shard, const std::string& before) {
  std::string made_of = fmt::format("{} {} {}", version(), shard.id, shard.input_hash) + before;
  const auto add = [&](const std::vector<std::string>& words) {
    for (const std::string& word : words) {
      made_of += " " + replaced(word, plan.folder.string(), "");
    }
  };
  switch (shard.stage) {
    case FleetStage::map:
      add(shard.words);
      break;
    case FleetStage::product:
      add(shard.words);
      add(plan.products.at(shard.number).options);
      break;
    case FleetStage::pairs:
      made_of += fmt::format(" of {}{}", plan.of(FleetStage::pairs).size(),
                             plan.same_site ? " same site" : "");
      break;
    case FleetStage::index:
    case FleetStage::solve:
    case FleetStage::report:
      break;
  }
  return text_hash(made_of);
}

ShardState state_of(const ShardLedger& ledger, const Shard& shard, const std::string& key) {
  if (const auto done = ledger.done(shard.id); done && done->key == key) {
    return ShardState::done;
  }
  if (const auto failed = ledger.failed(shard.id); failed && failed->key == key) {
    return ShardState::failed;
  }
  const std::vector<ShardStart> starts = ledger.starts(shard.id);
  return !starts.empty() && starts.back().key == key && !starts.back().ended ? ShardState::running
                                                                             : ShardState::waiting;
}

bool is_changed(const Shard& shard) {
  return shard.stage == FleetStage::map && fingerprint(shard.inputs).hash != shard.input_hash;
}

}  // namespace

std::string_view to_string(ShardState state) {
  constexpr std::array<std::string_view, 4> kNames = {"waiting", "running", "done", "failed"};
  return kNames[static_cast<std::size_t>(state)];
}

std::vector<ShardStanding> standings_of(const FleetPlan& plan, FleetStage last) {
  const ShardLedger ledger(plan.folder);
  std::vector<ShardStanding> standings;
  bool settled = true;   // the stages before
  std::string earlier;   // their results
  std::string before;    // those of the last one
  std::string of_stage;  // those of the present one
  for (const Shard& shard : plan.shards) {
    if (shard.stage > last) {
      break;
    }
    if (shard.number == 0 && shard.stage != FleetStage::map) {
      for (std::size_t i = 0; i < standings.size(); ++i) {
        settled = settled && is_settled(plan.shards[i].stage, standings[i].state);
      }
      before = std::exchange(of_stage, {});
      earlier += before;
    }
    ShardStanding standing;
    if (settled) {
      // Products are of the map of all, whatever that was made of.
      const bool of_last = shard.stage == FleetStage::product || shard.stage == FleetStage::pairs;
      standing.key = key_of(plan, shard, of_last ? before : earlier);
      standing.state = state_of(ledger, shard, *standing.key);
      of_stage += shard.id + " " +
                  (standing.state == ShardState::done ? ledger.done(shard.id)->hash : "failed") +
                  "\n";
    }
    standings.push_back(standing);
  }
  return standings;
}

std::optional<std::string> missing_for(const FleetPlan& plan, const Shard& shard,
                                       std::span<const ShardStanding> standings) {
  for (std::size_t i = 0; i < standings.size(); ++i) {
    const Shard& earlier = plan.shards[i];
    if (earlier.stage < shard.stage && !is_settled(earlier.stage, standings[i].state)) {
      return earlier.id;
    }
  }
  return std::nullopt;
}

int run_shard(const FleetPlan& plan, const Shard& shard, const fs::path& program, std::ostream& out,
              std::ostream& err) {
  const ShardLedger ledger(plan.folder);
  ledger.prepare();
  const std::vector<ShardStanding> standings = standings_of(plan, shard.stage);
  const std::size_t place = static_cast<std::size_t>(&shard - plan.shards.data());
  const auto& [key, state] = standings.at(place);
  if (!key) {
    err << "adit shard: " << shard.id << " waits for "
        << missing_for(plan, shard, standings).value_or("another shard") << ", which is not done\n";
    return kShardAgain;
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
  if (is_changed(shard)) {
    err << "adit shard: " << shard.inputs.front().string()
        << " has changed since the plan was made. Make the plan again\n";
    return kShardFailed;
  }
  const std::vector<ShardStart> starts = ledger.starts(shard.id);
  const auto unended = std::ranges::count_if(
      starts, [&](const ShardStart& one) { return one.key == *key && !one.ended; });
  if (static_cast<std::size_t>(unended) >= kMostStarts) {
    const std::string reason = fmt::format(
        "it was begun {} times and never came to an end: killed, or no memory", unended);
    ledger.set_failed(shard.id, {.key = *key, .reason = reason, .host = host_name()});
    err << "adit shard: " << shard.id << " has failed: " << reason << "\n";
    return kShardFailed;
  }
  return ShardRun(plan, shard, *key, program).run(out, err);
}

}  // namespace adit
