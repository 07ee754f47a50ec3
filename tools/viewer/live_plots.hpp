// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The plots of a run that goes on, in as much memory after days as after minutes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/tools/viewer/view_plots.hpp"

namespace adit {

/// The least and the most of each curve in equal times from the run's first sweep on. Once there
/// are more than kMostPlotBins of them, each two become one that lasts twice as long.
class LivePlots {
 public:
  /// A sweep `seconds` after the first one, which comes with that version of the scene.
  void add(const SweepRecord& sweep, double seconds, uint64_t version);

  /// The curves without values, to begin with: Plots of protocol.ts.
  static nlohmann::ordered_json nothing();
  /// What has changed since the version `told`: the values of all curves from one time on. Null
  /// where that is nothing.
  nlohmann::ordered_json since(uint64_t told) const;

 private:
  struct Bin {
    std::array<double, kPlotCurves> least{};
    std::array<double, kPlotCurves> most{};
    uint64_t version = 0;  ///< that it was last another one with
  };

  std::size_t place_for(double seconds, uint64_t version);
  void halve(uint64_t version);

  double begin_ = 0.0;  ///< s, of the first bin
  double step_ = 0.0;   ///< s, of each; 0: there is one sweep at most
  std::vector<Bin> bins_;
  uint64_t placed_ = 0;  ///< version since which bins last as long as they do
};

}  // namespace adit
