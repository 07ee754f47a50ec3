// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// --classify and --clean: which points of a cloud are ground, and which are noise.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "adit/tools/export/export_job.hpp"
#include "adit/tools/map_products/noise_space.hpp"
#include "adit/tools/plans/ground_planes.hpp"

namespace adit {

/// What is known of the classes of points.
struct CloudClasses {
  std::shared_ptr<const GroundPlanes> ground{};  ///< null: it was not looked for
  std::shared_ptr<const NoiseSpace> noise{};     ///< the same
  bool ground_is_class = false;                  ///< of --classify
  bool drop = false;                             ///< noise and what moves is left out
  bool looks_at_sweeps = false;  ///< mixed pixels and the carrier are looked for: of dense clouds

  bool any() const { return ground || noise; }
};

/// Looks for what the options ask for; nothing where they ask for nothing. Throws InputError where
/// the map is damaged.
CloudClasses find_classes(const ExportJob& job, const ProductCoordinates& coordinates);

/// `selection`, whose points get their classes.
CloudSelection with_classes(CloudSelection selection, const CloudClasses& classes);

/// Counts points by class on their way into a file, and leaves out those that are not wanted.
class ClassFilter {
 public:
  explicit ClassFilter(const CloudClasses& classes) : classes_(&classes) {}

  /// Those that go into the file; valid until the next call.
  std::span<const CloudPoint> pass(std::span<const CloudPoint> points);

  /// "; 1234 ground; 12 noise and 34 moving left out" for people; nothing where no
  /// class was looked for.
  std::string text() const;

 private:
  const CloudClasses* classes_;
  std::array<uint64_t, 256> counts_{};  ///< by class
  std::vector<CloudPoint> kept_;
};

}  // namespace adit
