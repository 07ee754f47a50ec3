// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/cloud_selection.hpp"

#include "adit/slam/submaps/moved_space.hpp"

namespace adit {

bool is_within(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& point) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    if ((a.y() > point.y()) != (b.y() > point.y())) {
      const double t = (point.y() - a.y()) / (b.y() - a.y());
      inside = inside != (point.x() < a.x() + t * (b.x() - a.x()));
    }
  }
  return inside;
}

LasClass class_of(const CloudPoint& point) {
  return point.moving ? LasClass::moving : point.classification;
}

bool is_noise(LasClass one) {
  return one == LasClass::low_noise || one == LasClass::high_noise || one == LasClass::mixed ||
         one == LasClass::carrier;
}

void classify(const CloudSelection& selection, const Eigen::Vector3d& in_map, CloudPoint& point) {
  if (selection.class_at) {
    point.classification = selection.class_at(in_map, point.position);
    point.moving = point.moving && point.classification == LasClass::unclassified;
  }
}

bool is_dropped(const CloudSelection& selection, const CloudPoint& point) {
  return selection.drops_noise && (point.moving || is_noise(point.classification));
}

bool has_moved(const CloudSelection& selection, const Eigen::Vector3d& point) {
  return selection.moved && selection.moved->contains(point);
}

bool is_wanted(const CloudSelection& selection, SessionId session, Nanoseconds stamp) {
  return (selection.sessions.empty() || selection.sessions.contains(session)) &&
         (!selection.from || stamp >= *selection.from) &&
         (!selection.until || stamp <= *selection.until);
}

bool is_wanted(const CloudSelection& selection, const CloudPoint& point) {
  return is_wanted(selection, point.session, point.time) &&
         !(selection.without_moving && point.moving) &&
         (selection.polygon.empty() || is_within(selection.polygon, point.position.head<2>()));
}

}  // namespace adit
