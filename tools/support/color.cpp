// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/color.hpp"

#include <unistd.h>

#include <array>
#include <cstdlib>

#include <fmt/core.h>

namespace adit {
namespace {

std::optional<std::string> variable_of(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

/// A colour of the 6 x 6 x 6 cube that terminals of 256 colours have, whatever their theme makes of
/// the first 16.
struct CubeColor {
  int red = 0;  // steps of the cube, 0 to 5
  int green = 0;
  int blue = 0;
};

constexpr CubeColor cube_color(Tone tone) {
  switch (tone) {
    case Tone::error:
      return {4, 0, 1};
    case Tone::warning:
      return {3, 1, 0};
    case Tone::note:
      return {0, 2, 2};
    case Tone::good:
      return {0, 2, 0};
  }
  return {};
}

constexpr int kCubeBegin = 16;
constexpr std::array<int, 6> kCubeLevels = {0, 95, 135, 175, 215, 255};

}  // namespace

ColorSurroundings surroundings_of(int descriptor) {
  return {.terminal = isatty(descriptor) != 0,
          .term = variable_of("TERM"),
          .no_color = variable_of("NO_COLOR"),
          .clicolor_force = variable_of("CLICOLOR_FORCE")};
}

bool wants_color(ColorChoice choice, const ColorSurroundings& surroundings) {
  if (choice != ColorChoice::automatic) {
    return choice == ColorChoice::always;
  }
  if (!surroundings.no_color.value_or("").empty()) {
    return false;
  }
  const std::string forced = surroundings.clicolor_force.value_or("");
  if (!forced.empty() && forced != "0") {
    return true;
  }
  return surroundings.terminal && surroundings.term.value_or("dumb") != "dumb";
}

Rgb color_of(Tone tone) {
  const CubeColor color = cube_color(tone);
  const auto level = [](int step) { return kCubeLevels[static_cast<std::size_t>(step)]; };
  return {.red = level(color.red), .green = level(color.green), .blue = level(color.blue)};
}

std::string painted(std::string_view text, Tone tone) {
  const CubeColor color = cube_color(tone);
  return fmt::format("\x1b[1;38;5;{}m{}\x1b[0m",
                     kCubeBegin + 36 * color.red + 6 * color.green + color.blue, text);
}

}  // namespace adit
