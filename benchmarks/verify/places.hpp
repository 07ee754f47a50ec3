// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Descriptions of places on the device, beside their twins.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "adit/benchmarks/reference/places.hpp"
#include "adit/benchmarks/verify/device_runs.hpp"
#include "adit/benchmarks/verify/verify.hpp"
#include "adit/engine/kernels/places.hpp"

namespace adit::test {

/// Places in one block of an index.
class PlaceRun {
 public:
  explicit PlaceRun(engine::Context& context);

  /// Describes a surface cloud as that place; `cell` is the edge of a cell of the plan, m.
  Times describe(const DeviceCloud& cloud, double cell, uint32_t place);
  /// And as the next place.
  void describe(const std::vector<gpu::uvec4>& cloud, double cell);
  /// That of the last place described, gpu::kPlaceRecord words.
  std::vector<uint32_t> record() const;
  std::vector<uint32_t> block() const;
  uint32_t places() const { return places_; }

  /// The last place described against the first `count`; one number each.
  Times match(uint32_t count);
  /// Cells' centres from the origin, in cells, against plans of the block; one number a job.
  Times correlate(const std::vector<Eigen::Vector2d>& cells, const std::vector<gpu::PlanJob>& jobs);
  const std::vector<uint32_t>& matches() const { return matches_; }

 private:
  engine::Context* context_;
  engine::PlaceKernels kernels_;
  engine::Buffer record_;
  engine::Buffer block_;
  uint32_t places_ = 0;
  std::vector<uint32_t> matches_;
};

/// Centres of a plan's cells from the origin, in cells.
std::vector<Eigen::Vector2d> plan_centres(std::span<const uint32_t> record);

/// Every certain bit and cell, none that is not possible; the block's copies are the record's, and
/// the spread view is what spreading it gives.
Verdict verify_described(const reference::DescribedPlace& expected,
                         std::span<const uint32_t> record, std::span<const uint32_t> block,
                         uint32_t place);
/// Of each place: the most hits of all turns exactly, at a turn that has so many.
Verdict verify_matches(std::span<const uint32_t> record, std::span<const uint32_t> block,
                       std::span<const uint32_t> matches);
/// Of each job: as many hits as the twin has at that shift, and no shift has more, but for what
/// float32 may count otherwise.
Verdict verify_correlations(std::span<const Eigen::Vector2d> cells,
                            std::span<const gpu::PlanJob> jobs, std::span<const uint32_t> block,
                            std::span<const uint32_t> matches);

}  // namespace adit::test
