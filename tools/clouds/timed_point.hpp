// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace adit {

/// A point with all that a sensor tells of it, as files hold it. 26 bytes without padding.
#pragma pack(push, 1)
struct TimedPoint {
  float x = 0.0F;  ///< m
  float y = 0.0F;
  float z = 0.0F;
  float intensity = 0.0F;
  double time = 0.0;  ///< s, of the recording's clock
  uint16_t ring = 0;  ///< beam
};

/// The colour of a point in PLY files.
struct PlyColor {
  std::array<uint8_t, 3> bytes{};  ///< red, green, blue

  static PlyColor of(const std::array<uint8_t, 3>& color) { return {color}; }
};

/// The colour of a point in PCD files: PCL's field `rgb`.
struct PcdColor {
  uint32_t rgb = 0;  ///< 0x00RRGGBB

  static PcdColor of(const std::array<uint8_t, 3>& color) {
    return {uint32_t{color[0]} << 16U | uint32_t{color[1]} << 8U | uint32_t{color[2]}};
  }
};

/// A point with a colour of either kind.
template <class P, class Color>
struct Colored {
  P point{};
  Color color{};
};

/// A point with its class, as files hold it. It may have a colour.
template <class P>
struct Classified {
  P point{};
  uint8_t classification = 1;  ///< LasClass
};
#pragma pack(pop)
static_assert(sizeof(TimedPoint) == 26);
static_assert(sizeof(Classified<Colored<TimedPoint, PlyColor>>) == 26 + 3 + 1);
static_assert(sizeof(Classified<Colored<TimedPoint, PcdColor>>) == 26 + 4 + 1);

/// What a type of points has.
template <class P>
inline constexpr bool kHasTime = false;
template <>
inline constexpr bool kHasTime<TimedPoint> = true;
template <class P, class Color>
inline constexpr bool kHasTime<Colored<P, Color>> = kHasTime<P>;
template <class P>
inline constexpr bool kHasTime<Classified<P>> = kHasTime<P>;
template <class P>
inline constexpr bool kHasColor = false;
template <class P, class Color>
inline constexpr bool kHasColor<Colored<P, Color>> = true;
template <class P>
inline constexpr bool kHasColor<Classified<P>> = kHasColor<P>;
template <class P>
inline constexpr bool kHasClass = false;
template <class P>
inline constexpr bool kHasClass<Classified<P>> = true;

}  // namespace adit
