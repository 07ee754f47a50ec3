// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/reading_gate.hpp"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

// A quantile moves by this share of itself with a value, by more at first, and does not fall to
// where it would not find back from.
constexpr double kPace = 0.05;
constexpr double kLeast = 1e-9;

// A jump is what is beyond so many times what three in four changes stay below, and beyond what
// harms nobody: a rate, and a share of gravity.
constexpr double kBeyondUsual = 6.0;
constexpr double kHarmlessTurn = 0.3;   // rad/s
constexpr double kHarmlessForce = 0.3;  // share of the usual force

constexpr std::size_t kMostWaiting = 4;  // none came back: it is the motion that has changed
constexpr int kFirst = 20;               // readings until it is known what is usual
// A reading agrees with the one before if it is this much nearer than that was to its own.
constexpr double kAgrees = 0.5;
// A spike is as far from both neighbours as from what would be there without it, up to this.
constexpr double kAlone = 0.7;
// Spikes in a row on one side of one of the six numbers, while the others are as usual: a blow
// moves several.
constexpr std::size_t kLongestBurst = 3;
constexpr int kCalm = 2;  // readings before them that passed at once

}  // namespace

void UsualValue::add(double value) {
  value_ = count_ == 0 ? value : value_;
  const double pace = std::max(kPace, 1.0 / ++count_);
  value_ *= std::exp(pace * (value > value_ ? share_ : share_ - 1.0));
  value_ = std::max(value_, kLeast);
}

ReadingGate::Scales ReadingGate::jumps() const {
  return {.turn = std::max(kHarmlessTurn, kBeyondUsual * turn_change_.get()),
          .force = std::max(kHarmlessForce * force_.get(), kBeyondUsual * force_change_.get())};
}

double ReadingGate::distance(const ImuSample& a, const ImuSample& b) const {
  const Scales scales = jumps();
  return std::max((b.angular_velocity - a.angular_velocity).norm() / scales.turn,
                  (b.linear_acceleration - a.linear_acceleration).norm() / scales.force);
}

bool ReadingGate::sticks_out(const ImuSample& before, const ImuSample& one,
                             const ImuSample& after) const {
  const Scales scales = jumps();
  return (one.angular_velocity - before.angular_velocity)
                     .dot(one.angular_velocity - after.angular_velocity) /
                 (scales.turn * scales.turn) +
             (one.linear_acceleration - before.linear_acceleration)
                     .dot(one.linear_acceleration - after.linear_acceleration) /
                 (scales.force * scales.force) >
         0.0;
}

bool ReadingGate::has_changed() const {
  return waiting_.size() > kMostWaiting || passed_ < kFirst;
}

std::optional<int> ReadingGate::lone_jump(const ImuSample& usual, const ImuSample& one) const {
  const Scales scales = jumps();
  Eigen::Matrix<double, 6, 1> off;
  off << (one.angular_velocity - usual.angular_velocity) / scales.turn,
      (one.linear_acceleration - usual.linear_acceleration) / scales.force;
  Eigen::Index axis = 0;
  if ((off.array().abs() > 1.0).count() != 1) {
    return std::nullopt;
  }
  off.cwiseAbs().maxCoeff(&axis);
  return static_cast<int>(axis + 1) * (off(axis) > 0.0 ? 1 : -1);
}

bool ReadingGate::may_be_burst() const {
  const std::optional<int> jump = lone_jump(*last_, waiting_.back());
  const auto other = std::find_if(waiting_.rbegin(), waiting_.rend(), [&](const ImuSample& one) {
    return lone_jump(*last_, one) != jump;
  });
  return calm_ >= kCalm && jump &&
         static_cast<std::size_t>(other - waiting_.rbegin()) <= kLongestBurst;
}

bool ReadingGate::is_settled() const {
  const std::size_t count = waiting_.size();
  const ImuSample& newest = waiting_.back();
  if (!last_ || has_changed() || distance(*last_, newest) <= static_cast<double>(count)) {
    return true;
  }
  if (count == 1 || may_be_burst()) {
    return false;
  }
  const ImuSample& middle = waiting_[count - 2];
  const ImuSample& first = count == 2 ? *last_ : waiting_[count - 3];
  return distance(middle, newest) <= kAgrees * distance(first, middle) ||
         distance(middle, interpolate(first, newest, middle.stamp)) <= 1.0;
}

bool ReadingGate::is_spike(std::size_t waiting) const {
  if (!last_ || has_changed() || waiting + 1 == waiting_.size()) {
    return false;
  }
  const auto usual = [&](std::size_t i) {
    return interpolate(*last_, waiting_.back(), waiting_[i].stamp);
  };
  const auto jump = [&](std::size_t i) { return lone_jump(usual(i), waiting_[i]); };
  // In a row only between readings that are as usual: a mount that rings swings from side to side.
  const bool calm = calm_ >= kCalm && distance(*last_, waiting_.back()) <= 1.0;
  const std::optional<int> own = calm ? jump(waiting) : std::nullopt;
  std::size_t first = waiting;
  std::size_t last = waiting;
  while (own && first > 0 && jump(first - 1) == own) {
    --first;
  }
  while (own && last + 2 < waiting_.size() && jump(last + 1) == own) {
    ++last;
  }
  const ImuSample& one = waiting_[waiting];
  const ImuSample& before = first == 0 ? *last_ : waiting_[first - 1];
  const ImuSample& after = waiting_[last + 1];
  const auto off = [&](std::size_t i) { return distance(waiting_[i], usual(i)); };
  return last - first < kLongestBurst && off(waiting) > 1.0 && sticks_out(before, one, after) &&
         distance(before, waiting_[first]) >= kAlone * off(first) &&
         distance(waiting_[last], after) >= kAlone * off(last);
}

void ReadingGate::learn(const ImuSample& passed) {
  force_.add(passed.linear_acceleration.norm());
  if (last_ && passed.stamp > last_->stamp) {
    turn_change_.add((passed.angular_velocity - last_->angular_velocity).norm());
    force_change_.add((passed.linear_acceleration - last_->linear_acceleration).norm());
  }
  last_ = passed;
  ++passed_;
}

std::vector<GatedReading> ReadingGate::pass(const ImuSample& reading) {
  const Eigen::Vector3d& turn = reading.angular_velocity;
  const Eigen::Vector3d& force = reading.linear_acceleration;
  if (!turn.allFinite() || !force.allFinite()) {
    return {{reading, ImuArrival::not_finite}};
  }
  if (turn.cwiseAbs().maxCoeff() > limits_.rate ||
      force.cwiseAbs().maxCoeff() > limits_.acceleration) {
    return {{reading, ImuArrival::impossible}};
  }
  if (std::ranges::find(waiting_, reading.stamp, &ImuSample::stamp) != waiting_.end()) {
    return {{reading, ImuArrival::duplicate}};
  }
  waiting_.push_back(reading);
  std::vector<GatedReading> known;
  if (!is_settled()) {
    return known;
  }
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    known.push_back({waiting_[i], is_spike(i) ? std::optional(ImuArrival::spike) : std::nullopt});
  }
  // A spike by itself leaves what is around it as calm as it was.
  const bool came_back = std::all_of(known.begin(), known.end() - 1, [](const GatedReading& one) {
    return one.dropped.has_value();
  });
  calm_ = came_back ? calm_ + 1 : 0;
  waiting_.clear();
  for (const GatedReading& one : known) {
    if (!one.dropped) {
      learn(one.sample);
    }
  }
  return known;
}

}  // namespace adit
