// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/receiver_jump.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "adit/slam/core/median.hpp"
#include "adit/slam/gnss/gnss_noise.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kFewestBeside = 5;  // pairs on either side
constexpr double kExplained = 0.9;        // share of each side that the jump has to explain
constexpr double kJumpGate = 3.035;       // standard deviations in two directions, 99 %
constexpr double kDriftSinceJump = 0.01;  // of the distance travelled since the jump

/// Where a jump would be: pairs up to it agree with the fit, those from it on do not, or the other
/// way round.
struct Split {
  std::size_t at = 0;
  bool agrees_first = true;
  std::size_t right = 0;  ///< pairs that are as this has them
};

Split best_split(const std::vector<bool>& agrees) {
  const auto agreeing = static_cast<std::size_t>(std::ranges::count(agrees, true));
  Split best;
  std::size_t before = 0;  // that agree
  for (std::size_t at = 1; at < agrees.size(); ++at) {
    before += agrees[at - 1] ? 1U : 0U;
    const std::size_t after = agreeing - before;
    const std::size_t first = before + (agrees.size() - at - after);
    const std::size_t second = agrees.size() - first;
    best = first > best.right ? Split{at, true, first} : best;
    best = second > best.right ? Split{at, false, second} : best;
  }
  return best;
}

Vector2d median_of(const std::vector<Vector2d>& values) {
  std::vector<double> x;
  std::vector<double> y;
  for (const Vector2d& value : values) {
    x.push_back(value.x());
    y.push_back(value.y());
  }
  return {median(std::move(x)), median(std::move(y))};
}

}  // namespace

std::optional<ReceiverJump> find_jump(std::span<const PositionPair> pairs, const WorldFit& fit) {
  if (pairs.size() < 2 * kFewestBeside || fit.agrees.size() != pairs.size()) {
    return std::nullopt;
  }
  const Split split = best_split(fit.agrees);
  const std::size_t after = pairs.size() - split.at;
  if (split.at < kFewestBeside || after < kFewestBeside ||
      static_cast<double>(split.right) < kExplained * static_cast<double>(pairs.size())) {
    return std::nullopt;
  }
  // The side that does not agree lies elsewhere as a whole.
  const auto other = split.agrees_first ? pairs.subspan(split.at) : pairs.first(split.at);
  std::vector<Vector2d> off;
  for (const PositionPair& pair : other) {
    off.emplace_back((pair.p_world - fit.T_world_map * pair.p_map).head<2>());
  }
  const Vector2d shift = median_of(off);
  const PositionPair& nearest = split.agrees_first ? other.front() : other.back();
  std::size_t alike = 0;
  double sigma = 0.0;
  for (std::size_t i = 0; i < other.size(); ++i) {
    const double drift = kDriftSinceJump * (other[i].p_map - nearest.p_map).norm();
    const double variance = std::max(other[i].covariance(0, 0), other[i].covariance(1, 1)) +
                            kMapNoise * kMapNoise + drift * drift;
    alike += (off[i] - shift).squaredNorm() < kJumpGate * kJumpGate * variance ? 1U : 0U;
    sigma = std::max(sigma, std::sqrt(variance));
  }
  if (static_cast<double>(alike) < kExplained * static_cast<double>(other.size()) ||
      shift.norm() < kJumpGate * sigma) {
    return std::nullopt;
  }
  return ReceiverJump{
      .time = pairs[split.at].time, .distance = shift.norm(), .before = split.at, .after = after};
}

}  // namespace adit
