// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/tools/drawing/png_writer.hpp"
#include "adit/tools/drawing/svg.hpp"

namespace adit {

/// A colour of SVG, "#rrggbb".
Color color_of(std::string_view name);

/// A drawing as a picture on white, of twice as many pixels as a page has px: for what shows no
/// SVG. Letters are those of image_text.hpp, of one size.
class ImageCanvas final : public Canvas {
 public:
  ImageCanvas(double width, double height);

  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
            const SvgStroke& stroke) override;
  void polyline(std::span<const Eigen::Vector2d> points, const SvgStroke& stroke) override;
  void rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size,
                 const SvgStroke& stroke) override;
  void circle(const Eigen::Vector2d& center, double radius, std::string_view fill,
              const SvgStroke& stroke) override;
  void square(const Eigen::Vector2d& center, double side, std::string_view fill,
              const SvgStroke& stroke) override;
  void text(const Eigen::Vector2d& at, std::string_view text, const SvgFont& font) override;
  void cells(std::span<const CellRuns> runs, const Eigen::Vector2d& corner, double scale) override;

  const Image& image() const { return image_; }

 private:
  Image image_;
};

}  // namespace adit
