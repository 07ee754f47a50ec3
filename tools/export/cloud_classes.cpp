// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/cloud_classes.hpp"

#include <optional>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/export/export_contours.hpp"
#include "adit/tools/support/progress.hpp"

namespace adit {
namespace {

NoiseSpace find_noise(const ExportJob& job) {
  std::optional<Progress> progress;
  NoiseSpace noise = find_noise_space(
      *job.map, job.memory->submap_bytes(), [&](std::size_t done, std::size_t total) {
        if (!progress) {
          progress.emplace(*job.err, progress_style_of_stderr(), "noise", total,
                           Progress::Clock::now(), "tiles");
        }
        progress->update(done, 0);
        require_within(job);
      });
  if (progress) {
    progress->finish();
  }
  return noise;
}

}  // namespace

CloudClasses find_classes(const ExportJob& job, const ProductCoordinates& coordinates) {
  const ExportCommandOptions& options = *job.options;
  CloudClasses classes{.ground_is_class = options.classify, .drop = options.clean == "drop"};
  if (options.classify || !options.clean.empty()) {
    const GroundLevelsFound found = find_ground(job, coordinates);
    classes.ground = std::make_shared<const GroundPlanes>(found.levels, found.size);
  }
  if (!options.clean.empty()) {
    classes.noise = std::make_shared<const NoiseSpace>(find_noise(job));
  }
  return classes;
}

CloudSelection with_classes(CloudSelection selection, const CloudClasses& classes) {
  selection.drops_noise = classes.drop;
  selection.looks_at_sweeps = classes.looks_at_sweeps;
  if (classes.any()) {
    selection.class_at = [classes](const Eigen::Vector3d& in_map,
                                   const Eigen::Vector3d& in_product) {
      if (classes.noise && classes.noise->contains(in_map)) {
        return classes.ground && classes.ground->is_below(in_product) ? LasClass::low_noise
                                                                      : LasClass::high_noise;
      }
      return classes.ground && classes.ground->is_ground(in_product) ? LasClass::ground
                                                                     : LasClass::unclassified;
    };
  }
  return selection;
}

std::span<const CloudPoint> ClassFilter::pass(std::span<const CloudPoint> points) {
  if (!classes_->any()) {
    return points;
  }
  kept_.clear();
  for (CloudPoint point : points) {
    const LasClass one = class_of(point);
    ++counts_.at(static_cast<std::size_t>(one));
    if (one == LasClass::ground && !classes_->ground_is_class) {
      point.classification = LasClass::unclassified;
    }
    if (!classes_->drop || !(is_noise(one) || one == LasClass::moving)) {
      kept_.push_back(point);
    }
  }
  return kept_;
}

std::string ClassFilter::text() const {
  const auto count = [this](LasClass one) { return counts_.at(static_cast<std::size_t>(one)); };
  std::string text;
  if (classes_->ground_is_class) {
    text += fmt::format("; {} ground", count(LasClass::ground));
  }
  if (classes_->noise) {
    text += fmt::format("; {} noise", count(LasClass::low_noise) + count(LasClass::high_noise));
    if (classes_->looks_at_sweeps) {
      text +=
          fmt::format(", {} mixed, {} carrier", count(LasClass::mixed), count(LasClass::carrier));
    }
    text += fmt::format(" and {} moving {}", count(LasClass::moving),
                        classes_->drop ? "left out" : "marked");
  }
  return text;
}

}  // namespace adit
