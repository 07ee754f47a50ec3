// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/reading_gate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <set>
#include <utility>

namespace adit {
namespace {

// A quantile moves by this share of itself with a value, and does not fall to where it would not
// find back from.
constexpr double kPace = 0.05;
constexpr double kLeast = 1e-9;
constexpr double kUsualChange = 0.75;  // share of the changes from one to the next
constexpr double kUsualForce = 0.5;

// A jump is what is beyond so many times what three in four changes stay below, and beyond what
// harms nobody: a rate, and a share of gravity.
constexpr double kBeyondUsual = 6.0;
constexpr double kHarmlessTurn = 0.3;   // rad/s
constexpr double kHarmlessForce = 0.3;  // share of the usual force

constexpr std::size_t kMostWaiting = 4;  // none came back: it is the motion that has changed
constexpr std::size_t kFirst = 20;       // readings that tell what is usual
// A reading agrees with the one before if it is this much nearer than that was to its own.
constexpr double kAgrees = 0.5;
// A spike is as far from both neighbours as from what would be there without it, up to this.
constexpr double kAlone = 0.7;
// Spikes in a row on one side of one of the six numbers, while the others are as usual: a blow
// moves several.
constexpr std::size_t kLongestBurst = 3;
constexpr int kCalm = 2;  // readings before them that passed at once

}  // namespace

UsualValue::UsualValue(double share, std::vector<double> first) : share_(share) {
  const auto below = static_cast<std::ptrdiff_t>(share * static_cast<double>(first.size()));
  std::ranges::nth_element(first, first.begin() + below);
  value_ = std::max(first[static_cast<std::size_t>(below)], kLeast);
}

void UsualValue::add(double value) {
  value_ *= std::exp(kPace * (value > value_ ? share_ : share_ - 1.0));
  value_ = std::max(value_, kLeast);
}

ReadingGate::Usual ReadingGate::usual_of(const std::vector<ImuSample>& first) {
  std::vector<double> turns;
  std::vector<double> forces;
  std::vector<double> force;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const ImuSample& before = first[i == 0 ? 1 : i - 1];
    turns.push_back((first[i].angular_velocity - before.angular_velocity).norm());
    forces.push_back((first[i].linear_acceleration - before.linear_acceleration).norm());
    force.push_back(first[i].linear_acceleration.norm());
  }
  return {.turn_change = UsualValue(kUsualChange, turns),
          .force_change = UsualValue(kUsualChange, forces),
          .force = UsualValue(kUsualForce, force),
          .last = first.front()};
}

ReadingGate::Scales ReadingGate::jumps() const {
  return {.turn = std::max(kHarmlessTurn, kBeyondUsual * usual_->turn_change.get()),
          .force = std::max(kHarmlessForce * usual_->force.get(),
                            kBeyondUsual * usual_->force_change.get())};
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
  return waiting_.size() > kMostWaiting && !is_past_spikes();
}

bool ReadingGate::is_past_spikes() const {
  const auto count = static_cast<double>(waiting_.size());
  if (calm_ < kCalm || distance(usual_->last, waiting_.back()) > count) {
    return false;
  }
  std::set<int> axes;
  for (std::size_t i = 0; i + 1 < waiting_.size(); ++i) {
    const std::optional<int> jump = lone_jump(usual_->last, waiting_[i]);
    if (!jump) {
      return false;
    }
    axes.insert(std::abs(*jump));
  }
  return axes.size() > 1;
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
  const std::optional<int> jump = lone_jump(usual_->last, waiting_.back());
  const auto other = std::find_if(waiting_.rbegin(), waiting_.rend(), [&](const ImuSample& one) {
    return lone_jump(usual_->last, one) != jump;
  });
  return calm_ >= kCalm && jump &&
         static_cast<std::size_t>(other - waiting_.rbegin()) <= kLongestBurst;
}

bool ReadingGate::is_settled() const {
  const std::size_t count = waiting_.size();
  const ImuSample& newest = waiting_.back();
  if (has_changed() || distance(usual_->last, newest) <= static_cast<double>(count)) {
    return true;
  }
  if (count == 1 || may_be_burst()) {
    return false;
  }
  const ImuSample& middle = waiting_[count - 2];
  const ImuSample& first = count == 2 ? usual_->last : waiting_[count - 3];
  return distance(middle, newest) <= kAgrees * distance(first, middle) ||
         distance(middle, interpolate(first, newest, middle.stamp)) <= 1.0;
}

bool ReadingGate::is_spike(std::size_t waiting) const {
  if (has_changed() || waiting + 1 == waiting_.size()) {
    return false;
  }
  const auto usual = [&](std::size_t i) {
    return interpolate(usual_->last, waiting_.back(), waiting_[i].stamp);
  };
  const auto jump = [&](std::size_t i) { return lone_jump(usual(i), waiting_[i]); };
  // In a row only between readings that are as usual: a mount that rings swings from side to side.
  const bool calm = calm_ >= kCalm && distance(usual_->last, waiting_.back()) <= 1.0;
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
  const ImuSample& before = first == 0 ? usual_->last : waiting_[first - 1];
  const ImuSample& after = waiting_[last + 1];
  const auto off = [&](std::size_t i) { return distance(waiting_[i], usual(i)); };
  return last - first < kLongestBurst && off(waiting) > 1.0 && sticks_out(before, one, after) &&
         distance(before, waiting_[first]) >= kAlone * off(first) &&
         distance(waiting_[last], after) >= kAlone * off(last);
}

void ReadingGate::learn(const ImuSample& passed) {
  usual_->force.add(passed.linear_acceleration.norm());
  const ImuSample& last = usual_->last;
  if (passed.stamp > last.stamp) {
    usual_->turn_change.add((passed.angular_velocity - last.angular_velocity).norm());
    usual_->force_change.add((passed.linear_acceleration - last.linear_acceleration).norm());
  }
  usual_->last = passed;
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
  if (usual_) {
    return settle(reading);
  }
  first_.push_back(reading);
  return first_.size() < kFirst ? std::vector<GatedReading>() : begin();
}

std::vector<GatedReading> ReadingGate::begin() {
  usual_ = usual_of(first_);
  // The first is held against the first two that agree, as if one of them had been read before it.
  const auto calm = std::ranges::adjacent_find(
      first_, [&](const ImuSample& a, const ImuSample& b) { return distance(a, b) <= 1.0; });
  usual_->last = calm == first_.end() ? first_.front() : *calm;
  usual_->last.stamp = first_.front().stamp - std::chrono::milliseconds(1);
  std::vector<GatedReading> known;
  for (const ImuSample& reading : std::exchange(first_, {})) {
    std::ranges::copy(settle(reading), std::back_inserter(known));
  }
  return known;
}

std::vector<GatedReading> ReadingGate::settle(const ImuSample& reading) {
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
