// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/run_statistics.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include <fmt/core.h>

#include "adit/tools/report/rejection_text.hpp"

namespace adit {
namespace {

std::string status_reason(const SweepResult& sweep, const Config& config) {
  const RegistrationResult& r = sweep.registration;
  switch (r.status) {
    case RegistrationStatus::too_little_overlap:
      return percent(r.overlap) + " of its points matched the submap, " +
             percent(config.registration.min_overlap) + " are needed (registration.min_overlap)";
    case RegistrationStatus::too_few_points:
      return std::to_string(r.inliers) + " of its points matched the submap, " +
             std::to_string(config.registration.min_inliers) +
             " are needed (registration.min_inliers)";
    case RegistrationStatus::not_converged:
      return "the alignment was still moving after " + std::to_string(r.iterations) +
             " iterations (registration.max_iterations)";
    case RegistrationStatus::diverged:
      return "the alignment diverged";
    case RegistrationStatus::doubtful:
      return sweep.rejection ? describe(*sweep.rejection) : "";
    case RegistrationStatus::converged:
    case RegistrationStatus::degenerate:
      break;
  }
  return "the alignment converged, but was not accepted";
}

}  // namespace

Distribution distribution(std::vector<float> values) {
  if (values.empty()) {
    return {};
  }
  std::ranges::sort(values);
  const auto count = static_cast<double>(values.size());
  const auto percentile = [&](double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * count));
    return static_cast<double>(values[std::max<std::size_t>(rank, 1) - 1]);
  };
  return {.count = values.size(),
          .mean = std::accumulate(values.begin(), values.end(), 0.0) / count,
          .p50 = percentile(0.50),
          .p95 = percentile(0.95),
          .max = static_cast<double>(values.back())};
}

std::vector<WorkCounts> counts_by_kind(const std::vector<engine::RecordedWork>& sweeps) {
  std::vector<WorkCounts> kinds;
  const auto add = [&](const char* name, const auto& value) {
    WorkCounts kind{.name = name, .counts = {}};
    for (const engine::RecordedWork& sweep : sweeps) {
      kind.counts.push_back(static_cast<float>(value(sweep)));
    }
    kinds.push_back(std::move(kind));
  };
  using Work = engine::RecordedWork;
  add("submissions", [](const Work& work) { return work.submissions; });
  add("dispatches", [](const Work& work) { return work.dispatches; });
  add("barriers", [](const Work& work) { return work.barriers; });
  add("copies", [](const Work& work) { return work.copies; });
  add("KiB up", [](const Work& work) { return static_cast<double>(work.upload_bytes) / 1024.0; });
  add("KiB down",
      [](const Work& work) { return static_cast<double>(work.readback_bytes) / 1024.0; });
  return kinds;
}

std::optional<std::string> failure_reason(const SweepResult& sweep, const Config& config) {
  const bool placed =
      sweep.state == OdometryState::tracking || sweep.state == OdometryState::initializing;
  if (sweep.valid_points == 0) {
    return sweep.raw_points == 0
               ? std::string("it has no points")
               : "none of its " + std::to_string(sweep.raw_points) +
                     " points is a return within range (preprocess.c_min, preprocess.c_max)";
  }
  if (placed) {
    return std::nullopt;
  }
  if (sweep.cloud_points < config.registration.min_inliers) {
    return "only " + std::to_string(sweep.cloud_points) +
           " points are left of it after down-sampling, " +
           std::to_string(config.registration.min_inliers) +
           " are needed (registration.min_inliers)";
  }
  return status_reason(sweep, config);
}

std::optional<SweepFailure> RunStatistics::add(std::size_t index, const Sweep& sweep,
                                               const SweepResult& result, const HostTimes& times) {
  const StampedPose pose{.stamp = result.stamp, .pose = result.T_map_lidar};
  if (first_) {
    distance_ += (pose.pose.translation() - last_.pose.translation()).norm();
    ++statuses_[static_cast<std::size_t>(result.registration.status)];
    if (index > last_index_) {
      longest_missing_ = std::max(longest_missing_, index - last_index_ - 1);
    }
  } else {
    first_ = pose;
    first_index_ = index;
  }
  last_index_ = std::max(last_index_, index);
  last_ = pose;
  coordinate_offset_ = sweep.offset;
  ++sweeps_;
  deskewed_ += result.deskewed ? 1 : 0;
  inertial_.add(index, result.inertial);
  velocity_.add(result);
  shares_.add(result.inertial);
  assessor_.add(result);
  keyframes_ += result.keyframe ? 1 : 0;
  lost_points_ += static_cast<std::size_t>(result.lost_points);
  crowded_voxels_ += static_cast<std::size_t>(result.crowded_voxels);
  ++states_[static_cast<std::size_t>(result.state)];

  const std::array by_stage{times.read, times.read_wait, times.host, times.wait,
                            times.map,  times.write,     times.total};
  static_assert(by_stage.size() == std::tuple_size_v<decltype(host_)>);
  for (std::size_t i = 0; i < by_stage.size(); ++i) {
    host_[i].ms.push_back(static_cast<float>(by_stage[i]));
  }
  if (result.inertial.nav) {
    inertial_times_.ms.push_back(static_cast<float>(times.inertial));
  }
  add_device_times(result.stages);
  work_.push_back(result.device_work);

  const auto reason = failure_reason(result, config_);
  if (!reason) {
    return std::nullopt;
  }
  failures_.push_back({.index = index,
                       .source = sweep.source,
                       .state = result.state,
                       .status = result.registration.status,
                       .reason = *reason});
  return failures_.back();
}

double RunStatistics::recorded_seconds() const {
  return first_ ? seconds(last_.stamp - first_->stamp) : 0.0;
}

void RunStatistics::add_device_times(const std::vector<StageTime>& stages) {
  if (stages.empty()) {
    return;
  }
  const auto put = [this](std::string_view name, double ms) {
    auto stage = std::ranges::find(device_, name, &StageTimes::stage);
    if (stage == device_.end()) {
      // The sum stays last, whichever sweep brings a new stage.
      const auto end = device_.empty() ? device_.end() : device_.end() - 1;
      stage = device_.insert(end, {.stage = std::string(name), .ms = {}});
    }
    stage->ms.push_back(static_cast<float>(ms));
  };
  if (device_.empty()) {
    device_.push_back({.stage = "total", .ms = {}});
  }
  double sum = 0.0;
  for (const StageTime& stage : stages) {
    put(stage.stage, stage.device_ms);
    sum += stage.device_ms;
  }
  put("total", sum);
}

}  // namespace adit
