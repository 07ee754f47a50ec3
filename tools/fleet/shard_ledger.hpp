// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What became of shards, as files in the plan's folder: machines that know nothing of each other
// share it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/fleet/fleet_plan.hpp"

namespace adit {

/// How a shard ended.
struct ShardResult {
  std::string key{};   ///< what it was made of: command, inputs, results of earlier stages, version
  std::string hash{};  ///< of what later stages read of it; of a failure empty
  std::string reason{};  ///< of a failure, one line; of a product, why it was left out
  std::string host{};    ///< the machine
  double seconds = 0.0;  ///< by the clock
  double processor_seconds = 0.0;
  uint64_t peak_memory = 0;  ///< bytes
};

/// A shard that was begun.
struct ShardStart {
  std::string key{};
  std::string host{};
  int64_t process = 0;
  bool ended = false;  ///< it came to its end, whatever that was, or is forgiven
};

/// The records of a plan's folder.
class ShardLedger {
 public:
  explicit ShardLedger(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// How it ended well; nothing: it has not.
  std::optional<ShardResult> done(const std::string& shard) const;
  /// All that have ended well, by name.
  std::vector<std::string> all_done() const;
  /// How it failed last.
  std::optional<ShardResult> failed(const std::string& shard) const;
  /// All of its starts, the oldest first.
  std::vector<ShardStart> starts(const std::string& shard) const;
  /// What its command printed.
  std::filesystem::path log(const std::string& shard) const;

  /// Throw OutputError.
  void set_done(const std::string& shard, const ShardResult& result) const;
  void set_failed(const std::string& shard, const ShardResult& result) const;
  /// This process begins or ends it.
  void note_start(const std::string& shard, const std::string& key) const;
  void note_end(const std::string& shard, const std::string& key) const;
  /// It may be tried again as if it had never failed.
  void forgive(const std::string& shard) const;
  /// As if it had never ended well.
  void forget(const std::string& shard) const;
  /// Makes the folders of the records. Throws OutputError.
  void prepare() const;

 private:
  std::optional<ShardResult> read(const char* folder, const std::string& shard) const;
  void write(const char* folder, const std::string& shard, const ShardResult& result) const;
  void note(const std::string& shard, const std::string& key, const char* event) const;

  std::filesystem::path folder_;
};

}  // namespace adit
