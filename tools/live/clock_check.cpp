// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/clock_check.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include <fmt/core.h>

#include "adit/tools/recordings/message_times.hpp"

namespace adit {
namespace {

// A cloud is stamped at its beginning and sent at its end, and drivers take a while more.
constexpr double kOrdinary = 1.0;  // s
// Clocks that are set by a network agree better.
constexpr double kFuture = 0.05;
// Sensors that are fused must agree better than their cloud is long.
constexpr double kApart = 0.5;
constexpr double kTai = 37.0;  // s before UTC, since 2017 (IERS Bulletin C)
constexpr double kHour = 3600.0;
constexpr double kYear = 365.0 * 24.0 * kHour;

bool is_about(double value, double other) {
  return std::abs(value - other) < kApart;
}

}  // namespace

std::vector<TopicLateness> lateness_of(const MessageFile& file) {
  const std::vector<Channel>& channels = file.channels();
  std::vector<std::optional<double>> least(channels.size());
  const auto stream = file.messages({});
  while (const auto message = stream->next()) {
    if (const auto stamp = stamp_in(channels[message->channel], *message)) {
      const double late = std::chrono::duration<double>(message->received - *stamp).count();
      std::optional<double>& known = least[message->channel];
      known = std::min(known.value_or(late), late);
    }
  }
  std::vector<TopicLateness> topics;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (least[i]) {
      topics.push_back({.topic = channels[i].topic, .least = *least[i]});
    }
  }
  return topics;
}

std::optional<std::string> explain_lateness(double least_s) {
  if (least_s > -kFuture && least_s < kOrdinary) {
    return std::nullopt;
  }
  const double hours = least_s / kHour;
  if (least_s > kYear) {
    return "its clock was never set, counts from when it was switched on, or a recording is played";
  }
  if (is_about(std::abs(least_s), kTai)) {
    return "37 s lie between TAI, which PTP carries, and UTC: one of the clocks takes it for the "
           "other";
  }
  if (std::abs(hours) > 0.5 && is_about(least_s, std::round(hours) * kHour)) {
    return "whole hours: a time zone was taken for UTC";
  }
  return "one of the clocks is not set";
}

std::vector<std::string> clock_faults(const std::vector<TopicLateness>& topics) {
  std::vector<std::string> faults;
  for (const TopicLateness& one : topics) {
    if (const auto reason = explain_lateness(one.least)) {
      faults.push_back(fmt::format("the stamps of {} are {:.3f} s {} this machine's clock: {}",
                                   one.topic, std::abs(one.least),
                                   one.least > 0.0 ? "behind" : "ahead of", *reason));
    }
  }
  for (std::size_t i = 1; i < topics.size(); ++i) {
    const double apart = topics[i].least - topics[0].least;
    if (std::abs(apart) > kApart) {
      faults.push_back(
          fmt::format("the clocks of {} and {} are {:.3f} s apart: what they measure "
                      "cannot be fused until they agree",
                      topics[0].topic, topics[i].topic, std::abs(apart)));
    }
  }
  return faults;
}

}  // namespace adit
