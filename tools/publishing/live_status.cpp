// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/publishing/live_status.hpp"

#include <string_view>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/support/resident_memory.hpp"

namespace adit {
namespace {

constexpr auto kSilence = std::chrono::seconds(3);

double seconds_between(LiveStatus::Clock::time_point from, LiveStatus::Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

/// A label's value.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    result += c == '\n' ? "\\n" : c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
  }
  return result;
}

class MetricsText {
 public:
  void begin(std::string_view name, std::string_view type, std::string_view help) {
    text_ += fmt::format("# HELP {0} {1}\n# TYPE {0} {2}\n", name, help, type);
  }
  void add(std::string_view name, double value, const std::string& labels = "") {
    text_ += labels.empty() ? fmt::format("{} {:.9g}\n", name, value)
                            : fmt::format("{}{{{}}} {:.9g}\n", name, labels, value);
  }
  void add_alone(std::string_view name, std::string_view type, std::string_view help,
                 double value) {
    begin(name, type, help);
    add(name, value);
  }
  std::string take() && { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace

void LiveStatus::begin_session() {
  const std::scoped_lock lock(mutex_);
  ++session_;
  last_.reset();
  state_ = OdometryState::initializing;
}

void LiveStatus::add(const SweepResult& result, std::optional<double> latency_ms) {
  const std::scoped_lock lock(mutex_);
  ++sweeps_;
  unaligned_ += result.state == OdometryState::coasting ? 1U : 0U;
  state_ = result.state;
  last_ = Clock::now();
  if (latency_ms) {
    latency_.add(*latency_ms);
  }
}

void LiveStatus::add(const SweepPlaced& placed) {
  const std::scoped_lock lock(mutex_);
  ++mapped_;
  keyframes_ += placed.result.keyframe ? 1U : 0U;
}

std::size_t LiveStatus::map_behind() const {
  const std::scoped_lock lock(mutex_);
  return waiting();
}

std::string LiveStatus::health_of(Clock::time_point now) const {
  if (!last_) {
    return "starting";
  }
  if (now - *last_ > kSilence) {
    return "no data";
  }
  return state_ == OdometryState::coasting ? "not aligned" : "ok";
}

std::string LiveStatus::health(Clock::time_point now) const {
  const std::scoped_lock lock(mutex_);
  return health_of(now);
}

std::string LiveStatus::health_json(Clock::time_point now) const {
  const std::scoped_lock lock(mutex_);
  nlohmann::ordered_json json = {{"status", health_of(now)},
                                 {"session", session_},
                                 {"sweeps", sweeps_},
                                 {"sweeps_not_aligned", unaligned_},
                                 {"keyframes", keyframes_},
                                 {"map_behind_sweeps", waiting()},
                                 {"latency_p50_ms", latency_.quantile_ms(0.5)},
                                 {"latency_p99_ms", latency_.quantile_ms(0.99)}};
  json["last_sweep_age_s"] = nullptr;
  if (last_) {
    json["last_sweep_age_s"] = seconds_between(*last_, now);
  }
  return json.dump(2) + "\n";
}

std::string LiveStatus::metrics(Clock::time_point now) const {
  const std::vector<SourceCounts> sources = received_();
  const std::scoped_lock lock(mutex_);
  MetricsText text;
  text.add_alone("adit_healthy", "gauge", "1 where /health answers with 200, else 0.",
                 health_of(now) == "ok" || health_of(now) == "starting" ? 1.0 : 0.0);
  text.add_alone("adit_session", "gauge", "Number of the session, counted from 1.",
                 static_cast<double>(session_));
  text.add_alone("adit_sweeps_total", "counter", "Sweeps that the odometry has placed.",
                 static_cast<double>(sweeps_));
  text.add_alone("adit_sweeps_not_aligned_total", "counter",
                 "Sweeps that were not aligned: their poses are predictions.",
                 static_cast<double>(unaligned_));
  text.add_alone("adit_keyframes_total", "counter", "Keyframes that were mapped.",
                 static_cast<double>(keyframes_));
  text.add_alone("adit_map_behind_sweeps", "gauge", "Sweeps that wait for the map.",
                 static_cast<double>(waiting()));
  if (last_) {
    text.add_alone("adit_last_sweep_age_seconds", "gauge", "Since a sweep was placed.",
                   seconds_between(*last_, now));
  }
  text.begin("adit_latency_seconds", "summary",
             "From the arrival of a sweep's last point to its pose.");
  for (const double share : {0.5, 0.99}) {
    text.add("adit_latency_seconds", 1e-3 * latency_.quantile_ms(share),
             fmt::format("quantile=\"{}\"", share));
  }
  text.add("adit_latency_seconds_sum", 1e-3 * latency_.sum_ms());
  text.add("adit_latency_seconds_count", static_cast<double>(latency_.count()));
  const auto of_sources = [&](std::string_view name, std::string_view help, auto member) {
    text.begin(name, "counter", help);
    for (const SourceCounts& source : sources) {
      text.add(name, static_cast<double>(source.*member),
               "source=\"" + escaped(source.name) + "\"");
    }
  };
  of_sources("adit_received_messages_total", "Messages or packets of a source.",
             &SourceCounts::messages);
  of_sources("adit_received_bytes_total", "Bytes of a source.", &SourceCounts::bytes);
  of_sources("adit_lost_messages_total", "Messages or packets that were sent and not received.",
             &SourceCounts::lost);
  of_sources("adit_left_out_messages_total", "Packets of no known sensor or of a second sender.",
             &SourceCounts::left_out);
  text.add_alone("process_resident_memory_bytes", "gauge", "Memory of the process in RAM.",
                 static_cast<double>(resident_bytes()));
  return std::move(text).take();
}

}  // namespace adit
