// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/program.hpp"

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/program_support.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

using test::Answer;
using test::call;

void expect_usage_error(const std::vector<const char*>& words, const std::string& part) {
  const Answer answer = call(words);
  EXPECT_EQ(answer.code, 2) << answer.err;
  EXPECT_NE(answer.err.find(part), std::string::npos) << "no '" << part << "' in: " << answer.err;
  EXPECT_EQ(answer.out, "");
}

TEST(Program, VersionAndHelpAreAnswers) {
  const Answer version_answer = call({"--version"});
  EXPECT_EQ(version_answer.code, 0);
  EXPECT_TRUE(version_answer.out.starts_with("adit " + std::string(version()) + "\ncommit   "))
      << version_answer.out;
  EXPECT_NE(version_answer.out.find("\nloader   1."), std::string::npos) << version_answer.out;
  for (const char* command : {"demo", "run", "simulate", "evaluate", "devices", "config"}) {
    const Answer help = call({command, "--help"});
    EXPECT_EQ(help.code, 0) << command;
    EXPECT_NE(help.out.find("Example"), std::string::npos) << command << "\n" << help.out;
    EXPECT_NE(call({"--help"}).out.find(command), std::string::npos) << command;
  }
}

TEST(Program, HelpIsAWordToo) {
  EXPECT_EQ(call({"help"}).out, call({"--help"}).out);
  EXPECT_EQ(call({"help", "run"}).out, call({"run", "--help"}).out);
  EXPECT_EQ(call({"help", "--color", "never", "run"}).out, call({"run", "--help"}).out);
  EXPECT_EQ(call({"help", "--help"}).code, 0);
  expect_usage_error({"help", "rnu"}, "no command 'rnu'. The nearest valid name is 'run'");
}

TEST(Program, WithoutWordsItExplainsItself) {
  expect_usage_error({}, "Subcommands:");
}

TEST(Program, UnknownCommandNamesTheNearest) {
  expect_usage_error({"rnu"}, "no command 'rnu'. The nearest valid name is 'run'");
  expect_usage_error({"configure"}, "'config'");
}

TEST(Program, UnknownOptionNamesTheNearestEvenWhereSomethingElseIsMissing) {
  expect_usage_error({"run", "drive", "--otput", "x"},
                     "adit run: there is no option '--otput'. The nearest valid "
                     "name is '--output'");
  expect_usage_error({"devices", "--jsn"}, "'--json'");
  expect_usage_error({"--versoin"}, "'--version'");
}

TEST(Program, MissingAndSuperfluousWordsAreUsageErrors) {
  expect_usage_error({"run"}, "RECORDING is missing");
  expect_usage_error({"run", "--continue"}, "-o OUT");
  expect_usage_error({"simulate", "room"}, "--output is required");
  expect_usage_error({"config", "--set", "submap.l=4", "submap.l=5"}, "not expected: submap.l=5");
  expect_usage_error({"run", "drive", "-o", "out", "--start", "-1"}, "--start must be at least 0");
  expect_usage_error({"run", "drive", "-o", "out", "--max-vram", "-1"}, "not negative");
  expect_usage_error({"run", "drive", "-o", "out", "--max-vram", "5 parsecs"}, "--max-vram");
}

TEST(Program, WordsThatWouldBeTakenForSomethingElseAreRefused) {
  expect_usage_error({"run", "drive", "-out", "x"}, "no option '-out'; write -o or --output");
  expect_usage_error({"simulate", "room", "-output", "x"}, "write -o or --output");
  expect_usage_error({"inspect", "drive", "-json"}, "no option '-json'; write --json");
  expect_usage_error({"inspect", "drive", "--json=out.json"}, "--json takes no value");
  expect_usage_error({"run", "drive", "-o", "x", "--quiet=yes"}, "--quiet takes no value");
  expect_usage_error({"simulate", "room", "out.mcap"}, "-o out.mcap");
  const test::TemporaryFolder folder;
  const std::string joined = "-o" + (folder / "x").string();
  EXPECT_EQ(call({"simulate", "no-such-place", joined.c_str()}).err.find("no option"),
            std::string::npos)
      << "a value may follow its letter";
  EXPECT_EQ(call({"-V"}).out, call({"--version"}).out);
}

TEST(Program, HelpAndComplaintsSpeakToPeople) {
  for (const std::vector<const char*>& command :
       std::vector<std::vector<const char*>>{{"run"},
                                             {"inspect"},
                                             {"convert"},
                                             {"align"},
                                             {"evaluate"},
                                             {"simulate"},
                                             {"config"},
                                             {"demo"},
                                             {"info"},
                                             {"check"},
                                             {"recover"},
                                             {"export"},
                                             {"loops"},
                                             {"view"},
                                             {"optimize"},
                                             {"devices"}}) {
    const std::string help = call({command.front(), "--help"}).out;
    for (const char* internal : {"->", "{", "FLOAT", "INT:", " INT ", "TEXT", "NONNEGATIVE",
                                 "POSITIVE", "REQUIRED", " x 2"}) {
      EXPECT_EQ(help.find(internal), std::string::npos) << internal << " in:\n" << help;
    }
  }
  expect_usage_error({"convert", "a", "b.mcap", "--ros", "0"}, "--ros: '0' is none of 1 or 2");
  expect_usage_error({"convert", "a", "b", "--compression", "zip"},
                     "'zip' is none of none, lz4, zstd or bz2");
  expect_usage_error({"evaluate", "a", "b", "--align", "best"},
                     "'best' is none of se3, sim3, origin or none");
  expect_usage_error({"evaluate", "a", "b", "--tolerance", "-1"},
                     "'-1' is not possible; it takes a number from 0 to 1000000000");
  expect_usage_error({"view", "a", "--port", "65536"}, "--port");
  expect_usage_error({"export", "a", "--cloud", "xyz"},
                     "'xyz' is none of ply, pcd, las, laz or copc");
  expect_usage_error({"run", "a", "-o", "b", "--device"}, "--device lacks its DEVICE");
  const test::TemporaryFolder folder;
  expect_usage_error({"evaluate", folder.path().c_str()}, "is no folder of a run");
  expect_usage_error({"run", "a", "-o", "b", "--start", "x"}, "--start: 'x' is not a number");
  expect_usage_error({"run", "a", "-o", "b", "--max-vram", "5 parsecs"}, "write 512MiB, 2GiB");
  for (const char* command : {"run", "demo"}) {
    EXPECT_NE(call({command, "--help"}).out.find("129, 130 or 143"), std::string::npos) << command;
  }
}

TEST(Program, WhatIsNoRecordingIsToldWhatIsOne) {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  for (const char* name : {"nothing", "nothing.xyz"}) {
    const std::string file = folder.write(name, "no recording").string();
    const std::string said = call({"run", file.c_str(), "-o", out.c_str()}).err;
    for (const char* form : {"MCAP", "ROS 1 bag", "rosbag2", ".db3", "pcapng", "KITTI raw", "EuRoC",
                             "TUM RGB-D", ".pcd", ".ply", ".las"}) {
      EXPECT_NE(said.find(form), std::string::npos) << form << " in: " << said;
    }
    EXPECT_EQ(said.find("ends in  "), std::string::npos) << said;
  }
}

TEST(Program, ConfigPrintsWhatItReadsBack) {
  const test::TemporaryFolder folder;
  const Answer first = call({"config", "--set", "submap.l=7", "--set", "preprocess.c_min=1"});
  ASSERT_EQ(first.code, 0) << first.err;
  const std::string file = folder.write("my.toml", first.out).string();
  const Answer second = call({"config", "--config", file.c_str()});
  EXPECT_EQ(second.code, 0) << second.err;
  EXPECT_EQ(second.out, first.out);
  EXPECT_EQ(load_config({.file = file, .overrides = {}}).submap.l, 7);
}

TEST(Program, ConfigRefusesABadFileWithItsLine) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("bad.toml", "[submap]\nL = 3\n").string();
  const Answer answer = call({"config", "--config", file.c_str()});
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.err.find("bad.toml, line 2"), std::string::npos) << answer.err;
  EXPECT_NE(answer.err.find("'submap.l'"), std::string::npos) << answer.err;
}

TEST(Program, DevicesListsTheDeviceOfTheTestAndItsKernels) {
  const Answer answer = call({"devices", "--json"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  const nlohmann::json devices = nlohmann::json::parse(answer.out)["devices"];
  ASSERT_GE(devices.size(), 1U);
  EXPECT_EQ(devices[0]["index"], 0);
  EXPECT_EQ(devices[0]["usable"], true);
  EXPECT_GE(devices[0]["requirements"].size(), 10U);
  EXPECT_GE(devices[0]["max_storage_buffer_bytes"], 1U << 27U);  // what Vulkan 1.3 asks for
  EXPECT_GE(devices[0]["max_texel_buffer_elements"], 1U << 16U);
  EXPECT_GE(devices[0]["self_test"].size(), 1U);
  const std::string name = devices[0]["name"];
  const Answer text = call({"devices", "--no-self-test"});
  EXPECT_EQ(text.code, 0);
  EXPECT_NE(text.out.find("0: " + name), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("self-test not run"), std::string::npos) << text.out;
}

/// Calls the program with its standard output on a full disk.
Answer call_on_full_disk(std::vector<const char*> words) {
  words.insert(words.begin(), "adit");
  testing::internal::CaptureStderr();
  std::fflush(stdout);
  const int terminal = ::dup(STDOUT_FILENO);
  const int full = ::open("/dev/full", O_WRONLY);
  ::dup2(full, STDOUT_FILENO);
  const int code = program(static_cast<int>(words.size()), words.data());
  std::cout.clear();
  std::clearerr(stdout);
  ::dup2(terminal, STDOUT_FILENO);
  ::close(full);
  ::close(terminal);
  return {.code = code, .out = {}, .err = testing::internal::GetCapturedStderr()};
}

TEST(Program, ReportOnAFullDiskIsAFailureOfEveryCommand) {
  const test::TemporaryFolder folder;
  const std::string drive = test::small_recording(folder.path(), 3).recording.string();
  const std::string truth = (folder / "truth.tum").string();
  const std::vector<std::vector<const char*>> calls = {
      {"config"},
      {"config", "--help"},
      {"--version"},
      {"devices", "--no-self-test"},
      {"devices", "--no-self-test", "--json"},
      {"inspect", drive.c_str()},
      {"inspect", drive.c_str(), "--json"},
      {"evaluate", truth.c_str(), truth.c_str(), "--align", "none"},
      {"simulate", "--example"}};
  for (const std::vector<const char*>& words : calls) {
    const Answer answer = call_on_full_disk(words);
    EXPECT_EQ(answer.code, 1) << words.front() << ": " << answer.err;
    EXPECT_NE(answer.err.find("could not be written to the standard output"), std::string::npos)
        << words.front() << ": " << answer.err;
  }
}

TEST(Program, DemoLooksForItsDeviceAndFolderBeforeItSimulates) {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "demo").string();
  const Answer answer = call({"demo", "-o", out.c_str(), "--device", "4711"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(answer.err.starts_with("adit demo: ")) << answer.err;
  EXPECT_FALSE(std::filesystem::exists(out)) << "nothing was simulated";
  folder.write("map.ply", "mine");
  const std::string mine = folder.path().string();
  EXPECT_EQ(call({"demo", "-o", mine.c_str()}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "mine.mcap"));
}

TEST(Program, DemoMapsEvaluatesAndSaysWhereToLook) {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "demo").string();
  const Answer answer = call({"demo", "-o", out.c_str(), "--duration", "3"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.out.find("bound 0.03 m: good"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("no place was seen twice"), std::string::npos) << answer.out;
  for (const char* file :
       {"trajectory.tum", "map.ply", "summary.json", "mine.mcap", "mine.truth.tum", "map.svg",
        "evaluation.svg", "mine.scene.png", "evaluation.html"}) {
    EXPECT_GT(std::filesystem::file_size(std::filesystem::path(out) / file), 0U) << file;
  }
  EXPECT_LT(std::filesystem::file_size(std::filesystem::path(out) / "map.svg"), 1'000'000U);
  EXPECT_NE(answer.out.find(" MiB in " + out), std::string::npos) << answer.out;
}

}  // namespace
}  // namespace adit
