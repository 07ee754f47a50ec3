// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace adit {

/// How a line is drawn.
struct SvgStroke {
  std::string_view color = "#000000";
  double width = 1.0;          ///< px
  std::string_view dash = {};  ///< SVG's stroke-dasharray; empty: solid
};

enum class SvgAnchor { start, middle, end };

/// How a text is set.
struct SvgFont {
  double size = 12.0;  ///< px
  std::string_view color = "#000000";
  SvgAnchor anchor = SvgAnchor::start;
  bool bold = false;
  bool upwards = false;  ///< turned by 90 degrees, reads from bottom to top
  bool halo = false;     ///< an edge of the ground, to stand out from lines
};

/// A drawing on white, put together element by element; on black for readers who prefer dark pages
/// and whose program knows style sheets. Coordinates in px, x right, y down.
class SvgDocument {
 public:
  SvgDocument(double width, double height);

  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const SvgStroke& stroke);

  /// Points nearer than a third of a pixel to the one before are left out.
  void polyline(std::span<const Eigen::Vector2d> points, const SvgStroke& stroke);
  void polygon(std::span<const Eigen::Vector2d> points, std::string_view fill, double opacity);
  void rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size,
                 const SvgStroke& stroke);
  void circle(const Eigen::Vector2d& center, double radius, std::string_view fill,
              const SvgStroke& stroke);
  void text(const Eigen::Vector2d& at, std::string_view text, const SvgFont& font);

  /// The whole file.
  std::string str() const;

 private:
  std::string head_;
  std::string body_;
};

/// Round numbers (1, 2 or 5 times a power of ten) that divide [low, high] into about `count` parts.
std::vector<double> round_ticks(double low, double high, int count);

/// A tick as text, with the decimals its neighbours at distance `step` need. Zero has no sign.
std::string tick_label(double value, double step);

/// The longest of 1, 2 or 5 times a power of ten that is at most `most`: the length of a scale bar.
/// 0 unless `most` is positive and finite.
double round_length(double most);

}  // namespace adit
