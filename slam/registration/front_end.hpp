// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernels/deskew.hpp"
#include "adit/engine/kernels/preprocess.hpp"
#include "adit/slam/core/config.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/slam/inertial/sweep_motion.hpp"

namespace adit::engine {
class Context;
class Recorder;
}  // namespace adit::engine

namespace adit {

/// Points of the largest sweep that is taken: its down-sampling table still fits one storage buffer
/// of the baseline device.
inline constexpr uint32_t kLargestSweep = 1U << 21U;

/// From a sweep's raw points to its down-sampled cloud with surfaces: device memory and recording.
class FrontEnd {
 public:
  /// A size that is left to be derived is the usual one.
  FrontEnd(engine::Context& context, const PreprocessConfig& config);

  /// Other settings, before the first sweep: kernels and buffers are the same for all.
  void use_lengths(const PreprocessConfig& config);

  /// Takes the sweep into mapped memory; buffers grow to the largest sweep seen. Throws
  /// engine::Error if the device has no room for it.
  void upload(const Sweep& sweep);
  /// The angle between neighbouring beams is set or has been measured.
  bool knows_beam_spacing() const { return settings_.beam_spacing > 0.0; }
  /// Measures the angle between neighbouring beams in these points, unless the configuration sets
  /// it. What is recorded from here on uses it; too few returns leave it unknown.
  void measure_beam_spacing(std::span<const Point> points);
  /// The sweep's points have times, so that they can be de-skewed.
  bool has_times() const { return has_times_; }
  /// Points the buffers are sized for.
  uint32_t capacity() const { return capacity_; }
  /// Raw points of the sweep taken last, invalid ones too.
  uint32_t points() const { return point_count_; }

  /// Records everything up to the surfaces, and the copies back. With the sensor's motion the
  /// points are first moved to the sweep's start; it may be given where has_times().
  void record(engine::Recorder& recorder, engine::Slice surface_cloud,
              const std::optional<SweepMotion>& motion = std::nullopt);
  /// gpu::SweepCounters of the sweep on the device, for kernels that follow.
  engine::Slice counters() const { return counters_; }

  /// After the submission: the counters, and the down-sampled cloud in the lidar frame. Where that
  /// has more points than were to be expected, the others are fetched then.
  gpu::SweepCounters read_counters() const;
  std::vector<Point> read_cloud() const;
  /// After a submission that failed: the scratch may hold anything.
  void invalidate() { reset_scratch_ = true; }

 private:
  void grow(uint32_t points);
  /// The points on the device, de-skewed or copied or where they were uploaded.
  engine::Slice record_points(engine::Recorder& recorder, const std::optional<SweepMotion>& motion);

  engine::Context* context_;
  engine::Deskew deskew_;
  engine::Preprocess preprocess_;
  engine::PreprocessSettings settings_;
  bool measures_beams_;  ///< the configuration leaves the angle between beams to be measured
  bool direct_;          ///< kernels read uploads, and the host reads results, where they are
  uint32_t capacity_ = 0;
  uint32_t point_count_ = 0;
  mutable uint32_t copied_points_ = 0;  ///< of the cloud, with the last sweep's submission
  bool reset_scratch_ = true;
  bool has_times_ = false;
  engine::Buffer knots_;  ///< uploaded
  std::optional<engine::Buffer> staging_;
  std::optional<engine::Buffer> times_;  ///< uploaded; none before the first sweep with times
  std::optional<engine::Buffer> raw_;
  std::optional<engine::Buffer> cloud_;
  std::optional<engine::Buffer> cloud_readback_;
  std::optional<engine::Buffer> scratch_;
  engine::Buffer counters_;
  engine::Buffer counters_readback_;
};

}  // namespace adit
