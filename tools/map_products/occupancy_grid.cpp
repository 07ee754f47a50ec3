// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/occupancy_grid.hpp"

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

constexpr double kLongestSight = 30.0;  // m: what is farther off is seen by a beam in many cells
constexpr int8_t kOccupied = 100;       // as nav_msgs/OccupancyGrid has it
constexpr int8_t kFree = 0;
constexpr int8_t kUnknown = -1;
constexpr char kOccupiedGray = '\0';
constexpr char kFreeGray = static_cast<char>(254);
constexpr char kUnknownGray = static_cast<char>(205);

}  // namespace

void OccupancyGrid::mark(const Grid::Index& index, State state) {
  State& cell = grid_.touch(index);
  cell = std::max(cell, state);
}

void OccupancyGrid::mark_free_between(const Eigen::Vector3d& sensor, const Eigen::Vector3d& end) {
  const Eigen::Vector3d way = end - sensor;
  const Grid::Index last = grid_.index_of(end.head<2>());
  const auto steps = static_cast<int64_t>(std::ceil(way.head<2>().norm() / (0.5 * config_.cell)));
  for (int64_t i = 0; i < steps; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(steps);
    const Grid::Index index = grid_.index_of((sensor + share * way).head<2>());
    if (index != last) {
      mark(index, State::free);
    }
  }
}

void OccupancyGrid::add(const MapKeyframe& keyframe, const KeyframeSubmap& submap,
                        const ProductCoordinates& coordinates, const CloudSelection& selection) {
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
    const Eigen::Vector3d position = keyframe.T_map_keyframe * measured.position();
    if (has_moved(selection, position)) {
      continue;
    }
    const Eigen::Vector3d p = coordinates.from_map(position);
    const Eigen::Vector3d& sensor = sensors[measured.sweep];
    const double height = p.z() - sensor.z();
    const Grid::Index index = grid_.index_of(p.head<2>());
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

OccupancyCells OccupancyGrid::cells_around(const Eigen::Vector2d& place, double reach) const {
  OccupancyCells cells;
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(reach);
  const Grid::Index low = grid_.index_of(place - half).cwiseMax(grid_.low());
  const Grid::Index high = grid_.index_of(place + half).cwiseMin(grid_.high());
  if (empty() || (low.array() > high.array()).any()) {
    return cells;
  }
  cells.origin = config_.cell * low.cast<double>();
  cells.columns = static_cast<std::size_t>(high.x() - low.x() + 1);
  cells.rows = static_cast<std::size_t>(high.y() - low.y() + 1);
  cells.values.reserve(cells.columns * cells.rows);
  for (int64_t y = low.y(); y <= high.y(); ++y) {
    for (int64_t x = low.x(); x <= high.x(); ++x) {
      const State state = grid_.at({x, y});
      cells.values.push_back(state == State::occupied ? kOccupied
                             : state == State::free   ? kFree
                                                      : kUnknown);
    }
  }
  return cells;
}

void OccupancyGrid::write_pgm(const std::filesystem::path& file) const {
  OutputFile output(file);
  output.write(fmt::format("P5\n{} {}\n255\n", columns(), rows()));
  std::string line;
  for (int64_t y = grid_.high().y(); !empty() && y >= grid_.low().y(); --y) {
    line.clear();
    for (int64_t x = grid_.low().x(); x <= grid_.high().x(); ++x) {
      const State state = grid_.at({x, y});
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
      with_decimals(config_.cell * static_cast<double>(grid_.low().x()), 6),
      with_decimals(config_.cell * static_cast<double>(grid_.low().y()), 6));
}

}  // namespace adit
