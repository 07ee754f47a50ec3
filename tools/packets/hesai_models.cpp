// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/hesai_models.hpp"

#include <array>
#include <cstdint>

namespace adit {
namespace {

// Hesai's manuals and SDKs publish, by channel: elevations and azimuths of the design (degrees) and
// firing times (ns). Each sensor's own angles are in its angle correction file.

// Pandar40P: the manual's appendices I and II. Times are before the end of the block.
constexpr std::array<double, 40> kElevations40p = {
    15,    11,    8,     5,  3,     2,     1.67, 1.33,  1,     0.67, 0.33,  0,     -0.33, -0.67,
    -1,    -1.33, -1.66, -2, -2.33, -2.67, -3,   -3.33, -3.67, -4,   -4.33, -4.67, -5,    -5.33,
    -5.67, -6,    -7,    -8, -9,    -10,   -11,  -12,   -13,   -14,  -19,   -25};
constexpr std::array<double, 40> kAzimuths40p = {
    -1.042, -1.042, -1.042, -1.042, -1.042, -1.042, 3.125,  -5.208, -1.042, 3.125,
    -5.208, -1.042, 3.125,  -5.208, -1.042, 3.125,  -5.208, -1.042, 3.125,  -5.208,
    -1.042, 3.125,  -5.208, -1.042, 3.125,  -5.208, -1.042, 3.125,  -5.208, -1.042,
    -1.042, -1.042, -1.042, -1.042, -1.042, -1.042, -1.042, -1.042, -1.042, -1.042};
constexpr std::array<int32_t, 40> kFirings40p = {
    42220, 28470, 16040, 3620,  45490, 31740, 47460, 54670, 20620, 33710,
    40910, 8190,  20620, 27160, 50730, 8190,  14740, 36980, 45490, 52700,
    23890, 31740, 38950, 11470, 18650, 25190, 48760, 6230,  12770, 35010,
    21920, 9500,  43520, 29770, 17350, 4920,  42220, 28470, 16040, 3620};

// PandarQT64: HesaiLidar_General_SDK; times are those of its firetime correction file.
constexpr std::array<double, 64> kElevationsQt64 = {
    -52.121, -49.785, -47.577, -45.477, -43.465, -41.528, -39.653, -37.831, -36.055, -34.32,
    -32.619, -30.95,  -29.308, -27.69,  -26.094, -24.517, -22.964, -21.42,  -19.889, -18.372,
    -16.865, -15.368, -13.88,  -12.399, -10.925, -9.457,  -7.994,  -6.535,  -5.079,  -3.626,
    -2.175,  -0.725,  0.725,   2.175,   3.626,   5.079,   6.534,   7.993,   9.456,   10.923,
    12.397,  13.877,  15.365,  16.861,  18.368,  19.885,  21.415,  22.959,  24.524,  26.101,
    27.697,  29.315,  30.957,  32.627,  34.328,  36.064,  37.84,   39.662,  41.537,  43.475,
    45.487,  47.587,  49.795,  52.133};
constexpr std::array<double, 64> kAzimuthsQt64 = {
    8.736,  8.314,  7.964,  7.669,  7.417,  7.198,  7.007,  6.838,  6.688,  6.554,  6.434,
    6.326,  6.228,  6.14,   6.059,  5.987,  -5.27,  -5.216, -5.167, -5.123, -5.083, -5.047,
    -5.016, -4.988, -4.963, -4.942, -4.924, -4.91,  -4.898, -4.889, -4.884, -4.881, 5.493,
    5.496,  5.502,  5.512,  5.525,  5.541,  5.561,  5.584,  5.611,  5.642,  5.676,  5.716,
    5.759,  5.808,  5.862,  5.921,  -5.33,  -5.396, -5.469, -5.55,  -5.64,  -5.74,  -5.85,
    -5.974, -6.113, -6.269, -6.447, -6.651, -6.887, -7.163, -7.493, -7.892};
constexpr std::array<int32_t, 64> kFiringsQt64 = {
    2310,   4370,   6430,   8490,   10540,  12600,  14660,  16710,  19160,  21220,  23280,
    25340,  27390,  29450,  31500,  33560,  36610,  38670,  40730,  42780,  44840,  46900,
    48950,  51010,  53450,  55520,  57580,  59630,  61690,  63740,  65800,  67860,  70900,
    72970,  75020,  77080,  79140,  81190,  83250,  85300,  87750,  89820,  91870,  93930,
    95980,  98040,  100100, 102150, 105200, 107260, 109320, 111380, 113430, 115490, 117540,
    119600, 122050, 124110, 126170, 128220, 130280, 132340, 134390, 136450};

// QT128C2X: correction file of HesaiLidar_Swift_ROS, firetime correction file of the manual. Of two
// firing sequences in turn, the first leaves out channels 1 to 32, the second 33 to 64.
constexpr std::array<double, 128> kElevationsQt128 = {
    -52.627, -51.028, -49.515, -48.074, -46.695, -45.369, -44.09,  -42.852, -41.651, -40.482,
    -39.343, -38.231, -37.143, -36.076, -35.03,  -34.002, -32.992, -31.996, -31.015, -30.048,
    -29.093, -28.149, -27.216, -26.292, -25.378, -24.473, -23.575, -22.685, -21.802, -20.926,
    -20.056, -19.191, -18.331, -17.477, -16.627, -15.781, -14.94,  -14.102, -13.268, -12.436,
    -11.608, -10.783, -9.96,   -9.139,  -8.32,   -7.503,  -6.688,  -5.874,  -5.061,  -4.25,
    -3.439,  -2.63,   -1.82,   -1.012,  -0.203,  0.606,   1.414,   2.223,   3.033,   3.843,
    4.654,   5.466,   6.279,   7.094,   7.91,    8.728,   9.547,   10.369,  11.194,  12.02,
    12.85,   13.683,  14.519,  15.359,  16.202,  17.05,   17.902,  18.759,  19.621,  20.488,
    21.362,  22.241,  23.128,  24.022,  24.923,  25.833,  26.751,  27.679,  28.618,  29.567,
    30.528,  31.502,  32.49,   33.493,  34.512,  35.549,  19.191,  20.056,  20.926,  21.802,
    22.685,  23.575,  24.473,  25.378,  26.292,  27.216,  28.149,  29.093,  30.048,  31.015,
    31.996,  32.992,  34.002,  35.03,   36.076,  37.143,  38.231,  39.343,  40.482,  41.651,
    42.852,  44.09,   45.369,  46.695,  48.074,  49.515,  51.028,  52.627};
constexpr std::array<double, 128> kAzimuthsQt128 = {
    10.108, 9.72,   9.384,  9.091,  8.833,  8.603,  8.396,  8.209,  8.04,   7.885,  7.743,  7.612,
    7.492,  7.38,   7.277,  7.18,   7.09,   7.006,  6.928,  6.854,  6.785,  6.721,  6.66,   6.602,
    6.549,  6.498,  6.45,   6.405,  6.363,  6.323,  6.285,  6.25,   -6.217, -6.186, -6.157, -6.129,
    -6.104, -6.08,  -6.057, -6.037, -6.018, -6,     -5.984, -5.969, -5.955, -5.943, -5.927, -5.923,
    -5.915, -5.908, -5.902, -5.897, -5.894, -5.892, -5.891, -5.891, -5.893, -5.896, -5.899, -5.905,
    -5.911, -5.919, -5.927, -5.938, 5.949,  5.962,  5.976,  5.992,  6.008,  6.027,  6.047,  6.068,
    6.091,  6.116,  6.143,  6.171,  6.201,  6.233,  6.267,  6.304,  6.343,  6.384,  6.427,  6.474,
    6.523,  6.575,  6.631,  6.69,   6.752,  6.819,  6.89,   6.966,  7.047,  7.134,  7.227,  7.327,
    -6.25,  -6.285, -6.323, -6.363, -6.405, -6.45,  -6.498, -6.549, -6.602, -6.66,  -6.721, -6.785,
    -6.854, -6.928, -7.006, -7.09,  -7.18,  -7.277, -7.38,  -7.492, -7.612, -7.743, -7.885, -8.04,
    -8.209, -8.396, -8.603, -8.833, -9.091, -9.384, -9.72,  -10.108};
constexpr std::array<int32_t, 128> kFirstFiringsQt128 = {
    0,     0,     0,     0,     0,     0,     0,     0,     0,      0,     0,     0,     0,
    0,     0,     0,     0,     0,     0,     0,     0,     0,      0,     0,     0,     0,
    0,     0,     0,     0,     0,     0,     27656, 53000, 2312,   78344, 81512, 5480,  56168,
    30824, 33992, 59336, 8648,  84680, 87848, 11816, 62504, 37160,  40328, 65672, 14984, 91016,
    94184, 18152, 68840, 43496, 46664, 72008, 21320, 97352, 100520, 24488, 75176, 49832, 1456,
    77488, 26800, 52144, 55312, 29968, 80656, 4624,  7792,  83824,  33136, 58480, 61648, 36304,
    86992, 10960, 14128, 90160, 39472, 64816, 67984, 42640, 93328,  17296, 20464, 96496, 45808,
    71152, 74320, 48976, 99664, 23632, 25944, 51288, 600,   76632,  79800, 3768,  54456, 29112,
    32280, 57624, 6936,  82968, 86136, 10104, 60792, 35448, 38616,  63960, 13272, 89304, 92472,
    16440, 67128, 41784, 44952, 70296, 19608, 95640, 98808, 22776,  73464, 48120};
constexpr std::array<int32_t, 128> kSecondFiringsQt128 = {
    2312,  78344, 27656, 53000, 56168,  30824, 81512, 5480,  8648,  84680, 33992, 59336, 62504,
    37160, 87848, 11816, 14984, 91016,  40328, 65672, 68840, 43496, 94184, 18152, 21320, 97352,
    46664, 72008, 75176, 49832, 100520, 24488, 0,     0,     0,     0,     0,     0,     0,
    0,     0,     0,     0,     0,      0,     0,     0,     0,     0,     0,     0,     0,
    0,     0,     0,     0,     0,      0,     0,     0,     0,     0,     0,     0,     600,
    76632, 25944, 51288, 54456, 29112,  79800, 3768,  6936,  82968, 32280, 57624, 60792, 35448,
    86136, 10104, 13272, 89304, 38616,  63960, 67128, 41784, 92472, 16440, 19608, 95640, 44952,
    70296, 73464, 48120, 98808, 22776,  26800, 52144, 1456,  77488, 80656, 4624,  55312, 29968,
    33136, 58480, 7792,  83824, 86992,  10960, 61648, 36304, 39472, 64816, 14128, 90160, 93328,
    17296, 67984, 42640, 45808, 71152,  20464, 96496, 99664, 23632, 74320, 48976};

template <std::size_t N>
HesaiAngles angles_of(const std::array<double, N>& elevations,
                      const std::array<double, N>& azimuths) {
  return {.elevations = {elevations.begin(), elevations.end()},
          .azimuths = {azimuths.begin(), azimuths.end()}};
}

/// Elevations from `first` down, `step` degrees apart, at the azimuth of the block.
HesaiAngles even_angles(std::size_t lasers, double first, double step) {
  HesaiAngles angles;
  for (std::size_t i = 0; i < lasers; ++i) {
    angles.elevations.push_back(first - step * static_cast<double>(i));
    angles.azimuths.push_back(0.0);
  }
  return angles;
}

template <std::size_t N>
std::vector<double> seconds_of(const std::array<int32_t, N>& nanoseconds, double after = 0.0) {
  std::vector<double> firing;
  for (const int32_t one : nanoseconds) {
    firing.push_back(after + 1e-9 * one);
  }
  return firing;
}

HesaiModel xt(std::size_t lasers) {
  HesaiModel model{.name = "PandarXT-" + std::to_string(lasers),
                   .design = even_angles(lasers, 15.0, 32.0 / static_cast<double>(lasers)),
                   .blocks = {.first = 5.632e-6, .period = 50e-6, .from_last = true}};
  // XT's lasers fire 1.512 us apart; 16 of them, every second of those of 32.
  for (std::size_t i = 0; i < lasers; ++i) {
    model.firing[0].push_back(1e-6 *
                              (0.28 + 1.512 * static_cast<double>(lasers == 16 ? 2 * i : i)));
  }
  return model;
}

/// Two lasers at a time, a half of the fan apart. Its azimuths are read before the packet's delay.
HesaiModel xt32m() {
  HesaiModel model{.name = "XT32M2X",
                   .design = even_angles(32, 19.5, 1.3),
                   .blocks = {.first = 5.632e-6, .period = 50e-6, .from_last = true},
                   .azimuth_read = -5.632e-6};
  for (std::size_t i = 0; i < 32; ++i) {
    model.firing[0].push_back(1e-6 * (0.368 + 2.888 * static_cast<double>(i % 16)));
  }
  return model;
}

HesaiModel pandar40p() {
  constexpr double kFirst = 54.67e-6;  // s before the block's end, the time of its azimuth
  HesaiModel model{.name = "Pandar40P",
                   .design = angles_of(kElevations40p, kAzimuths40p),
                   .each_has_its_own = true,
                   .blocks = {.first = -28.58e-6 - kFirst, .period = 55.56e-6, .from_last = true},
                   .azimuth_read = kFirst};
  for (const int32_t before : kFirings40p) {
    model.firing[0].push_back(kFirst - 1e-9 * before);
  }
  return model;
}

HesaiModel qt64() {
  constexpr double kDelay = 10e-6;  // s from a block's begin to the zero of its firing times
  return {.name = "PandarQT64",
          .design = angles_of(kElevationsQt64, kAzimuthsQt64),
          .each_has_its_own = true,
          .blocks = {.first = 25.71e-6, .period = 500e-6 / 3.0},
          .azimuth_read = kDelay,
          .firing = {seconds_of(kFiringsQt64, kDelay), {}}};
}

HesaiModel qt128() {
  return {.name = "QT128C2X",
          .design = angles_of(kElevationsQt128, kAzimuthsQt128),
          .each_has_its_own = true,
          .blocks = {.first = 9e-6, .period = 111.11e-6},
          .azimuth_read = 0.0,
          .firing = {seconds_of(kFirstFiringsQt128), seconds_of(kSecondFiringsQt128)}};
}

}  // namespace

const HesaiModel* find_hesai_model(std::string_view name) {
  static const std::array<HesaiModel, 6> kModels = {xt(32),      xt(16), xt32m(),
                                                    pandar40p(), qt64(), qt128()};
  for (const HesaiModel& model : kModels) {
    if (model.name == name) {
      return &model;
    }
  }
  return nullptr;
}

}  // namespace adit
