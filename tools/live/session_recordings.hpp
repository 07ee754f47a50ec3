// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The recordings of a live run, one for each session. A SIGHUP, or request_next(), begins the next
// one while the sensors go on.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <ostream>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "adit/tools/live/live_folder.hpp"
#include "adit/tools/live/live_options.hpp"
#include "adit/tools/live/live_timer.hpp"
#include "adit/tools/live/message_recorder.hpp"
#include "adit/tools/live/packet_recorder.hpp"
#include "adit/tools/run/run_job.hpp"
#include "adit/tools/run/run_options.hpp"
#include "adit/tools/support/stop_signal.hpp"

namespace adit {

/// A session, and the recording that it maps.
template <class Recorder>
struct LiveSession {
  RunCommandOptions run;  ///< with its folder and its recording
  std::unique_ptr<Recorder> recorder{};
  LiveClock::time_point begun = LiveClock::now();
  std::size_t messages = 0;  ///< or packets, that arrived in it
};

/// The sessions so far. A receiver's thread writes to the recordings that are open, another one
/// maps them.
template <class Recorder>
class LiveSessions {
 public:
  /// Makes the session of that number, counted from 1. May throw; the run then stays as it is.
  using Make = std::function<LiveSession<Recorder>(std::size_t number)>;

  LiveSessions(Make make, std::function<void(const std::string&)> complain)
      : make_(std::move(make)), complain_(std::move(complain)) {
    sessions_.push_back(make_(1));
  }

  std::size_t size() const {
    const std::scoped_lock lock(mutex_);
    return sessions_.size();
  }
  /// Counted from 0.
  LiveSession<Recorder>& at(std::size_t i) {
    const std::scoped_lock lock(mutex_);
    return sessions_.at(i);
  }
  /// Whether anything has arrived in a session, counted from 0.
  bool has_messages(std::size_t i) const {
    const std::scoped_lock lock(mutex_);
    return sessions_.at(i).messages > 0;
  }
  /// As a SIGHUP.
  void request_next() { ++requests_; }
  /// It was asked for, and the receiver begins it.
  bool is_about_to_begin() const {
    const std::scoped_lock lock(mutex_);
    return !ended_ && wanted() > seen_;
  }

 protected:
  /// A sweep at 5 Hz, and its readings: for so long two recordings get what arrives, so that each
  /// sweep is whole in one of them.
  static constexpr double kOverlap = 0.3;  // s

  /// Begins a session, or ends the recording of the one before it, where that is due. The mutex is
  /// held. Returns whether one began.
  bool look() {
    if (first_open_ + 1 < sessions_.size() && seconds_since(sessions_.back().begun) > kOverlap) {
      sessions_[first_open_].recorder->finish();
      ++first_open_;
    }
    const std::size_t asked = wanted();
    if (asked <= seen_ || first_open_ + 1 < sessions_.size()) {
      return false;
    }
    seen_ = asked;
    try {
      sessions_.push_back(make_(sessions_.size() + 1));
      return true;
    } catch (const std::exception& error) {
      complain_(error.what());
      return false;
    }
  }

  /// Nothing arrives any more, and no session begins. The mutex is held.
  void end() { ended_ = true; }
  /// The mutex is held.
  void for_each_open(const auto& act) {
    for (std::size_t i = first_open_; i < sessions_.size(); ++i) {
      act(*sessions_[i].recorder);
    }
  }
  /// The same with something that has arrived.
  void write_to_open(const auto& act) {
    for (std::size_t i = first_open_; i < sessions_.size(); ++i) {
      act(*sessions_[i].recorder);
      ++sessions_[i].messages;
    }
  }

  mutable std::mutex mutex_;
  std::deque<LiveSession<Recorder>> sessions_;

 private:
  std::size_t wanted() const {
    return static_cast<std::size_t>(StopSignal::hang_ups()) + requests_;
  }

  Make make_;
  std::function<void(const std::string&)> complain_;
  std::atomic<std::size_t> requests_ = 0;
  std::size_t seen_ = static_cast<std::size_t>(StopSignal::hang_ups());
  bool ended_ = false;
  std::size_t first_open_ = 0;  ///< of the sessions, the first whose recording is written
};

class PacketSessions final : public LiveSessions<PacketRecorder>, public PacketSink {
 public:
  using LiveSessions::LiveSessions;

  void add(const ReceivedDatagram& datagram) override {
    const std::scoped_lock lock(mutex_);
    write_to_open([&](PacketRecorder& recorder) { recorder.add(datagram); });
  }
  void commit() override {
    const std::scoped_lock lock(mutex_);
    for_each_open([](PacketRecorder& recorder) { recorder.commit(); });
    look();
  }
  void finish() override {
    const std::scoped_lock lock(mutex_);
    end();
    for_each_open([](PacketRecorder& recorder) { recorder.finish(); });
  }
};

/// Each recording begins with what arrived before of latched channels.
class MessageSessions final : public LiveSessions<MessageRecorder>, public MessageSink {
 public:
  /// `latched`: by channel.
  MessageSessions(Make make, std::function<void(const std::string&)> complain,
                  std::vector<bool> latched)
      : LiveSessions(std::move(make), std::move(complain)), latched_(std::move(latched)) {}

  void write(std::size_t channel, Nanoseconds received, std::span<const std::byte> bytes) override {
    const std::scoped_lock lock(mutex_);
    if (latched_.at(channel)) {
      kept_.push_back({.channel = channel, .bytes = {bytes.begin(), bytes.end()}});
    }
    write_to_open([&](MessageRecorder& recorder) { recorder.write(channel, received, bytes); });
    last_ = received;
  }
  void commit() override {
    const std::scoped_lock lock(mutex_);
    if (look()) {
      for (const Kept& one : kept_) {
        sessions_.back().recorder->write(one.channel, last_, one.bytes);
      }
    }
  }
  void finish() override {
    const std::scoped_lock lock(mutex_);
    end();
    for_each_open([](MessageRecorder& recorder) { recorder.finish(); });
  }
  void abandon() override {
    const std::scoped_lock lock(mutex_);
    end();
    for_each_open([](MessageRecorder& recorder) { recorder.abandon(); });
  }

 private:
  struct Kept {
    std::size_t channel = 0;
    std::vector<std::byte> bytes;
  };

  std::vector<bool> latched_;
  std::vector<Kept> kept_;
  Nanoseconds last_{0};  ///< time of the newest message
};

/// With --restart a failure of the device begins the next session, unless it came before a sweep
/// was placed.
template <class Sessions>
void restart_where_wanted(const LiveOptions& options, RunSource& source, Sessions& sessions) {
  if (!options.restarts) {
    return;
  }
  auto placed = std::make_shared<bool>(false);
  source.placed = [placed, then = source.placed](const Sweep& sweep, const SweepResult& result) {
    *placed = true;
    then(sweep, result);
  };
  source.ended = [placed, &sessions, then = source.ended](const MappingResult& result) {
    then(result);
    if (*placed && result.end == RunEnd::device_error) {
      sessions.request_next();
    }
  };
}

/// Leaves room for the map on a disk that fills up (DiskReserve), and says so; what is not to be
/// kept goes at once.
void leave_room(const auto& recorder, const LiveOptions& options, std::ostream& err) {
  if (!options.record) {
    recorder.reserve().begin(recorder.path(), {}, std::numeric_limits<uint64_t>::max() / 2);
    return;
  }
  recorder.reserve().begin(recorder.path(), [&err](const std::string& what) {
    err << ("note: " + what + "\n") << std::flush;
  });
}

/// Whether the recording holds all that was mapped goes into the report.
void report_recording(RunSource& source, const auto& recorder) {
  source.report = [&recorder, then = source.report] {
    LiveReport report = then();
    report.recording_is_whole = !recorder.reserve().kept();
    return report;
  };
}

/// Maps the sessions one after the other by `map_one(session, view)`, which returns an exit code;
/// a page shows the first. Returns the greatest of the codes.
template <class Sessions, class View>
int map_sessions(Sessions& sessions, View* view, const auto& map_one, std::ostream& err) {
  int code = 0;
  for (std::size_t i = 0;; ++i) {
    auto& session = sessions.at(i);
    if (i > 0) {
      err << "session " << i + 1 << ": " << session.run.output.string() << std::endl;
      // Its sensors begin, as before the first session.
      while ((!sessions.has_messages(i) || seconds_since(session.begun) < kFirstLook) &&
             StopSignal::received() == 0 && !session.recorder->finished()) {
        std::this_thread::sleep_for(kLookEvery);
      }
      if (!sessions.has_messages(i)) {
        err << "nothing arrived in it\n";
        const PendingRecording nothing(session.run.recording, session.run.output);
        return code;
      }
    }
    code = std::max(code, map_one(session, i == 0 ? view : nullptr));
    session.recorder->reserve().cut();
    while (sessions.is_about_to_begin() && StopSignal::received() == 0) {
      std::this_thread::sleep_for(kLookEvery);
    }
    if (i + 1 == sessions.size()) {
      return code;
    }
  }
}

}  // namespace adit
