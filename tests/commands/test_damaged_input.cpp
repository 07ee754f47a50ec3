// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Some of the cases of `./dev fuzz-commands`: commands on damaged input end, and tell numbers only.
#include <algorithm>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/commands/command_cases.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/commands/command_run.hpp"

namespace adit {
namespace {

using test::FuzzedCommand;

// Per command and format; where the sanitizers make each ten times as long, ./dev fuzz-commands has
// more.
#ifdef __SANITIZE_ADDRESS__
constexpr uint64_t kCases = 1;
#else
constexpr uint64_t kCases = 2;
#endif

class DamagedInput : public test::DeviceTest {};

TEST_F(DamagedInput, EndsEveryCommandWithACodeAndWithNumbers) {
  const test::CommandCases cases(context());
  for (const FuzzedCommand command : test::kFuzzedCommands) {
    int told[3] = {0, 0, 0};
    int aligned = 0;
    for (const std::string& format : cases.formats()) {
      // What is no recording has one format or two: more cases of it.
      const bool only_one = !cases.reads(FuzzedCommand::inspect, format);
      const uint64_t most = !cases.reads(command, format) ? 0 : (only_one ? 10 : 1) * kCases;
      for (uint64_t number = 0; number < most; ++number) {
        const test::CommandOutcome outcome = cases.run(command, format, number);
        ASSERT_EQ(outcome.complaint, "")
            << to_string(command) << ", " << format << ", case " << number << ":\n"
            << outcome.told;
        ++told[outcome.code];
        aligned += outcome.told.find("refused: ") != std::string::npos ? 1 : 0;
      }
    }
    // Damage that hinders always, or never, would try nothing; one case a format is too few to say.
    if (kCases == 1) {
      continue;
    }
    if (command == FuzzedCommand::align) {
      EXPECT_GT(told[0] + aligned, 0)
          << "the small drive's sweeps are sparse: aligned, and refused";
    } else {
      EXPECT_GT(told[0], 0) << to_string(command);
    }
    EXPECT_GT(told[1], 0) << to_string(command);
  }
}

// A call that is refused whatever it reads would try nothing.
TEST_F(DamagedInput, IsReadByCallsThatTakeItWithoutTheDamage) {
  const test::CommandCases cases(context());
  for (const FuzzedCommand command : test::kFuzzedCommands) {
    const bool always = command == FuzzedCommand::convert || command == FuzzedCommand::simulate ||
                        command == FuzzedCommand::maps || command == FuzzedCommand::config;
    for (const std::string& format : cases.formats()) {
      int best = 2;
      std::string told;
      for (uint64_t number = 0; cases.reads(command, format) && number < kCases; ++number) {
        const test::CommandOutcome outcome = cases.run(command, format, number, test::Damage::none);
        EXPECT_EQ(outcome.complaint, "") << to_string(command) << ", " << format;
        EXPECT_LE(outcome.code, always ? 0 : 1) << to_string(command) << ", " << format << ":\n"
                                                << outcome.told;
        best = std::min(best, outcome.code);
        told += outcome.told;
      }
      // Inspect finds things, align too little to hold a pose, evaluate none in recordings; and of
      // two topics of sweeps run asks for one.
      if (kCases > 1 && cases.reads(command, format) && command == FuzzedCommand::run) {
        EXPECT_EQ(best, format == "euroc" ? 1 : 0) << format << ":\n" << told;
      }
    }
  }
}

TEST_F(DamagedInput, IsOfRecordingsThatAreHealthyWithoutTheDamage) {
  const test::TemporaryFolder folder;
  for (const test::HealthyFormat& format :
       test::write_healthy_recordings(folder / "formats", test::small_drive())) {
    ASSERT_FALSE(format.recordings.empty()) << format.name;
    const test::HealthyRecording& first = format.recordings.front();
    std::ostringstream told;
    RunCommandOptions options;
    options.recording = first.path();
    options.output = folder / ("out_" + format.name);
    options.overwrite = true;
    options.device.opened = &context();
    const int code = run_command(options, told, told);
    // EuRoC's folders have no sweeps, which there is nothing to map without.
    EXPECT_EQ(code, format.name == "euroc" ? 1 : 0) << format.name << ":\n" << told.str();
  }
}

TEST(Damage, IsTheSameForTheSameNumber) {
  const auto damaged = [](uint64_t seed) {
    test::Dice dice(seed);
    std::string bytes(1000, 'x');
    test::damage_bytes(bytes, dice);
    return bytes;
  };
  EXPECT_EQ(damaged(7), damaged(7));
  EXPECT_NE(damaged(7), damaged(8));
}

}  // namespace
}  // namespace adit
