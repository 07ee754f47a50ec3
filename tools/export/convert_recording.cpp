// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/convert_recording.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <memory>
#include <utility>

#include "adit/tools/containers/bag_writer.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/containers/ros_definitions.hpp"
#include "adit/tools/containers/rosbag2_metadata.hpp"
#include "adit/tools/containers/rosbag2_reader.hpp"
#include "adit/tools/containers/rosbag2_writer.hpp"
#include "adit/tools/export/recording_converter.hpp"
#include "adit/tools/recordings/message_recording.hpp"
#include "adit/tools/recordings/packet_messages.hpp"
#include "adit/tools/recordings/ros_codec.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/recordings/ros_transcode.hpp"
#include "adit/tools/recordings/tolerant_recording.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/setup/configured_recording.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

enum class Format { mcap, bag, rosbag2 };

/// By the name's suffix. A folder has none, or says that it is one by a slash at its end, or is
/// there already. Throws UsageError for other suffixes.
Format format_of(const fs::path& output) {
  std::string suffix = output.extension().string();
  std::ranges::transform(suffix, suffix.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::error_code ignored;
  if (suffix == ".mcap") {
    return Format::mcap;
  }
  if (suffix == ".bag") {
    return Format::bag;
  }
  if (suffix.empty() || fs::is_directory(output, ignored)) {
    return Format::rosbag2;
  }
  const std::string name = output.string();
  throw UsageError(name + ": no format ends in " + suffix +
                   ". Write NAME.mcap, NAME.bag, or a rosbag2 folder: " +
                   output.parent_path().append(output.stem().string()).string() + ", or " + name +
                   "/ for a folder of that name.");
}

/// The one encoding that the format holds; nothing where it holds all.
std::optional<Encoding> encoding_of(Format format) {
  switch (format) {
    case Format::bag:
      return Encoding::ros1;
    case Format::rosbag2:
      return Encoding::cdr;
    case Format::mcap:
      break;
  }
  return std::nullopt;
}

/// The profile of an MCAP file: that of all messages, where they have one in common.
std::string profile_of(const ConvertOptions& options,
                       const std::vector<std::unique_ptr<MessageFile>>& files) {
  std::optional<Encoding> common = options.encoding;
  if (!common && files.empty()) {
    common = Encoding::cdr;
  }
  if (!common) {
    for (const auto& file : files) {
      for (const Channel& channel : file->channels()) {
        if (common && common != channel.encoding) {
          return {};
        }
        common = channel.encoding;
      }
    }
  }
  return common == Encoding::cdr ? "ros2" : common == Encoding::ros1 ? "ros1" : "";
}

/// The ROS distribution that the recording was made with, as far as it tells.
std::string ros_distro_of(const fs::path& input,
                          const std::vector<std::unique_ptr<MessageFile>>& files) {
  for (const auto& file : files) {
    if (std::string distro = file->ros_distro(); !distro.empty()) {
      return distro;
    }
  }
  std::error_code ignored;
  std::string distro =
      told_ros_distro(fs::is_directory(input, ignored) ? input : input.parent_path());
  return distro.empty() ? "unknown" : distro;
}

std::unique_ptr<MessageWriter> make_writer(const ConvertOptions& options,
                                           const std::vector<std::unique_ptr<MessageFile>>& files) {
  const Format format = format_of(options.output);
  const auto compression = [&](Compression usual, Compression not_in_it) {
    const Compression chosen = options.compression.value_or(usual);
    if (chosen == not_in_it) {
      throw UsageError("--compression " + std::string(to_string(chosen)) + ": " +
                       options.output.filename().string() + " cannot hold it.");
    }
    return chosen;
  };
  if (format == Format::mcap) {
    return std::make_unique<McapWriter>(
        options.output, McapOptions{.compression = compression(Compression::zstd, Compression::bz2),
                                    .profile = profile_of(options, files)});
  }
  if (format == Format::bag) {
    return std::make_unique<BagWriter>(
        options.output,
        BagOptions{.compression = compression(Compression::lz4, Compression::zstd)});
  }
  const Compression chosen = compression(Compression::none, Compression::bz2);
  if (chosen == Compression::lz4) {
    throw UsageError("--compression lz4: rosbag2's SQLite storage knows none and zstd.");
  }
  return std::make_unique<Rosbag2Writer>(
      options.output,
      Rosbag2Options{.pack_messages = chosen == Compression::zstd,
                     .ros_distro = ros_distro_of(without_metadata_file(options.input), files)});
}

/// Throws UsageError for times that cut nothing out.
void check_times(const ConvertOptions& options) {
  constexpr double kMost = 1e9;  // s, 31 years
  for (const auto& [name, time] :
       {std::pair{"--begin", options.begin_s}, std::pair{"--end", options.end_s}}) {
    if (time && !(*time >= 0.0 && *time <= kMost)) {
      throw UsageError(std::string(name) +
                       ": must be seconds after the first message, between 0 and 1e9.");
    }
  }
  if (options.begin_s && options.end_s && *options.begin_s > *options.end_s) {
    throw UsageError("--begin is after --end: nothing lies between them.");
  }
}

/// The part to keep, from what the options say in seconds after the first message. Throws
/// UsageError where it begins behind the last.
TimeSpan chosen_span(const ConvertOptions& options, const std::optional<TimeSpan>& known) {
  const TimeSpan all = known.value_or(TimeSpan{});
  const auto after = [&](double seconds) {
    const Nanoseconds by = to_nanoseconds(seconds).value();
    return all.begin > Nanoseconds::max() - by ? Nanoseconds::max() : all.begin + by;
  };
  TimeSpan span{Nanoseconds::min(), Nanoseconds::max()};
  if (options.begin_s) {
    span.begin = after(*options.begin_s);
    if (known && span.begin > all.end) {
      const std::chrono::duration<double> length = all.end - all.begin;
      throw UsageError("--begin: the recording ends " + std::to_string(length.count()) +
                       " s after its first message; nothing lies behind.");
    }
  }
  if (options.end_s) {
    span.end = after(*options.end_s);
  }
  return span;
}

/// From the first event on; where the last is, is not known before all are read.
std::optional<TimeSpan> span_of(const Recording& recording) {
  const auto whole = pass_over_damage(recording, [](const InputError&) {});
  const auto first = whole->events({})->next();
  return first ? std::optional(TimeSpan{first->received, Nanoseconds::max()}) : std::nullopt;
}

/// Removes the recording in a folder: its containers and metadata.yaml. Other files stay, and the
/// writer refuses them.
void remove_rosbag2(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return;
  }
  std::vector<fs::path> files = container_files(folder);
  files.push_back(folder / "metadata.yaml");
  for (const fs::path& file : files) {
    if (!fs::remove(file, error) && error) {
      throw OutputError(file, file.string() + ": it cannot be removed: " + error.message());
    }
  }
}

void require_topics(const ConvertOptions& options, const std::vector<std::string>& names) {
  for (const std::string& topic : options.topics) {
    if (std::ranges::count(names, topic) == 0) {
      throw UsageError("--topic " + topic + ": the recording has no such topic. " +
                       suggestion(topic, names) + ".");
    }
  }
}

}  // namespace

std::vector<fs::path> inputs_of(const ConvertOptions& options) {
  std::vector<fs::path> all = {options.input};
  all.insert(all.end(), options.further_inputs.begin(), options.further_inputs.end());
  return all;
}

void require_free_output(const ConvertOptions& options) {
  std::error_code unknown;
  const fs::path& output = options.output;
  const bool is_folder = fs::is_directory(output, unknown);
  for (const fs::path& input : inputs_of(options)) {
    if (is_folder && is_within(input, output)) {
      throw UsageError(output.string() + ": it holds " + input.string() +
                       ", which is read. Name another folder.");
    }
  }
  const bool there = is_folder ? !fs::is_empty(output, unknown) : fs::exists(output, unknown);
  if (there && !options.overwrite) {
    throw UsageError(output.string() +
                     " is there already, and is not replaced. Name another one, or give "
                     "--overwrite.");
  }
}

ConvertReport convert_recording(const ConvertOptions& options) {
  const std::optional<Encoding> only = encoding_of(format_of(options.output));
  if (options.encoding && only && options.encoding != only) {
    throw UsageError("--ros: " + options.output.filename().string() + " holds " +
                     (only == Encoding::ros1 ? "ROS 1" : "ROS 2") + " messages alone.");
  }
  check_times(options);
  const bool cut = options.begin_s || options.end_s;
  const auto files = open_message_files(inputs_of(options));
  std::unique_ptr<Recording> sweeps;
  std::vector<std::string> names;
  std::optional<TimeSpan> all;
  if (files.empty()) {
    sweeps = open_recording(options.input,
                            options.repair.value_or(RecordingConfig{.metadata = options.metadata}));
    std::ranges::transform(sweeps->topics(), std::back_inserter(names), event_topic);
    all = cut ? span_of(*sweeps) : std::nullopt;
  }
  for (const auto& file : files) {
    for (const Channel& channel : file->channels()) {
      names.push_back(channel.topic);
    }
    if (const std::optional<TimeSpan> span = file->span()) {
      all = {std::min(all.value_or(*span).begin, span->begin),
             std::max(all.value_or(*span).end, span->end)};
    }
  }
  if (options.metadata && (!files.empty() || !holds_packets(options.input))) {
    throw UsageError("--metadata: it is for captures of a sensor's packets, and " +
                     options.input.string() + " is none; leave it out.");
  }
  require_topics(options, names);
  const TimeSpan span = chosen_span(options, all);
  require_free_output(options);
  if (options.overwrite) {
    remove_rosbag2(options.output);
  }
  const std::unique_ptr<MessageWriter> writer = make_writer(options, files);
  RecordingConverter converter({.topics = options.topics,
                                .encoding = options.encoding ? options.encoding : only,
                                .repair = options.repair},
                               *writer);
  if (options.begin_s) {
    converter.copy_latched(files, span.begin);
    if (sweeps) {
      converter.copy_latched(*sweeps, span.begin);
    }
  }
  for (const auto& file : files) {
    converter.copy(*file, span);
  }
  if (sweeps) {
    converter.copy(*sweeps, span);
  }
  writer->close();
  ConvertReport report = std::move(converter).take();
  if (cut && report.messages() == 0 && report.error_count == 0) {
    throw UsageError("--begin, --end: no message was received between them; " +
                     options.output.string() + " is empty.");
  }
  return report;
}

}  // namespace adit
