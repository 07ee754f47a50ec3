// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "adit/slam/core/lie.hpp"

namespace adit {

/// What is known of where a session is in the map of earlier ones.
enum class LocalizationState {
  none,         ///< there is no map of earlier sessions
  searching,    ///< no place of the map has been recognised yet
  ambiguous,    ///< places of the map look alike, and none is clearly the likeliest yet
  localized,    ///< the map has been recognised a short way ago
  outside,      ///< no keyframe of the map is near: the odometry goes on alone
  unconfirmed,  ///< keyframes of the map are near, but none has been recognised for a while
  lost,         ///< the odometry has started anew since, and nothing has been recognised again
};
inline constexpr std::size_t kLocalizationStates = 7;
/// The enumerator's name.
constexpr std::string_view to_string(LocalizationState state) {
  switch (state) {
    case LocalizationState::none:
      return "none";
    case LocalizationState::searching:
      return "searching";
    case LocalizationState::ambiguous:
      return "ambiguous";
    case LocalizationState::localized:
      return "localized";
    case LocalizationState::outside:
      return "outside";
    case LocalizationState::unconfirmed:
      return "unconfirmed";
    case LocalizationState::lost:
      return "lost";
  }
  return "unknown";
}

/// What the session's first place in the map came from.
enum class StartSource {
  appearance,  ///< it was searched for by what places look like
  guess,       ///< somebody said where it begins
  fixes,       ///< GNSS fixes, in a map that is georeferenced
};
/// The enumerator's name.
constexpr std::string_view to_string(StartSource source) {
  switch (source) {
    case StartSource::appearance:
      return "appearance";
    case StartSource::guess:
      return "guess";
    case StartSource::fixes:
      return "fixes";
  }
  return "unknown";
}

/// A session in the map of earlier ones, as its newest keyframe has it.
struct Localization {
  LocalizationState state = LocalizationState::none;
  std::size_t recognised = 0;  ///< accepted loops to keyframes of earlier sessions
  double path = 0.0;           ///< m, gone since the last of them
  double searched = 0.0;       ///< m, gone until the first of them was accepted
  std::array<std::size_t, kLocalizationStates> keyframes{};  ///< so far, by LocalizationState
  StartSource start = StartSource::appearance;
  bool start_contradicted = false;  ///< what was recognised lies elsewhere than it was expected to
  /// The pose's in the map's frame, right perturbation [rho, phi], m^2, rad^2; without an earlier
  /// session's keyframe that it is tied to: zero.
  Matrix6d covariance = Matrix6d::Zero();

  /// There is such a map.
  bool any() const { return state != LocalizationState::none; }
};

}  // namespace adit
