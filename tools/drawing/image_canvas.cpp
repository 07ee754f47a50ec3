// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/image_canvas.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "adit/tools/drawing/image_text.hpp"

namespace adit {
namespace {

constexpr double kScale = 2.0;  // pixels a px
constexpr double kDash = 4.0;   // px, and as long a gap

/// Colours the pixels about whose centres `inside` says yes, within a box in pixels.
template <class Inside>
void paint(Image& image, const Eigen::AlignedBox2d& box, const Color& color, Inside&& inside) {
  const auto limit = [](double value, int most) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(most)));
  };
  for (int y = limit(std::floor(box.min().y()), image.height);
       y < limit(std::ceil(box.max().y()) + 1.0, image.height); ++y) {
    for (int x = limit(std::floor(box.min().x()), image.width);
         x < limit(std::ceil(box.max().x()) + 1.0, image.width); ++x) {
      if (inside(Eigen::Vector2d(x + 0.5, y + 0.5))) {
        image.at(x, y) = color;
      }
    }
  }
}

}  // namespace

Color color_of(std::string_view name) {
  Color color{};
  for (std::size_t i = 0; i < color.size() && name.size() == 7; ++i) {
    const char* digits = name.data() + 1 + 2 * i;
    std::from_chars(digits, digits + 2, color.at(i), 16);
  }
  return color;
}

ImageCanvas::ImageCanvas(double width, double height)
    : image_(static_cast<int>(std::ceil(kScale * width)),
             static_cast<int>(std::ceil(kScale * height))) {
  std::ranges::fill(image_.pixels, Color{255, 255, 255});
}

void ImageCanvas::line(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                       const SvgStroke& stroke) {
  const Eigen::Vector2d a = kScale * from;
  const Eigen::Vector2d way = kScale * (to - from);
  const double half = std::max(0.5 * kScale * stroke.width, 0.71);
  const double length = way.norm();
  const Eigen::Vector2d along = length > 0.0 ? Eigen::Vector2d(way / length) : way;
  Eigen::AlignedBox2d box(a.cwiseMin(a + way), a.cwiseMax(a + way));
  box.min().array() -= half;
  box.max().array() += half;
  paint(image_, box, color_of(stroke.color), [&](const Eigen::Vector2d& p) {
    const double at = std::clamp((p - a).dot(along), 0.0, length);
    const bool gap = !stroke.dash.empty() && std::fmod(at, 2.0 * kScale * kDash) > kScale * kDash;
    return !gap && (p - a - at * along).norm() <= half;
  });
}

void ImageCanvas::polyline(std::span<const Eigen::Vector2d> points, const SvgStroke& stroke) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    line(points[i - 1], points[i], stroke);
  }
}

void ImageCanvas::rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size,
                            const SvgStroke& stroke) {
  const Eigen::Vector2d right(size.x(), 0.0);
  const Eigen::Vector2d down(0.0, size.y());
  polyline(
      std::array<Eigen::Vector2d, 5>{corner, corner + right, corner + size, corner + down, corner},
      stroke);
}

void ImageCanvas::circle(const Eigen::Vector2d& center, double radius, std::string_view fill,
                         const SvgStroke& stroke) {
  const Eigen::Vector2d c = kScale * center;
  const auto disc = [&](double r, std::string_view color) {
    const Eigen::Vector2d reach = Eigen::Vector2d::Constant(r);
    paint(image_, {c - reach, c + reach}, color_of(color),
          [&](const Eigen::Vector2d& p) { return (p - c).norm() <= r; });
  };
  disc(kScale * (radius + 0.5 * stroke.width), stroke.color);
  disc(kScale * (radius - 0.5 * stroke.width), fill);
}

void ImageCanvas::square(const Eigen::Vector2d& center, double side, std::string_view fill,
                         const SvgStroke& stroke) {
  const auto box = [&](double edge, std::string_view color) {
    const Eigen::Vector2d half = Eigen::Vector2d::Constant(0.5 * kScale * edge);
    const Eigen::AlignedBox2d all(kScale * center - half, kScale * center + half);
    paint(image_, all, color_of(color), [&](const Eigen::Vector2d& p) { return all.contains(p); });
  };
  box(side + stroke.width, stroke.color);
  box(side - stroke.width, fill);
}

void ImageCanvas::text(const Eigen::Vector2d& at, std::string_view text, const SvgFont& font) {
  const int width = text_width_px(text);
  const int height = text_height_px();
  const double left = font.anchor == SvgAnchor::start    ? 0.0
                      : font.anchor == SvgAnchor::middle ? -0.5 * width
                                                         : -width;
  Image line(std::max(width, 1), height);
  const Color paper{255, 255, 255};
  std::ranges::fill(line.pixels, paper);
  write_text(line, {0, 0}, text, color_of(font.color));
  // Upwards, the line's x is the picture's -y.
  const Eigen::Vector2d base = kScale * at;
  for (int y = 0; y < line.height; ++y) {
    for (int x = 0; x < line.width; ++x) {
      const Eigen::Vector2d p(left + x, y - height);
      const Eigen::Vector2d on = base + (font.upwards ? Eigen::Vector2d(p.y(), -p.x()) : p);
      const bool within =
          (on.array() >= 0.0).all() && on.x() < image_.width && on.y() < image_.height;
      if (within && line.at(x, y) != paper) {
        image_.at(static_cast<int>(on.x()), static_cast<int>(on.y())) = line.at(x, y);
      }
    }
  }
}

void ImageCanvas::cells(std::span<const CellRuns> runs, const Eigen::Vector2d& corner,
                        double scale) {
  for (const CellRuns& color : runs) {
    const Color ink = color_of(color.color);
    for (const CellRun& run : color.runs) {
      const Eigen::Vector2d from(static_cast<double>(run.column), static_cast<double>(run.row));
      const Eigen::Vector2d size(static_cast<double>(run.count), 1.0);
      const Eigen::AlignedBox2d box(kScale * (corner + scale * from),
                                    kScale * (corner + scale * (from + size)));
      // A cell less wide than a pixel has one.
      paint(image_, box, ink, [&](const Eigen::Vector2d& p) {
        return ((p - box.min()).array() >= -0.5).all() && ((box.max() - p).array() >= -0.5).all();
      });
    }
  }
}

}  // namespace adit
