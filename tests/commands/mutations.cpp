// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tests/commands/mutations.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>
#include <variant>

namespace adit::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::array kNumbers = {kNone, kInfinity, -kInfinity, 1e200, -1e200, 1e30,  -1e30, 1e10,
                                 -1e10, 1e5,       600.0,      -20.0, 0.0,    1e-30, 1e-320};

double number(Dice& dice) {
  return kNumbers[dice.below(kNumbers.size())];
}

/// Between frames of the rig or others: to itself, in loops, without names, anywhere.
Recorded some_transform(Nanoseconds received, Dice& dice) {
  constexpr std::array<const char*, 8> kFrames = {"base_link", "lidar", "imu", "/imu",
                                                  "fix",       "odom",  "",    "mast"};
  StaticTransform transform{kFrames[dice.below(kFrames.size())],
                            kFrames[dice.below(kFrames.size())], Eigen::Isometry3d::Identity()};
  if (dice.one_in(2)) {
    transform.T_parent_child.translation().x() = number(dice);
  }
  if (dice.one_in(3)) {
    transform.T_parent_child.linear() = so3_exp({0.0, 0.0, static_cast<double>(dice.below(7))});
  }
  return {"/tf_static", received, transform};
}

Nanoseconds stamp(Nanoseconds before, Dice& dice) {
  constexpr int64_t kSecond = 1'000'000'000;
  const std::array<int64_t, 10> stamps = {0,
                                          1,
                                          before.count() - kSecond * 3600,
                                          before.count() + kSecond * 3600,
                                          before.count() + kSecond * 37,
                                          before.count() - kSecond / 5,
                                          before.count() + kSecond / 3,
                                          kSecond * 4294967295,
                                          kSecond * 2147483647,
                                          MovingRig::kBegin.count()};
  return Nanoseconds(stamps[dice.below(stamps.size())]);
}

void damage(Sweep& sweep, Dice& dice) {
  const auto any = [&]() -> Point& { return sweep.points[dice.below(sweep.points.size())]; };
  if (sweep.points.empty()) {
    return;
  }
  switch (dice.below(9)) {
    case 0:
      sweep.points.clear();
      sweep.times.clear();
      sweep.rings.clear();
      sweep.doppler.clear();
      break;
    case 1:
      sweep.points.resize(1);
      sweep.times.resize(std::min<std::size_t>(1, sweep.times.size()));
      sweep.rings.resize(std::min<std::size_t>(1, sweep.rings.size()));
      sweep.doppler.resize(std::min<std::size_t>(1, sweep.doppler.size()));
      break;
    case 2:
      std::ranges::fill(sweep.points, any());
      break;
    case 3:
      for (Point& point : sweep.points) {
        point.z = 0.0F;
      }
      break;
    case 4: {
      const auto value = static_cast<float>(number(dice));
      for (Point& point : sweep.points) {
        (dice.one_in(2) ? point.x : point.y) = value;
      }
      break;
    }
    case 5:
      for (std::size_t i = 0; i < 1 + dice.below(50); ++i) {
        any() = {static_cast<float>(number(dice)), static_cast<float>(number(dice)),
                 static_cast<float>(number(dice)), static_cast<float>(number(dice))};
      }
      break;
    case 6:
      for (Point& point : sweep.points) {
        point = {1000.0F * point.x, 1000.0F * point.y, 1000.0F * point.z, point.intensity};
      }
      break;
    case 7:
      for (float& time : sweep.times) {
        time = static_cast<float>(number(dice));
      }
      break;
    default:
      sweep.stamp = stamp(sweep.stamp, dice);
  }
}

void damage(ImuSample& sample, Dice& dice) {
  if (dice.one_in(5)) {
    sample.stamp = stamp(sample.stamp, dice);
    return;
  }
  Eigen::Vector3d& triad = dice.one_in(2) ? sample.angular_velocity : sample.linear_acceleration;
  triad(static_cast<Eigen::Index>(dice.below(3))) = number(dice);
}

void damage(GnssFix& fix, Dice& dice) {
  (dice.one_in(2) ? fix.latitude : fix.altitude) = number(dice);
  fix.covariance = Eigen::Matrix3d::Constant(number(dice));
}

void damage(BodyVelocity& velocity, Dice& dice) {
  if (dice.one_in(3)) {
    velocity.stamp = stamp(velocity.stamp, dice);
  } else if (dice.one_in(2)) {
    velocity.linear(static_cast<Eigen::Index>(dice.below(3))) = number(dice);
  } else {
    velocity.covariance = Eigen::Matrix3d::Constant(number(dice));
  }
}

void damage(Heading& heading, Dice& dice) {
  if (dice.one_in(3)) {
    heading.stamp = stamp(heading.stamp, dice);
  } else {
    heading.yaw = number(dice);
  }
}

void damage(StaticTransform& transform, Dice& dice) {
  if (dice.one_in(2)) {
    std::swap(transform.parent, transform.child);
  }
  transform.T_parent_child.translation().x() = number(dice);
}

void damage(ReferencePose& pose, Dice& dice) {
  if (dice.one_in(2)) {
    pose.stamp = stamp(pose.stamp, dice);
  } else {
    pose.T_parent_child.translation().x() = number(dice);
  }
}

}  // namespace

void damage_bytes(std::string& bytes, Dice& dice) {
  if (dice.is_harmless()) {
    return;
  }
  for (std::size_t change = 0; change <= dice.below(4) && !bytes.empty(); ++change) {
    const std::size_t at = dice.below(bytes.size());
    const std::size_t length = std::min(std::size_t{1} << dice.below(14), bytes.size() - at);
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end = begin + static_cast<std::ptrdiff_t>(length);
    switch (dice.below(8)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        *begin = static_cast<char>(*begin ^ static_cast<char>(1U << dice.below(8)));
        break;
      case 2:
        *begin = static_cast<char>(dice.bits());
        break;
      case 3:
        std::fill(begin, end, dice.one_in(3) ? '\xff' : '\0');
        break;
      case 4:
        bytes.insert(at, bytes.substr(dice.below(bytes.size()), length));
        break;
      case 5:
        bytes.erase(at, length);
        break;
      case 6: {
        const std::string other = bytes.substr(dice.below(bytes.size()), length);
        bytes.replace(at, other.size(), other);
        break;
      }
      default:
        for (auto byte = begin; byte != end && byte - begin < 8; ++byte) {
          *byte = static_cast<char>(dice.bits());
        }
    }
  }
}

void damage_text(std::string& text, Dice& dice) {
  if (dice.is_harmless()) {
    return;
  }
  constexpr std::array<std::string_view, 16> kWords = {
      "nan",
      "inf",
      "-inf",
      "1e200",
      "-1e200",
      "1e-320",
      "0",
      "-0",
      "",
      "x",
      "9e18",
      "1e10",
      "99999999999999999999",
      "-1",
      "0x10",
      ",",
  };
  if (dice.one_in(3)) {
    damage_bytes(text, dice);
    return;
  }
  for (std::size_t change = 0; change <= dice.below(6) && !text.empty(); ++change) {
    const std::size_t from = text.find_last_of(" ,\n:[", dice.below(text.size()));
    const std::size_t at = from == text.npos ? 0 : from + 1;
    const std::size_t line = std::min(text.find('\n', at), text.size() - 1) + 1;
    const std::size_t length = std::min(text.find_first_of(" ,\n]}", at), text.size()) - at;
    switch (dice.below(4)) {
      case 0:
        text.erase(at, line - at);
        break;
      case 1:
        text.insert(line, text.substr(at, line - at));
        break;
      default:
        text.replace(at, length, kWords[dice.below(kWords.size())]);
    }
  }
}

void damage_numbers(std::string& text, Dice& dice) {
  if (dice.is_harmless()) {
    return;
  }
  constexpr std::array<std::string_view, 12> kOthers = {"0",    "1",  "-1",  "0.0",  "1.0", "-1.0",
                                                        "1e-9", "25", "0.5", "90.0", "1e3", "-1e6"};
  const auto numbers = [&] {  // where each begins, and its length
    std::vector<std::pair<std::size_t, std::size_t>> found;
    for (std::size_t at = text.find_first_of("0123456789"); at != text.npos;
         at = text.find_first_of("0123456789", at)) {
      const std::size_t begin = at > 0 && text[at - 1] == '-' ? at - 1 : at;
      const std::size_t end = std::min(text.find_first_not_of("0123456789.e-", at), text.size());
      found.emplace_back(begin, end - begin);
      at = end;
    }
    return found;
  };
  for (std::size_t change = 0; change <= dice.below(4); ++change) {
    const auto found = numbers();
    if (found.empty()) {
      return;
    }
    const auto [at, length] = found[dice.below(found.size())];
    const auto [from, size] = found[dice.below(found.size())];
    text.replace(at, length,
                 dice.one_in(2) ? text.substr(from, size)
                                : std::string(kOthers[dice.below(kOthers.size())]));
  }
}

void damage_events(std::vector<Recorded>& events, Dice& dice) {
  if (dice.is_harmless()) {
    return;
  }
  for (std::size_t change = 0; change <= dice.below(4) && !events.empty(); ++change) {
    const std::size_t at = dice.below(events.size());
    const std::size_t length = std::min(std::size_t{1} << dice.below(8), events.size() - at);
    const auto begin = events.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end = begin + static_cast<std::ptrdiff_t>(length);
    const std::string topic = begin->topic;
    switch (dice.below(12)) {
      case 0:
        events.erase(begin, end);
        break;
      case 1:
        events.resize(at);
        break;
      case 2:
        std::iter_swap(begin,
                       events.begin() + static_cast<std::ptrdiff_t>(dice.below(events.size())));
        break;
      case 3:
        events.insert(begin, *begin);
        break;
      case 4:
        std::erase_if(events, [&](const Recorded& event) { return event.topic == topic; });
        break;
      case 5:
        begin->received = stamp(begin->received, dice);
        break;
      case 6:
        events.insert(begin, some_transform(begin->received, dice));
        break;
      case 7: {
        // Messages of one sensor on two topics, or of two on one.
        const std::string other = dice.one_in(2) ? topic + "_b" : "/points";
        for (auto event = begin; event != end; ++event) {
          event->topic =
              event->topic == topic && event->topic != "/tf_static" ? other : event->topic;
        }
        break;
      }
      case 8:
        // Mountings as a robot without /tf_static publishes them.
        for (int k = 0; k < 40; ++k) {
          const Nanoseconds at_time = MovingRig::kBegin + std::chrono::milliseconds(100 * k);
          events.push_back({"/tf", at_time, some_transform(at_time, dice).value});
        }
        break;
      default:
        for (auto event = begin; event != end; ++event) {
          std::visit([&](auto& value) { damage(value, dice); }, event->value);
        }
    }
  }
}

}  // namespace adit::test
