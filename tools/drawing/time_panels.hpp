// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Quantities over time, one panel below the other with one time axis.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/drawing/svg.hpp"

namespace adit {

/// One value a time; NaN interrupts it.
struct Curve {
  std::string name;  ///< for the legend; empty: not in it
  std::string_view color = kSeriesColors[0];
  std::vector<double> values;
  std::vector<double> sigma{};  ///< half the width of a band about it; empty: none
  std::string_view dash{};
  bool dots = false;  ///< dots instead of a line
};

/// A line across the panel.
struct Gate {
  std::string name;
  double value = 0.0;
};

/// A class a time, by its place in `classes`; negative: none.
struct Band {
  std::string name;
  std::vector<int> values;
};

struct BandClass {
  std::string name;
  std::string_view color;
};

/// Either curves with gates, or bands of colour.
struct TimePanel {
  std::string title;  ///< with the unit
  std::vector<Curve> curves{};
  std::vector<Gate> gates{};
  std::vector<Band> bands{};
  std::vector<BandClass> classes{};  ///< the bands' classes
  bool logarithmic = false;          ///< values of 0 and less are left out
  std::optional<double> low{};       ///< the scale's ends, where the data must not decide
  std::optional<double> high{};
};

/// The panels as an SVG document of that width (px). `times` in s, rising; every curve and band has
/// as many values. Panels without a single value are left out; none left gives an empty text.
/// `axis` names the times.
std::string draw_time_panels(std::span<const double> times, std::span<const TimePanel> panels,
                             double width,
                             std::string_view axis = "time since the first sweep (s)");

}  // namespace adit
