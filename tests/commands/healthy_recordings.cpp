// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tests/commands/healthy_recordings.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <memory>
#include <span>
#include <utility>

#include "adit/tests/commands/small_room.hpp"
#include "adit/tests/recordings/fuzz_corpus.hpp"
#include "adit/tools/containers/bag_writer.hpp"
#include "adit/tools/containers/compression.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/containers/rosbag2_writer.hpp"
#include "adit/tools/recordings/ros_codec.hpp"

namespace adit::test {
namespace {

namespace fs = std::filesystem;

/// What packs a whole file, as rosbag2 does.
void pack(const fs::path& file) {
  const std::string bytes = content(file);
  const auto packed = compress(Compression::zstd, std::as_bytes(std::span(bytes)));
  write(file.string() + ".zstd", text_of(packed));
  fs::remove(file);
}

}  // namespace

std::vector<Recorded> small_drive() {
  const MovingRig rig{.tenths = kSweeps, .lidar = {.beams = 12, .columns = 72}};
  std::vector<Recorded> events = rig.record();
  for (int i = 0; i < 4 * kSweeps; ++i) {
    const Nanoseconds stamp = at(0.025 * i);
    events.push_back({"/odom", stamp, ReferencePose{stamp, "map", "lidar", rig.pose(0.025 * i)}});
    const Eigen::Vector3d moved =
        rig.pose(0.025 * i + 0.01).translation() - rig.pose(0.025 * i - 0.01).translation();
    events.push_back(
        {"/wheels", stamp,
         BodyVelocity{.stamp = stamp,
                      .linear = rig.pose(0.025 * i).linear().transpose() * moved / 0.02,
                      .covariance = 0.0025 * Eigen::Matrix3d::Identity(),
                      .frame = "lidar"}});
  }
  std::ranges::stable_sort(events, {}, &Recorded::received);
  return events;
}

bool holds_messages(const std::string& format) {
  return format == "bag" || format == "mcap" || format.starts_with("rosbag2");
}

HealthyRecording write_messages(const fs::path& folder, const std::string& format,
                                std::size_t variant, const std::vector<Recorded>& events,
                                const std::function<void(std::string&)>& change) {
  constexpr std::array kOfMcap = {Compression::lz4, Compression::zstd, Compression::none};
  constexpr std::array kOfBag = {Compression::lz4, Compression::bz2, Compression::none};
  HealthyRecording recording{.folder = folder, .opened = "drive." + format, .metadata = {}};
  fs::create_directories(folder);
  std::unique_ptr<MessageWriter> out;
  if (format == "bag") {
    out = std::make_unique<BagWriter>(folder / recording.opened,
                                      BagOptions{.compression = kOfBag[variant % 3]});
  } else if (format == "mcap") {
    out = std::make_unique<McapWriter>(folder / recording.opened,
                                       variant % 4 == 3
                                           ? McapOptions{.chunks = false, .summary = false}
                                           : McapOptions{.compression = kOfMcap[variant % 4]});
  } else {
    recording.opened = "drive";
    out = std::make_unique<Rosbag2Writer>(folder / "drive",
                                          Rosbag2Options{.pack_messages = variant % 3 == 1});
  }
  const Encoding encoding = format == "bag" ? Encoding::ros1 : Encoding::cdr;
  std::map<std::string, std::size_t> channels;
  std::unique_ptr<McapWriter> storage;
  std::vector<std::pair<MessageWriter*, std::map<std::string, std::size_t>*>> writers;
  std::map<std::string, std::size_t> storage_channels;
  writers.emplace_back(out.get(), &channels);
  if (format == "rosbag2_mcap") {
    storage =
        std::make_unique<McapWriter>(folder / "drive/drive_0.mcap", McapOptions{.profile = "ros2"});
    writers.emplace_back(storage.get(), &storage_channels);
  }
  for (const Recorded& event : events) {
    ros::EncodedEvent message;
    try {
      const std::string frame = event.topic == "/points" ? "lidar" : event.topic.substr(1);
      message = ros::from_event(event.value, encoding, frame);
    } catch (const ros::CodecError&) {
      continue;  // a time that a message cannot hold
    }
    std::string bytes = text_of(message.bytes);
    if (change) {
      change(bytes);
    }
    for (auto& [writer, known] : writers) {
      if (!known->contains(event.topic)) {
        (*known)[event.topic] = writer->add_channel({.topic = event.topic,
                                                     .type = message.type,
                                                     .encoding = encoding,
                                                     .definition = {},
                                                     .messages = std::nullopt});
      }
      writer->write((*known)[event.topic], event.received, std::as_bytes(std::span(bytes)));
    }
  }
  out->close();
  if (storage) {  // the same metadata, but for the storage
    storage->close();
    fs::remove(folder / "drive/drive_0.db3");
    std::string metadata = content(folder / "drive/metadata.yaml");
    const auto replace = [&](const std::string& from, const std::string& to) {
      for (std::size_t found = metadata.find(from); found != metadata.npos;
           found = metadata.find(from, found + to.size())) {
        metadata.replace(found, from.size(), to);
      }
    };
    replace("sqlite3", "mcap");
    replace(".db3", ".mcap");
    write(folder / "drive/metadata.yaml", metadata);
  }
  if (format.starts_with("rosbag2") && variant % 3 == 2) {
    pack(folder / (storage ? "drive/drive_0.mcap" : "drive/drive_0.db3"));
  }
  return recording;
}

std::vector<HealthyFormat> write_healthy_recordings(const fs::path& folder,
                                                    const std::vector<Recorded>& events) {
  std::vector<HealthyFormat> formats;
  std::vector<Recorded> grouped = events;
  std::ranges::stable_sort(grouped, {}, &Recorded::topic);
  for (const char* name : {"bag", "mcap", "rosbag2", "rosbag2_mcap"}) {
    HealthyFormat format{.name = name, .recordings = {}};
    for (std::size_t variant = 0; variant < 5; ++variant) {
      const fs::path here = folder / (name + std::to_string(variant));
      format.recordings.push_back(
          write_messages(here, name, variant, variant == 4 ? grouped : events));
    }
    formats.push_back(std::move(format));
  }
  std::ranges::move(write_healthy_captures(folder), std::back_inserter(formats));
  std::ranges::move(write_healthy_folders(folder), std::back_inserter(formats));
  // Small files of every kind of message, of times and of compression.
  for (const FuzzSeed& seed : fuzz_corpus()) {
    const std::string suffix = seed.format == "rosbag2" ? "db3" : seed.format;
    const std::string name = suffix.starts_with("pcap") ? "velodyne" : seed.format;
    const auto format = std::ranges::find(formats, name, &HealthyFormat::name);
    if (format != formats.end() && (seed.fuzzer == "containers" || seed.fuzzer == "clouds")) {
      const fs::path here = folder / (seed.format + "_" + seed.name);
      write(here / ("file." + suffix), seed.bytes);
      format->recordings.push_back({.folder = here, .opened = "file." + suffix, .metadata = {}});
    }
  }
  return formats;
}

}  // namespace adit::test
