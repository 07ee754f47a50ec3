// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "adit/tools/containers/message_file.hpp"
#include "adit/tools/dds/dds_node.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// A topic that several nodes publish is there once: reliable or latched where all of them are.
struct PublishedTopic {
  DdsTopic topic;
  std::size_t publishers = 0;
};

/// Whether a source is a ROS 2 topic ("/points", as no file is named), all of them ("ros2"), or a
/// gpsd, whose fixes are recorded beside them or beside packets.
bool is_topic_source(const std::string& source);

/// The topic as a channel of a recording.
Channel channel_of(const DdsTopic& topic);

/// What its messages tell.
TopicKind kind_of(const DdsTopic& topic);

/// For people, a clause.
std::string text_of(const DdsTopic& topic);

/// The topics that are published at this moment and that adit reads.
std::vector<PublishedTopic> understood_topics(DdsNode& node);

/// The topics to record: those that are named, or with "ros2" all that adit reads, once all that
/// are named are published, and with "ros2" one with sweeps. Static transforms come with them.
/// Throws InputError where that is not so within `wait_s` seconds, and UsageError for a gpsd alone.
std::vector<PublishedTopic> wait_for_topics(DdsNode& node, const std::vector<std::string>& sources,
                                            double wait_s);

}  // namespace adit
