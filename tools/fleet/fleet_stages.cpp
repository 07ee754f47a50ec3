// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/fleet_stages.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <system_error>
#include <utility>

#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "adit/tools/fleet/shard_ledger.hpp"
#include "adit/tools/fleet/shard_standing.hpp"
#include "adit/tools/fleet/shared_files.hpp"
#include "adit/tools/map_merge/merge_job.hpp"
#include "adit/tools/map_merge/merge_report.hpp"
#include "adit/tools/map_merge/tie_file.hpp"
#include "adit/tools/support/commit.hpp"
#include "adit/tools/support/fingerprint.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

fs::path index_of(const FleetPlan& plan) {
  return plan.folder / "index" / "pairs.json";
}

/// In the plan's folder, wherever that lies.
fs::path relative_map(const std::string& name) {
  return fs::path("maps") / name / "map.adit";
}

/// SQLite wants its files on a disk of this machine: a copy of a map, NAME.adit.
fs::path local_copy(const FleetPlan& plan, const std::string& name, const fs::path& folder) {
  const fs::path copy = folder / (name + ".adit");
  std::error_code error;
  if (fs::exists(copy, error)) {
    return copy;
  }
  fs::copy_file(map_of(plan, name), copy, error);
  if (error) {
    throw OutputError(copy, copy.string() + ": cannot be written: " + error.message());
  }
  return copy;
}

/// The name that local_copy() was given.
std::string name_of_copy(const fs::path& copy) {
  return copy.stem().string();
}

/// A folder for copies, which goes away.
class Copies {
 public:
  explicit Copies(const fs::path& into) : folder_(into / "copies") {
    fs::create_directories(folder_);
  }
  ~Copies() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Copies(const Copies&) = delete;
  Copies& operator=(const Copies&) = delete;
  const fs::path& folder() const { return folder_; }
  /// The copies of these maps, and no others.
  void keep_only(const std::array<std::string, 2>& names) const {
    std::vector<fs::path> others;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      if (std::ranges::count(names, name_of_copy(entry.path())) == 0) {
        others.push_back(entry.path());
      }
    }
    for (const fs::path& other : others) {
      fs::remove(other);
    }
  }

 private:
  fs::path folder_;
};

std::string tie_key(const FleetPlan& plan, const FleetIndex& index, const MapPair& pair) {
  std::array hashes = {index.hashes.at(pair.first), index.hashes.at(pair.second)};
  std::ranges::sort(hashes);
  return text_hash(std::string(version()) + " " + std::string(commit()) + " " + hashes[0] + " " +
                   hashes[1] + (is_of_one_site(plan, index, pair) ? " same site" : ""));
}

/// Maps are open all at the same time, each with up to three files: as many as the system allows.
void allow_many_files() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) == 0) {
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
  }
}

}  // namespace

std::string map_name(const Shard& shard) {
  return shard.result.filename().string();
}

fs::path map_of(const FleetPlan& plan, const std::string& name) {
  return plan.folder / relative_map(name);
}

bool is_of_one_site(const FleetPlan& plan, const FleetIndex& index, const MapPair& pair) {
  return plan.same_site || (index.on_earth.at(pair.first) && index.on_earth.at(pair.second));
}

fs::path tie_of(const FleetPlan& plan, const FleetIndex& index, const MapPair& pair) {
  return plan.folder / "ties" / (tie_key(plan, index, pair) + ".json");
}

FleetIndex read_index(const FleetPlan& plan) {
  const fs::path file = index_of(plan);
  try {
    const Json json = Json::parse(read_text_file(file));
    FleetIndex index{.failed = json.at("failed").get<std::vector<std::string>>(),
                     .pairs = json.at("pairs").get<std::vector<MapPair>>()};
    for (const Json& map : json.at("maps")) {
      index.maps.push_back(map.at("name").get<std::string>());
      index.hashes.push_back(map.at("hash").get<std::string>());
      index.on_earth.push_back(map.at("on_earth").get<bool>());
    }
    for (const auto& [one, other] : index.pairs) {
      if (one >= other || other >= index.maps.size()) {
        throw InputError(file, {}, "it names a pair of maps that is none",
                         "Remove it, and run the shard `index` again");
      }
    }
    return index;
  } catch (const Json::exception& error) {
    throw InputError(file, {}, std::string("it is no index of maps: ") + error.what(),
                     "Remove it, and run the shard `index` again");
  }
}

void index_maps(const FleetPlan& plan, const fs::path& into) {
  const ShardLedger ledger(plan.folder);
  const std::vector<ShardStanding> standings = standings_of(plan, FleetStage::map);
  Json json;
  json["maps"] = Json::array();
  json["failed"] = Json::array();
  std::vector<MapPlaces> places;
  for (const Shard& shard : plan.of(FleetStage::map)) {
    const std::string name = map_name(shard);
    const std::optional<ShardResult> result = ledger.done(shard.id);
    if (!result || standings[shard.number].state != ShardState::done) {
      json["failed"].push_back(name);
      continue;
    }
    places.push_back(read_places(map_of(plan, name).parent_path() / "places.json"));
    json["maps"].push_back({{"name", name},
                            {"hash", result->hash},
                            {"keyframes", places.back().keyframes},
                            {"on_earth", !places.back().places.empty()}});
  }
  json["pairs"] = pairs_to_search(places);
  write_text_file(into / "pairs.json", json.dump() + "\n");
}

namespace {

/// Of two maps, or why they could not be searched: that is no reason to have no map of the others.
MapTie searched(const std::array<fs::path, 2>& maps, bool same_site, const DeviceOptions& device) {
  try {
    const TiedMaps tied =
        tie_maps(open_merge_inputs({maps[0], maps[1]}), device, {.same_site = same_site},
                 [](const MergeStep&) { return StopSignal::received() == 0; });
    return tie_between(tied.merged, 0, 1);
  } catch (const InputError& error) {
    return {.other = 1, .not_searched = error.what()};
  }
}

/// The lines of what a shard of pairs has written: two names, and the tie's file and hash.
std::vector<std::string> lines_of(const fs::path& file) {
  const std::string text = read_text_file(file);
  LineReader lines(text);
  std::vector<std::string> all;
  while (const auto line = lines.next()) {
    all.emplace_back(*line);
  }
  return all;
}

}  // namespace

bool has_ties(const FleetPlan& plan, const Shard& shard) {
  std::error_code error;
  const fs::path file = plan.folder / shard.result;
  return fs::exists(file, error) &&
         std::ranges::all_of(lines_of(file), [&](const std::string& one) {
           const std::string name = one.substr(one.find('\t') + 1);
           return fs::exists(plan.folder / "ties" / name.substr(0, name.find('\t')), error);
         });
}

void search_pairs(const FleetPlan& plan, const Shard& shard, const DeviceOptions& device,
                  const fs::path& into) {
  const FleetIndex index = read_index(plan);
  const std::size_t shards = plan.of(FleetStage::pairs).size();
  const Copies copies(into);
  std::string list;
  // In a row: pairs with a map in common follow each other.
  const std::size_t begin = index.pairs.size() * shard.number / shards;
  const std::size_t end = index.pairs.size() * (shard.number + 1) / shards;
  for (std::size_t i = begin; i < end; ++i) {
    const MapPair& pair = index.pairs[i];
    const fs::path file = tie_of(plan, index, pair);
    std::error_code error;
    if (!fs::exists(file, error)) {
      copies.keep_only({index.maps[pair.first], index.maps[pair.second]});
      put_text(file, to_json(searched({local_copy(plan, index.maps[pair.first], copies.folder()),
                                       local_copy(plan, index.maps[pair.second], copies.folder())},
                                      is_of_one_site(plan, index, pair), device)));
    }
    list += index.maps[pair.first] + " " + index.maps[pair.second] + "\t" +
            file.filename().string() + "\t" + whole_hash(file) + "\n";
  }
  write_text_file(into / "pairs.txt", list);
}

void solve_fleet(const FleetPlan& plan, const fs::path& into) {
  const FleetIndex index = read_index(plan);
  if (index.maps.size() < 2) {
    throw InputError(plan.folder, {}, "fewer than two recordings have a map",
                     "`adit plan PLAN --status` says what became of the others");
  }
  allow_many_files();
  const Copies copies(into);
  std::vector<fs::path> maps;
  for (const std::string& name : index.maps) {
    maps.push_back(local_copy(plan, name, copies.folder()));
  }
  std::vector<MergeInput> inputs = open_merge_inputs(maps);
  std::map<std::string, std::size_t> number_of;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    number_of[name_of_copy(inputs[i].file)] = i;
  }
  std::vector<MapTie> ties;
  std::vector<MapPair> pair_of;
  for (const MapPair& pair : index.pairs) {
    const auto [one, other] =
        std::minmax(number_of.at(index.maps[pair.first]), number_of.at(index.maps[pair.second]));
    ties.push_back(read_tie(tie_of(plan, index, pair), one, other));
    pair_of.push_back(pair);
  }
  const UnfinishedMap unfinished(into / "map.adit");
  const TiedMaps tied = join_tied_maps(std::move(inputs), ties);
  MergeOutcome outcome = write_merged_map(tied, unfinished);
  for (MergedSession& session : outcome.sessions) {
    session.from = relative_map(name_of_copy(session.from));
  }
  for (MapApart& map : outcome.apart) {
    const std::string name = name_of_copy(map.file);
    map.file = relative_map(name);
    for (std::size_t i = 0; i < ties.size() && !outcome.sessions.empty(); ++i) {
      const std::string& one = index.maps[pair_of[i].first];
      const std::string& other = index.maps[pair_of[i].second];
      if (ties[i].search.is_tied && (name == one || name == other)) {
        map.reason = "it is tied to " + (name == one ? other : one) +
                     ", and nothing ties that to the map of all";
        break;
      }
    }
  }
  const MergeCommandOptions options{.output = fs::path("site") / "map.adit"};
  std::string text = describe(options, outcome);
  for (const std::size_t tie : tied.contradicted) {
    text += "left out  the tie of " + index.maps[pair_of[tie].first] + " and " +
            index.maps[pair_of[tie].second] + ": the others contradict it\n";
  }
  for (std::size_t i = 0; i < ties.size(); ++i) {
    if (!ties[i].not_searched.empty()) {
      text += "left out  the pair of " + index.maps[pair_of[i].first] + " and " +
              index.maps[pair_of[i].second] + ": " + ties[i].not_searched + "\n";
    }
  }
  if (outcome.sessions.empty()) {
    throw InputError(plan.folder, {}, "no map could be tied to another:\n" + text,
                     "See docs/maps.md on what ties maps");
  }
  write_text_file(into / "merge.txt", text);
  write_text_file(into / "merge.json", to_json(options, outcome));
}

}  // namespace adit
