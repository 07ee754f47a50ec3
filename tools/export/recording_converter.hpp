// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The messages of a recording on their way to a writer.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "adit/slam/core/recording_config.hpp"
#include "adit/tools/containers/message_writer.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// What became of a topic.
struct ConvertedTopic {
  std::string topic;
  std::string type;
  uint64_t messages = 0;     ///< written
  uint64_t from_before = 0;  ///< number from before the cut: what still holds where it begins
  std::string left_out{};    ///< why, where it was
};

struct ConvertReport {
  std::vector<ConvertedTopic> topics;
  std::vector<std::string> notes;   ///< for people: what was changed without loss
  std::vector<std::string> errors;  ///< the input's first errors
  uint64_t error_count = 0;

  uint64_t messages() const;  ///< sum over all topics
};

/// What a converter makes of messages.
struct Conversion {
  std::vector<std::string> topics{};        ///< those to keep; empty: all
  std::optional<Encoding> encoding{};       ///< none: as it is
  std::optional<RecordingConfig> repair{};  ///< write sweeps and IMU samples as understood
};

/// The topic that events go to: folders of sweeps have no name that a message could go by.
std::string event_topic(const Topic& topic);

/// Copies, translates or repairs messages. Damage of the input is counted and passed over.
class RecordingConverter {
 public:
  /// `writer` must outlive it.
  RecordingConverter(Conversion conversion, MessageWriter& writer)
      : conversion_(std::move(conversion)), writer_(&writer) {}

  /// What still holds when the part from `begin` on begins, stamped as received then.
  void copy_latched(const std::vector<std::unique_ptr<MessageFile>>& files, Nanoseconds begin);
  void copy_latched(const Recording& recording, Nanoseconds begin);

  /// What was received within the span.
  void copy(const MessageFile& file, const TimeSpan& span);
  void copy(const Recording& recording, const TimeSpan& span);

  ConvertReport take() && { return std::move(report_); }

 private:
  /// Where the messages of a channel go.
  struct Route {
    std::size_t topic = 0;  ///< index into the report
    Encoding from = Encoding::other;
    Encoding to = Encoding::other;
    std::optional<std::size_t> channel{};  ///< the writer's; none: left out
    bool repaired = false;
  };

  void add_error(const InputError& error);
  void run(const std::function<bool()>& step);
  bool is_repaired(const Channel& channel) const;
  Route route_of(const Channel& channel);
  void copy_events(const Recording& recording, const EventSelection& selection,
                   std::optional<Nanoseconds> received);
  void write(const MessageFile& file, const Route& route, const RawMessage& message);
  void write_repaired(const MessageFile& file, const Route& route, const RawMessage& message);
  void write_translated(const MessageFile& file, const Route& route, const RawMessage& message);
  std::size_t write(const Event& event, const std::string& topic);
  std::string frame_with_offset(const std::string& frame, const Eigen::Vector3d& offset,
                                Nanoseconds received);
  void note_coarse(const std::string& topic, double step);

  Conversion conversion_;
  MessageWriter* writer_;
  ConvertReport report_;
  std::set<std::string> errors_;                                 // those counted, the first ones
  std::map<std::pair<std::string, std::string>, Route> routes_;  // by topic and type
  std::map<std::string, Eigen::Vector3d> offsets_;  // of clouds that are repaired, by topic
  std::set<std::string> placed_frames_;             // those whose offset was written
  std::set<std::string> coarse_topics_;             // those that a note tells of
};

}  // namespace adit
