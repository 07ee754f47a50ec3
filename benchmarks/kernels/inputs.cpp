// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/kernels/inputs.hpp"

#include <utility>

#include "adit/slam/core/config.hpp"
#include "adit/slam/registration/beam_spacing.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit::bench {
namespace {

constexpr int kManyPoints = 200'000;
constexpr double kFineInput = 0.05;  // m

// The first sweeps of a recording, at most `count`.
std::vector<std::vector<Point>> read_sweeps(const std::filesystem::path& path, size_t count) {
  const std::unique_ptr<Recording> recording = open_recording(path);
  const std::unique_ptr<EventStream> events =
      recording->events({.topics = {sweep_topic(*recording, path, {})}});
  std::vector<std::vector<Point>> sweeps;
  while (sweeps.size() < count) {
    std::optional<Event> event = events->next();
    if (!event) {
      break;
    }
    if (auto* sweep = std::get_if<Sweep>(&event->value)) {
      sweeps.push_back(std::move(sweep->points));
    }
  }
  return sweeps;
}

// A second sweep made from one alone: the same points from elsewhere.
std::vector<Point> moved(const std::vector<Point>& points, const Eigen::Isometry3d& pose) {
  std::vector<Point> result;
  for (const Point& p : points) {
    const Eigen::Vector3d q = pose * Eigen::Vector3d(p.x, p.y, p.z);
    result.push_back({static_cast<float>(q.x()), static_cast<float>(q.y()),
                      static_cast<float>(q.z()), p.intensity});
  }
  return result;
}

}  // namespace

Bench::Bench(engine::Context& context, const std::vector<std::filesystem::path>& files,
             double r_input)
    : context_(&context), description_("a simulated street") {
  if (files.empty()) {
    return;
  }
  std::vector<std::vector<Point>> sweeps;
  description_.clear();
  for (const std::filesystem::path& file : files) {
    for (std::vector<Point>& sweep : read_sweeps(file, files.size() == 1 ? 2 : 1)) {
      sweeps.push_back(std::move(sweep));
    }
    description_ += (description_.empty() ? "" : ", ") + file.filename().string();
  }
  if (sweeps.empty()) {
    throw InputError(files.front(), {}, "there is no sweep in it",
                     "Give a point cloud or a recording of a range sensor");
  }
  const PreprocessConfig defaults = with_lengths({}).preprocess;
  given_ = std::make_unique<test::AlignmentCase>(test::street_alignment(1));
  given_->name = description_;
  given_->preprocess = {.c_min = defaults.c_min,
                        .c_max = defaults.c_max,
                        .r_input = r_input,
                        .beam_spacing = measured_beam_spacing(sweeps.front()).value_or(0.0),
                        .surface_size = defaults.surface_size};
  truth_known_ = sweeps.size() == 1;
  if (truth_known_) {
    const Eigen::Isometry3d pose =
        retract(Eigen::Isometry3d::Identity(), test::offsets().back().second);
    given_->T_target_source = pose;
    sweeps.push_back(moved(sweeps.front(), pose.inverse()));
  } else {
    given_->T_target_source.setIdentity();
  }
  given_->target = std::move(sweeps[0]);
  given_->source = std::move(sweeps[1]);
}

std::vector<int> Bench::sizes(const std::vector<int>& wanted) const {
  return given_ ? std::vector{static_cast<int>(given_->source.size())} : wanted;
}

const test::AlignmentCase& Bench::alignment(int points) {
  if (given_) {
    return *given_;
  }
  const auto found = alignments_.find(points);
  if (found != alignments_.end()) {
    return found->second;
  }
  test::AlignmentCase made = test::street_alignment(points);
  made.preprocess.surface_size = with_lengths({}).preprocess.surface_size;
  if (points > kManyPoints) {
    made.preprocess.r_input = kFineInput;
  }
  return alignments_.emplace(points, std::move(made)).first->second;
}

const test::AlignmentScene& Bench::scene(int points) {
  std::unique_ptr<test::AlignmentScene>& scene = scenes_[points];
  if (!scene) {
    scene = std::make_unique<test::AlignmentScene>(*context_, alignment(points));
  }
  return *scene;
}

Eigen::Isometry3d Bench::start(int points) {
  const Eigen::Isometry3d& truth = alignment(points).T_target_source;
  return truth_known_ && !given_ ? retract(truth, test::offsets().back().second)
                                 : Eigen::Isometry3d::Identity();
}

}  // namespace adit::bench
