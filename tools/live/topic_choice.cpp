// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/topic_choice.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/containers/live_metadata.hpp"
#include "adit/tools/containers/ros_definitions.hpp"
#include "adit/tools/live/gpsd_receiver.hpp"
#include "adit/tools/live/live_timer.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr const char* kAllTopics = "ros2";

/// All that are published.
std::vector<PublishedTopic> published_topics(DdsNode& node) {
  std::map<std::pair<std::string, std::string>, PublishedTopic> found;
  for (const DdsTopic& one : node.published()) {
    auto [at, is_new] = found.try_emplace({one.name, one.type}, PublishedTopic{.topic = one});
    DdsTopic& topic = at->second.topic;
    topic.reliable = topic.reliable && one.reliable;
    topic.latched = topic.latched && one.latched;
    ++at->second.publishers;
  }
  std::vector<PublishedTopic> topics;
  for (auto& [key, topic] : found) {
    topics.push_back(std::move(topic));
  }
  return topics;
}

bool is_wanted(const DdsTopic& topic, const std::vector<std::string>& sources) {
  const TopicKind kind = kind_of(topic);
  // Transforms tell how the sensors are mounted, whoever names the others.
  return kind == TopicKind::transforms ||
         std::ranges::any_of(sources, [&](const std::string& source) {
           return source == topic.name || (source == kAllTopics && kind != TopicKind::other);
         });
}

/// The first source that is not published; empty: all are.
std::string missing_source(const std::vector<PublishedTopic>& topics,
                           const std::vector<std::string>& sources) {
  for (const std::string& source : sources) {
    if (gpsd_endpoint(source)) {
      continue;
    }
    const bool there = std::ranges::any_of(topics, [&](const PublishedTopic& one) {
      return source == kAllTopics ? kind_of(one.topic) == TopicKind::sweeps
                                  : one.topic.name == source;
    });
    if (!there) {
      return source;
    }
  }
  return "";
}

}  // namespace

bool is_topic_source(const std::string& source) {
  std::error_code unknown;
  return source == kAllTopics ||
         (source.starts_with('/') && !std::filesystem::exists(source, unknown)) ||
         gpsd_endpoint(source).has_value();
}

Channel channel_of(const DdsTopic& topic) {
  const auto definition = ros::definition_of(topic.type, Encoding::cdr);
  return {.topic = topic.name,
          .type = topic.type,
          .encoding = Encoding::cdr,
          .definition = definition ? definition->text : "",
          .messages = std::nullopt,
          .metadata = {{kOrderKey, kArrivalOrder}}};
}

TopicKind kind_of(const DdsTopic& topic) {
  return ros::kind_of(channel_of(topic));
}

std::vector<PublishedTopic> understood_topics(DdsNode& node) {
  std::vector<PublishedTopic> topics = published_topics(node);
  std::erase_if(topics, [](const auto& one) { return kind_of(one.topic) == TopicKind::other; });
  return topics;
}

std::vector<PublishedTopic> wait_for_topics(DdsNode& node, const std::vector<std::string>& sources,
                                            double wait_s) {
  if (std::ranges::all_of(sources,
                          [](const auto& one) { return gpsd_endpoint(one).has_value(); })) {
    throw UsageError("gpsd:// goes with udp:// sources or ROS 2 topics: name them, or ros2.");
  }
  const auto start = LiveClock::now();
  std::optional<LiveClock::time_point> ready;
  while (!ready || seconds_since(*ready) < kFirstLook) {
    const std::string missing = missing_source(published_topics(node), sources);
    ready = missing.empty() ? ready.value_or(LiveClock::now()) : ready;
    if ((!ready && seconds_since(start) > wait_s) || StopSignal::received() != 0) {
      throw InputError(
          sources.front(), {},
          fmt::format("{} was not published in {:.1f} s",
                      missing == kAllTopics ? "a topic of point clouds" : missing,
                      seconds_since(start)),
          "`adit live --list` shows what is published. Check ROS_DOMAIN_ID; for other machines set "
          "ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET");
    }
    std::this_thread::sleep_for(kLookEvery);
  }
  std::vector<PublishedTopic> topics = published_topics(node);
  std::erase_if(topics, [&](const PublishedTopic& one) { return !is_wanted(one.topic, sources); });
  return topics;
}

std::string text_of(const DdsTopic& topic) {
  return fmt::format("{} {} ({}{})", topic.name, topic.type,
                     topic.reliable ? "reliable" : "best effort", topic.latched ? ", latched" : "");
}

}  // namespace adit
