// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/self_test/self_test_deskew.hpp"

#include <cmath>
#include <string>

namespace adit::engine {
namespace {

constexpr uint32_t kKnots = 65;
constexpr double kDuration = 0.1;    // s
constexpr double kTurn = 0.1;        // rad about z, over the sweep
constexpr double kMove = 1.0;        // m along x, over the sweep
constexpr double kTolerance = 2e-5;  // m; float32 at 5 m and interpolation: 3e-6

bool is_measured(const gpu::vec4& p, const PreprocessSettings& settings) {
  const double range =
      std::hypot(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
  return std::isfinite(range) && range >= settings.c_min && range <= settings.c_max && range > 0.0;
}

}  // namespace

DeskewSettings known_motion_settings(const KnownScene& scene) {
  return {.c_min = scene.settings.c_min,
          .c_max = scene.settings.c_max,
          .first_time = 0.0,
          .last_time = kDuration};
}

std::vector<gpu::DeskewKnot> known_motion() {
  std::vector<gpu::DeskewKnot> knots;
  for (uint32_t k = 0; k < kKnots; ++k) {
    const double share = static_cast<double>(k) / (kKnots - 1);
    knots.push_back({.rotation = {0.0F, 0.0F, static_cast<float>(std::sin(0.5 * kTurn * share)),
                                  static_cast<float>(std::cos(0.5 * kTurn * share))},
                     .translation = {static_cast<float>(kMove * share), 0.0F, 0.0F, 0.0F}});
  }
  return knots;
}

std::vector<float> known_times(const KnownScene& scene) {
  std::vector<float> times;
  for (size_t i = 0; i < scene.raw.size(); ++i) {
    times.push_back(static_cast<float>(kDuration * static_cast<double>(i) /
                                       static_cast<double>(scene.raw.size())));
  }
  return times;
}

SelfTestCase check_deskew(const KnownScene& scene, std::span<const gpu::vec4> moved) {
  const std::vector<float> times = known_times(scene);
  double worst = 0.0;
  uint64_t wrong = 0;
  for (size_t i = 0; i < scene.raw.size(); ++i) {
    const gpu::vec4& p = scene.raw[i];
    const gpu::vec4& q = moved[i];
    if (!is_measured(p, scene.settings)) {
      wrong += q.x == 0.0F && q.y == 0.0F && q.z == 0.0F ? 0U : 1U;
      continue;
    }
    const double share = static_cast<double>(times[i]) / kDuration;
    const double c = std::cos(kTurn * share);
    const double s = std::sin(kTurn * share);
    const auto x = static_cast<double>(p.x);
    const auto y = static_cast<double>(p.y);
    const double off = std::hypot(c * x - s * y + kMove * share - static_cast<double>(q.x),
                                  s * x + c * y - static_cast<double>(q.y),
                                  static_cast<double>(p.z) - static_cast<double>(q.z));
    worst = std::isnan(off) || off > worst ? off : worst;
  }
  return {"deskew", worst <= kTolerance && wrong == 0,
          "expected points within " + std::to_string(1e3 * kTolerance) +
              " mm of where they belong, found them within " + std::to_string(1e3 * worst) +
              " mm; " + std::to_string(wrong) + " invalid points kept"};
}

}  // namespace adit::engine
