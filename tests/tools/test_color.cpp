// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/color.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace adit {
namespace {

const ColorSurroundings kTerminal = {.terminal = true, .term = "xterm-256color"};

TEST(Color, TerminalsGetColorsAndFilesDoNot) {
  EXPECT_TRUE(wants_color(ColorChoice::automatic, kTerminal));
  EXPECT_FALSE(wants_color(ColorChoice::automatic, {.terminal = false, .term = "xterm"}));
  EXPECT_FALSE(wants_color(ColorChoice::automatic, {.terminal = true, .term = "dumb"}));
  EXPECT_FALSE(wants_color(ColorChoice::automatic, {.terminal = true}));
}

TEST(Color, EnvironmentForbidsOrForcesThem) {
  ColorSurroundings terminal = kTerminal;
  terminal.no_color = "1";
  EXPECT_FALSE(wants_color(ColorChoice::automatic, terminal));
  terminal.no_color = "";
  EXPECT_TRUE(wants_color(ColorChoice::automatic, terminal)) << "an empty one counts as none";
  ColorSurroundings file = {.terminal = false, .clicolor_force = "1"};
  EXPECT_TRUE(wants_color(ColorChoice::automatic, file));
  file.no_color = "1";
  EXPECT_FALSE(wants_color(ColorChoice::automatic, file)) << "it is the stronger one";
  EXPECT_FALSE(wants_color(ColorChoice::automatic, {.clicolor_force = "0"}));
}

TEST(Color, UserIsStrongerThanAllElse) {
  ColorSurroundings terminal = kTerminal;
  EXPECT_FALSE(wants_color(ColorChoice::never, terminal));
  terminal.no_color = "1";
  EXPECT_TRUE(wants_color(ColorChoice::always, terminal));
  EXPECT_TRUE(wants_color(ColorChoice::always, {}));
}

/// Relative luminance of WCAG 2, 0 (black) to 1 (white).
double luminance(const Rgb& color) {
  const auto linear = [](int level) {
    const double value = level / 255.0;
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(color.red) + 0.7152 * linear(color.green) + 0.0722 * linear(color.blue);
}

TEST(Color, EveryToneIsReadOnBlackAndOnWhite) {
  for (const Tone tone : {Tone::error, Tone::warning, Tone::note, Tone::good}) {
    const double own = luminance(color_of(tone)) + 0.05;
    EXPECT_GE(own / 0.05, 4.0) << "on black, tone " << static_cast<int>(tone);
    EXPECT_GE(1.05 / own, 4.0) << "on white, tone " << static_cast<int>(tone);
  }
}

TEST(Color, PaintedTextEndsAsItBegan) {
  EXPECT_EQ(painted("lost", Tone::error), "\x1b[1;38;5;161mlost\x1b[0m");
  EXPECT_EQ(painted("note:", Tone::note), "\x1b[1;38;5;30mnote:\x1b[0m");
}

}  // namespace
}  // namespace adit
