// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/shard_ledger.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "adit/tools/fleet/shared_files.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kDone = "done";
constexpr const char* kFailed = "failed";
constexpr const char* kStarts = "starts";
constexpr const char* kLogs = "logs";

int64_t now() {
  return std::chrono::duration_cast<std::chrono::seconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// One write() at the end of a file. Where a network's file system mixes lines of two machines, a
/// start is lost: nothing but its count.
void append_line(const fs::path& file, const std::string& line) {
  const int descriptor =
      open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);  // NOLINT: POSIX
  const bool written = descriptor >= 0 && write(descriptor, line.data(), line.size()) ==
                                              static_cast<ssize_t>(line.size());
  const int reason = errno;
  if (descriptor >= 0) {
    close(descriptor);
  }
  if (!written) {
    throw OutputError(file, file.string() + ": cannot be written: " + std::strerror(reason));
  }
}

/// A line of a shard's starts. One that was cut off when a machine lost power says nothing.
void note_in(std::vector<ShardStart>& starts, std::string_view line) {
  try {
    const Json json = Json::parse(line);
    const std::string event = json.value("event", "");
    const ShardStart one{.key = json.value("key", ""),
                         .host = json.value("host", ""),
                         .process = json.value("process", int64_t{0})};
    if (event == "start") {
      starts.push_back(one);
    }
    for (ShardStart& start : starts) {
      start.ended = start.ended || event == "forgiven" ||
                    (event == "end" && start.host == one.host && start.process == one.process);
    }
  } catch (const Json::exception&) {
  }
}

}  // namespace

std::optional<ShardResult> ShardLedger::read(const char* folder, const std::string& shard) const {
  const fs::path file = folder_ / folder / (shard + ".json");
  std::error_code error;
  if (!fs::exists(file, error)) {
    return std::nullopt;
  }
  try {
    const Json json = Json::parse(read_whole_file(file));
    return ShardResult{.key = json.value("key", ""),
                       .hash = json.value("hash", ""),
                       .reason = json.value("reason", ""),
                       .host = json.value("host", ""),
                       .seconds = json.value("seconds", 0.0),
                       .processor_seconds = json.value("processor_seconds", 0.0),
                       .peak_memory = json.value("peak_memory", uint64_t{0})};
  } catch (const Json::exception&) {
    return std::nullopt;  // damaged: the shard runs again
  }
}

void ShardLedger::write(const char* folder, const std::string& shard,
                        const ShardResult& result) const {
  Json json;
  json["key"] = result.key;
  json["hash"] = result.hash;
  json["reason"] = result.reason;
  json["host"] = result.host;
  json["seconds"] = result.seconds;
  json["processor_seconds"] = result.processor_seconds;
  json["peak_memory"] = result.peak_memory;
  put_text(folder_ / folder / (shard + ".json"),
           json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::optional<ShardResult> ShardLedger::done(const std::string& shard) const {
  return read(kDone, shard);
}

std::vector<std::string> ShardLedger::all_done() const {
  std::vector<std::string> shards;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / kDone, error)) {
    const fs::path name = entry.path().filename();
    if (name.extension() == ".json" && !name.string().starts_with('.')) {
      shards.push_back(name.stem().string());
    }
  }
  std::ranges::sort(shards);
  return shards;
}

void ShardLedger::forget(const std::string& shard) const {
  std::error_code ignored;
  fs::remove(folder_ / kDone / (shard + ".json"), ignored);
}

std::optional<ShardResult> ShardLedger::failed(const std::string& shard) const {
  return read(kFailed, shard);
}

std::vector<ShardStart> ShardLedger::starts(const std::string& shard) const {
  const fs::path file = folder_ / kStarts / (shard + ".jsonl");
  std::error_code error;
  std::vector<ShardStart> starts;
  if (!fs::exists(file, error)) {
    return starts;
  }
  const std::string text = read_whole_file(file);
  LineReader lines(text);
  while (const auto line = lines.next()) {
    note_in(starts, *line);
  }
  return starts;
}

fs::path ShardLedger::log(const std::string& shard) const {
  return folder_ / kLogs / (shard + ".log");
}

void ShardLedger::set_done(const std::string& shard, const ShardResult& result) const {
  write(kDone, shard, result);
  std::error_code ignored;
  fs::remove(folder_ / kFailed / (shard + ".json"), ignored);
}

void ShardLedger::set_failed(const std::string& shard, const ShardResult& result) const {
  write(kFailed, shard, result);
}

void ShardLedger::note(const std::string& shard, const std::string& key, const char* event) const {
  Json json;
  json["event"] = event;
  json["key"] = key;
  json["host"] = host_name();
  json["process"] = getpid();
  json["time"] = now();  // for people
  append_line(folder_ / kStarts / (shard + ".jsonl"), json.dump() + "\n");
}

void ShardLedger::note_start(const std::string& shard, const std::string& key) const {
  note(shard, key, "start");
}

void ShardLedger::note_end(const std::string& shard, const std::string& key) const {
  note(shard, key, "end");
}

void ShardLedger::forgive(const std::string& shard) const {
  std::error_code ignored;
  fs::remove(folder_ / kFailed / (shard + ".json"), ignored);
  if (!starts(shard).empty()) {
    note(shard, "", "forgiven");
  }
}

void ShardLedger::prepare() const {
  for (const char* const name : {kDone, kFailed, kStarts, kLogs}) {
    std::error_code error;
    fs::create_directories(folder_ / name, error);
    if (error) {
      throw OutputError(folder_, folder_.string() + ": cannot be written: " + error.message());
    }
  }
}

}  // namespace adit
