// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/velodyne_models.hpp"

#include <cmath>

#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

using Angles = std::array<double, VelodyneModel::kMostLasers>;  // degrees, by laser

// Manual 63-9243 (VLP-16); heights are those of its table.
constexpr Angles kVlp16Elevations = {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};
constexpr Angles kVlp16Heights = {0.0112, -0.0007, 0.0097, -0.0022, 0.0081, -0.0037,
                                  0.0066, -0.0051, 0.0051, -0.0066, 0.0037, -0.0081,
                                  0.0022, -0.0097, 0.0007, -0.0112};
// Puck Hi-Res: the VLP-16 with other angles, in the same table.
constexpr Angles kHiResElevations = {-10,    0.667, -8.667, 2,     -7.333, 3.333, -6,     4.667,
                                     -4.667, 6,     -3.333, 7.333, -2,     8.667, -0.667, 10};
constexpr Angles kHiResHeights = {0.0074, -0.0009, 0.0065, -0.0018, 0.0055, -0.0027,
                                  0.0046, -0.0037, 0.0037, -0.0046, 0.0027, -0.0055,
                                  0.0018, -0.0065, 0.0009, -0.0074};
// Manual 63-9113 (HDL-32E).
constexpr Angles kHdl32Elevations = {-30.67, -9.33, -29.33, -8.00, -28.00, -6.67, -26.67, -5.33,
                                     -25.33, -4.00, -24.00, -2.67, -22.67, -1.33, -21.33, 0.00,
                                     -20.00, 1.33,  -18.67, 2.67,  -17.33, 4.00,  -16.00, 5.33,
                                     -14.67, 6.67,  -13.33, 8.00,  -12.00, 9.33,  -10.67, 10.67};
// Manual 63-9325 (VLP-32C), table of elevations and azimuth offsets.
constexpr Angles kVlp32Elevations = {-25,    -1,    -1.667, -15.639, -11.31, 0,     -0.667, -8.843,
                                     -7.254, 0.333, -0.333, -6.148,  -5.333, 1.333, 0.667,  -4,
                                     -4.667, 1.667, 1,      -3.667,  -3.333, 3.333, 2.333,  -2.667,
                                     -3,     7,     4.667,  -2.333,  -2,     15,    10.333, -1.333};
constexpr Angles kVlp32Azimuths = {1.4,  -4.2, 1.4,  -1.4, 1.4,  -1.4, 4.2,  -1.4, 1.4,  -4.2, 1.4,
                                   -1.4, 4.2,  -1.4, 4.2,  -1.4, 1.4,  -4.2, 1.4,  -4.2, 4.2,  -1.4,
                                   1.4,  -1.4, 1.4,  -1.4, 1.4,  -4.2, 4.2,  -1.4, 1.4,  -1.4};
// Manual 63-9483 (VLS-128, sold as Alpha Prime), tables of elevations and azimuth offsets.
constexpr Angles kVls128Elevations = {
    -11.742, -1.99,   3.4,   -5.29,   -0.78, 4.61,  -4.08,   1.31,   -6.5,  -1.11,   4.28,  -4.41,
    0.1,     6.48,    -3.2,  2.19,    -3.86, 1.53,  -9.244,  -1.77,  2.74,  -5.95,   -0.56, 4.83,
    -2.98,   2.41,    -6.28, -0.89,   3.62,  -5.07, 0.32,    7.58,   -0.34, 5.18,    -3.64, 1.75,
    -25,     -2.43,   2.96,  -5.73,   0.54,  9.7,   -2.76,   2.63,   -7.65, -1.55,   3.84,  -4.85,
    3.18,    -5.51,   -0.12, 5.73,    -4.3,  1.09,  -16.042, -2.21,  4.06,  -4.63,   0.76,  15,
    -3.42,   1.97,    -6.85, -1.33,   -5.62, -0.23, 5.43,    -3.53,  0.98,  -19.582, -2.32, 3.07,
    -4.74,   0.65,    11.75, -2.65,   1.86,  -7.15, -1.44,   3.95,   -2.1,  3.29,    -5.4,  -0.01,
    4.5,     -4.19,   1.2,   -13.565, -1.22, 4.17,  -4.52,   0.87,   6.08,  -3.31,   2.08,  -6.65,
    1.42,    -10.346, -1.88, 3.51,    -6.06, -0.67, 4.72,    -3.97,  2.3,   -6.39,   -1,    4.39,
    -5.18,   0.21,    6.98,  -3.09,   4.98,  -3.75, 1.64,    -8.352, -2.54, 2.85,    -5.84, -0.45,
    8.43,    -2.87,   2.52,  -6.17,   -1.66, 3.73,  -4.96,   0.43};
constexpr std::array<double, 8> kVls128Azimuths = {6.354,  4.548,  2.732,  0.911,
                                                   -0.911, -2.732, -4.548, -6.354};

/// Lasers that fire in groups of `together`, `step` s apart, with a break of a step after every
/// `groups` of them.
constexpr VelodyneModel evenly_firing(std::string_view name, std::size_t lasers, double range_unit,
                                      double cycle, double step, std::size_t together,
                                      std::size_t groups, const Angles& elevations) {
  VelodyneModel result{.name = name,
                       .lasers = lasers,
                       .range_unit = range_unit,
                       .cycle = cycle,
                       .elevation = elevations};
  for (std::size_t i = 0; i < lasers; ++i) {
    const std::size_t group = i / together;
    result.firing[i] = step * static_cast<double>(group + group / groups);
    for (std::size_t k = 0; k < lasers; ++k) {
      result.rings[i] =
          static_cast<uint16_t>(result.rings[i] + (elevations[k] < elevations[i] ? 1 : 0));
    }
  }
  return result;
}

/// Lasers that fire from a ring of `radius` (m) about the axis, and whose ranges are from the axis.
/// The heights of VLP-16 in its manual are those of a ring of 41.91 mm.
Angles heights_of(const VelodyneModel& model, double radius) {
  Angles heights{};
  for (std::size_t i = 0; i < model.lasers; ++i) {
    heights[i] = -radius * std::tan(model.elevation[i] * kDegree);
  }
  return heights;
}

constexpr std::size_t kNoBreak = VelodyneModel::kMostLasers;

const std::array<std::pair<unsigned, VelodyneModel>, 5>& models() {
  // The byte of a packet that names the model, and how that fires.
  static const std::array<std::pair<unsigned, VelodyneModel>, 5> all = [] {
    std::array<std::pair<unsigned, VelodyneModel>, 5> made = {
        std::pair{0x21U, evenly_firing("HDL-32E", 32, 0.002, 46.08e-6, 1.152e-6, 1, kNoBreak,
                                       kHdl32Elevations)},
        std::pair{0x22U, evenly_firing("VLP-16", 16, 0.002, 55.296e-6, 2.304e-6, 1, kNoBreak,
                                       kVlp16Elevations)},
        std::pair{0x24U, evenly_firing("Puck Hi-Res", 16, 0.002, 55.296e-6, 2.304e-6, 1, kNoBreak,
                                       kHiResElevations)},
        std::pair{0x28U, evenly_firing("VLP-32C", 32, 0.004, 55.296e-6, 2.304e-6, 2, kNoBreak,
                                       kVlp32Elevations)},
        std::pair{0xa1U, evenly_firing("VLS-128", 128, 0.004, 53.3e-6, 2.665e-6, 8, 8,
                                       kVls128Elevations)}};
    made[1].second.height = kVlp16Heights;
    made[2].second.height = kHiResHeights;
    made[3].second.azimuth = kVlp32Azimuths;
    made[3].second.height = heights_of(made[3].second, 0.0424);
    made[4].second.height = heights_of(made[4].second, 0.05863);
    for (std::size_t i = 0; i < 128; ++i) {
      made[4].second.azimuth[i] = kVls128Azimuths[i % kVls128Azimuths.size()];
    }
    made[4].second.first_firing = -8.7e-6;  // the manual's correction of a packet's time
    return made;
  }();
  return all;
}

}  // namespace

const VelodyneModel* find_velodyne_model(unsigned factory_byte) {
  for (const auto& [code, model] : models()) {
    if (code == factory_byte) {
      return &model;
    }
  }
  return nullptr;
}

}  // namespace adit
