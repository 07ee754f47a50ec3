// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the messages of a topic tell, as events, and events as messages.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/clouds/cloud_columns.hpp"
#include "adit/tools/clouds/depth_camera.hpp"
#include "adit/tools/containers/message_file.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit::ros {

/// What a topic of such messages tells; images tell nothing by themselves: see
/// find_depth_camera(). TFMessage tells of static transforms on a topic named
/// "tf_static" and of poses on others.
TopicKind kind_of(const Channel& channel);

/// What a message tells.
struct MessageEvents {
  std::vector<EventValue> values;
  std::string frame;                           ///< the header's; empty where there are several
  std::optional<PointTimeNature> point_times;  ///< for a sweep with times
  bool has_intensity = true;                   ///< false: those of a sweep's points are made up
  std::vector<std::string> left_out{};         ///< damaged parts, a clause each, for people
  double coordinate_step = 0.0;                ///< of a sweep, as CloudFile::coordinate_step
  std::vector<InputError> faults{};            ///< damage of a sweep that is left out of it
};

/// The events in a message, in its order; none for kinds that are not understood. A message whose
/// header has no time counts as taken when it was received. `reading` is for
/// PointCloud2. Images are sweeps where `camera`, which took them, is
/// given.
///
/// Sweeps from Livox's CustomMsg are without the returns that the sensor marks as noise (bits 4 and
/// 5 of the tag). Throws CodecError or InputError (naming `file` and the point) where the message
/// is damaged.
MessageEvents to_events(const Channel& channel, const RawMessage& message,
                        const std::filesystem::path& file, const CloudReading& reading = {},
                        const DepthCamera* camera = nullptr);

/// The twist of an odometry message, in the axes of its child frame, which is the frame of the
/// result. Throws CodecError where the message is damaged.
MessageEvents to_velocity(const Channel& channel, const RawMessage& message);

/// The reading of an IMU, and the heading that its orientation tells where it has one: that of its
/// x axis in the axes east, north, up. Throws CodecError where the message is damaged.
MessageEvents to_reading_and_heading(const Channel& channel, const RawMessage& message);

/// A message and its type.
struct EncodedEvent {
  std::string type;
  std::vector<std::byte> bytes;
};

/// The event as a message (a heading loses its standard deviation) with the frame `frame` (poses,
/// transforms and most velocities name their own), a sweep with or without the field intensity.
/// Throws CodecError where the encoding cannot hold its time.
EncodedEvent from_event(const EventValue& event, Encoding encoding, const std::string& frame,
                        bool with_intensity = true);

}  // namespace adit::ros
