// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Some of the cases of `./dev fuzz-commands`: commands on damaged input end, and tell numbers only.
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/commands/command_cases.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using test::FuzzedCommand;

constexpr uint64_t kCases = 40;

class DamagedInput : public test::DeviceTest {};

TEST_F(DamagedInput, EndsEveryCommandWithACodeAndWithNumbers) {
  const test::CommandCases cases(context());
  for (const FuzzedCommand command : test::kFuzzedCommands) {
    int told[3] = {0, 0, 0};
    for (uint64_t number = 0; number < kCases; ++number) {
      const test::CommandOutcome outcome = cases.run(command, number);
      ASSERT_EQ(outcome.complaint, "") << to_string(command) << ", case " << number << ":\n"
                                       << outcome.told;
      ++told[outcome.code];
    }
    // Damage that hinders always, or never, would try nothing.
    EXPECT_GT(told[0], 0) << to_string(command);
    EXPECT_GT(told[1], 0) << to_string(command);
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
