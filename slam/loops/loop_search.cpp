// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/loop_search.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <Eigen/Cholesky>

namespace adit {
namespace {

/// What of a distance is beyond the dead zone, in its direction.
Eigen::Vector3d beyond(const Eigen::Vector3d& difference, double dead_zone) {
  const double norm = difference.norm();
  return norm <= dead_zone ? Eigen::Vector3d::Zero()
                           : Eigen::Vector3d(difference * (1.0 - dead_zone / norm));
}

// What is not known of a guess by appearance: m, rad. Plans tell the place to a few cells and the
// turn to a degree or two, and nothing of heights; both places know their vertical.
constexpr double kGuessedAside = 1.0;
constexpr double kGuessedHeight = 1.0;
constexpr double kGuessedTilt = 0.02;
constexpr double kGuessedYaw = 0.05;

Matrix6d guessed_covariance() {
  Vector6d sigma;
  sigma << kGuessedAside, kGuessedAside, kGuessedHeight, kGuessedTilt, kGuessedTilt, kGuessedYaw;
  return sigma.cwiseAbs2().asDiagonal();
}

std::size_t apart(std::size_t a, std::size_t b) {
  return a < b ? b - a : a - b;
}

bool nearer(const LoopPlace& a, const LoopPlace& b) {
  return std::tuple(a.distance, a.score, a.node) < std::tuple(b.distance, b.score, b.node);
}

}  // namespace

std::vector<LoopPlace> find_loop_places(const PoseGraph& graph, NodeId newest,
                                        std::span<const std::optional<RelativePlace>> known,
                                        std::span<const double> reaches,
                                        const LoopSearchSettings& settings) {
  const std::size_t self = graph.index_of(newest);
  const Eigen::Isometry3d& T_map_newest = graph.nodes()[self].T_map_node;
  std::vector<LoopPlace> places;
  bool in_stretch = false;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (settings.earlier_alone && i >= settings.earlier_nodes) {
      break;
    }
    const Eigen::Isometry3d T_newest_node = T_map_newest.inverse() * graph.nodes()[i].T_map_node;
    const double distance = T_newest_node.translation().norm();
    if (i == self || !known[i] || distance > settings.max_distance ||
        (i >= settings.earlier_nodes &&
         known[i]->path < settings.min_path + settings.detour * distance)) {
      in_stretch = false;
      continue;
    }
    const double dead_zone = std::max(
        settings.least_dead_zone, settings.dead_zone_share * std::min(reaches[i], reaches[self]));
    // Covariance of the position in the newest one's axes.
    const Eigen::Matrix3d& R = T_newest_node.linear();
    const Eigen::Matrix3d spread =
        R * known[i]->covariance.topLeftCorner<3, 3>() * R.transpose() +
        settings.sigma_floor * settings.sigma_floor * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d away = beyond(T_newest_node.translation(), dead_zone);
    const double mahalanobis = away.dot(spread.ldlt().solve(away));
    if (mahalanobis > settings.gate) {
      in_stretch = false;
      continue;
    }
    const LoopPlace place{.node = graph.nodes()[i].id,
                          .T_node_newest = T_newest_node.inverse(),
                          .covariance = inverted(T_newest_node, known[i]->covariance),
                          .distance = distance,
                          .score = mahalanobis,
                          .path = known[i]->path};
    if (!in_stretch) {
      places.push_back(place);
    } else if (nearer(place, places.back())) {
      places.back() = place;
    }
    in_stretch = true;
  }
  std::ranges::sort(places, nearer);
  places.resize(std::min(places.size(), settings.most));
  return places;
}

std::vector<LoopPlace> find_similar_places(const PoseGraph& graph, const PlaceIndex& index,
                                           std::span<const std::optional<RelativePlace>> known,
                                           const AppearanceSearchSettings& settings) {
  /// Less than `least` metres along edges from the newest one, in its own session.
  const auto is_on_the_way = [&](std::size_t place, double least) {
    return place >= settings.earlier_nodes && known[place] && known[place]->path < least;
  };
  std::vector<SimilarPlace> similar = index.similar();
  std::erase_if(similar, [&](const SimilarPlace& one) {
    return one.similarity < settings.least_similarity ||
           (settings.earlier_alone && one.place >= settings.earlier_nodes) ||
           is_on_the_way(one.place, settings.min_path);
  });
  std::ranges::sort(similar, [](const SimilarPlace& a, const SimilarPlace& b) {
    return std::tuple(b.similarity, a.place) < std::tuple(a.similarity, b.place);
  });
  std::vector<SimilarPlace> best;
  for (const SimilarPlace& one : similar) {
    if (best.size() < settings.most_correlated &&
        std::ranges::none_of(best, [&](const SimilarPlace& other) {
          return apart(other.place, one.place) < settings.apart;
        })) {
      best.push_back(one);
    }
  }
  std::vector<PlaceGuess> guesses = index.guesses(best);
  std::erase_if(guesses,
                [&](const PlaceGuess& guess) { return guess.likeness < settings.least_likeness; });
  std::ranges::sort(guesses, [](const PlaceGuess& a, const PlaceGuess& b) {
    return std::tuple(b.likeness, a.place) < std::tuple(a.likeness, b.place);
  });
  std::erase_if(guesses, [&](const PlaceGuess& guess) {
    return is_on_the_way(
        guess.place,
        settings.min_path + settings.detour * guess.T_place_newest.translation().norm());
  });
  guesses.resize(std::min(guesses.size(), settings.most));
  std::vector<LoopPlace> places;
  for (const PlaceGuess& guess : guesses) {
    places.push_back({.node = graph.nodes()[guess.place].id,
                      .source = LoopSource::appearance,
                      .T_node_newest = guess.T_place_newest,
                      .covariance = guessed_covariance(),
                      .distance = guess.T_place_newest.translation().norm(),
                      .score = guess.likeness,
                      .path = known[guess.place] ? known[guess.place]->path : 0.0});
  }
  return places;
}

}  // namespace adit
