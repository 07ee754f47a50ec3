// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/topic_survey.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "adit/tools/clouds/returns.hpp"

namespace adit {
namespace {

constexpr std::size_t kMostErrors = 100;  // damaged messages that are passed over

/// As many as show which frames take turns on a topic, and whether a sensor has started.
std::size_t sample_size(TopicKind kind) {
  return kind == TopicKind::sweeps ? 10 : kind == TopicKind::imu ? 400 : 50;
}

/// What was seen of one frame.
struct SeenFrame {
  std::size_t first = 0;  ///< order of its first message
  std::size_t events = 0;
  bool returns = false;  ///< some sweep has a return
  bool turns = false;    ///< some reading has an angular velocity that is not zero
  bool weighs = false;   ///< some reading has an acceleration that is not zero
  bool no_gyroscope = true;
  bool fixes = false;   ///< some fix has a position
  bool speeds = false;  ///< some velocity has a number
  bool points = false;  ///< some heading is there
  std::vector<Nanoseconds> stamps{};

  void add(const EventValue& value, Nanoseconds stamp) {
    ++events;
    stamps.push_back(stamp);
    if (const auto* sweep = std::get_if<Sweep>(&value)) {
      returns = returns || std::ranges::any_of(sweep->points, is_return);
    } else if (const auto* reading = std::get_if<ImuSample>(&value)) {
      const auto measures = [](const Eigen::Vector3d& v) {
        return v.allFinite() && !v.isZero(0.0);
      };
      turns = turns || measures(reading->angular_velocity);
      weighs = weighs || measures(reading->linear_acceleration);
      no_gyroscope = no_gyroscope && reading->angular_velocity.array().isNaN().all();
    } else if (const auto* fix = std::get_if<GnssFix>(&value)) {
      const bool position = std::abs(fix->latitude) <= 90.0 && std::abs(fix->longitude) <= 360.0;
      fixes = fixes || (fix->kind != GnssFixKind::none && position);
    } else if (const auto* velocity = std::get_if<BodyVelocity>(&value)) {
      speeds = speeds || velocity->linear.array().isFinite().any();
    } else if (const auto* heading = std::get_if<Heading>(&value)) {
      points = points || std::isfinite(heading->yaw);
    }
  }

  /// Zero where the stamps do not increase.
  double rate() const {
    std::vector<Nanoseconds> intervals;
    for (std::size_t i = 1; i < stamps.size(); ++i) {
      if (stamps[i] > stamps[i - 1]) {
        intervals.push_back(stamps[i] - stamps[i - 1]);
      }
    }
    if (intervals.empty()) {
      return 0.0;
    }
    const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
    std::nth_element(intervals.begin(), middle, intervals.end());
    return 1.0 / seconds(*middle);
  }

  std::string fault(TopicKind kind) const {
    const std::string first_ones = "its first " + std::to_string(events) + " ";
    if (kind == TopicKind::sweeps) {
      return returns ? "" : first_ones + "sweeps are empty";
    }
    if (kind == TopicKind::gnss) {
      return fixes ? "" : first_ones + "messages have no fix";
    }
    if (kind == TopicKind::velocities) {
      return speeds ? "" : first_ones + "velocities have no numbers";
    }
    if (kind == TopicKind::headings) {
      return points ? "" : first_ones + "messages have no heading";
    }
    if (!turns && !weighs) {
      return first_ones + "readings are all zero";
    }
    if (!turns || !weighs) {
      const std::string missing = turns ? "accelerations" : "angular velocities";
      return no_gyroscope && !turns ? "it has no " + missing
                                    : first_ones + missing + " are all zero";
    }
    return events > 1 && rate() == 0.0 ? "its clock stands still" : "";
  }
};

/// Those without a frame are of the frame with most messages.
void merge_nameless(std::map<std::string, SeenFrame>& frames) {
  const auto nameless = frames.find("");
  if (nameless == frames.end() || frames.size() == 1) {
    return;
  }
  SeenFrame unnamed = std::move(nameless->second);
  frames.erase(nameless);
  auto& [name, most] =
      *std::ranges::max_element(frames, {}, [](const auto& frame) { return frame.second.events; });
  most.events += unnamed.events;
  most.returns = most.returns || unnamed.returns;
  most.turns = most.turns || unnamed.turns;
  most.weighs = most.weighs || unnamed.weighs;
  most.fixes = most.fixes || unnamed.fixes;
  most.speeds = most.speeds || unnamed.speeds;
  most.points = most.points || unnamed.points;
}

/// Leaves those out that are as `unusable` says, unless all are.
template <class Unusable>
void keep_usable(std::vector<std::size_t>& topics, Unusable&& unusable) {
  std::vector<std::size_t> usable;
  std::ranges::copy_if(topics, std::back_inserter(usable),
                       [&](std::size_t topic) { return !unusable(topic); });
  if (!usable.empty()) {
    topics = std::move(usable);
  }
}

}  // namespace

std::string plain_frame(const std::string& frame) {
  return frame.substr(std::min(frame.find_first_not_of('/'), frame.size()));
}

std::vector<SensorSample> first_samples(const Recording& recording, std::size_t topic,
                                        bool headings) {
  const bool of_odometry = recording.topics()[topic].kind == TopicKind::poses;
  const TopicKind kind = of_odometry ? TopicKind::velocities
                         : headings  ? TopicKind::headings
                                     : recording.topics()[topic].kind;
  std::map<std::string, SeenFrame> frames;
  std::size_t seen = 0;
  std::size_t errors = 0;
  EventSelection selection{.topics = {topic}};
  if (of_odometry) {
    selection.velocities_of = topic;
  }
  if (headings) {
    selection.headings_of = topic;
  }
  const auto events = recording.events(selection);
  // Files of sweeps name no frames, and large ones take their time.
  const auto is_enough = [&] {
    constexpr std::size_t kNameless = 3;
    const auto nameless = frames.find("");
    return kind == TopicKind::sweeps && seen >= kNameless && frames.size() == 1 &&
           nameless != frames.end() && nameless->second.returns;
  };
  while (seen < sample_size(kind) && errors < kMostErrors && !is_enough()) {
    try {
      const std::optional<Event> event = events->next();
      if (!event) {
        break;
      }
      SeenFrame& frame =
          frames.try_emplace(plain_frame(event->frame), SeenFrame{.first = seen}).first->second;
      frame.add(event->value, stamp_of(*event));
      ++seen;
    } catch (const InputError&) {
      ++errors;  // reported where the events are read
    }
  }
  merge_nameless(frames);
  std::vector<std::pair<std::string, SeenFrame>> sorted(frames.begin(), frames.end());
  std::ranges::sort(sorted, [](const auto& a, const auto& b) {
    return std::pair(b.second.events, a.second.first) < std::pair(a.second.events, b.second.first);
  });
  std::vector<SensorSample> samples;
  for (const auto& [name, frame] : sorted) {
    samples.push_back(
        {.frame = name, .events = frame.events, .rate = frame.rate(), .fault = frame.fault(kind)});
  }
  return samples;
}

std::string fault_of_topic(const Recording& recording, std::size_t topic) {
  const std::vector<SensorSample> samples = first_samples(recording, topic);
  return samples.empty() ? "not one of its messages can be read" : samples.front().fault;
}

std::size_t sweep_topic(const Recording& recording, const std::filesystem::path& path,
                        const std::optional<std::string>& name) {
  std::vector<std::size_t> topics;
  const auto names = [&] {
    std::string text;
    for (const std::size_t topic : topics) {
      text += (text.empty() ? "" : ", ") + recording.topics()[topic].name;
    }
    return text;
  };
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    if (recording.topics()[i].kind == TopicKind::sweeps) {
      topics.push_back(i);
    }
  }
  if (topics.empty()) {
    throw InputError(path, {}, "there are no sweeps in it",
                     "`adit inspect` lists what it holds; mapping needs point clouds "
                     "(sensor_msgs/PointCloud2 or Livox's CustomMsg)");
  }
  if (name) {
    const std::string known = names();
    std::erase_if(topics, [&](std::size_t i) { return recording.topics()[i].name != *name; });
    if (topics.empty()) {
      throw InputError(path, {}, "it has no topic of sweeps named " + *name, "It has " + known);
    }
    return topics.back();
  }
  keep_usable(topics, [&](std::size_t i) { return recording.topics()[i].messages == 0U; });
  if (topics.size() > 1) {
    keep_usable(topics, [&](std::size_t i) { return !fault_of_topic(recording, i).empty(); });
  }
  if (topics.size() > 1) {
    throw InputError(path, {},
                     "it has " + std::to_string(topics.size()) + " topics of sweeps: " + names(),
                     "Choose one with --topic");
  }
  return topics.front();
}

}  // namespace adit
