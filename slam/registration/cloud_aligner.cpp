// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/cloud_aligner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>

#include "adit/slam/registration/beam_spacing.hpp"

namespace adit {
namespace {

constexpr double kNearest = 0.2;     // m: returns from the sensor's own mounting
constexpr double kFarthest = 200.0;  // m, as far as voxels reach
constexpr double kSizeStep = 0.05;   // m: down-samplings are multiples of it
constexpr std::size_t kFewestPoints = 100;
constexpr int kFewestMatches = 100;
constexpr std::size_t kPairsAtOnce = 64;
// Whatever the method: it alone knows what its matches hold. On one level, since coarser ones would
// lead competing poses back to the same one.
constexpr RegistrationMethod kJudge = RegistrationMethod::vgicp;
constexpr std::size_t kFineLevels = 2;
constexpr std::size_t kFineStarts = 3;  // of the searched poses, that coarse levels leave
// Far starts take many iterations on the coarse levels; the finest ones are near by then.
constexpr int kMostIterations = 60;

// As of consecutive submaps: what every alignment has in common is 1 cm and 1 mrad.
constexpr CovarianceModel kModel{.sigma_translation = 0.01, .sigma_rotation = 0.001};

bool gaussians(RegistrationMethod method) {
  return content_for(method) == engine::VoxelContent::moments;
}

/// In units of the down-sampling, coarse to fine. Gaussians take six points each.
std::vector<double> levels_of(RegistrationMethod method, double r_input) {
  const std::vector<double> cells = gaussians(method) ? std::vector<double>{24.0, 12.0, 6.0}
                                                      : std::vector<double>{16.0, 8.0, 4.0, 2.0};
  std::vector<double> sizes;
  for (const double count : cells) {
    sizes.push_back(count * r_input);
  }
  return sizes;
}

double judged_size(double r_input) {
  return levels_of(kJudge, r_input).back();
}

AlignmentSettings judge_settings(const CloudAlignerSettings& settings, double r_input) {
  return {.method = kJudge,
          .neighbours = 7,
          .robust = RobustKernel::huber,
          .d_max = judged_size(r_input),
          .max_iterations = kMostIterations,
          .translation_epsilon = 1e-3,
          .rotation_epsilon = 1e-4,
          .min_inliers = kFewestMatches,
          .min_overlap = settings.min_overlap};
}

AlignmentSettings settings_of(const CloudAlignerSettings& settings, double r_input) {
  AlignmentSettings alignment = judge_settings(settings, r_input);
  if (settings.method != kJudge) {
    alignment.method = settings.method;
    alignment.d_max = levels_of(settings.method, r_input).back();
    alignment.robust = gaussians(settings.method) ? RobustKernel::none : RobustKernel::huber;
    alignment.resolve_weak = false;
    alignment.min_inliers = 6;
    alignment.min_overlap = 0.0;
  }
  return alignment;
}

/// From far starts to where the fine levels find on: whatever comes of it is judged there.
AlignmentSettings coarse_settings(const CloudAlignerSettings& settings, double r_input) {
  const std::vector<double> levels = levels_of(settings.method, r_input);
  AlignmentSettings alignment = settings_of(settings, r_input);
  alignment.d_max = levels[levels.size() - kFineLevels - 1];
  alignment.translation_epsilon = 1e-2;
  alignment.rotation_epsilon = 1e-3;
  alignment.resolve_weak = false;
  alignment.min_overlap = 0.0;
  return alignment;
}

bool is_return(const Point& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) &&
         (p.x != 0.0F || p.y != 0.0F || p.z != 0.0F);
}

/// The frame's origin where it is among the points, else the middle of their bounding box.
Eigen::Vector3d viewpoint_of(std::span<const Point> points) {
  Eigen::AlignedBox3d box;
  for (const Point& p : points) {
    if (is_return(p)) {
      box.extend(Eigen::Vector3f(p.x, p.y, p.z).cast<double>());
    }
  }
  if (box.isEmpty()) {
    return Eigen::Vector3d::Zero();
  }
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(10.0);
  const Eigen::AlignedBox3d about(box.min() - margin, box.max() + margin);
  return about.contains(Eigen::Vector3d::Zero()) ? Eigen::Vector3d::Zero().eval()
                                                 : box.center().eval();
}

double size_for(std::span<const Point> points, const Eigen::Vector3d& viewpoint) {
  std::vector<Point> seen(points.begin(), points.end());
  for (Point& p : seen) {
    p.x -= static_cast<float>(viewpoint.x());
    p.y -= static_cast<float>(viewpoint.y());
    p.z -= static_cast<float>(viewpoint.z());
  }
  const double measured = measured_voxel_size(seen).value_or(kUsualInput);
  return std::max(kSizeStep, kSizeStep * std::round(measured / kSizeStep));
}

// Where starts ended: nearer ones found the same pose.
constexpr double kSamePlace = 0.5;   // m
constexpr double kSameTurn = 0.087;  // rad
// A pose that fits nearly as well as the best one makes it ambiguous.
constexpr CompetingPoseSettings kCompeting{};

bool same_pose(const Eigen::Isometry3d& p, const Eigen::Isometry3d& q) {
  const Eigen::Isometry3d off = p.inverse() * q;
  return off.translation().norm() < kSamePlace && rotation_angle(off.linear()) < kSameTurn;
}

/// Usable ones first.
bool is_better(const RegistrationResult& a, const RegistrationResult& b) {
  return is_usable(a.status) != is_usable(b.status) ? is_usable(a.status) : fits_better(a, b);
}

/// The other start's result that contradicts the best one, if any.
std::optional<CompetingPose> contradiction(std::span<const RegistrationResult> results,
                                           const RegistrationResult& best) {
  std::optional<CompetingPose> other;
  for (const RegistrationResult& result : results) {
    if (is_usable(result.status) && !same_pose(result.T_target_source, best.T_target_source) &&
        result.overlap >= kCompeting.least_overlap * best.overlap &&
        result.residual_rms <= kCompeting.most_rms * best.residual_rms &&
        (!other || is_better(result, other->result))) {
      const Eigen::Isometry3d off = best.T_target_source.inverse() * result.T_target_source;
      other = CompetingPose{.result = result, .apart = off.translation().norm()};
    }
  }
  return other;
}

/// Two clouds at a pose, aligned on these levels.
AlignmentPair pair_on(AlignmentTarget AlignableCloud::*levels, const CloudPair& pair,
                      const Eigen::Isometry3d& T_a_b) {
  const AlignmentTarget& target = pair.a->*levels;
  const bool gaussians = target.method == RegistrationMethod::ndt_to_ndt;
  return {.source = &pair.b->cloud,
          .source_map = gaussians ? &(pair.b->*levels) : nullptr,
          .target = &target,
          .T_target_source = T_a_b};
}

/// Results by pair: those of pair i are from first[i] to first[i + 1].
struct Grouped {
  std::vector<RegistrationResult> results;
  std::vector<std::size_t> first;

  std::span<const RegistrationResult> of(std::size_t pair) const {
    return std::span(results).subspan(first[pair], first[pair + 1] - first[pair]);
  }
};

/// Aligns each pair from its poses.
Grouped aligned(BatchAligner& aligner, AlignmentTarget AlignableCloud::*levels,
                std::span<const CloudPair> pairs,
                const std::vector<std::vector<Eigen::Isometry3d>>& poses,
                const Checkpoint& checkpoint) {
  Grouped grouped;
  std::vector<AlignmentPair> starts;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    grouped.first.push_back(starts.size());
    for (const Eigen::Isometry3d& pose : poses[i]) {
      starts.push_back(pair_on(levels, pairs[i], pose));
    }
  }
  grouped.first.push_back(starts.size());
  grouped.results = aligner.align(starts, checkpoint);
  return grouped;
}

bool has_converged(RegistrationStatus status) {
  return status != RegistrationStatus::not_converged && status != RegistrationStatus::diverged &&
         status != RegistrationStatus::too_few_points;
}

/// A result of another method with what the judge measured at its pose.
RegistrationResult judged(const RegistrationResult& result, RegistrationResult measured,
                          double min_overlap) {
  const auto none = [](const ObservedDirection& direction) {
    return direction.localizability == Localizability::none;
  };
  measured.iterations = result.iterations;
  if (!has_converged(result.status)) {
    measured.status = result.status;
  } else if (measured.inliers < kFewestMatches || measured.overlap < min_overlap) {
    measured.status = RegistrationStatus::too_little_overlap;
  } else if (std::ranges::any_of(measured.translation, none) ||
             std::ranges::any_of(measured.rotation, none)) {
    measured.status = RegistrationStatus::degenerate;
  } else {
    measured.status = RegistrationStatus::converged;
  }
  return measured;
}

/// What the judge measures at each pose that another method found.
Grouped judged_by(BatchAligner& judge, std::span<const CloudPair> pairs, Grouped found,
                  double min_overlap, const Checkpoint& checkpoint) {
  std::vector<AlignmentPair> at;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (const RegistrationResult& result : found.of(i)) {
      at.push_back(pair_on(&AlignableCloud::judge, pairs[i], result.T_target_source));
    }
  }
  const std::vector<RegistrationResult> measured = judge.evaluate(at, checkpoint);
  for (std::size_t k = 0; k < measured.size(); ++k) {
    found.results[k] = judged(found.results[k], measured[k], min_overlap);
  }
  return found;
}

/// The best of what coarse levels found, each place once.
std::vector<Eigen::Isometry3d> best_places(std::span<const RegistrationResult> results) {
  std::vector<RegistrationResult> sorted(results.begin(), results.end());
  std::erase_if(sorted, [](const RegistrationResult& result) {
    return !result.T_target_source.matrix().allFinite();
  });
  std::ranges::stable_sort(sorted, is_better);
  std::vector<Eigen::Isometry3d> places;
  for (const RegistrationResult& result : sorted) {
    const bool known = std::ranges::any_of(places, [&](const Eigen::Isometry3d& place) {
      return same_pose(place, result.T_target_source);
    });
    if (!known && places.size() < kFineStarts) {
      places.push_back(result.T_target_source);
    }
  }
  return places;
}

bool too_small(const CloudPair& pair) {
  return pair.a->cloud.size < kFewestPoints || pair.b->cloud.size < kFewestPoints;
}

AlignmentRefusal refusal_of(const RegistrationResult& result, double most_rms) {
  switch (result.status) {
    case RegistrationStatus::converged:
      return result.residual_rms > most_rms ? AlignmentRefusal::poor_fit : AlignmentRefusal::none;
    case RegistrationStatus::degenerate:
      return AlignmentRefusal::degenerate;
    case RegistrationStatus::too_little_overlap:
    case RegistrationStatus::too_few_points:
      return AlignmentRefusal::too_little_overlap;
    case RegistrationStatus::not_converged:
    case RegistrationStatus::diverged:
    case RegistrationStatus::doubtful:
      return AlignmentRefusal::not_converged;
  }
  return AlignmentRefusal::not_converged;
}

}  // namespace

std::string_view to_string(AlignmentRefusal refusal) {
  switch (refusal) {
    case AlignmentRefusal::none:
      return "none";
    case AlignmentRefusal::nothing_to_align:
      return "nothing_to_align";
    case AlignmentRefusal::nothing_found:
      return "nothing_found";
    case AlignmentRefusal::not_converged:
      return "not_converged";
    case AlignmentRefusal::too_little_overlap:
      return "too_little_overlap";
    case AlignmentRefusal::poor_fit:
      return "poor_fit";
    case AlignmentRefusal::degenerate:
      return "degenerate";
    case AlignmentRefusal::ambiguous:
      return "ambiguous";
  }
  return "unknown";
}

/// What works on clouds of one down-sampling.
struct CloudAligner::Size {
  AlignmentClouds clouds;
  BatchAligner coarse;
  BatchAligner fine;
  BatchAligner judge;
};
struct CloudAligner::Sizes {
  std::map<double, Size> by_r_input;
};

CloudAligner::CloudAligner(engine::Context& context, const CloudAlignerSettings& settings)
    : context_(&context), settings_(settings), sizes_(std::make_unique<Sizes>()) {}
CloudAligner::~CloudAligner() = default;
CloudAligner::CloudAligner(CloudAligner&&) noexcept = default;
CloudAligner& CloudAligner::operator=(CloudAligner&&) noexcept = default;

CloudAligner::Size& CloudAligner::of_size(double r_input) {
  auto found = sizes_->by_r_input.find(r_input);
  if (found == sizes_->by_r_input.end()) {
    Config config;
    config.preprocess.c_min = kNearest;
    config.preprocess.c_max = kFarthest;
    config.preprocess.r_input = r_input;
    found = sizes_->by_r_input
                .emplace(r_input, Size{.clouds = {*context_, with_lengths(config).preprocess},
                                       .coarse = {*context_, coarse_settings(settings_, r_input)},
                                       .fine = {*context_, settings_of(settings_, r_input)},
                                       .judge = {*context_, judge_settings(settings_, r_input)}})
                .first;
  }
  return found->second;
}

AlignableCloud CloudAligner::prepare(std::span<const Point> points,
                                     const std::optional<Eigen::Vector3d>& given,
                                     const Checkpoint& checkpoint) {
  pass(checkpoint);
  const Eigen::Vector3d viewpoint = given.value_or(viewpoint_of(points));
  const double r_input = settings_.r_input > 0.0 ? settings_.r_input : size_for(points, viewpoint);
  AlignmentClouds& maker = of_size(r_input).clouds;
  const std::vector<double> levels = levels_of(settings_.method, r_input);
  pass(checkpoint);
  SurfaceCloud cloud = maker.make_cloud(points, viewpoint);
  const auto target = [&](std::span<const double> sizes) {
    pass(checkpoint);
    return maker.make_target(cloud, settings_.method, sizes);
  };
  AlignmentTarget coarse = target(std::span(levels).first(levels.size() - kFineLevels));
  AlignmentTarget fine = target(std::span(levels).last(kFineLevels));
  pass(checkpoint);
  AlignmentTarget judge = maker.make_target(cloud, kJudge, std::array{judged_size(r_input)});
  return {.r_input = r_input,
          .points = points.size(),
          .cloud = std::move(cloud),
          .coarse = std::move(coarse),
          .fine = std::move(fine),
          .judge = std::move(judge),
          .above = overhead_view(points, 2.0 * r_input)};
}

std::vector<CloudAlignment> CloudAligner::align(std::span<const CloudPair> pairs,
                                                const Checkpoint& checkpoint) {
  std::map<double, std::vector<std::size_t>> of_sizes;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    of_sizes[pairs[i].a->r_input].push_back(i);
  }
  std::vector<CloudAlignment> alignments(pairs.size());
  for (const auto& [r_input, all] : of_sizes) {
    for (std::size_t first = 0; first < all.size(); first += kPairsAtOnce) {
      const auto which = std::span(all).subspan(first, std::min(kPairsAtOnce, all.size() - first));
      std::vector<CloudPair> some;
      for (const std::size_t i : which) {
        some.push_back(pairs[i]);
      }
      std::vector<CloudAlignment> found = align_some(of_size(r_input), some, checkpoint);
      for (std::size_t k = 0; k < which.size(); ++k) {
        alignments[which[k]] = std::move(found[k]);
      }
    }
  }
  return alignments;
}

std::vector<CloudAlignment> CloudAligner::align_some(Size& size, std::span<const CloudPair> pairs,
                                                     const Checkpoint& checkpoint) const {
  std::vector<CloudAlignment> alignments(pairs.size());
  std::vector<std::vector<Eigen::Isometry3d>> poses(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (too_small(pairs[i])) {
      continue;
    }
    poses[i] = pairs[i].guess ? std::vector{*pairs[i].guess}
                              : find_overhead_poses(pairs[i].a->above, pairs[i].b->above,
                                                    settings_.search, checkpoint);
    alignments[i].poses_tried = poses[i].size();
  }
  const Grouped coarse = aligned(size.coarse, &AlignableCloud::coarse, pairs, poses, checkpoint);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    poses[i] = best_places(coarse.of(i));
  }
  Grouped fine = aligned(size.fine, &AlignableCloud::fine, pairs, poses, checkpoint);
  if (settings_.method != kJudge) {
    fine = judged_by(size.judge, pairs, std::move(fine), settings_.min_overlap, checkpoint);
  }

  std::vector<AlignmentPair> open;
  std::vector<RegistrationResult> open_results;
  std::vector<std::size_t> open_pairs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::span<const RegistrationResult> own = fine.of(i);
    CloudAlignment& alignment = alignments[i];
    if (own.empty()) {
      alignment.refusal = too_small(pairs[i])    ? AlignmentRefusal::nothing_to_align
                          : coarse.of(i).empty() ? AlignmentRefusal::nothing_found
                                                 : AlignmentRefusal::not_converged;
      continue;
    }
    alignment.registration = *std::ranges::min_element(own, is_better);
    alignment.T_a_b = alignment.registration.T_target_source;
    alignment.refusal =
        refusal_of(alignment.registration, settings_.most_rms * judged_size(pairs[i].a->r_input));
    if (alignment.refusal != AlignmentRefusal::none) {
      continue;
    }
    alignment.covariance = covariance(alignment.registration, kModel);
    alignment.competing = contradiction(own, alignment.registration);
    if (alignment.competing) {
      alignment.refusal = AlignmentRefusal::ambiguous;
      continue;
    }
    open.push_back(pair_on(&AlignableCloud::judge, pairs[i], alignment.T_a_b));
    open_results.push_back(alignment.registration);
    open_pairs.push_back(i);
  }
  const auto competing =
      find_competing_poses(size.judge, open, open_results, kCompeting, checkpoint);
  for (std::size_t k = 0; k < open.size(); ++k) {
    CloudAlignment& alignment = alignments[open_pairs[k]];
    alignment.competing = competing[k];
    if (competing[k]) {
      alignment.refusal = AlignmentRefusal::ambiguous;
    }
  }
  return alignments;
}

}  // namespace adit
