// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/frame_tree.hpp"

#include <algorithm>
#include <deque>
#include <set>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

// Calibrations are published with few digits; what differs by less changes no map.
constexpr double kAlikeDistance = 0.01;        // m
constexpr double kAlikeAngle = 0.5 * kDegree;  // rad
constexpr std::size_t kMostEntries = 2000;     // a robot has hundreds
constexpr double kOrthogonal = 0.01;           // beyond it a matrix scales or shears

/// tf's first version wrote names with a slash in front.
std::string plain(const std::string& frame) {
  return frame.substr(std::min(frame.find_first_not_of('/'), frame.size()));
}

bool is_rigid(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  return T.matrix().allFinite() && R.determinant() > 0.0 &&
         (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kOrthogonal;
}

bool are_alike(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Isometry3d apart = a.inverse() * b;
  return apart.translation().norm() < kAlikeDistance &&
         rotation_angle(apart.linear()) < kAlikeAngle;
}

}  // namespace

void FrameTree::ignore(const StaticTransform& transform, TransformFault fault) {
  const IgnoredTransform one{transform.parent, transform.child, fault};
  if (ignored_.size() < kMostEntries && std::ranges::find(ignored_, one) == ignored_.end()) {
    ignored_.push_back(one);
  }
}

void FrameTree::add(const StaticTransform& transform) {
  StaticTransform named = transform;
  named.parent = plain(transform.parent);
  named.child = plain(transform.child);
  if (named.parent.empty() || named.child.empty()) {
    return ignore(named, TransformFault::unnamed);
  }
  if (named.parent == named.child) {
    return ignore(named, TransformFault::itself);
  }
  if (!is_rigid(named.T_parent_child)) {
    return ignore(named, TransformFault::not_finite);
  }
  const auto known = of_frames_.find({named.parent, named.child});
  if (known != of_frames_.end()) {
    Entry& earlier = entries_[known->second];
    if (are_alike(earlier.transform.T_parent_child, named.T_parent_child)) {
      earlier.transform.T_parent_child = named.T_parent_child;
      if (!earlier.loop) {
        make_latest_parent(known->second);
      }
      return;
    }
  }
  if (entries_.size() >= kMostEntries) {
    return;
  }
  const bool loop = is_ancestor(named.child, named.parent);
  if (loop) {
    if (are_alike(*this->transform(named.parent, named.child), named.T_parent_child)) {
      return;  // the same said the other way round
    }
    ignore(named, TransformFault::loop);
  }
  if (known != of_frames_.end()) {
    entries_[known->second].replaced = true;
    std::erase(parents_[named.child], known->second);
  }
  of_frames_[{named.parent, named.child}] = entries_.size();
  entries_.push_back({.transform = std::move(named), .loop = loop});
  if (!loop) {
    make_latest_parent(entries_.size() - 1);
  }
}

void FrameTree::make_latest_parent(std::size_t entry) {
  std::vector<std::size_t>& parents = parents_[entries_[entry].transform.child];
  std::erase(parents, entry);
  parents.push_back(entry);
}

bool FrameTree::is_ancestor(const std::string& frame, const std::string& of) const {
  std::set<std::string> seen{of};
  std::deque<std::string> next{of};
  for (; !next.empty(); next.pop_front()) {
    if (next.front() == frame) {
      return true;
    }
    const auto parents = parents_.find(next.front());
    for (std::size_t i = 0; parents != parents_.end() && i < parents->second.size(); ++i) {
      const std::string& parent = entries_[parents->second[i]].transform.parent;
      if (seen.insert(parent).second) {
        next.push_back(parent);
      }
    }
  }
  return false;
}

bool FrameTree::knows(const std::string& frame) const {
  const std::string name = plain(frame);
  return std::ranges::any_of(entries_, [&](const Entry& entry) {
    return entry.transform.parent == name || entry.transform.child == name;
  });
}

FrameTree::Chain FrameTree::chain_to_root(const std::string& frame) const {
  Chain chain;
  for (auto up = parents_.find(frame); up != parents_.end() && !up->second.empty();
       up = parents_.find(entries_[up->second.back()].transform.parent)) {
    chain.push_back(up->second.back());
  }
  return chain;
}

FrameTree::Mounting FrameTree::mounting(const std::string& frame) const {
  Mounting result{plain(frame), Eigen::Isometry3d::Identity()};
  for (const std::size_t entry : chain_to_root(result.root)) {
    result.T_root_frame = entries_[entry].transform.T_parent_child * result.T_root_frame;
    result.root = entries_[entry].transform.parent;
  }
  return result;
}

/// What tf2 walks: up by each frame's latest parent, and down again.
std::optional<FrameTree::Chain> FrameTree::chain_by_parents(const std::string& a,
                                                            const std::string& b) const {
  if (mounting(a).root != mounting(b).root) {
    return std::nullopt;
  }
  Chain up = chain_to_root(a);
  Chain down = chain_to_root(b);
  while (!up.empty() && !down.empty() && up.back() == down.back()) {
    up.pop_back();
    down.pop_back();
  }
  up.insert(up.end(), down.rbegin(), down.rend());
  return up;
}

/// Without one entry those that were replaced count, too: they are what it may contradict.
std::optional<FrameTree::Chain> FrameTree::shortest_chain(
    const std::string& a, const std::string& b, std::optional<std::size_t> without) const {
  // By frame: those at the other ends; entries in a loop last, later ones first.
  std::map<std::string, std::vector<std::pair<std::size_t, const std::string*>>> neighbours;
  for (const bool loop : {false, true}) {
    for (std::size_t i = entries_.size(); i-- > 0;) {
      const Entry& entry = entries_[i];
      if (entry.loop == loop && i != without && (without || !entry.replaced)) {
        neighbours[entry.transform.parent].emplace_back(i, &entry.transform.child);
        neighbours[entry.transform.child].emplace_back(i, &entry.transform.parent);
      }
    }
  }
  std::map<std::string, std::pair<std::size_t, std::string>> reached;  // by which entry, from where
  std::deque<std::string> next{a};
  for (; !next.empty() && next.front() != b; next.pop_front()) {
    for (const auto& [entry, other] : neighbours[next.front()]) {
      if (*other != a && !reached.contains(*other)) {
        reached[*other] = {entry, next.front()};
        next.push_back(*other);
      }
    }
  }
  if (next.empty()) {
    return std::nullopt;
  }
  Chain chain;
  for (std::string at = b; at != a; at = reached.at(at).second) {
    chain.push_back(reached.at(at).first);
  }
  std::ranges::reverse(chain);
  return chain;
}

Eigen::Isometry3d FrameTree::product(const std::string& a, const Chain& chain) const {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  std::string at = a;
  for (const std::size_t i : chain) {
    const StaticTransform& one = entries_[i].transform;
    const bool down = one.parent == at;
    T = T * (down ? one.T_parent_child : one.T_parent_child.inverse());
    at = down ? one.child : one.parent;
  }
  return T;
}

std::optional<Eigen::Isometry3d> FrameTree::transform(const std::string& a,
                                                      const std::string& b) const {
  const std::string from = plain(a);
  const std::string to = plain(b);
  const std::optional<Chain> usual = chain_by_parents(from, to);
  if (usual && usual->size() <= 1) {
    return mounting(from).T_root_frame.inverse() * mounting(to).T_root_frame;
  }
  const std::optional<Chain> shortest = shortest_chain(from, to, std::nullopt);
  if (usual && usual->size() <= shortest->size()) {
    return mounting(from).T_root_frame.inverse() * mounting(to).T_root_frame;
  }
  return shortest ? std::optional(product(from, *shortest)) : std::nullopt;
}

std::optional<MountingConflict> FrameTree::conflict(const std::string& a,
                                                    const std::string& b) const {
  const std::string from = plain(a);
  const std::string to = plain(b);
  const std::optional<Eigen::Isometry3d> T = transform(from, to);
  const std::optional<Chain> usual = chain_by_parents(from, to);
  const std::optional<Chain> shortest = shortest_chain(from, to, std::nullopt);
  const Chain used = usual && usual->size() <= shortest.value_or(Chain{}).size()
                         ? *usual
                         : shortest.value_or(Chain{});
  std::optional<MountingConflict> worst;
  for (const std::size_t entry : used) {
    const std::optional<Chain> other = shortest_chain(from, to, entry);
    if (!other) {
      continue;
    }
    const Eigen::Isometry3d other_T = product(from, *other);
    if (are_alike(*T, other_T)) {
      continue;
    }
    const Eigen::Isometry3d apart = T->inverse() * other_T;
    const auto unused = std::ranges::find_if(
        *other, [&](std::size_t i) { return std::ranges::find(used, i) == used.end(); });
    const StaticTransform& named = entries_[*unused].transform;
    const MountingConflict found{.parent = named.parent,
                                 .child = named.child,
                                 .distance = apart.translation().norm(),
                                 .angle = rotation_angle(apart.linear())};
    if (!worst ||
        std::pair(found.angle, found.distance) > std::pair(worst->angle, worst->distance)) {
      worst = found;
    }
  }
  return worst;
}

}  // namespace adit
