// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/maps/occupancy_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

constexpr int64_t kGridBlock = 256;     // cells
constexpr double kLongestSight = 30.0;  // m: what is farther off is seen by a beam in many cells
constexpr char kOccupiedGray = '\0';
constexpr char kFreeGray = static_cast<char>(254);
constexpr char kUnknownGray = static_cast<char>(205);

int64_t grid_block_of(int64_t cell) {
  return cell / kGridBlock - static_cast<int64_t>(cell % kGridBlock < 0);
}

std::size_t place_in_block(int64_t x, int64_t y) {
  return static_cast<std::size_t>((y - kGridBlock * grid_block_of(y)) * kGridBlock + x -
                                  kGridBlock * grid_block_of(x));
}

}  // namespace

OccupancyGrid::Index OccupancyGrid::index_of(const Eigen::Vector3d& place) const {
  return {static_cast<int64_t>(std::floor(place.x() / config_.cell)),
          static_cast<int64_t>(std::floor(place.y() / config_.cell))};
}

void OccupancyGrid::mark(const Index& index, State state) {
  if (empty()) {
    low_ = index;
    high_ = index;
  }
  low_ = low_.cwiseMin(index);
  high_ = high_.cwiseMax(index);
  std::vector<State>& block =
      blocks_[{.y = grid_block_of(index.y()), .x = grid_block_of(index.x())}];
  if (block.empty()) {
    block.resize(static_cast<std::size_t>(kGridBlock * kGridBlock), State::unknown);
  }
  State& cell = block[place_in_block(index.x(), index.y())];
  cell = std::max(cell, state);
}

void OccupancyGrid::mark_free_between(const Eigen::Vector3d& sensor, const Eigen::Vector3d& end) {
  const Eigen::Vector3d way = end - sensor;
  const Index last = index_of(end);
  const auto steps = static_cast<int64_t>(std::ceil(way.head<2>().norm() / (0.5 * config_.cell)));
  for (int64_t i = 0; i < steps; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(steps);
    const Index index = index_of(sensor + share * way);
    if (index != last) {
      mark(index, State::free);
    }
  }
}

void OccupancyGrid::add(const MapKeyframe& keyframe, const KeyframeSubmap& submap,
                        const ProductCoordinates& coordinates) {
  std::vector<Eigen::Vector3d> sensors;
  for (const SubmapSweep& sweep : submap.sweeps) {
    sensors.push_back(coordinates.from_map(
        Eigen::Vector3d(keyframe.T_map_keyframe * sweep.T_keyframe_lidar.translation())));
  }
  std::set<std::array<int64_t, 3>> seen;  // of each sweep a cell's sight is enough once
  for (const SubmapPoint& measured : submap.points) {
    if (measured.seen_through || measured.sweep >= sensors.size()) {
      continue;
    }
    const Eigen::Vector3d p =
        coordinates.from_map(Eigen::Vector3d(keyframe.T_map_keyframe * measured.position()));
    const Eigen::Vector3d& sensor = sensors[measured.sweep];
    const double height = p.z() - sensor.z();
    const Index index = index_of(p);
    if (height < config_.low) {
      mark(index, State::free);
    } else if (height <= config_.high) {
      mark(index, State::occupied);
      if ((p - sensor).head<2>().norm() <= kLongestSight &&
          seen.insert({measured.sweep, index.x(), index.y()}).second) {
        mark_free_between(sensor, p);
      }
    }
  }
}

void OccupancyGrid::write_pgm(const std::filesystem::path& file) const {
  OutputFile output(file);
  output.write(fmt::format("P5\n{} {}\n255\n", columns(), rows()));
  std::string line;
  for (int64_t y = high_.y(); !empty() && y >= low_.y(); --y) {
    line.clear();
    for (int64_t x = low_.x(); x <= high_.x(); ++x) {
      const auto block = blocks_.find({.y = grid_block_of(y), .x = grid_block_of(x)});
      const State state =
          block == blocks_.end() ? State::unknown : block->second[place_in_block(x, y)];
      line += state == State::occupied ? kOccupiedGray
              : state == State::free   ? kFreeGray
                                       : kUnknownGray;
    }
    output.write(line);
  }
  output.close();
}

std::string OccupancyGrid::yaml(const std::string& picture) const {
  return fmt::format(
      "image: {}\nmode: trinary\nresolution: {}\norigin: [{}, {}, 0.0]\nnegate: 0\n"
      "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
      picture, shortest(config_.cell),
      with_decimals(config_.cell * static_cast<double>(low_.x()), 6),
      with_decimals(config_.cell * static_cast<double>(low_.y()), 6));
}

}  // namespace adit
