// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/overhead_search.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <map>
#include <numbers>
#include <unordered_map>
#include <utility>

#include <unsupported/Eigen/FFT>

#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

constexpr float kFarthestPoint = 1e5F;   // m, of a point that counts
constexpr float kMostRise = 6.0F;        // steps: a tower is no more than a wall
constexpr std::size_t kSide = 256;       // cells of the images that are correlated
constexpr double kCells = 2.0;           // an image's cell, in steps, at least
constexpr double kNear = 0.95;           // share of what rises that the images hold
constexpr std::size_t kPeaks = 2;        // of a heading
constexpr double kSameHeading = 12.0;    // degrees
constexpr std::size_t kLeastGround = 8;  // columns that tell a height

using Spectrum = std::vector<std::complex<float>>;

/// What rises, weighed; positions about the middle of a cloud.
struct Riser {
  Eigen::Vector2f at = Eigen::Vector2f::Zero();
  float weight = 0.0F;
};

Eigen::Vector2f middle_of(const OverheadView& view) {
  std::vector<float> x;
  std::vector<float> y;
  for (const OverheadView::Column& column : view.columns) {
    x.push_back(column.center.x());
    y.push_back(column.center.y());
  }
  const auto half = static_cast<std::ptrdiff_t>(x.size() / 2);
  std::ranges::nth_element(x, x.begin() + half);
  std::ranges::nth_element(y, y.begin() + half);
  return {x[static_cast<std::size_t>(half)], y[static_cast<std::size_t>(half)]};
}

std::vector<Riser> risers_of(const OverheadView& view, const Eigen::Vector2f& middle) {
  std::vector<Riser> risers;
  for (const OverheadView::Column& column : view.columns) {
    if (column.rise > 0.0F) {
      risers.push_back({column.center - middle, std::sqrt(std::min(column.rise, kMostRise))});
    }
  }
  return risers;
}

/// Radius that holds nearly all of them, m.
float reach_of(const std::vector<Riser>& risers) {
  std::vector<float> distances;
  for (const Riser& riser : risers) {
    distances.push_back(riser.at.norm());
  }
  const auto most = static_cast<std::ptrdiff_t>(kNear * static_cast<double>(distances.size() - 1));
  std::ranges::nth_element(distances, distances.begin() + most);
  return distances[static_cast<std::size_t>(most)];
}

/// The square of cells that images have, the middle of a cloud at its corner: it goes round.
class Images {
 public:
  Images(float reach_a, float reach_b, double least_cell)
      : reach_(std::max(reach_a, reach_b)),
        cell_(std::max(static_cast<float>(least_cell),
                       2.0F * (reach_a + reach_b) / static_cast<float>(kSide - 2))) {}

  float cell() const { return cell_; }

  /// Adds what rises, turned, to an image: weights shared among the four cells around.
  template <class Add>
  void draw(const std::vector<Riser>& risers, double heading, Add&& add) const {
    const Eigen::Rotation2Df turn(static_cast<float>(heading));
    for (const Riser& riser : risers) {
      if (riser.at.norm() > reach_) {
        continue;
      }
      const Eigen::Vector2f at = turn * riser.at / cell_;
      const Eigen::Vector2f low(std::floor(at.x()), std::floor(at.y()));
      const Eigen::Vector2f part = at - low;
      for (const int dy : {0, 1}) {
        for (const int dx : {0, 1}) {
          const float share =
              (dx == 1 ? part.x() : 1.0F - part.x()) * (dy == 1 ? part.y() : 1.0F - part.y());
          add(index(static_cast<int>(low.x()) + dx, static_cast<int>(low.y()) + dy),
              riser.weight * share);
        }
      }
    }
  }

  static std::size_t index(int x, int y) {
    constexpr int kMask = static_cast<int>(kSide) - 1;
    return static_cast<std::size_t>(y & kMask) * kSide + static_cast<std::size_t>(x & kMask);
  }

  /// In place, along rows and then along columns.
  void transform(Spectrum& image, bool forward) {
    std::array<std::complex<float>, kSide> in;
    std::array<std::complex<float>, kSide> out;
    for (const bool rows : {true, false}) {
      const std::size_t along = rows ? 1 : kSide;
      const std::size_t across = rows ? kSide : 1;
      for (std::size_t line = 0; line < kSide; ++line) {
        for (std::size_t i = 0; i < kSide; ++i) {
          in[i] = image[line * across + i * along];
        }
        if (forward) {
          fft_.fwd(out.data(), in.data(), static_cast<int>(kSide));
        } else {
          fft_.inv(out.data(), in.data(), static_cast<int>(kSide));
        }
        for (std::size_t i = 0; i < kSide; ++i) {
          image[line * across + i * along] = out[i];
        }
      }
    }
  }

 private:
  float reach_;
  float cell_;
  Eigen::FFT<float> fft_;
};

struct Peak {
  double score = 0.0;
  double heading = 0.0;                             // rad
  Eigen::Vector2f shift = Eigen::Vector2f::Zero();  // m, between the middles
};

/// The highest places of one heading's correlation.
template <class Value>
void add_peaks(std::vector<Peak>& peaks, double heading, float cell, const Value& value) {
  constexpr int kHalf = static_cast<int>(kSide) / 2;
  std::vector<Peak> found;
  for (int y = -kHalf; y < kHalf; ++y) {
    for (int x = -kHalf; x < kHalf; ++x) {
      const float here = value(Images::index(x, y));
      if (found.size() == kPeaks && here <= static_cast<float>(found.back().score)) {
        continue;
      }
      const bool highest =
          here > value(Images::index(x - 1, y)) && here >= value(Images::index(x + 1, y)) &&
          here > value(Images::index(x, y - 1)) && here >= value(Images::index(x, y + 1));
      if (!highest || here <= 0.0F) {
        continue;
      }
      found.push_back(
          {.score = static_cast<double>(here),
           .heading = heading,
           .shift = cell * Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y))});
      std::ranges::stable_sort(found, std::ranges::greater{}, &Peak::score);
      found.resize(std::min(found.size(), kPeaks));
    }
  }
  peaks.insert(peaks.end(), found.begin(), found.end());
}

bool same_place(const Peak& p, const Peak& q, double least_apart) {
  const double turn =
      std::abs(std::remainder(p.heading - q.heading, 2.0 * std::numbers::pi)) * kDegreesPerRadian;
  return turn < kSameHeading && static_cast<double>((p.shift - q.shift).norm()) < least_apart;
}

uint64_t key_of(const Eigen::Vector2f& at, double step) {
  const auto cell = [step](float value) {
    return static_cast<uint32_t>(
        static_cast<int32_t>(std::floor(static_cast<double>(value) / step)));
  };
  return (static_cast<uint64_t>(cell(at.x())) << 32U) | cell(at.y());
}

/// How much higher a's ground is than b's, where both have columns.
class Ground {
 public:
  explicit Ground(const OverheadView& a) : step_(a.step) {
    for (const OverheadView::Column& column : a.columns) {
      lowest_[key_of(column.center, step_)] = column.lowest;
    }
  }

  double above(const OverheadView& b, const Eigen::Isometry2f& T_a_b) const {
    std::vector<float> differences;
    for (const OverheadView::Column& column : b.columns) {
      const auto found = lowest_.find(key_of(T_a_b * column.center, step_));
      if (found != lowest_.end()) {
        differences.push_back(found->second - column.lowest);
      }
    }
    if (differences.size() < kLeastGround) {
      return 0.0;
    }
    const auto half = static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::ranges::nth_element(differences, differences.begin() + half);
    return static_cast<double>(differences[static_cast<std::size_t>(half)]);
  }

 private:
  double step_;
  std::unordered_map<uint64_t, float> lowest_;
};

/// All headings, two in one complex image.
std::vector<Peak> correlate(const std::vector<Riser>& a, const std::vector<Riser>& b,
                            double least_cell, double turn, const Checkpoint& checkpoint) {
  Images images(reach_of(a), reach_of(b), least_cell);
  Spectrum of_a(kSide * kSide);
  images.draw(a, 0.0, [&](std::size_t i, float weight) { of_a[i] += weight; });
  images.transform(of_a, true);
  const auto pairs = std::max(static_cast<int>(std::lround(180.0 / turn)), 1);
  std::vector<Peak> peaks;
  for (int pair = 0; pair < pairs; ++pair) {
    pass(checkpoint);
    const double first = std::numbers::pi * pair / pairs;
    const double second = first + std::numbers::pi;
    Spectrum both(kSide * kSide);
    images.draw(b, first, [&](std::size_t i, float weight) { both[i] += weight; });
    images.draw(b, second,
                [&](std::size_t i, float weight) { both[i] += std::complex<float>(0.0F, weight); });
    images.transform(both, true);
    // The correlation of a with (b1 + i b2) conjugated is that with b1 less i times that with b2.
    for (std::size_t i = 0; i < both.size(); ++i) {
      both[i] = of_a[i] * std::conj(both[i]);
    }
    images.transform(both, false);
    add_peaks(peaks, first, images.cell(), [&](std::size_t i) { return both[i].real(); });
    add_peaks(peaks, second, images.cell(), [&](std::size_t i) { return -both[i].imag(); });
  }
  std::ranges::stable_sort(peaks, std::ranges::greater{}, &Peak::score);
  return peaks;
}

}  // namespace

OverheadView overhead_view(std::span<const Point> points, double step) {
  OverheadView view{.step = step, .columns = {}};
  std::map<std::pair<int32_t, int32_t>, std::vector<std::pair<int32_t, float>>> columns;
  const auto at = [step](float value) {
    return static_cast<int32_t>(std::floor(static_cast<double>(value) / step));
  };
  for (const Point& p : points) {
    // NaN fails every comparison; (0, 0, 0) is no return.
    if (std::abs(p.x) < kFarthestPoint && std::abs(p.y) < kFarthestPoint &&
        std::abs(p.z) < kFarthestPoint && (p.x != 0.0F || p.y != 0.0F || p.z != 0.0F)) {
      columns[{at(p.x), at(p.y)}].emplace_back(at(p.z), p.z);
    }
  }
  for (auto& [cell, heights] : columns) {
    std::ranges::sort(heights);
    std::size_t steps = 1;
    float lowest = heights.front().second;
    for (std::size_t i = 1; i < heights.size(); ++i) {
      steps += static_cast<std::size_t>(heights[i].first != heights[i - 1].first);
      lowest = std::min(lowest, heights[i].second);
    }
    const auto center = [step](int32_t index) {
      return static_cast<float>((static_cast<double>(index) + 0.5) * step);
    };
    view.columns.push_back({.center = {center(cell.first), center(cell.second)},
                            .lowest = lowest,
                            .rise = static_cast<float>(steps - 1)});
  }
  return view;
}

std::vector<Eigen::Isometry3d> find_overhead_poses(const OverheadView& a, const OverheadView& b,
                                                   const OverheadSearchSettings& settings,
                                                   const Checkpoint& checkpoint) {
  if (a.columns.empty() || b.columns.empty()) {
    return {};
  }
  const Eigen::Vector2f middle_a = middle_of(a);
  const Eigen::Vector2f middle_b = middle_of(b);
  const std::vector<Riser> risers_a = risers_of(a, middle_a);
  const std::vector<Riser> risers_b = risers_of(b, middle_b);
  if (risers_a.empty() || risers_b.empty()) {
    return {};
  }
  const Ground ground(a);
  std::vector<Peak> chosen;
  std::vector<Eigen::Isometry3d> poses;
  for (const Peak& peak : correlate(risers_a, risers_b, kCells * std::max(a.step, b.step),
                                    settings.turn, checkpoint)) {
    if (poses.size() == settings.most_poses) {
      break;
    }
    if (std::ranges::any_of(chosen, [&](const Peak& other) {
          return same_place(peak, other, settings.least_apart);
        })) {
      continue;
    }
    chosen.push_back(peak);
    Eigen::Isometry2f flat = Eigen::Isometry2f::Identity();
    flat.linear() = Eigen::Rotation2Df(static_cast<float>(peak.heading)).toRotationMatrix();
    flat.translation() = middle_a + peak.shift - flat.linear() * middle_b;
    Eigen::Isometry3d pose(Eigen::AngleAxisd(peak.heading, Eigen::Vector3d::UnitZ()));
    pose.translation() << flat.translation().cast<double>(), ground.above(b, flat);
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace adit
