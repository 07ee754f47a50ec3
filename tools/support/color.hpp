// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Colours of what a terminal shows: few, and never the only thing that tells a line from another.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace adit {

enum class ColorChoice {
  automatic,  ///< as the stream and the environment have it
  always,
  never,
};

/// What decides on colours where the user leaves it to the program. Variables that are not set are
/// absent.
struct ColorSurroundings {
  bool terminal = false;                        ///< the stream is one
  std::optional<std::string> term{};            ///< TERM
  std::optional<std::string> no_color{};        ///< NO_COLOR
  std::optional<std::string> clicolor_force{};  ///< CLICOLOR_FORCE
};

/// Of a file descriptor of this process and of its environment.
ColorSurroundings surroundings_of(int descriptor);

/// NO_COLOR, unless empty, forbids colours; CLICOLOR_FORCE, unless empty or 0, asks for them;
/// without either a terminal gets them that is not dumb.
bool wants_color(ColorChoice choice, const ColorSurroundings& surroundings);

enum class Tone { error, warning, note, good };

/// Red, green and blue of a tone, 0 to 255 each. Every tone can be read on black and on white: its
/// contrast to either is at least 4 to 1 (WCAG 2).
struct Rgb {
  int red = 0;
  int green = 0;
  int blue = 0;
};
Rgb color_of(Tone tone);

/// The text in bold and in the tone's colour, by escape sequences for terminals of 256 colours.
std::string painted(std::string_view text, Tone tone);

}  // namespace adit
