// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/heading_consensus.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr std::size_t kMostHypotheses = 100;
constexpr int kMeans = 3;  // each is over those that agree with the one before

std::vector<bool> agreeing_with(double yaw, std::span<const YawSample> samples) {
  std::vector<bool> agrees;
  agrees.reserve(samples.size());
  for (const YawSample& sample : samples) {
    const double apart = wrapped_angle(sample.yaw - yaw);
    const double variance = sample.sigma * sample.sigma + kMapYaw * kMapYaw;
    agrees.push_back(apart * apart < kHeadingGate * variance);
  }
  return agrees;
}

}  // namespace

double wrapped_angle(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

std::optional<YawConsensus> yaw_consensus(std::span<const YawSample> samples) {
  if (samples.size() < kFewestHeadings) {
    return std::nullopt;
  }
  YawConsensus best;
  const std::size_t hypotheses = std::min(samples.size(), kMostHypotheses);
  for (std::size_t k = 0; k < hypotheses; ++k) {
    const double yaw = samples[k * samples.size() / hypotheses].yaw;
    std::vector<bool> agrees = agreeing_with(yaw, samples);
    const auto agreeing = static_cast<std::size_t>(std::ranges::count(agrees, true));
    if (agreeing > best.agreeing) {
      best = {.yaw = yaw, .agrees = std::move(agrees), .agreeing = agreeing};
    }
  }
  for (int round = 0; round < kMeans && best.agreeing > 0; ++round) {
    double weights = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double weight =
          best.agrees[i] ? samples[i].share / (samples[i].sigma * samples[i].sigma) : 0.0;
      weights += weight;
      sum += weight * wrapped_angle(samples[i].yaw - best.yaw);
    }
    best.yaw = wrapped_angle(best.yaw + sum / weights);
    best.sigma = 1.0 / std::sqrt(weights);
    best.agrees = agreeing_with(best.yaw, samples);
    best.agreeing = static_cast<std::size_t>(std::ranges::count(best.agrees, true));
  }
  return best;
}

}  // namespace adit
