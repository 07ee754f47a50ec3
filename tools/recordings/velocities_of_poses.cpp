// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/velocities_of_poses.hpp"

#include <chrono>
#include <utility>
#include <variant>

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

class PoseVelocityStream final : public EventStream {
 public:
  PoseVelocityStream(std::unique_ptr<EventStream> events, std::size_t topic)
      : events_(std::move(events)), topic_(topic) {}

  std::optional<Event> next() override {
    while (true) {
      std::optional<Event> event = events_->next();
      auto* pose = event ? std::get_if<ReferencePose>(&event->value) : nullptr;
      if (pose == nullptr || event->topic != topic_) {
        return event;
      }
      const std::optional<ReferencePose> before = std::exchange(last_, *pose);
      const auto velocity = before ? velocity_between(*before, *pose) : std::nullopt;
      if (velocity) {
        event->frame = velocity->frame;
        event->value = *velocity;
        return event;
      }
    }
  }

 private:
  std::unique_ptr<EventStream> events_;
  std::size_t topic_;
  std::optional<ReferencePose> last_{};
};

}  // namespace

std::optional<BodyVelocity> velocity_between(const ReferencePose& from, const ReferencePose& to) {
  const Nanoseconds duration = to.stamp - from.stamp;
  if (duration <= Nanoseconds(0) || duration > std::chrono::seconds(1)) {
    return std::nullopt;
  }
  const Eigen::Isometry3d T_from_to = from.T_parent_child.inverse() * to.T_parent_child;
  const Eigen::Matrix3d R_from_middle = so3_exp(0.5 * so3_log(T_from_to.linear()));
  return BodyVelocity{
      .stamp = from.stamp + duration / 2,
      .linear = R_from_middle.transpose() * T_from_to.translation() / seconds(duration),
      .frame = to.child};
}

std::unique_ptr<EventStream> with_velocities_of_poses(std::unique_ptr<EventStream> events,
                                                      std::size_t topic) {
  return std::make_unique<PoseVelocityStream>(std::move(events), topic);
}

}  // namespace adit
