// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Each kernel family with its buffers filled, ready to run any number of times: what tests verify
// is what benchmarks time. Every function waits for the device. Scope times are empty unless the
// context profiles.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "adit/benchmarks/reference/submap_merge.hpp"
#include "adit/benchmarks/reference/vgicp.hpp"
#include "adit/engine/context.hpp"
#include "adit/engine/kernels/deskew.hpp"
#include "adit/engine/kernels/preprocess.hpp"
#include "adit/engine/kernels/registration.hpp"
#include "adit/engine/kernels/submap_merge.hpp"
#include "adit/engine/kernels/voxel_map.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/slam/inertial/sweep_motion.hpp"

namespace adit::test {

/// What the clocks say of one submission, ms.
struct Times {
  std::vector<engine::ScopeTime> scopes;  ///< the device's clock
  double wait_ms = 0.0;                   ///< from submitting to the end of the wait
  double host_ms = 0.0;                   ///< from recording to the end of the wait
};

/// Records what `record` says, runs it and waits.
template <class Record>
Times run_and_wait(engine::Context& context, Record&& record) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  engine::Recorder recorder = context.make_recorder();
  record(recorder);
  const Clock::time_point recorded = Clock::now();
  engine::Submission submission = context.submit(std::move(recorder));
  submission.wait();
  const Clock::time_point end = Clock::now();
  using Milliseconds = std::chrono::duration<double, std::milli>;
  return {.scopes = submission.scope_times(),
          .wait_ms = Milliseconds(end - recorded).count(),
          .host_ms = Milliseconds(end - begin).count()};
}

/// A sweep on the device, and what Preprocess makes of it.
class PreprocessRun {
 public:
  PreprocessRun(engine::Context& context, const engine::PreprocessSettings& settings,
                const std::vector<Point>& raw);

  Times run();

  gpu::SweepCounters counters() const;
  std::vector<Point> cloud() const;
  std::vector<gpu::uvec4> surface_cloud() const;

 private:
  engine::Context* context_;
  engine::Preprocess preprocess_;
  engine::PreprocessSettings settings_;
  uint32_t count_;
  engine::Buffer raw_;
  engine::Buffer cloud_;
  engine::Buffer surface_cloud_;
  engine::Buffer counters_;
  engine::Buffer scratch_;
};

/// A sweep and the sensor's motion on the device, and what Deskew makes of them.
class DeskewRun {
 public:
  /// `times` in s after the sweep's stamp, one a point.
  DeskewRun(engine::Context& context, const engine::DeskewSettings& settings,
            const std::vector<Point>& raw, const std::vector<float>& times,
            const SweepMotion& motion);

  Times run();

  std::vector<Point> moved() const;  ///< NaN where nothing was written

 private:
  engine::Context* context_;
  engine::Deskew deskew_;
  engine::DeskewSettings settings_;
  uint32_t count_;
  uint32_t knots_count_;
  engine::Buffer raw_;
  engine::Buffer times_;
  engine::Buffer knots_;
  engine::Buffer moved_;
};

/// A surface cloud on the device.
class DeviceCloud {
 public:
  DeviceCloud(engine::Context& context, const std::vector<gpu::uvec4>& points);

  uint32_t size() const { return size_; }
  engine::Slice points() const { return points_; }
  /// gpu::SweepCounters that say size().
  engine::Slice counters() const { return counters_; }

 private:
  uint32_t size_;
  engine::Buffer points_;
  engine::Buffer counters_;
};

/// A Gaussian voxel map, empty at first.
class VoxelMapRun {
 public:
  /// Voxel size in m; `slots` is a power of two.
  VoxelMapRun(engine::Context& context, double voxel_size, uint32_t slots,
              engine::VoxelContent content = engine::VoxelContent::surfaces);

  void clear();
  Times add(const DeviceCloud& cloud, const Eigen::Isometry3d& T_map_cloud);
  Times remove(const DeviceCloud& cloud, const Eigen::Isometry3d& T_map_cloud);

  /// From now on target() is what VoxelMapKernels::record_finish() makes of the map.
  Times finish(const engine::FinishSettings& settings);

  engine::VoxelMapView view() const;
  /// What alignments read.
  engine::Slice target() const { return finished_ ? *finished_ : table_; }
  std::vector<gpu::GaussianCell> target_cells() const;
  std::vector<gpu::GaussianCell> cells() const;
  gpu::VoxelMapCounters counters() const;

 private:
  engine::Context* context_;
  engine::VoxelMapKernels kernels_;
  double voxel_size_;
  engine::Buffer table_;
  engine::Buffer counters_;
  std::optional<engine::Buffer> finished_;
};

/// Clouds on the device, and the cells that SubmapMerge makes of them.
class SubmapMergeRun {
 public:
  /// `edge` in m; `slots` is a power of two.
  SubmapMergeRun(engine::Context& context, std::span<const reference::CloudToMerge> clouds,
                 double edge, uint32_t slots);

  Times run();  ///< empties the table first, which is not timed

  std::vector<gpu::MergeCell> cells() const;
  gpu::MergeCounters counters() const;

 private:
  engine::MergeView view() const;

  engine::Context* context_;
  engine::SubmapMerge kernels_;
  double edge_;
  std::vector<engine::MergeCloud> clouds_;
  engine::Buffer points_;
  engine::Buffer table_;
  engine::Buffer counters_;
};

/// A merged cloud on the device, and its surfaces.
class SubmapSurfacesRun {
 public:
  /// Each point with the number of its sensor; where the sensors were, m.
  SubmapSurfacesRun(engine::Context& context, const engine::PreprocessSettings& settings,
                    const std::vector<gpu::uvec4>& points,
                    const std::vector<Eigen::Vector3f>& sensors);

  Times run();

  std::vector<gpu::uvec4> surface_cloud() const;

 private:
  engine::Context* context_;
  engine::SubmapMerge kernels_;
  engine::PreprocessSettings settings_;
  uint32_t count_;
  engine::Buffer points_;
  engine::Buffer sensors_;
  engine::Buffer surface_cloud_;
  engine::Buffer scratch_;
};

/// All that the device leaves of an alignment.
struct DeviceOutcome : gpu::RegistrationState, gpu::RegistrationProgress {
  gpu::RegistrationHeader header;
};

/// What a run is given beyond reference::AlignmentSettings.
struct AlignmentOptions {
  double robust_width = 1.0;
  uint32_t max_constrained = 0;
  Matrix6d prior_information = Matrix6d::Zero();        ///< for the start pose; right perturbation
  Eigen::Vector3d viewpoint = Eigen::Vector3d::Zero();  ///< target's sensor, target frame
  double score_weight = 1.0;                            ///< factor of NDT: -d1 d2
  double score_exponent = 0.0;                          ///< d2 / 2
};

/// Alignments of one cloud with one map. These and the kernels must outlive this.
class AlignmentRun {
 public:
  AlignmentRun(engine::Context& context, const engine::RegistrationKernels& kernels,
               const DeviceCloud& source, const VoxelMapRun& target,
               const reference::AlignmentSettings& settings, const AlignmentOptions& options = {});

  /// The whole loop from `start`.
  Times align(const Eigen::Isometry3d& start);
  /// One linearisation at `pose`, no step, and what its matches hold.
  Times evaluate(const Eigen::Isometry3d& pose);
  /// At most so many linearisations and steps from `pose`, and nothing else.
  Times step(const Eigen::Isometry3d& pose, uint32_t steps);

  DeviceOutcome state() const;

 private:
  Times run(const Eigen::Isometry3d& pose, uint32_t max_iterations, bool assess);

  engine::Context* context_;
  const engine::RegistrationKernels* kernels_;
  const DeviceCloud* source_;
  const VoxelMapRun* target_;
  reference::AlignmentSettings settings_;
  AlignmentOptions options_;
  engine::Buffer upload_;
  engine::Buffer progress_;
  engine::Buffer state_;
  engine::Buffer scratch_;
};

/// Device time of the scope of this name, ms; 0 where there is none.
double device_ms(const Times& times, std::string_view scope);

}  // namespace adit::test
