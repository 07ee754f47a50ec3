// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The commands, run to their end on damaged input: what they owe whatever that is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "adit/engine/context.hpp"
#include "adit/tests/commands/healthy_recordings.hpp"
#include "adit/tests/commands/mutations.hpp"
#include "adit/tests/support/temporary_folder.hpp"

namespace adit::test {

/// `maps` are the commands on maps, turn and turn about.
enum class FuzzedCommand { inspect, run, convert, evaluate, align, simulate, maps, config };
inline constexpr FuzzedCommand kFuzzedCommands[] = {FuzzedCommand::inspect, FuzzedCommand::run,
                                                    FuzzedCommand::convert, FuzzedCommand::evaluate,
                                                    FuzzedCommand::align,   FuzzedCommand::simulate,
                                                    FuzzedCommand::maps,    FuzzedCommand::config};
std::string_view to_string(FuzzedCommand command);

/// What a command did.
struct CommandOutcome {
  int code = 0;
  std::string told;       ///< output on both streams
  std::string complaint;  ///< what it owed and did not do; empty: nothing
};

/// Small recordings, runs, scenes and maps, and the commands on damaged copies of them. A case is
/// told by its number: the same command, format and number, the same damage.
class CommandCases {
 public:
  /// Device work is done on `context`.
  explicit CommandCases(engine::Context& context);

  /// Those of recordings, and at last "tables": the files of a run and tables of poses; "scenes":
  /// files that say what to simulate; "maps"; "graphs": files of pose graphs; and "configs".
  std::vector<std::string> formats() const;

  /// Whether it is for the command to read.
  static bool reads(FuzzedCommand command, const std::string& format);

  /// A code of 0, 1 or 2 in bounded time, and nothing written that is not a number. With
  /// Damage::none the same call on the healthy input.
  CommandOutcome run(FuzzedCommand command, const std::string& format, uint64_t number,
                     Damage damage = Damage::some) const;

 private:
  struct Damaged {
    std::filesystem::path recording;
    std::filesystem::path metadata;  // to be named to the command; or empty
  };
  Damaged damaged_recording(const std::string& format, const std::filesystem::path& folder,
                            Dice& dice) const;
  int call(FuzzedCommand command, const std::string& format, const std::filesystem::path& folder,
           Dice& dice, std::ostream& told) const;
  int simulate(const std::filesystem::path& folder, Dice& dice, std::ostream& told) const;
  int maps(const std::string& format, const std::filesystem::path& folder, Dice& dice,
           std::ostream& told) const;
  static int config(const std::filesystem::path& folder, Dice& dice, std::ostream& told);
  int evaluate_tables(const std::filesystem::path& folder, Dice& dice, std::ostream& told) const;
  int evaluate(const std::filesystem::path& recording, Dice& dice, std::ostream& told) const;
  int align(const std::string& cloud, const std::filesystem::path& folder, Dice& dice,
            std::ostream& told) const;

  engine::Context* context_;
  TemporaryFolder folder_;
  std::vector<Recorded> events_;
  std::vector<HealthyFormat> formats_;
  std::filesystem::path drive_;  ///< a healthy recording
  std::filesystem::path run_;    ///< the folder of a healthy run of it
};

}  // namespace adit::test
