// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/containers/message_file.hpp"

namespace adit {

/// By how much the stamps of a topic lie before the arrival of their messages, s: the least of all,
/// which network and driver add least to (a lower envelope). Below 0: the stamps are of the future.
struct TopicLateness {
  std::string topic;
  double least = 0.0;
};

/// Of each topic of the file whose messages have stamps.
std::vector<TopicLateness> lateness_of(const MessageFile& file);

/// What a difference of clocks of so many seconds comes from, for people; nothing where it is an
/// ordinary delay.
std::optional<std::string> explain_lateness(double least_s);

/// What is wrong with the clocks, a sentence each: of one topic against this machine, and of topics
/// against each other.
std::vector<std::string> clock_faults(const std::vector<TopicLateness>& topics);

}  // namespace adit
