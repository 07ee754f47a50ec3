// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Recordings with next to nothing in them: topics that were announced and never written to, one
// message each, messages that cannot be decoded, files that were cut off. Every command that reads
// recordings tells what it finds and ends.
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/moving_rig.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/commands/command_convert.hpp"
#include "adit/tools/commands/command_inspect.hpp"
#include "adit/tools/commands/command_run.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::MovingRig;
using test::Recorded;

struct Told {
  int code = 0;
  std::string text;  ///< on both streams
};

class SparseRecordings : public test::DeviceTest {
 protected:
  /// Every topic is announced; of `kept` events the values are written, of the others nothing.
  template <class Kept>
  fs::path write(Kept&& kept) const {
    const MovingRig rig{.tenths = 10, .lidar = {.beams = 12, .columns = 90}};
    McapWriter writer(folder_ / "sparse.mcap", {});
    std::map<std::string, std::size_t> channels;
    for (const Recorded& event : rig.record()) {
      const ros::EncodedEvent message =
          ros::from_event(event.value, Encoding::cdr, event.topic.substr(1));
      if (!channels.contains(event.topic)) {
        channels[event.topic] = writer.add_channel({.topic = event.topic,
                                                    .type = message.type,
                                                    .encoding = Encoding::cdr,
                                                    .definition = {},
                                                    .messages = std::nullopt});
      }
      if (const std::optional<std::vector<std::byte>> bytes = kept(event, message.bytes)) {
        writer.write(channels[event.topic], event.received, *bytes);
      }
    }
    writer.close();
    return folder_ / "sparse.mcap";
  }

  static Told inspect(const fs::path& recording) {
    std::ostringstream out;
    InspectCommandOptions options;
    options.recording = recording;
    options.device.opened = &context();
    const int code = inspect_command(options, out, out);
    return {code, out.str()};
  }
  Told map(const fs::path& recording) const {
    std::ostringstream out;
    RunCommandOptions options;
    options.recording = recording;
    options.output = folder_ / "run";
    options.overwrite = true;
    options.device.opened = &context();
    const int code = run_command(options, out, out);
    return {code, out.str()};
  }
  Told convert(const fs::path& recording) const {
    std::ostringstream out;
    ConvertOptions options;
    options.input = recording;
    options.output = folder_ / "converted.mcap";
    fs::remove(options.output);
    const int code = convert_command(options, out, out);
    return {code, out.str()};
  }

  test::TemporaryFolder folder_;
};

using Bytes = std::optional<std::vector<std::byte>>;

TEST_F(SparseRecordings, ATopicWithoutMessagesIsNoFaultUnlessItIsTheSweeps) {
  for (const std::string silent : {"/imu", "/fix", "/points", "/tf_static"}) {
    const fs::path file = write([&](const Recorded& event, const std::vector<std::byte>& bytes) {
      return event.topic == silent ? Bytes() : Bytes(bytes);
    });
    const bool maps = silent != "/points";
    EXPECT_EQ(inspect(file).code, maps ? 0 : 1) << silent << inspect(file).text;
    EXPECT_EQ(map(file).code, maps ? 0 : 1) << silent << map(file).text;
    EXPECT_EQ(convert(file).code, 0) << silent << convert(file).text;
  }
}

TEST_F(SparseRecordings, NothingAtAllOrOneMessageATopic) {
  const fs::path none = write([](const Recorded&, const auto&) { return Bytes(); });
  EXPECT_EQ(inspect(none).code, 1);
  EXPECT_NE(inspect(none).text.find("/points: it holds no sweep"), std::string::npos)
      << inspect(none).text;
  EXPECT_EQ(map(none).code, 1);
  std::map<std::string, int> seen;
  const fs::path one = write([&](const Recorded& event, const std::vector<std::byte>& bytes) {
    return seen[event.topic]++ == 0 ? Bytes(bytes) : Bytes();
  });
  EXPECT_EQ(inspect(one).code, 0) << inspect(one).text;
  EXPECT_EQ(map(one).code, 0) << map(one).text;
  EXPECT_EQ(convert(one).code, 0) << convert(one).text;
}

TEST_F(SparseRecordings, WhereNoSweepCanBeDecodedThatIsTold) {
  const fs::path file = write([](const Recorded& event, const std::vector<std::byte>& bytes) {
    return Bytes(event.topic == "/points" ? std::vector<std::byte>(bytes.size(), std::byte{0xff})
                                          : bytes);
  });
  const Told inspected = inspect(file);
  EXPECT_EQ(inspected.code, 1);
  EXPECT_NE(inspected.text.find("problem"), std::string::npos) << inspected.text;
  const Told mapped = map(file);
  EXPECT_EQ(mapped.code, 1);
  EXPECT_NE(mapped.text.find("/points"), std::string::npos) << mapped.text;
}

TEST_F(SparseRecordings, SweepsThatARecordingDeclaresAndDoesNotHoldAreCountedAndStrictFails) {
  const fs::path file =
      write([](const Recorded&, const std::vector<std::byte>& bytes) { return Bytes(bytes); });
  fs::create_directories(folder_ / "bag");
  fs::rename(file, folder_ / "bag/drive_0.mcap");
  folder_.write("bag/metadata.yaml",
                "rosbag2_bagfile_information:\n"
                "  relative_file_paths:\n"
                "    - drive_0.mcap\n"
                "    - drive_1.mcap\n"
                "  topics_with_message_count:\n"
                "    - topic_metadata:\n"
                "        name: /points\n"
                "      message_count: 25\n");
  const Told inspected = inspect(folder_ / "bag");
  EXPECT_EQ(inspected.code, 1);
  EXPECT_NE(inspected.text.find("problem: drive_1.mcap: metadata.yaml lists this file"),
            std::string::npos)
      << inspected.text;
  const Told mapped = map(folder_ / "bag");
  EXPECT_EQ(mapped.code, 0) << mapped.text;
  EXPECT_NE(mapped.text.find("sweeps that the recording declares are not in it"), std::string::npos)
      << mapped.text;
  const auto summary = nlohmann::json::parse(std::ifstream(folder_ / "run/summary.json"));
  EXPECT_EQ(summary["left_out"]["sweeps_missing"], 25 - summary["sweeps"]["processed"].get<int>());
  EXPECT_EQ(summary["left_out"]["declarations"].size(), 2U);
  for (const bool strict_input : {false, true}) {
    RunCommandOptions options;
    options.recording = folder_ / "bag";
    options.output = folder_ / (strict_input ? "strict_input" : "strict");
    options.overwrite = true;
    options.device.opened = &context();
    options.strict = !strict_input;
    options.strict_input = strict_input;
    std::ostringstream out;
    EXPECT_EQ(run_command(options, out, out), 1) << out.str();
  }
}

TEST_F(SparseRecordings, AFileThatWasCutOffAnywhereIsInspectedToItsEnd) {
  const fs::path whole =
      write([](const Recorded&, const std::vector<std::byte>& bytes) { return Bytes(bytes); });
  const auto size = fs::file_size(whole);
  for (int twentieths = 19; twentieths >= 0; --twentieths) {
    fs::resize_file(whole, size * static_cast<std::uintmax_t>(twentieths) / 20);
    const Told told = inspect(whole);
    EXPECT_EQ(told.code, 1) << twentieths << told.text;
    EXPECT_FALSE(told.text.empty());
    EXPECT_EQ(convert(whole).code, 1) << twentieths;
  }
}

}  // namespace
}  // namespace adit
