// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// A point with its class, as files hold it.
template <class P>
struct Classified {
  P point{};
  uint8_t classification = 1;  ///< LasClass
};
#pragma pack(pop)
static_assert(sizeof(TimedPoint) == 26);

/// What a type of points has.
template <class P>
inline constexpr bool kHasTime = false;
template <>
inline constexpr bool kHasTime<TimedPoint> = true;
template <class P>
inline constexpr bool kHasTime<Classified<P>> = kHasTime<P>;
template <class P>
inline constexpr bool kHasClass = false;
template <class P>
inline constexpr bool kHasClass<Classified<P>> = true;

}  // namespace adit
