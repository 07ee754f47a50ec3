// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit run` from a folder of sweeps to the files it writes, on the device that the environment
// gives.
#include "adit/tools/commands/command_run.hpp"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>

#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/environment.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/evaluation/evaluate.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kRunSweeps = 8;

/// The recording is simulated once for all tests.
class RunCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    data_ = new test::TemporaryFolder();
    small_recording(data_->path());
  }
  static void TearDownTestSuite() {
    delete data_;
    data_ = nullptr;
  }

  static test::SmallRecording small_recording(const fs::path& folder) {
    return test::small_recording(folder, kRunSweeps);
  }

  RunCommandOptions options() const {
    RunCommandOptions options;
    options.recording = test::SmallRecording(data_->path()).recording;
    options.output = out_ / "out";
    options.overwrite = true;
    options.config.overrides = {"preprocess.beam_spacing=0.03"};
    return options;
  }

  int run(const RunCommandOptions& options) {
    printed_.str("");
    said_.str("");
    return run_command(options, printed_, said_);
  }

  nlohmann::json summary() const { return test::json_of(out_ / "out/summary.json"); }

  static inline test::TemporaryFolder* data_ = nullptr;
  test::TemporaryFolder out_;
  std::ostringstream printed_;
  std::ostringstream said_;
};

/// The recording as an MCAP file, the bytes of message i as `spoil` leaves them.
fs::path write_mcap(const fs::path& folder, const fs::path& file,
                    const std::function<void(std::size_t, std::vector<std::byte>&)>& spoil = {}) {
  McapWriter writer(file, {});
  const std::size_t channel = writer.add_channel({.topic = "/points",
                                                  .type = "sensor_msgs/PointCloud2",
                                                  .encoding = Encoding::cdr,
                                                  .definition = {},
                                                  .messages = std::nullopt});
  const auto recording = open_recording(folder);
  const auto events = recording->events({});
  for (std::size_t i = 0; const std::optional<Event> event = events->next(); ++i) {
    ros::EncodedEvent message = ros::from_event(event->value, Encoding::cdr, "lidar");
    if (spoil) {
      spoil(i, message.bytes);
    }
    writer.write(channel, event->received, message.bytes);
  }
  writer.close();
  return file;
}

/// Ends the run as Ctrl-C does, as soon as it says these words.
class StopsAt : public std::stringbuf {
 public:
  explicit StopsAt(std::string words) : words_(std::move(words)) {}

 protected:
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    const std::streamsize written = std::stringbuf::xsputn(text, count);
    if (!raised_ && str().find(words_) != std::string::npos) {
      raised_ = true;
      std::raise(SIGINT);
    }
    return written;
  }

 private:
  std::string words_;
  bool raised_ = false;
};

TEST_F(RunCommand, AFirstStartSaysThatKernelsAreCompiledAndLaterOnesRelyOnIt) {
  const test::Variable cache("XDG_CACHE_HOME", (out_ / "cache").string());
  const std::string words = "compiling kernels for";
  StopsAt stops(words);
  std::ostream said(&stops);
  EXPECT_EQ(run_command(options(), printed_, said), 128 + SIGINT) << stops.str();
  EXPECT_NE(stops.str().find("stopped by a signal while kernels were compiled"), std::string::npos)
      << stops.str();
  EXPECT_FALSE(fs::exists(options().output / "summary.json"));
  fs::remove_all(out_ / "cache" / "adit");
  EXPECT_EQ(run(options()), 0) << said_.str();
  EXPECT_NE(said_.str().find(words), std::string::npos) << said_.str();
  const std::string first = test::content(out_ / "out/trajectory.tum");
  EXPECT_GT(summary()["time"]["start_s"], 0.0);
  EXPECT_EQ(run(options()), 0) << said_.str();
  EXPECT_EQ(said_.str().find(words), std::string::npos) << said_.str();
  EXPECT_EQ(test::content(out_ / "out/trajectory.tum"), first);
}

TEST_F(RunCommand, McapGivesTheSameBytesAsTheFolder) {
  RunCommandOptions from = options();
  EXPECT_EQ(run(from), 0) << said_.str();
  const std::string trajectory = test::content(from.output / "trajectory.tum");
  const std::string map = test::content(from.output / "map.ply");
  from.recording = write_mcap(from.recording, out_ / "drive.mcap");
  from.output = out_ / "from_mcap";
  EXPECT_EQ(run(from), 0) << said_.str();
  EXPECT_EQ(test::content(from.output / "trajectory.tum"), trajectory);
  EXPECT_EQ(test::content(from.output / "map.ply"), map);
}

TEST_F(RunCommand, McapThatWasCutOffIsMappedUpToThereAndSaysSo) {
  RunCommandOptions from = options();
  const fs::path file = write_mcap(from.recording, out_ / "drive.mcap");
  fs::resize_file(file, fs::file_size(file) / 2);
  from.recording = file;
  EXPECT_EQ(run(from), 0) << said_.str();
  EXPECT_NE(said_.str().find("its recorder was killed"), std::string::npos) << said_.str();
  EXPECT_NE(said_.str().find("left out: 1 damaged place in the recording"), std::string::npos);
  EXPECT_EQ(summary()["status"], "completed");
  EXPECT_EQ(summary()["left_out"]["damaged_places"], 1);
  const std::size_t placed = test::lines(out_ / "out/trajectory.tum");
  EXPECT_GT(placed, 0U);
  EXPECT_LT(placed, kRunSweeps);
  from.strict_input = true;
  EXPECT_EQ(run(from), 1);
  EXPECT_NE(said_.str().find("its recorder was killed"), std::string::npos) << said_.str();
  EXPECT_EQ(summary()["status"], "input_error");
  EXPECT_EQ(test::lines(out_ / "out/trajectory.tum"), placed);
}

TEST_F(RunCommand, DamagedMessagesAreLeftOutCountedAndTold) {
  RunCommandOptions from = options();
  from.recording = write_mcap(from.recording, out_ / "drive.mcap",
                              [](std::size_t i, std::vector<std::byte>& bytes) {
                                if (i == 1 || i == 5) {
                                  bytes.resize(bytes.size() / 2);
                                }
                              });
  EXPECT_EQ(run(from), 0) << said_.str();
  EXPECT_NE(said_.str().find("left out: 2 damaged places"), std::string::npos) << said_.str();
  EXPECT_NE(said_.str().find("message 5 of /points"), std::string::npos) << said_.str();
  EXPECT_NE(printed_.str().find("left out 2 damaged places"), std::string::npos) << printed_.str();
  EXPECT_EQ(summary()["status"], "completed");
  EXPECT_EQ(summary()["left_out"]["damaged_places"], 2);
  EXPECT_EQ(summary()["left_out"]["damage"].size(), 2U);
  EXPECT_EQ(test::lines(out_ / "out/trajectory.tum"), kRunSweeps - 2);
  const std::string table = test::content(out_ / "out/sweeps.csv");
  EXPECT_EQ(table.find("\n5,"), std::string::npos) << "sweeps keep their number";
  EXPECT_NE(table.find("\n6,"), std::string::npos);
  from.strict_input = true;
  EXPECT_EQ(run(from), 1);
  EXPECT_EQ(summary()["status"], "input_error");
  EXPECT_EQ(test::lines(out_ / "out/trajectory.tum"), 1U);
}

TEST_F(RunCommand, RecordingOfDamageAloneSaysSo) {
  RunCommandOptions from = options();
  from.recording = write_mcap(from.recording, out_ / "drive.mcap",
                              [](std::size_t, std::vector<std::byte>& bytes) { bytes.resize(20); });
  EXPECT_EQ(run(from), 1);
  EXPECT_NE(said_.str().find("not one sweep could be read"), std::string::npos) << said_.str();
  EXPECT_NE(said_.str().find("message 0 of /points"), std::string::npos) << said_.str();
}

TEST_F(RunCommand, OneBadPcdHeaderDoesNotEndAFolder) {
  const std::string rows = "1 2 3\n4 5 6\n7 8 9\n";
  const auto header = [](const char* width) {
    return "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
           std::string(width) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n";
  };
  for (int i = 0; i < 5; ++i) {
    out_.write("clouds/" + std::to_string(i) + ".pcd", header(i == 2 ? "many" : "3") + rows);
  }
  RunCommandOptions from = options();
  from.recording = out_ / "clouds";
  run(from);
  EXPECT_NE(said_.str().find("2.pcd"), std::string::npos) << said_.str();
  EXPECT_EQ(summary()["status"], "completed");
  EXPECT_EQ(summary()["left_out"]["damaged_places"], 1);
  EXPECT_EQ(summary()["sweeps"]["processed"], 4);
}

TEST_F(RunCommand, McapWithoutAWholeSweepLeftSaysSo) {
  RunCommandOptions from = options();
  from.recording = write_mcap(from.recording, out_ / "drive.mcap");
  fs::resize_file(from.recording, 2000);
  EXPECT_EQ(run(from), 1);
  EXPECT_NE(said_.str().find("/points holds no whole sweep"), std::string::npos) << said_.str();
}

TEST_F(RunCommand, MapsARecordingAndWritesEveryFile) {
  ASSERT_EQ(run(options()), 0) << said_.str();
  const Trajectory estimate = read_trajectory(out_ / "out/trajectory.tum");
  ASSERT_EQ(estimate.poses.size(), kRunSweeps);
  EXPECT_EQ(read_trajectory(out_ / "out/trajectory.kitti").poses.size(), kRunSweeps);
  EXPECT_GT(read_ply(out_ / "out/map.ply").sweep.points.size(), 1000U);
  const Trajectory truth = read_trajectory(test::SmallRecording(data_->path()).truth);
  for (std::size_t i = 0; i < kRunSweeps; ++i) {
    const Eigen::Vector3d error =
        estimate.poses[i].pose.translation() - truth.poses[i].pose.translation();
    EXPECT_LT(error.norm(), 0.15) << "sweep " << i;
  }
  EXPECT_EQ(test::lines(out_ / "out/sweeps.csv"), kRunSweeps + 1);
  for (const char* file :
       {"trajectory.tum", "trajectory.kitti", "sweeps.csv", "map.ply", "summary.json"}) {
    EXPECT_NE(printed_.str().find(file), std::string::npos) << printed_.str();
  }
  EXPECT_FALSE(fs::exists(out_ / "out/summary.json.part"));
}

TEST_F(RunCommand, SummaryTellsWhatWasDoneWithWhat) {
  RunCommandOptions profiled = options();
  profiled.stage_table = true;
  ASSERT_EQ(run(profiled), 0) << said_.str();
  const nlohmann::json json = summary();
  EXPECT_EQ(json["adit"], version());
  EXPECT_EQ(json["status"], "completed");
  EXPECT_EQ(json["input"]["sweeps"], kRunSweeps);
  EXPECT_EQ(json["sweeps"]["processed"], kRunSweeps);
  EXPECT_EQ(json["sweeps"]["failed"], 0);
  EXPECT_EQ(json["sweeps"]["states"]["initializing"], 1);
  EXPECT_EQ(json["sweeps"]["states"]["tracking"], kRunSweeps - 1);
  EXPECT_EQ(json["sweeps"]["registrations"]["converged"], kRunSweeps - 1);
  EXPECT_NEAR(json["distance_m"].get<double>(), 0.8 * (kRunSweeps - 1), 0.2);
  EXPECT_EQ(json["configuration"]["preprocess"]["beam_spacing"], 0.03);
  EXPECT_EQ(json["configuration"]["submap"]["l"], Config{}.submap.l);
  EXPECT_FALSE(json["device"]["name"].get<std::string>().empty());
  EXPECT_FALSE(json["device"]["driver_version"].get<std::string>().empty());
  EXPECT_GT(json["device"]["memory_peak_bytes"].get<uint64_t>(), 0U);
  EXPECT_EQ(json["time"]["host_ms"]["total"]["sweeps"], kRunSweeps);
  EXPECT_GT(json["time"]["device_ms"]["total"]["mean"].get<double>(), 0.0);
  EXPECT_NE(printed_.str().find("  device total "), std::string::npos) << printed_.str();
  EXPECT_GT(json["time"]["sweeps_per_s"].get<double>(), 0.0);
  EXPECT_EQ(json["output"]["map_points"], read_ply(out_ / "out/map.ply").sweep.points.size());
}

TEST_F(RunCommand, TwoRunsGiveTheSameBytes) {
  ASSERT_EQ(run(options()), 0) << said_.str();
  RunCommandOptions again = options();
  again.output = out_ / "again";
  ASSERT_EQ(run(again), 0) << said_.str();
  for (const char* file : {"trajectory.tum", "trajectory.kitti", "map.ply"}) {
    EXPECT_EQ(test::content(out_ / "out" / file), test::content(out_ / "again" / file)) << file;
  }
}

TEST_F(RunCommand, TimelineIsWrittenAsItsNameSaysAndNothingElseChanges) {
  ASSERT_EQ(run(options()), 0) << said_.str();
  const std::string expected = test::content(out_ / "out/trajectory.tum");
  for (const char* name : {"timeline.html", "timeline.json"}) {
    RunCommandOptions drawn = options();
    drawn.timeline = out_ / name;
    ASSERT_EQ(run(drawn), 0) << said_.str();
    EXPECT_EQ(test::content(out_ / "out/trajectory.tum"), expected);
  }
  const std::string page = test::content(out_ / "timeline.html");
  for (const char* part : {"reader", "device", "The middle", "The slowest", "<svg"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(test::json_of(out_ / "timeline.json")["traceEvents"][0]["ph"], "M");
  RunCommandOptions wrong = options();
  wrong.timeline = out_ / "timeline.png";
  EXPECT_EQ(run(wrong), 2);
}

TEST_F(RunCommand, JsonOptionPrintsTheSummary) {
  RunCommandOptions json = options();
  json.json = true;
  ASSERT_EQ(run(json), 0) << said_.str();
  EXPECT_EQ(printed_.str(), test::content(out_ / "out/summary.json"));
}

TEST_F(RunCommand, QuietPrintsNothing) {
  RunCommandOptions quiet = options();
  quiet.quiet = true;
  ASSERT_EQ(run(quiet), 0);
  EXPECT_EQ(printed_.str() + said_.str(), "");
}

TEST_F(RunCommand, PartOfARecordingIsMapped) {
  RunCommandOptions part = options();
  part.start = 2;
  part.count = 3;
  part.map.enabled = false;
  ASSERT_EQ(run(part), 0) << said_.str();
  const Trajectory estimate = read_trajectory(out_ / "out/trajectory.tum");
  ASSERT_EQ(estimate.poses.size(), 3U);
  EXPECT_EQ(estimate.poses[0].stamp, std::chrono::milliseconds(200));
  EXPECT_TRUE(estimate.poses[0].pose.isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_FALSE(fs::exists(out_ / "out/map.ply"));
}

TEST_F(RunCommand, DamagedSweepInTheMiddleKeepsTheTrajectoryAndSaysSo) {
  const test::TemporaryFolder damaged;
  RunCommandOptions run_options = options();
  run_options.recording = small_recording(damaged.path()).recording;
  const fs::path sweep = run_options.recording / "velodyne/000005.bin";
  fs::resize_file(sweep, fs::file_size(sweep) - 7);
  EXPECT_EQ(run(run_options), 0);
  EXPECT_NE(said_.str().find("000005.bin"), std::string::npos) << said_.str();
  EXPECT_EQ(read_trajectory(out_ / "out/trajectory.tum").poses.size(), kRunSweeps)
      << "the whole points of the sweep are used";
  EXPECT_EQ(summary()["left_out"]["damaged_places"], 1);
  run_options.strict_input = true;
  EXPECT_EQ(run(run_options), 1);
  EXPECT_NE(said_.str().find("000005.bin"), std::string::npos) << said_.str();
  EXPECT_EQ(read_trajectory(out_ / "out/trajectory.tum").poses.size(), 5U);
  EXPECT_EQ(summary()["status"], "input_error");
  EXPECT_NE(summary()["reason"].get<std::string>().find("000005.bin"), std::string::npos);
  EXPECT_EQ(summary()["sweeps"]["processed"], 5);
  EXPECT_NE(said_.str().find("5 of 8 sweeps done"), std::string::npos) << said_.str();
}

TEST_F(RunCommand, DamagedFirstSweepIsReportedWithoutATableOfZeros) {
  const test::TemporaryFolder damaged;
  RunCommandOptions run_options = options();
  run_options.recording = small_recording(damaged.path()).recording;
  fs::resize_file(run_options.recording / "velodyne/000000.bin", 7);
  run_options.strict_input = true;
  EXPECT_EQ(run(run_options), 1);
  EXPECT_NE(said_.str().find("000000.bin"), std::string::npos) << said_.str();
  EXPECT_NE(said_.str().find("0 of 8 sweeps done"), std::string::npos) << said_.str();
  EXPECT_EQ(printed_.str(), "");
  EXPECT_EQ(summary()["status"], "input_error");
}

TEST_F(RunCommand, SweepWithoutPointsIsAFailureAndTheRunGoesOn) {
  const test::TemporaryFolder damaged;
  RunCommandOptions run_options = options();
  run_options.recording = small_recording(damaged.path()).recording;
  fs::resize_file(run_options.recording / "velodyne/000004.bin", 0);
  EXPECT_EQ(run(run_options), 0) << said_.str();
  const nlohmann::json json = summary();
  EXPECT_EQ(json["sweeps"]["processed"], kRunSweeps);
  ASSERT_EQ(json["sweeps"]["failures"].size(), 1U);
  EXPECT_EQ(json["sweeps"]["failures"][0]["index"], 4);
  EXPECT_EQ(json["sweeps"]["failures"][0]["reason"], "it has no points");
  EXPECT_NE(said_.str().find("sweep 4"), std::string::npos) << said_.str();
}

TEST_F(RunCommand, RecordingWithoutAnyPointFails) {
  const test::TemporaryFolder empty;
  RunCommandOptions run_options = options();
  run_options.recording = small_recording(empty.path()).recording;
  for (std::size_t i = 0; i < kRunSweeps; ++i) {
    fs::resize_file(run_options.recording / "velodyne" / ("00000" + std::to_string(i) + ".bin"), 0);
  }
  EXPECT_EQ(run(run_options), 1);
  EXPECT_NE(said_.str().find("not one sweep could be aligned"), std::string::npos) << said_.str();
}

TEST_F(RunCommand, FullDiskIsReportedAndTheRestKept) {
  fs::create_directory(out_ / "out");
  fs::create_symlink("/dev/full", out_ / "out/map.ply");
  EXPECT_EQ(run(options()), 1);
  EXPECT_NE(said_.str().find("map.ply"), std::string::npos) << said_.str();
  EXPECT_NE(said_.str().find("No space left"), std::string::npos) << said_.str();
}

/// A signal that comes while the device is still being opened.
TEST_F(RunCommand, SignalBeforeTheFirstSweepLeavesASummaryThatSaysSo) {
  const fs::path out = options().output;
  std::thread terminal([out] {
    while (!fs::exists(out)) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    ::kill(::getpid(), SIGHUP);
  });
  const int code = run(options());
  terminal.join();
  EXPECT_EQ(code, 128 + SIGHUP) << said_.str();
  EXPECT_EQ(summary()["status"], "interrupted");
  EXPECT_LT(summary()["sweeps"]["processed"], kRunSweeps);
}

TEST_F(RunCommand, ReportThatCannotBeWrittenFailsAndTheFilesAreThere) {
  printed_.setstate(std::ios::badbit);
  EXPECT_EQ(run_command(options(), printed_, said_), 1);
  EXPECT_NE(said_.str().find("could not be written to the standard output"), std::string::npos)
      << said_.str();
  EXPECT_EQ(summary()["status"], "completed");
}

TEST_F(RunCommand, UnwritableOutputIsNamedBeforeAnyWork) {
  fs::create_directories(out_ / "out/trajectory.kitti");
  EXPECT_EQ(run(options()), 1);
  EXPECT_NE(said_.str().find("trajectory.kitti: cannot be written"), std::string::npos)
      << said_.str();
  EXPECT_NE(said_.str().find("Choose another folder"), std::string::npos) << said_.str();
  EXPECT_FALSE(fs::exists(out_ / "out/trajectory.tum"));
  EXPECT_EQ(said_.str().find("mapping"), std::string::npos) << said_.str();
}

TEST_F(RunCommand, MistakesOnTheCommandLineAreUsageErrors) {
  RunCommandOptions device = options();
  device.device.device = "4711";
  EXPECT_EQ(run(device), 2);
  EXPECT_NE(said_.str().find("4711"), std::string::npos) << said_.str();
  EXPECT_NE(said_.str().find("0: "), std::string::npos) << "the list of devices: " << said_.str();
  RunCommandOptions start = options();
  start.start = kRunSweeps;
  EXPECT_EQ(run(start), 2);
  EXPECT_NE(said_.str().find("the sweeps 0 to 7"), std::string::npos) << said_.str();
  RunCommandOptions resolution = options();
  resolution.map.resolution = 0.0;
  EXPECT_EQ(run(resolution), 2);
  RunCommandOptions setting = options();
  setting.config.overrides = {"submap.l=0"};
  EXPECT_EQ(run(setting), 2);
  EXPECT_FALSE(fs::exists(out_ / "out/trajectory.tum")) << "nothing was done";
}

TEST_F(RunCommand, HighRateWithoutAnImuHasNoPosesAndSaysWhy) {
  RunCommandOptions high_rate = options();
  high_rate.high_rate.enabled = true;
  ASSERT_EQ(run(high_rate), 0) << said_.str();
  EXPECT_NE(printed_.str().find("odometry_highrate.tum (0 poses: the IMU was never fused)"),
            std::string::npos)
      << printed_.str();
  EXPECT_EQ(test::lines(out_ / "out/odometry_highrate.tum"), 0U);
  EXPECT_EQ(test::lines(out_ / "out/odometry_highrate.csv"), 1U);
  EXPECT_EQ(summary()["output"]["high_rate"]["poses"], 0);
  RunCommandOptions smoothing = options();
  smoothing.high_rate.smoothing = 0.1;
  EXPECT_EQ(run(smoothing), 2) << "needs --high-rate";
}

TEST_F(RunCommand, TooSmallAMemoryBudgetIsReported) {
  RunCommandOptions small = options();
  small.device.max_vram_bytes = 4096;
  EXPECT_EQ(run(small), 1);
  EXPECT_NE(said_.str().find("4096"), std::string::npos) << said_.str();
}

TEST_F(RunCommand, MissingRecordingIsReported) {
  RunCommandOptions missing = options();
  missing.recording = out_ / "nowhere";
  EXPECT_EQ(run(missing), 1);
  EXPECT_NE(said_.str().find("nowhere"), std::string::npos) << said_.str();
}

}  // namespace
}  // namespace adit
