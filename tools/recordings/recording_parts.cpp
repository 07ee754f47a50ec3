// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/recording_parts.hpp"

#include <algorithm>
#include <deque>
#include <set>
#include <string>
#include <utility>

#include "adit/tools/recordings/message_times.hpp"

namespace adit {
namespace {

/// Counts the messages of a part and compares.
class PartTally {
 public:
  PartTally(const RecordingPart& part, const std::vector<Topic>& topics,
            const std::vector<bool>& wanted)
      : part_(&part), topics_(&topics), wanted_(&wanted), counts_(part.topics.size()) {
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      if (wanted[part.topics[i]]) {
        counts_[i] = 0;
      }
    }
  }

  void add(std::size_t channel) {
    if (counts_[channel]) {
      ++*counts_[channel];
    }
  }

  /// What the part does not hold, of the topics that were read.
  std::vector<DeclarationError> contradictions() const {
    std::vector<DeclarationError> found = contradictions_of(*part_->file, counts_);
    std::erase_if(found, [&](const DeclarationError& error) { return is_left_out(error.topic()); });
    return found;
  }

 private:
  /// A topic that was not asked for.
  bool is_left_out(const std::string& name) const {
    bool known = false;
    for (std::size_t i = 0; i < topics_->size(); ++i) {
      if ((*topics_)[i].name == name) {
        known = true;
        if ((*wanted_)[i]) {
          return false;
        }
      }
    }
    return known;
  }

  const RecordingPart* part_;
  const std::vector<Topic>* topics_;
  const std::vector<bool>* wanted_;
  std::vector<std::optional<uint64_t>> counts_;  // by channel
};

/// The channels of the part whose topics are wanted.
std::vector<std::size_t> wanted_channels(const RecordingPart& part,
                                         const std::vector<bool>& wanted) {
  std::vector<std::size_t> channels;
  for (std::size_t i = 0; i < part.topics.size(); ++i) {
    if (wanted[part.topics[i]]) {
      channels.push_back(i);
    }
  }
  return channels;
}

/// File by file, each in its order.
class FileOrderStream final : public PartStream {
 public:
  FileOrderStream(const std::vector<RecordingPart>& parts, const std::vector<Topic>& topics,
                  PartSelection selection)
      : parts_(&parts), topics_(&topics), selection_(std::move(selection)) {}

  std::optional<PartMessage> next() override {
    while (true) {
      if (!pending_.empty()) {
        const DeclarationError error = std::move(pending_.front());
        pending_.pop_front();
        throw DeclarationError(error);
      }
      if (!stream_ && !open_next()) {
        return std::nullopt;
      }
      if (const std::optional<RawMessage> message = stream_->next()) {
        tally_->add(message->channel);
        return PartMessage{current_, *message};
      }
      stream_.reset();
      if (selection_.whole()) {
        for (DeclarationError& error : tally_->contradictions()) {
          pending_.push_back(std::move(error));
        }
      }
    }
  }

 private:
  /// The next file that has a topic of interest, or that something is wrong with.
  bool open_next() {
    while (part_ < parts_->size()) {
      const RecordingPart& part = (*parts_)[part_++];
      const MessageSelection selection{.channels = wanted_channels(part, selection_.wanted),
                                       .begin = selection_.received.begin,
                                       .end = selection_.received.end};
      if (!selection.channels.empty() || part.file->damage() ||
          !part.file->contradictions().empty()) {
        current_ = &part;
        tally_.emplace(part, *topics_, selection_.wanted);
        stream_ = part.file->messages(selection);
        return true;
      }
    }
    return false;
  }

  const std::vector<RecordingPart>* parts_;
  const std::vector<Topic>* topics_;
  PartSelection selection_;
  std::size_t part_ = 0;
  const RecordingPart* current_ = nullptr;
  std::optional<PartTally> tally_;
  std::unique_ptr<MessageStream> stream_;
  std::deque<DeclarationError> pending_;
};

/// All messages of a topic, file by file.
class TopicCursor {
 public:
  TopicCursor(const std::vector<RecordingPart>& parts, std::size_t topic,
              const PartSelection& selection)
      : parts_(&parts),
        topic_(topic),
        received_(selection.received),
        by_stamps_(selection.times.order == MessageOrder::stamps),
        key_(selection.times.begin.value_or(Nanoseconds::min())) {}

  /// Goes on to the next message; false at the end. Throws InputError where it is damaged.
  bool advance() {
    while (stream_ || open_next()) {
      message_ = stream_->next();
      if (message_) {
        take_time();
        return true;
      }
      stream_.reset();
    }
    return false;
  }

  const std::optional<RawMessage>& message() const { return message_; }
  /// Never decreases, so that a topic whose clock steps back does not come before all others.
  Nanoseconds key() const { return key_; }
  std::size_t part() const { return part_ - 1; }

 private:
  bool open_next() {
    while (part_ < parts_->size()) {
      const RecordingPart& part = (*parts_)[part_++];
      MessageSelection selection{.channels = {}, .by_index = true};
      if (!by_stamps_) {
        selection.begin = received_.begin;
        selection.end = received_.end;
      }
      for (std::size_t i = 0; i < part.topics.size(); ++i) {
        if (part.topics[i] == topic_) {
          selection.channels.push_back(i);
        }
      }
      if (!selection.channels.empty()) {
        stream_ = part.file->messages(selection);
        return true;
      }
    }
    return false;
  }

  void take_time() {
    Nanoseconds time = message_->received;
    if (by_stamps_) {
      const Channel& channel = (*parts_)[part()].file->channels()[message_->channel];
      // What has no time of its own is due with what precedes it, at first before all others.
      time = stamp_in(channel, *message_).value_or(key_);
      message_->received = std::max(time, key_);
    }
    key_ = std::max(key_, time);
  }

  const std::vector<RecordingPart>* parts_;
  std::size_t topic_;
  TimeSpan received_;
  bool by_stamps_;
  std::size_t part_ = 0;
  std::unique_ptr<MessageStream> stream_;
  std::optional<RawMessage> message_;
  Nanoseconds key_;
};

/// Topic by topic, each with a cursor of its own, the earliest first.
class MergedStream final : public PartStream {
 public:
  MergedStream(const std::vector<RecordingPart>& parts, const std::vector<Topic>& topics,
               PartSelection selection)
      : parts_(&parts), selection_(std::move(selection)) {
    for (std::size_t i = 0; i < topics.size(); ++i) {
      if (selection_.wanted[i]) {
        cursors_.push_back({TopicCursor(parts, i, selection_), State::used});
      }
    }
    for (const RecordingPart& part : parts) {
      tallies_.emplace_back(part, topics, selection_.wanted);
    }
  }

  std::optional<PartMessage> next() override {
    while (true) {
      advance();
      Head* first = nullptr;
      for (Head& head : cursors_) {
        if (head.state == State::ready &&
            (first == nullptr || head.cursor.key() < first->cursor.key())) {
          first = &head;
        }
      }
      if (first == nullptr) {
        report_contradictions();
        return std::nullopt;
      }
      first->state = State::used;
      const RawMessage& message = *first->cursor.message();
      tallies_[first->cursor.part()].add(message.channel);
      if (message.received >= selection_.received.begin &&
          message.received <= selection_.received.end) {
        return PartMessage{&(*parts_)[first->cursor.part()], message};
      }
    }
  }

 private:
  enum class State {
    used,  // its message was given
    ready,
    ended,
  };
  struct Head {
    TopicCursor cursor;
    State state = State::used;
  };

  void advance() {
    for (Head& head : cursors_) {
      while (head.state == State::used) {
        try {
          head.state = head.cursor.advance() ? State::ready : State::ended;
        } catch (const InputError& error) {
          // Where chunks are of several topics, each cursor finds the same damage.
          if (damage_.size() < kComparedDamage && !damage_.insert(error.what()).second) {
            continue;
          }
          throw;
        }
      }
    }
  }

  /// Throws what the parts do not hold, one after the other.
  void report_contradictions() {
    if (!selection_.whole()) {
      return;
    }
    if (!pending_) {
      pending_.emplace();
      for (const PartTally& tally : tallies_) {
        for (DeclarationError& error : tally.contradictions()) {
          pending_->push_back(std::move(error));
        }
      }
    }
    if (!pending_->empty()) {
      const DeclarationError error = std::move(pending_->front());
      pending_->pop_front();
      throw DeclarationError(error);
    }
  }

  static constexpr std::size_t kComparedDamage = 10000;

  const std::vector<RecordingPart>* parts_;
  PartSelection selection_;
  std::vector<Head> cursors_;
  std::vector<PartTally> tallies_;
  std::set<std::string> damage_;
  std::optional<std::deque<DeclarationError>> pending_;
};

}  // namespace

std::unique_ptr<PartStream> read_parts(const std::vector<RecordingPart>& parts,
                                       const std::vector<Topic>& topics, PartSelection selection) {
  if (selection.times.order == MessageOrder::files) {
    return std::make_unique<FileOrderStream>(parts, topics, std::move(selection));
  }
  return std::make_unique<MergedStream>(parts, topics, std::move(selection));
}

}  // namespace adit
