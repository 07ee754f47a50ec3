// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A recording is a stream of typed events in the order in which they were recorded, whatever files
// it lies in. See open_recording() for the formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/clouds/point_times.hpp"
#include "adit/tools/containers/time_span.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

/// What a topic tells.
enum class TopicKind {
  sweeps,
  imu,
  gnss,
  velocities,  ///< of wheels, a radar or another odometry
  headings,    ///< against true north
  poses,       ///< somebody else's estimate or the truth
  transforms,  ///< static
  other,       ///< nothing that is understood; never part of the stream
};
/// The enumerator's name.
std::string_view to_string(TopicKind kind);

/// A named series of events of one kind.
struct Topic {
  std::string name;                   ///< "/points"; for folders, what the folder holds
  std::string type;                   ///< "sensor_msgs/PointCloud2", "KITTI .bin"
  TopicKind kind = TopicKind::other;  ///< what its messages are
  std::optional<uint64_t> messages;   ///< how many the recording says there are
};

/// What an event can be.
using EventValue =
    std::variant<Sweep, ImuSample, GnssFix, BodyVelocity, ReferencePose, StaticTransform, Heading>;

/// Coordinates (m) that a pose can have: finite, and not so large that a path of them is not.
inline bool is_position(const Eigen::Vector3d& p) {
  constexpr double kFarthest = 1e12;
  return (p.array().abs() <= kFarthest).all();
}

/// A measurement of a recording, decoded.
struct Event {
  std::size_t topic = 0;    ///< index into Recording::topics()
  Nanoseconds received{0};  ///< the recorder's clock; for files of sweeps, the sweep's stamp
  EventValue value;         ///< the measurement
  uint64_t bytes = 0;   ///< size of the message or file; further events of the same message have 0
  std::string frame{};  ///< the sensor's, where the recording names it
  std::optional<PointTimeNature> point_times{};  ///< for sweeps with times
  std::optional<std::size_t> number{};  ///< place among the topic's messages, from 0, if known
  bool has_intensity = true;            ///< false: those of a sweep's points are made up zeros
  double coordinate_step = 0.0;         ///< of a sweep, as CloudFile::coordinate_step
};

/// The event's own time; that of a static transform is when it was received.
Nanoseconds stamp_of(const Event& event);

/// Which events to read, and how.
struct EventSelection {
  std::vector<std::size_t> topics{};       ///< indices; empty: all but TopicKind::other
  Nanoseconds begin = Nanoseconds::min();  ///< earliest `received`, inclusive
  Nanoseconds end = Nanoseconds::max();    ///< latest `received`, inclusive
  uint64_t skip = 0;  ///< messages of these topics and times to pass over first, undecoded
  /// This topic of odometry messages gives velocities in place of poses; none: none does.
  std::optional<std::size_t> velocities_of{};
  /// The orientations of this topic of readings of an IMU are headings, too; none: none's are.
  std::optional<std::size_t> headings_of{};
  std::optional<double> point_time_unit{};     ///< s; none: inferred from the first sweeps
  std::optional<double> coordinate_scale{};    ///< m of a step of the coordinates; none: metres
  std::optional<uint32_t> floats_per_point{};  ///< of .bin files; none: found by their numbers
};

/// Reads the events of a recording, one after the other.
class EventStream {
 public:
  EventStream() = default;
  virtual ~EventStream() = default;
  EventStream(const EventStream&) = delete;
  EventStream& operator=(const EventStream&) = delete;

  /// The next event, nothing at the end. Throws InputError at a damaged place, DeclarationError
  /// where messages that a container declares are not there; the call after that goes on behind it
  /// if there is a way to, else finds the end. Of a sweep that is damaged in part the damage comes
  /// first, then the rest of the sweep.
  virtual std::optional<Event> next() = 0;
};

/// Something about a recording that is no fault and worth knowing, for people.
struct RecordingNotice {
  std::string kind;    ///< a word for programs
  std::string found;   ///< what, with the numbers
  std::string effect;  ///< on what is read
  std::string remedy;  ///< what to do about it
};

/// A recording of any format; open_recording() finds out which.
class Recording {
 public:
  Recording() = default;
  virtual ~Recording() = default;
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// What it holds; events name a topic by its place here.
  virtual const std::vector<Topic>& topics() const = 0;

  /// Reads the events from the first on; memory does not grow with the recording. It must outlive
  /// the stream, and may have several.
  virtual std::unique_ptr<EventStream> events(const EventSelection& selection) const = 0;

  /// For people, one line: what was recognised, how much it is, where the times come from.
  virtual std::string description() const = 0;

  /// True where nothing in the recording tells the times and 10 Hz was assumed (description() says
  /// so too).
  virtual bool times_are_assumed() const = 0;

  /// What opening found worth knowing.
  virtual std::vector<RecordingNotice> notices() const { return {}; }

  /// ImuConfig::wait (s) of the run that mapped it as it arrived and recorded it; none: no such
  /// run.
  virtual std::optional<double> recorded_wait() const { return std::nullopt; }
};

/// The topic of sweeps that is named, else the only one that has messages with points, by its first
/// ones. Throws InputError where there is none, or where there are several and none is named.
std::size_t sweep_topic(const Recording& recording, const std::filesystem::path& path,
                        const std::optional<std::string>& name);

/// Opens a recording. Where there is an index, that alone is read.
///
/// - MCAP files (none, LZ4, Zstandard), with ROS 1 or ROS 2 messages.
/// - ROS 1 bags of version 2.0 (none, LZ4, bzip2).
/// - rosbag2 folders and their files (.db3 or .mcap, packed as a whole or message by message),
///   split or not. With metadata.yaml, which may be named instead of its folder, the files that it
///   lists are read; without it all.
/// - Folders of MCAP files or ROS 1 bags that follow each other in time.
/// - Captures of a sensor's packets: see open_packet_capture().
/// - Folders of IMU samples and poses in EuRoC's layout: see open_euroc_folder().
/// - Folders of depth images in TUM RGB-D's layout: see open_tum_folder().
/// - Folders and files of sweeps: see open_sweep_files().
///
/// `metadata` is a file that tells of the sensor, for captures and packets in messages; empty: what
/// lies beside counts. Throws InputError: nothing there or nothing readable in it.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& path,
                                          const std::filesystem::path& metadata = {});

/// Several recordings of messages that follow each other in time, in any order, as one. One path is
/// opened as above. Throws InputError also where their times overlap, or where a topic has several
/// types.
std::unique_ptr<Recording> open_recording(const std::vector<std::filesystem::path>& paths,
                                          const std::filesystem::path& metadata = {});

/// The paths for people: "a.bag, b.bag".
std::string text_of(const std::vector<std::filesystem::path>& paths);

}  // namespace adit
