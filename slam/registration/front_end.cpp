// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/front_end.hpp"

#include <algorithm>
#include <bit>
#include <string>

#include "adit/engine/context.hpp"
#include "adit/slam/registration/beam_spacing.hpp"

namespace adit {
namespace {

constexpr uint32_t kSmallestCapacity = 1U << 14U;

engine::PreprocessSettings settings_of(const PreprocessConfig& config) {
  return {.c_min = config.c_min,
          .c_max = config.c_max,
          .r_input = config.r_input > 0.0 ? config.r_input : kUsualInput,
          .beam_spacing = config.beam_spacing,
          .surface_size = config.surface_size};
}

}  // namespace

FrontEnd::FrontEnd(engine::Context& context, const PreprocessConfig& config)
    : context_(&context),
      deskew_(context),
      preprocess_(context),
      settings_(settings_of(config)),
      measures_beams_(config.beam_spacing == 0.0),
      direct_(!context.device().gpu_shapes),
      knots_(context.make_buffer(kMotionKnots * sizeof(gpu::DeskewKnot), engine::Memory::upload,
                                 "motion within the sweep")),
      counters_(context.make_buffer(sizeof(gpu::SweepCounters), engine::Memory::device,
                                    "sweep counters")),
      counters_readback_(context.make_buffer(sizeof(gpu::SweepCounters), engine::Memory::readback,
                                             "sweep counters back")) {}

void FrontEnd::use_lengths(const PreprocessConfig& config) {
  settings_ = settings_of(config);
}

void FrontEnd::grow(uint32_t points) {
  const uint32_t capacity = std::bit_ceil(std::max(points, kSmallestCapacity));
  const uint64_t bytes = uint64_t{capacity} * sizeof(Point);
  capacity_ = 0;
  for (auto* buffer : {&staging_, &times_, &raw_, &cloud_, &cloud_readback_, &scratch_}) {
    buffer->reset();
  }
  staging_ = context_->make_buffer(bytes, engine::Memory::upload, "raw points");
  cloud_ = context_->make_buffer(bytes, engine::Memory::device, "down-sampled cloud");
  if (!direct_) {
    raw_ = context_->make_buffer(bytes, engine::Memory::device, "raw points on the device");
    cloud_readback_ =
        context_->make_buffer(bytes, engine::Memory::readback, "down-sampled cloud back");
  }
  scratch_ = context_->make_buffer(preprocess_.scratch_bytes(capacity), engine::Memory::device,
                                   "preprocessing scratch");
  reset_scratch_ = true;
  capacity_ = capacity;
}

void FrontEnd::measure_beam_spacing(std::span<const Point> points) {
  if (measures_beams_) {
    settings_.beam_spacing = measured_beam_spacing(points).value_or(0.0);
  }
}

void FrontEnd::upload(const Sweep& sweep) {
  if (sweep.points.size() > kLargestSweep) {
    throw engine::Error("sweep " + sweep.source + " has " + std::to_string(sweep.points.size()) +
                        " points; at most " + std::to_string(kLargestSweep) +
                        " fit: thin the recording or split its sweeps");
  }
  const auto count = static_cast<uint32_t>(sweep.points.size());
  if (count > capacity_ || capacity_ == 0) {
    grow(count);
  }
  point_count_ = count;
  std::ranges::copy(sweep.points, staging_->as<Point>().begin());
  has_times_ = count > 0 && sweep.times.size() == sweep.points.size();
  if (has_times_) {
    if (!times_) {
      times_ = context_->make_buffer(uint64_t{capacity_} * sizeof(float), engine::Memory::upload,
                                     "times of points");
    }
    if (!raw_) {
      raw_ = context_->make_buffer(uint64_t{capacity_} * sizeof(Point), engine::Memory::device,
                                   "raw points on the device");
    }
    std::ranges::copy(sweep.times, times_->as<float>().begin());
  }
}

engine::Slice FrontEnd::record_points(engine::Recorder& recorder,
                                      const std::optional<SweepMotion>& motion) {
  const uint64_t bytes = uint64_t{point_count_} * sizeof(Point);
  if (motion && has_times_) {
    const std::vector<gpu::DeskewKnot> table = knots(*motion);
    std::ranges::copy(table, knots_.as<gpu::DeskewKnot>().begin());
    // Straight from mapped memory: each point is read once, as a copy would.
    deskew_.record(recorder,
                   {.c_min = settings_.c_min,
                    .c_max = settings_.c_max,
                    .first_time = motion->first,
                    .last_time = motion->last},
                   {.point_count = point_count_,
                    .knot_count = static_cast<uint32_t>(table.size()),
                    .raw = staging_->slice(0, bytes),
                    .times = times_->slice(0, uint64_t{point_count_} * sizeof(float)),
                    .knots = knots_,
                    .moved = raw_->slice(0, bytes)});
    recorder.barrier();
    return *raw_;
  }
  if (direct_) {
    return *staging_;
  }
  if (point_count_ > 0) {
    const engine::Scope scope = recorder.scope("upload");
    recorder.copy(staging_->slice(0, bytes), raw_->slice(0, bytes));
    recorder.barrier();
  }
  return *raw_;
}

void FrontEnd::record(engine::Recorder& recorder, engine::Slice surface_cloud,
                      const std::optional<SweepMotion>& motion) {
  if (reset_scratch_) {
    preprocess_.record_reset(recorder, *scratch_);
    reset_scratch_ = false;
  }
  const engine::Slice raw = record_points(recorder, motion);
  preprocess_.record(recorder, settings_,
                     {.point_count = point_count_,
                      .capacity = capacity_,
                      .raw = raw,
                      .cloud = *cloud_,
                      .surface_cloud = surface_cloud,
                      .counters = counters_},
                     *scratch_);
  recorder.barrier();
  if (!direct_ && point_count_ > 0) {
    // Sweeps have about as many points left as the one before.
    const uint32_t last = copied_points_ > 0 ? read_counters().cloud_points : point_count_;
    copied_points_ = std::min(point_count_, last + last / 4 + 1024);
    const uint64_t bytes = uint64_t{copied_points_} * sizeof(Point);
    recorder.copy(cloud_->slice(0, bytes), cloud_readback_->slice(0, bytes));
  }
  recorder.copy(counters_, counters_readback_);
}

gpu::SweepCounters FrontEnd::read_counters() const {
  return counters_readback_.as<gpu::SweepCounters>()[0];
}

std::vector<Point> FrontEnd::read_cloud() const {
  const uint32_t count = read_counters().cloud_points;
  if (!direct_ && count > copied_points_) {
    const uint64_t at = uint64_t{copied_points_} * sizeof(Point);
    const uint64_t bytes = uint64_t{count - copied_points_} * sizeof(Point);
    engine::Recorder recorder = context_->make_recorder();
    recorder.copy(cloud_->slice(at, bytes), cloud_readback_->slice(at, bytes));
    context_->submit(std::move(recorder)).wait();
    copied_points_ = count;
  }
  const auto points = (direct_ ? *cloud_ : *cloud_readback_).as<Point>();
  return {points.begin(), points.begin() + count};
}

}  // namespace adit
