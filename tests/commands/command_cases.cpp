// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tests/commands/command_cases.hpp"

#include <array>
#include <cctype>
#include <ctime>
#include <fstream>
#include <memory>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "adit/tools/commands/command_convert.hpp"
#include "adit/tools/commands/command_evaluate.hpp"
#include "adit/tools/commands/command_inspect.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/containers/bag_writer.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/containers/rosbag2_writer.hpp"
#include "adit/tools/recordings/ros_codec.hpp"
#include "adit/tools/recordings/ros_events.hpp"

namespace adit::test {
namespace {

namespace fs = std::filesystem;

// Healthy input takes a tenth of a second of the processor; a command that takes this much is held
// up by something that the input made up.
constexpr double kMostSeconds = 30.0;

double processor_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write(const fs::path& file, const std::string& bytes) {
  fs::create_directories(file.parent_path());
  std::ofstream stream(file, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream.flush()) {
    throw std::runtime_error("cannot write " + file.string());
  }
}

/// Sweeps, readings, fixes and mountings of some tenths of a second, few points a sweep.
std::vector<Recorded> small_drive() {
  return MovingRig{.tenths = 8, .lidar = {.beams = 12, .columns = 72}}.record();
}

std::unique_ptr<MessageWriter> writer(const fs::path& folder, fs::path& file, std::size_t kind) {
  switch (kind) {
    case 0:
      file = folder / "drive.bag";
      return std::make_unique<BagWriter>(file, BagOptions{});
    case 1:
      file = folder / "drive";
      return std::make_unique<Rosbag2Writer>(file, Rosbag2Options{});
    case 2:
      file = folder / "drive.mcap";
      return std::make_unique<McapWriter>(file, McapOptions{.compression = Compression::lz4});
    default:
      file = folder / "drive.mcap";
      return std::make_unique<McapWriter>(file, McapOptions{.chunks = false, .summary = false});
  }
}

/// Writes the events; with dice, the bytes of some messages are damaged.
fs::path record(const std::vector<Recorded>& events, const fs::path& folder, std::size_t kind,
                Dice* dice) {
  fs::path file;
  const std::unique_ptr<MessageWriter> out = writer(folder, file, kind);
  const Encoding encoding = kind == 0 ? Encoding::ros1 : Encoding::cdr;
  std::map<std::string, std::size_t> channels;
  for (const Recorded& event : events) {
    ros::EncodedEvent message;
    try {
      const std::string frame = event.topic == "/points" ? "lidar" : event.topic.substr(1);
      message = ros::from_event(event.value, encoding, frame);
    } catch (const ros::CodecError&) {
      continue;  // a time that a message cannot hold
    }
    if (!channels.contains(event.topic)) {
      channels[event.topic] = out->add_channel({.topic = event.topic,
                                                .type = message.type,
                                                .encoding = encoding,
                                                .definition = {},
                                                .messages = std::nullopt});
    }
    if (dice != nullptr && dice->one_in(20)) {
      std::string bytes(reinterpret_cast<const char*>(message.bytes.data()), message.bytes.size());
      damage_bytes(bytes, *dice);
      const auto* begin = reinterpret_cast<const std::byte*>(bytes.data());
      message.bytes.assign(begin, begin + bytes.size());
    }
    out->write(channels[event.topic], event.received, message.bytes);
  }
  out->close();
  return file;
}

/// The first number in it that is none; empty where all are. What is quoted is the input's.
std::string no_number(const std::string& told) {
  static const std::regex kQuoted("'[^'\n]*'");
  const std::string text = std::regex_replace(told, kQuoted, "''");
  static const std::regex kNone("(^|[^A-Za-z_/.])-?(nan|inf)([^A-Za-z_/.]|$)");
  std::smatch found;
  if (!std::regex_search(text, found, kNone)) {
    return {};
  }
  const auto at = static_cast<std::size_t>(found.position());
  return text.substr(at < 80 ? 0 : at - 80, 160);
}

}  // namespace

std::string_view to_string(FuzzedCommand command) {
  constexpr std::array<std::string_view, 4> kNames = {"inspect", "run", "convert", "evaluate"};
  return kNames[static_cast<std::size_t>(command)];
}

CommandCases::CommandCases(engine::Context& context)
    : context_(&context), events_(small_drive()), run_(folder_ / "run") {
  for (FuzzSeed& seed : fuzz_corpus()) {
    if (seed.fuzzer == "containers" || seed.fuzzer == "clouds") {
      files_.push_back(std::move(seed));
    }
  }
  std::ostringstream told;
  RunCommandOptions options;
  options.recording = record(events_, folder_.path(), 3, nullptr);
  options.output = run_;
  options.device.opened = context_;
  if (run_command(options, told, told) != 0) {
    throw std::runtime_error("the healthy recording could not be mapped: " + told.str());
  }
  const std::unique_ptr<Recording> recording = open_recording(options.recording);
  const auto events = recording->events({});
  int sweeps = 0;
  while (const std::optional<Event> event = events->next()) {
    if (const auto* sweep = std::get_if<Sweep>(&event->value)) {
      const std::string name = "sweeps/velodyne/00000" + std::to_string(sweeps++) + ".bin";
      write(folder_ / name, std::string(reinterpret_cast<const char*>(sweep->points.data()),
                                        sweep->points.size() * sizeof(Point)));
    }
  }
  std::string times;
  for (int i = 0; i < sweeps; ++i) {
    times += std::to_string(0.1 * i) + "\n";
  }
  write(folder_ / "sweeps/times.txt", times);
}

fs::path CommandCases::damaged_messages(const fs::path& folder, Dice& dice) const {
  std::vector<Recorded> events = events_;
  const bool in_fields = !dice.one_in(3);
  if (in_fields) {
    damage_events(events, dice);
  }
  return record(events, folder, dice.below(4), in_fields ? nullptr : &dice);
}

fs::path CommandCases::damaged_folder(const fs::path& folder, Dice& dice) const {
  const fs::path copy = folder / "sweeps";
  fs::copy(folder_ / "sweeps", copy, fs::copy_options::recursive);
  if (dice.one_in(3)) {
    std::string times = content(copy / "times.txt");
    damage_text(times, dice);
    write(copy / "times.txt", times);
  }
  for (std::size_t i = dice.below(4); i > 0; --i) {
    const fs::path file = copy / "velodyne" / ("00000" + std::to_string(dice.below(8)) + ".bin");
    std::string bytes = content(file);
    damage_bytes(bytes, dice);
    write(file, bytes);
  }
  return copy;
}

fs::path CommandCases::damaged_recording(const fs::path& folder, Dice& dice) const {
  const std::size_t kind = dice.below(10);
  if (kind < 5) {
    return damaged_messages(folder, dice);
  }
  if (kind < 6) {
    return damaged_folder(folder, dice);
  }
  // The bytes of a whole file: of the drive, or of a small one of any format.
  if (kind < 8) {
    const fs::path file = record(events_, folder, dice.one_in(2) ? 0 : 3, nullptr);
    std::string bytes = content(file);
    damage_bytes(bytes, dice);
    write(file, bytes);
    return file;
  }
  const FuzzSeed& seed = files_[dice.below(files_.size())];
  std::string bytes = seed.bytes;
  damage_bytes(bytes, dice);
  const fs::path file = folder / ("file." + (seed.format == "rosbag2" ? "db3" : seed.format));
  write(file, bytes);
  return file;
}

int CommandCases::evaluate(const fs::path& folder, Dice& dice, std::ostream& told) const {
  const fs::path copy = folder / "run";
  fs::copy(run_, copy, fs::copy_options::recursive);
  const std::array<const char*, 4> names = {"sweeps.csv", "trajectory.tum", "trajectory.kitti",
                                            "summary.json"};
  const fs::path damaged = copy / names[dice.below(names.size())];
  std::string text = content(damaged);
  damage_text(text, dice);
  write(damaged, text);

  EvaluateCommandOptions options;
  options.json = dice.one_in(2);
  options.evaluation.tolerance = 0.06;
  switch (dice.below(3)) {
    case 0:
      options.estimates = {copy};
      options.truth = run_ / "trajectory.tum";
      break;
    case 1:
      options.estimates = {copy};
      break;
    default:
      options.estimates = {damaged};
      options.truth = run_ / "trajectory.tum";
      options.plot = folder / "plot.svg";
      if (dice.one_in(2)) {
        std::swap(options.estimates.front(), options.truth);
      }
  }
  return evaluate_command(options, told, told);
}

int CommandCases::call(FuzzedCommand command, const fs::path& folder, Dice& dice,
                       std::ostream& told) const {
  if (command == FuzzedCommand::evaluate) {
    return evaluate(folder, dice, told);
  }
  const fs::path recording = damaged_recording(folder, dice);
  if (command == FuzzedCommand::convert) {
    const std::array<const char*, 3> names = {"out.mcap", "out.bag", "out"};
    ConvertOptions options;
    options.input = recording;
    options.output = folder / names[dice.below(names.size())];
    options.repair = dice.one_in(2) ? std::optional(RecordingConfig{}) : std::nullopt;
    return convert_command(options, told, told);
  }
  if (command == FuzzedCommand::inspect) {
    InspectCommandOptions options;
    options.recording = recording;
    options.device.opened = context_;
    options.json = dice.one_in(2);
    options.html = folder / "page.html";
    options.write_config = folder / "written.toml";
    return inspect_command(options, told, told);
  }
  RunCommandOptions options;
  options.recording = recording;
  options.output = folder / "out";
  options.device.opened = context_;
  options.high_rate.enabled = dice.one_in(2);
  options.json = dice.one_in(2);
  return run_command(options, told, told);
}

CommandOutcome CommandCases::run(FuzzedCommand command, uint64_t number) const {
  Dice dice(4 * number + static_cast<uint64_t>(command));
  const TemporaryFolder folder;
  std::ostringstream told;
  CommandOutcome outcome;
  const double before = processor_seconds();
  outcome.code = call(command, folder.path(), dice, told);
  const double taken = processor_seconds() - before;
  outcome.told = told.str();
  if (outcome.code < 0 || outcome.code > 2) {
    outcome.complaint = "it ended with " + std::to_string(outcome.code);
  } else if (taken > kMostSeconds) {
    outcome.complaint = "it took " + std::to_string(taken) + " s of the processor";
  } else if (outcome.told.empty()) {
    outcome.complaint = "it said nothing";
  } else if (const std::string found = no_number(outcome.told); !found.empty()) {
    outcome.complaint = "it says: " + found;
  }
  for (const char* name : {"trajectory.tum", "trajectory.kitti", "sweeps.csv", "summary.json",
                           "odometry_highrate.tum", "odometry_highrate.csv"}) {
    const std::string found = no_number(content(folder / (std::string("out/") + name)));
    if (command == FuzzedCommand::run && !found.empty()) {
      outcome.complaint = std::string(name) + " has: " + found;
    }
  }
  return outcome;
}

}  // namespace adit::test
