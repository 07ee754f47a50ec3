// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/static_transforms.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/core.h>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tools/recordings/ros_messages.hpp"
#include "adit/tools/recordings/tolerant_recording.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kLookAhead = std::chrono::seconds(10);
constexpr Nanoseconds kConstantLook = std::chrono::seconds(20);
constexpr std::size_t kMostTransforms = 10'000;  // different ones; a robot has hundreds
constexpr std::size_t kMostDamage = 10;
// A joint that does not move is published with the same numbers each time, but for rounding.
constexpr double kStillDistance = 1e-4;  // m
constexpr double kStillAngle = 1e-4;     // rad
constexpr std::size_t kFewestStill = 5;  // messages
constexpr Nanoseconds kShortestStill = std::chrono::seconds(1);

using FramePair = std::pair<std::string, std::string>;

/// How many of the frames hang together with the first.
std::size_t connected(const FrameTree& tree, const std::vector<std::string>& frames) {
  std::size_t count = 0;
  for (const std::string& frame : frames) {
    count += tree.transform(frames.front(), frame) ? 1U : 0U;
  }
  return count;
}

/// Static transforms as they come, without repetitions.
struct StaticCollection {
  std::vector<StaticTransform> transforms{};
  FrameTree tree{};
  std::map<FramePair, StaticTransform> latest{};

  void add(const StaticTransform& transform) {
    const auto known = latest.find({transform.parent, transform.child});
    if ((known != latest.end() &&
         known->second.T_parent_child.matrix() == transform.T_parent_child.matrix()) ||
        transforms.size() >= kMostTransforms) {
      return;
    }
    latest.insert_or_assign({transform.parent, transform.child}, transform);
    transforms.push_back(transform);
    tree.add(transform);
  }
};

std::vector<std::size_t> topics_where(const Recording& recording, const auto& wanted) {
  std::vector<std::size_t> topics;
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    if (wanted(recording.topics()[i])) {
      topics.push_back(i);
    }
  }
  return topics;
}

/// Those of the ten seconds from the first on, and further ones until the frames are connected.
StaticCollection collect_static(const Recording& recording, const EventSelection& selection,
                                const std::vector<std::string>& frames) {
  StaticCollection found;
  const auto events = recording.events(selection);
  std::optional<Nanoseconds> begin;
  while (const std::optional<Event> event = events->next()) {
    begin = begin.value_or(event->received);
    if (event->received > *begin + kLookAhead && connected(found.tree, frames) == frames.size()) {
      break;
    }
    found.add(std::get<StaticTransform>(event->value));
  }
  return found;
}

StaticCollection static_part(const Recording& whole, const Recording& quiet,
                             const std::vector<std::string>& frames) {
  EventSelection selection;
  selection.topics =
      topics_where(whole, [](const Topic& topic) { return topic.kind == TopicKind::transforms; });
  if (selection.topics.empty()) {
    return {};
  }
  // Usually they come at the beginning: the rest of the recording is not read for them.
  if (const std::optional<Event> first = quiet.events({})->next()) {
    selection.end = first->received + 2 * kLookAhead;
    StaticCollection found = collect_static(whole, selection, frames);
    if (!found.transforms.empty() && connected(found.tree, frames) == frames.size()) {
      return found;
    }
  }
  selection.end = Nanoseconds::max();
  return collect_static(whole, selection, frames);
}

/// A transform of /tf while it is watched.
struct WatchedTransform {
  ReferencePose first{};
  Nanoseconds last{0};
  std::size_t messages = 0;
  bool moved = false;
};

std::vector<StaticTransform> constant_on_tf(const Recording& whole) {
  EventSelection selection;
  selection.topics = topics_where(whole, [](const Topic& topic) {
    return topic.kind == TopicKind::poses &&
           (topic.type == ros::TFMessage::kType || topic.type == "tf/tfMessage");
  });
  if (selection.topics.empty()) {
    return {};
  }
  std::map<FramePair, WatchedTransform> watched;
  std::optional<Nanoseconds> begin;
  const auto events = whole.events(selection);
  while (const std::optional<Event> event = events->next()) {
    begin = begin.value_or(event->received);
    if (event->received > *begin + kConstantLook) {
      break;
    }
    const auto& pose = std::get<ReferencePose>(event->value);
    const FramePair name{pose.parent, pose.child};
    if (watched.size() >= kMostTransforms && !watched.contains(name)) {
      continue;
    }
    WatchedTransform& one =
        watched.try_emplace(name, WatchedTransform{.first = pose}).first->second;
    const Eigen::Isometry3d apart = one.first.T_parent_child.inverse() * pose.T_parent_child;
    one.moved = one.moved || apart.translation().norm() > kStillDistance ||
                rotation_angle(apart.linear()) > kStillAngle;
    one.last = std::max(one.last, pose.stamp);
    ++one.messages;
  }
  std::vector<StaticTransform> constant;
  for (const auto& [name, one] : watched) {
    if (!one.moved && one.messages >= kFewestStill &&
        one.last - one.first.stamp >= kShortestStill) {
      constant.push_back({one.first.parent, one.first.child, one.first.T_parent_child});
    }
  }
  return constant;
}

FrameTree tree_with(const std::vector<StaticTransform>& transforms,
                    const std::vector<StaticTransform>& constant) {
  FrameTree tree;
  for (const std::vector<StaticTransform>* all : {&transforms, &constant}) {
    for (const StaticTransform& transform : *all) {
      tree.add(transform);
    }
  }
  return tree;
}

/// Those of `constant` without which fewer of the frames would be connected.
std::vector<StaticTransform> needed_of(std::vector<StaticTransform> constant,
                                       const std::vector<StaticTransform>& transforms,
                                       const std::vector<std::string>& frames) {
  const std::size_t most = connected(tree_with(transforms, constant), frames);
  if (most == connected(tree_with(transforms, {}), frames)) {
    return {};
  }
  for (std::size_t i = constant.size(); i-- > 0;) {
    std::vector<StaticTransform> others = constant;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    if (connected(tree_with(transforms, others), frames) == most) {
      constant = std::move(others);
    }
  }
  return constant;
}

}  // namespace

RecordedTransforms recorded_transforms(const Recording& recording,
                                       const std::vector<std::string>& frames) {
  std::vector<std::string> named;
  std::ranges::copy_if(frames, std::back_inserter(named),
                       [](const std::string& frame) { return !frame.empty(); });
  RecordedTransforms result;
  // Other damage is reported where the recording is mapped.
  const auto whole = pass_over_damage(recording, [&](const InputError& error) {
    const bool of_transforms = std::ranges::any_of(recording.topics(), [&](const Topic& topic) {
      return topic.kind == TopicKind::transforms &&
             error.place().find(" of " + topic.name + " (") != std::string::npos;
    });
    const bool known = std::ranges::find(result.damage, error.what()) != result.damage.end();
    if (of_transforms && !known && result.damage.size() < kMostDamage) {
      result.damage.emplace_back(error.what());
    }
  });
  const auto quiet = pass_over_damage(recording, [](const InputError&) {});
  StaticCollection found = static_part(*whole, *quiet, named);
  result.transforms = std::move(found.transforms);
  if (connected(found.tree, named) < named.size()) {
    result.constant = needed_of(constant_on_tf(*quiet), result.transforms, named);
    result.transforms.insert(result.transforms.end(), result.constant.begin(),
                             result.constant.end());
  }
  return result;
}

FrameTree frame_tree_of(const RecordedTransforms& transforms) {
  return tree_with(transforms.transforms, {});
}

bool is_scaled(const StaticTransform& transform) {
  constexpr double kRounding = 0.01;  // of the squared length
  const double length = transform.quaternion_length;
  return std::abs(length * length - 1.0) > kRounding;
}

std::string describe(const IgnoredTransform& ignored) {
  const std::string name =
      "the transform from '" + ignored.parent + "' to '" + ignored.child + "' ";
  switch (ignored.fault) {
    case TransformFault::itself:
      return name + "leads from a frame to itself";
    case TransformFault::unnamed:
      return name + "lacks the name of a frame";
    case TransformFault::not_finite:
      return name + "is no rigid motion";
    case TransformFault::loop:
      return name + "closes a loop of frames and contradicts it";
  }
  return name;
}

std::string names_of(const std::vector<StaticTransform>& transforms) {
  constexpr std::size_t kNamed = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(kNamed, transforms.size()); ++i) {
    text += (i == 0 ? "'" : ", '") + transforms[i].parent + "' to '" + transforms[i].child + "'";
  }
  return transforms.size() > kNamed ? text + fmt::format(" and {} more", transforms.size() - kNamed)
                                    : text;
}

std::string describe(const MountingConflict& conflict, const std::string& frames) {
  return fmt::format(
      "the mounting of {} is ambiguous: with the transform from '{}' to '{}' it is {:.3f} m and "
      "{:.1f} degrees away from the one in use",
      frames, conflict.parent, conflict.child, conflict.distance,
      conflict.angle * kDegreesPerRadian);
}

std::vector<std::string> notes_of(const RecordedTransforms& transforms) {
  std::vector<std::string> notes;
  const FrameTree tree = frame_tree_of(transforms);
  for (const IgnoredTransform& ignored : tree.ignored()) {
    notes.push_back(describe(ignored) + "; it is ignored");
  }
  std::vector<StaticTransform> scaled;
  std::ranges::copy_if(transforms.transforms, std::back_inserter(scaled), is_scaled);
  if (!scaled.empty()) {
    notes.push_back(
        fmt::format("static transforms have quaternions that are not of length 1: {}; "
                    "they are normalised",
                    names_of(scaled)));
  }
  if (!transforms.constant.empty()) {
    notes.push_back(
        "/tf_static does not connect the sensors; transforms that stay constant on /tf "
        "do: " +
        names_of(transforms.constant));
  }
  notes.insert(notes.end(), transforms.damage.begin(), transforms.damage.end());
  return notes;
}

}  // namespace adit
