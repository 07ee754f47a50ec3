// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace adit {

/// Widths of drawings, px: for a desktop, and for a telephone, on which the former would be read
/// with a magnifying glass.
inline constexpr double kDeskWidth = 960.0;
inline constexpr double kPhoneWidth = 400.0;

/// Colours for readers with any kind of colour vision, on white and, replaced by lighter ones, on
/// black. Good, middling and bad also differ in lightness.
inline constexpr std::string_view kTextColor = "#000000";
inline constexpr std::string_view kAxisColor = "#555555";
inline constexpr std::string_view kGridColor = "#e4e4e4";
inline constexpr std::string_view kGateColor = "#b86e00";
inline constexpr std::string_view kGoodColor = "#009e73";
inline constexpr std::string_view kMiddlingColor = "#e6a700";
inline constexpr std::string_view kBadColor = "#a4262c";
inline constexpr std::string_view kUnknownColor = "#8a8f96";

/// Curves in one panel: blue, vermilion, bluish green, purple, sky blue, brown.
inline constexpr std::array<std::string_view, 6> kSeriesColors = {"#0072b2", "#d55e00", "#009e73",
                                                                  "#b0508c", "#3392cc", "#7a5200"};

/// Curves of the axes x, y and z.
inline constexpr std::array<std::string_view, 3> kAxisColors = {kSeriesColors[1], kSeriesColors[0],
                                                                kSeriesColors[2]};

/// Heights and other numbers, from low to high: blue over green to yellow, of even lightness steps,
/// told apart with any kind of colour vision. The ends leave the path and both grounds, white and
/// black, to be seen.
inline constexpr std::array<std::string_view, 8> kRampColors = {
    "#3b3f8f", "#3a5ba0", "#3778a8", "#3794a6", "#45ae94", "#6fc378", "#a5d05a", "#dcd64a"};

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

/// A horizontal run of cells of a raster: `count` from (column, row) on.
struct CellRun {
  std::size_t column = 0;
  std::size_t row = 0;
  std::size_t count = 0;
};

/// Cells of one colour.
struct CellRuns {
  std::string_view color;
  std::vector<CellRun> runs{};
};

/// What a picture is drawn on. Coordinates in px, x right, y down.
class Canvas {
 public:
  virtual ~Canvas() = default;

  virtual void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                    const SvgStroke& stroke) = 0;
  virtual void polyline(std::span<const Eigen::Vector2d> points, const SvgStroke& stroke) = 0;
  virtual void rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size,
                         const SvgStroke& stroke) = 0;
  virtual void circle(const Eigen::Vector2d& center, double radius, std::string_view fill,
                      const SvgStroke& stroke) = 0;
  /// About its centre.
  virtual void square(const Eigen::Vector2d& center, double side, std::string_view fill,
                      const SvgStroke& stroke) = 0;
  virtual void text(const Eigen::Vector2d& at, std::string_view text, const SvgFont& font) = 0;
  /// Cells of `scale` px, the first of which has its corner at `corner`.
  virtual void cells(std::span<const CellRuns> runs, const Eigen::Vector2d& corner,
                     double scale) = 0;
};

/// A drawing on white, put together element by element; on black for readers who prefer dark pages
/// and whose program knows style sheets. Coordinates in px, x right, y down.
class SvgDocument final : public Canvas {
 public:
  SvgDocument(double width, double height);

  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
            const SvgStroke& stroke) override;

  /// Points nearer than a third of a pixel to the one before are left out.
  void polyline(std::span<const Eigen::Vector2d> points, const SvgStroke& stroke) override;
  void polygon(std::span<const Eigen::Vector2d> points, std::string_view fill, double opacity);
  void rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size,
                 const SvgStroke& stroke) override;
  void circle(const Eigen::Vector2d& center, double radius, std::string_view fill,
              const SvgStroke& stroke) override;
  void square(const Eigen::Vector2d& center, double side, std::string_view fill,
              const SvgStroke& stroke) override;
  void text(const Eigen::Vector2d& at, std::string_view text, const SvgFont& font) override;
  void cells(std::span<const CellRuns> runs, const Eigen::Vector2d& corner, double scale) override;

  /// Text from `at` in lines that end before `right`. Returns the height of what it took.
  double paragraph(const Eigen::Vector2d& at, std::string_view text, double right,
                   const SvgFont& font);

  /// An element as it is, for what the others do not draw. Its colours follow the page where they
  /// are among those above.
  void raw(const std::string& element) { body_ += element; }

  /// The whole file.
  std::string str() const;

 private:
  std::string head_;
  std::string body_;
};

/// About how wide a text becomes, px.
double text_width(std::string_view text, double font_size);

/// Round numbers (1, 2 or 5 times a power of ten) that divide [low, high] into about `count` parts.
std::vector<double> round_ticks(double low, double high, int count);

/// A tick as text, with the decimals its neighbours at distance `step` need. Zero has no sign.
std::string tick_label(double value, double step);

/// The longest of 1, 2 or 5 times a power of ten that is at most `most`: the length of a scale bar.
/// 0 unless `most` is positive and finite.
double round_length(double most);

}  // namespace adit
