// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Small recordings whose messages are written in an order of the test's choice.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "adit/tests/recordings/container_support.hpp"
#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/bag_writer.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/containers/rosbag2_writer.hpp"

namespace adit::test {

/// What is written to and read from: MCAP with and without chunks or a summary, a bag, rosbag2.
enum class Container { mcap, mcap_one_chunk, mcap_no_summary, mcap_no_chunks, bag, rosbag2 };
inline constexpr std::array kContainers = {Container::mcap,
                                           Container::mcap_one_chunk,
                                           Container::mcap_no_summary,
                                           Container::mcap_no_chunks,
                                           Container::bag,
                                           Container::rosbag2};

inline Encoding encoding_of(Container container) {
  return container == Container::bag ? Encoding::ros1 : Encoding::cdr;
}

/// Writes the messages, of sample_channels(), in the order in which they are given. Returns the
/// recording.
inline std::filesystem::path write_messages(const TemporaryFolder& folder, const std::string& name,
                                            Container container,
                                            const std::vector<SampleMessage>& messages) {
  const bool is_bag = container == Container::bag;
  const std::filesystem::path path = folder / (name + (container == Container::rosbag2 ? ""
                                                       : is_bag                        ? ".bag"
                                                                                       : ".mcap"));
  std::filesystem::create_directories(path.parent_path());
  std::unique_ptr<MessageWriter> writer;
  if (is_bag) {
    writer = std::make_unique<BagWriter>(
        path, BagOptions{.compression = Compression::lz4, .chunk_bytes = 400});
  } else if (container == Container::rosbag2) {
    writer = std::make_unique<Rosbag2Writer>(path, Rosbag2Options{});
  } else {
    writer = std::make_unique<McapWriter>(
        path, McapOptions{.chunks = container != Container::mcap_no_chunks,
                          .chunk_bytes = container == Container::mcap_one_chunk ? 1U << 20U : 400U,
                          .summary = container != Container::mcap_no_summary &&
                                     container != Container::mcap_no_chunks});
  }
  std::vector<std::size_t> ids;
  for (const Channel& channel : sample_channels(encoding_of(container))) {
    ids.push_back(writer->add_channel(channel));
  }
  for (const SampleMessage& message : messages) {
    writer->write(ids[message.channel], message.received, message.bytes);
  }
  writer->close();
  return path;
}

/// Twenty rounds of clouds, IMU samples and fixes and whatever else is in sample_messages(), sorted
/// by topic: all clouds first.
inline std::vector<SampleMessage> grouped_messages(Encoding encoding, uint32_t rounds = 20) {
  std::vector<SampleMessage> messages = sample_messages(encoding, rounds);
  std::ranges::stable_sort(messages, {}, &SampleMessage::channel);
  return messages;
}

/// The recording in a file with a byte of a chunk changed so that fewer events can be read.
inline std::filesystem::path damage_a_chunk(const TemporaryFolder& folder,
                                            const std::filesystem::path& file) {
  const std::string bytes = content_of(file);
  const std::size_t whole = read_all(*open_recording(file)).events.size();
  std::filesystem::path damaged;
  for (std::size_t at = bytes.size() / 3; at < bytes.size(); at += 13) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(~changed[at]);
    damaged = folder.write("damaged" + file.extension().string(), changed);
    if (read_all(*open_recording(damaged)).events.size() < whole) {
      break;
    }
  }
  return damaged;
}

/// Largest time (ns) by which an event's own time is before that of one that precedes it.
inline Nanoseconds largest_step_back(const std::vector<Event>& events) {
  Nanoseconds newest = Nanoseconds::min();
  Nanoseconds largest{0};
  for (const Event& event : events) {
    if (!std::holds_alternative<StaticTransform>(event.value)) {
      newest = std::max(newest, stamp_of(event));
      largest = std::max(largest, newest - stamp_of(event));
    }
  }
  return largest;
}

}  // namespace adit::test
