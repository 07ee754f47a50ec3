// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Options that would have no effect are refused on the command line, with the reason.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/program_support.hpp"
#include "adit/tools/map_database/map_database.hpp"

namespace adit {
namespace {

/// A command line and a part of what is said of it. "OUT" stands for the folder of a run, "A" and
/// "B" for trajectories, "MAP" for a map and "FILE" for something to write.
struct Refused {
  std::vector<std::string> words;
  std::string part;
};

std::vector<Refused> refused_lines() {
  return {
      {{"--quiet", "run", "A", "-o", "FILE"}, "--quiet: stands before run"},
      {{"evaluate", "A", "B", "--table", "--csv"}, "exclude each other"},
      {{"evaluate", "A", "B", "--json", "--latex"}, "exclude each other"},
      {{"evaluate", "A", "B", "--tolerance", "inf"}, "--tolerance: 'inf' is not possible"},
      {{"evaluate", "A", "B", "--delta", "inf"}, "--delta: 'inf' is not possible"},
      {{"evaluate", "OUT", "A", "--table", "--html", "FILE"}, "--table: has a line an estimate"},
      {{"evaluate", "OUT", "A", "--csv", "--loops", "B"}, "leave out --html, --loops and --world"},
      {{"evaluate", "OUT", "A", "--markdown", "--world", "1", "2", "3"}, "--markdown: has a line"},
      {{"evaluate", "OUT", "A", "--html", "page.pdf"},
       "--html: 'page.pdf' does not end in .html or .htm"},
      {{"inspect", "A", "--html", "page.png"}, "--html: 'page.png' does not end in .html"},
      {{"inspect", "A", "--write-config", "a.yaml"}, "'a.yaml' does not end in .toml"},
      {{"loops", "MAP", "--html", "page.svg"}, "--html: 'page.svg' does not end in .html"},
      {{"align", "A", "B", "--picture", "both.jpg"}, "'both.jpg' does not end in .png"},
      {{"align", "--guess", "1", "2", "3", "A", "B"}, "It takes 4 to 7 numbers (X Y Z YAW)"},
      {{"loops", "--guess", "1", "2", "3", "MAP"}, "It takes 4 numbers (X Y Z YAW)"},
      {{"evaluate", "--world", "1", "2", "A"}, "It takes 3 numbers (LAT LON ALT)"},
      {{"evaluate", "OUT", "--align", "sim3"}, "--align: needs a TRUTH"},
      {{"evaluate", "OUT", "--delta", "5"}, "--delta: needs a TRUTH"},
      {{"evaluate", "OUT", "--part", "1"}, "--part: needs a TRUTH"},
      {{"evaluate", "OUT", "--truth-topic", "/odom"}, "--truth-topic: needs a TRUTH"},
      {{"evaluate", "A", "B", "--truth-topic", "/odom"}, "is a file without topics"},
      {{"evaluate", "A", "A", "B", "--estimate-topic", "/odom"}, "each of the estimates"},
      {{"evaluate", "A", "B", "--truth-times", "A"}, "has times of its own"},
      {{"evaluate", "A", "B", "--estimate-times", "A"}, "--estimate-times: "},
      {{"inspect", "OUT", "--set", "imu.use=false"}, "--set: is of recordings"},
      {{"inspect", "OUT", "--device", "0"}, "--device: is of recordings"},
      {{"convert", "A", "FILE.mcap", "--repair", "--set", "imu.use=false"},
       "--set imu.use=false: --repair corrects by"},
      {{"simulate", "room", "-o", "FILE.mcap", "--gnss-rate", "10"}, "--gnss-rate: there is no"},
      {{"simulate", "room", "-o", "FILE.mcap", "--imu", "none", "--imu-rate", "100"},
       "--imu-rate: there is no IMU"},
      {{"simulate", "room", "-o", "FILE.mcap", "--seed", "-1"}, "--seed: '-1' is not possible"},
      {{"export", "MAP", "--cloud", "ply", "-o", "FILE", "--from", "inf"}, "--from: 'inf'"},
      {{"export", "MAP", "--cloud", "ply", "-o", "FILE", "--until", "nan"}, "--until: 'nan'"},
      {{"optimize", "MAP", "--max-iterations", "5"}, "--max-iterations: a map is optimised as"},
      {{"optimize", "MAP", "--convention", "g2o"}, "--convention: a map has one of its own"},
      {{"optimize", "MAP", "--kernel-width", "2"}, "--kernel-width needs --loop-kernel"},
      {{"optimize", "MAP", "-o", "FILE.adit"}, "name it *.g2o"},
  };
}

class UnusedOptions : public testing::Test {
 protected:
  UnusedOptions() {
    constexpr const char* kPoses = "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 1 1 0 0 0 0 1\n";
    folder_.write("A", kPoses);
    folder_.write("B", kPoses);
    folder_.write("OUT/sweeps.csv", "");
    MapDatabase map(folder_ / "MAP", MapAccess::write);
    const SessionId session = test::add_session(map);
    map.store(test::record(0, session));
  }

  test::Answer answer(std::vector<std::string> words) const {
    std::vector<const char*> line;
    for (std::string& word : words) {
      for (const char* name : {"A", "B", "OUT", "MAP"}) {
        word = word == name ? (folder_ / name).string() : word;
      }
      word = word.starts_with("FILE") ? (folder_ / word).string() : word;
      line.push_back(word.c_str());
    }
    return test::call(line);
  }

  test::TemporaryFolder folder_;
};

TEST_F(UnusedOptions, AreRefusedWithTheReason) {
  for (const Refused& one : refused_lines()) {
    const test::Answer said = answer(one.words);
    EXPECT_EQ(said.code, 2) << one.part << ": " << said.err;
    EXPECT_NE(said.err.find(one.part), std::string::npos)
        << "no '" << one.part << "': " << said.err;
    EXPECT_EQ(said.out, "");
    for (const char* name : {"FILE", "FILE.mcap", "FILE.adit"}) {
      EXPECT_FALSE(std::filesystem::exists(folder_ / name)) << one.part;
    }
  }
}

TEST_F(UnusedOptions, ThoseThatHaveAnEffectAreTaken) {
  folder_.write("C", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 1 0 0 1 0\n");
  folder_.write("times", "1\n2\n3\n");
  const std::string kitti = (folder_ / "C").string();
  const std::string times = (folder_ / "times").string();
  const test::Answer one_of_two =
      answer({"evaluate", kitti, "A", "B", "--align", "none", "--estimate-times", times});
  EXPECT_EQ(one_of_two.code, 0) << one_of_two.err;
  for (const char* initial : {"file", "better"}) {
    const test::Answer plain = answer({"optimize", "MAP", "--initial", initial});
    EXPECT_EQ(plain.out.find("as in its run"), std::string::npos) << plain.out;
  }
  EXPECT_EQ(answer({"optimize", "MAP", "--loop-kernel", "none", "--max-iterations", "5"}).code, 0);
}

}  // namespace
}  // namespace adit
