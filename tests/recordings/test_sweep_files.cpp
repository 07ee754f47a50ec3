// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/recording.hpp"

#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/shared_data.hpp"
#include "adit/tests/support/temporary_folder.hpp"

namespace adit {
namespace {

using test::bytes_of_all;
using test::read_sweep;
using test::TemporaryFolder;

/// A KITTI sweep of one point whose x tells which it is.
std::string bin(float x) {
  return bytes_of_all(x, 2.0F, 3.0F, 0.5F);
}

std::string pcd(float x) {
  return test::pcd_header(1, "binary") + bin(x);
}

/// A PCD of one point with a time field.
std::string timed_pcd(float x, double time) {
  return "FIELDS x y z time\nSIZE 4 4 4 8\nTYPE F F F F\nWIDTH 1\nHEIGHT 1\nDATA binary\n" +
         bytes_of_all(x, 2.0F, 3.0F, time);
}

InputError open_error(const std::filesystem::path& path) {
  try {
    open_recording(path);
  } catch (const InputError& error) {
    return error;
  }
  ADD_FAILURE() << "opened " << path;
  return InputError("", {}, "", "");
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Recording, KittiFolder) {
  const TemporaryFolder folder;
  folder.write("times.txt", "5.0\n5.1\n5.25\n");
  for (int i = 0; i < 3; ++i) {
    folder.write("velodyne/00000" + std::to_string(i) + ".bin", bin(static_cast<float>(i + 1)));
  }
  const auto recording = open_recording(folder.path());
  ASSERT_EQ(recording->topics().at(0).messages, 3U);
  EXPECT_FALSE(recording->times_are_assumed());
  EXPECT_TRUE(
      contains(recording->description(), "KITTI folder, 3 sweeps over 0.2 s; times from times.txt"))
      << recording->description();
  const Sweep sweep = read_sweep(*recording, 2);
  EXPECT_EQ(sweep.stamp, Nanoseconds(5250000000));
  EXPECT_EQ(sweep.points.at(0).x, 3.0F);
  EXPECT_EQ(sweep.points.at(0).intensity, 0.5F);
  EXPECT_TRUE(sweep.times.empty());
  EXPECT_TRUE(contains(sweep.source, "000002.bin"));
}

TEST(Recording, KittiRawDrive) {
  const TemporaryFolder folder;
  folder.write("velodyne_points/timestamps.txt", "2011-09-26 13:02:25.5\n2011-09-26 13:02:25.6\n");
  folder.write("velodyne_points/data/0000000000.bin", bin(1.0F));
  folder.write("velodyne_points/data/0000000001.bin", bin(2.0F));
  const auto recording = open_recording(folder.path());
  EXPECT_TRUE(contains(recording->description(), "KITTI raw drive"));
  EXPECT_EQ(read_sweep(*recording, 0).stamp, Nanoseconds(1317042145500000000));
  EXPECT_EQ(read_sweep(*open_recording(folder / "velodyne_points/data"), 1).stamp,
            Nanoseconds(1317042145600000000));
}

TEST(Recording, VelodyneFolderItselfFindsTheTimesBesideIt) {
  const TemporaryFolder folder;
  folder.write("times.txt", "5.0\n");
  folder.write("velodyne/000000.bin", bin(1.0F));
  EXPECT_EQ(read_sweep(*open_recording(folder / "velodyne"), 0).stamp, Nanoseconds(5000000000));
  EXPECT_EQ(read_sweep(*open_recording(folder / "velodyne/"), 0).stamp, Nanoseconds(5000000000));
}

TEST(Recording, WithoutTimesTenHertzAreAssumedAndSaid) {
  const TemporaryFolder folder;
  folder.write("velodyne/000000.bin", bin(1.0F));
  folder.write("velodyne/000001.bin", bin(2.0F));
  const auto recording = open_recording(folder.path());
  EXPECT_TRUE(recording->times_are_assumed());
  EXPECT_TRUE(contains(recording->description(), "no times.txt: 10 Hz assumed"))
      << recording->description();
  EXPECT_EQ(read_sweep(*recording, 1).stamp, Nanoseconds(100000000));
}

TEST(Recording, FilesComeInNumericOrder) {
  const TemporaryFolder folder;
  for (const int i : {10, 9, 1, 100}) {
    folder.write("scan" + std::to_string(i) + ".pcd", pcd(static_cast<float>(i)));
  }
  folder.write("notes.md", "not a sweep");
  folder.write(".hidden.pcd", "not a sweep");
  const auto recording = open_recording(folder.path());
  ASSERT_EQ(recording->topics().at(0).messages, 4U);
  EXPECT_EQ(read_sweep(*recording, 0).points.at(0).x, 1.0F);
  EXPECT_EQ(read_sweep(*recording, 1).points.at(0).x, 9.0F);
  EXPECT_EQ(read_sweep(*recording, 3).points.at(0).x, 100.0F);
}

TEST(Recording, NamesThatAreTimesGiveOrderAndStamps) {
  const TemporaryFolder folder;
  folder.write("1623370000.5.pcd", pcd(2.0F));
  folder.write("1623370000.25.pcd", pcd(1.0F));
  const auto recording = open_recording(folder.path());
  EXPECT_TRUE(contains(recording->description(), "times from the file names"))
      << recording->description();
  EXPECT_EQ(read_sweep(*recording, 0).stamp, Nanoseconds(1623370000250000000));
  EXPECT_EQ(read_sweep(*recording, 1).points.at(0).x, 2.0F);
}

TEST(Recording, TimesFileInTheFolderWinsOverNames) {
  const TemporaryFolder folder;
  folder.write("1623370000.5.pcd", pcd(1.0F));
  folder.write("times.txt", "7\n");
  EXPECT_EQ(read_sweep(*open_recording(folder.path()), 0).stamp, Nanoseconds(7000000000));
}

TEST(Recording, EqualTimesInNamesAreAnError) {
  const TemporaryFolder folder;
  folder.write("a_1623370000.5.pcd", pcd(1.0F));
  folder.write("b_1623370000.5.pcd", pcd(1.0F));
  EXPECT_TRUE(contains(open_error(folder.path()).found(), "the same time"));
}

TEST(Recording, RelativePointTimesMoveTheStart) {
  const TemporaryFolder folder;
  folder.write("1623370000.5.pcd", timed_pcd(1.0F, -0.1));
  EXPECT_EQ(read_sweep(*open_recording(folder.path()), 0).stamp, Nanoseconds(1623370000400000000));
}

TEST(Recording, AbsolutePointTimesReplaceAssumedOnes) {
  const TemporaryFolder folder;
  folder.write("0.pcd", timed_pcd(1.0F, 1623370000.5));
  folder.write("1.pcd", timed_pcd(1.0F, 1623370000.75));
  const auto recording = open_recording(folder.path());
  EXPECT_EQ(read_sweep(*recording, 0).stamp, Nanoseconds(1623370000500000000));
  EXPECT_EQ(read_sweep(*recording, 1).stamp, Nanoseconds(1623370000750000000));
}

TEST(Recording, PointTimesThatGoBackAreAnError) {
  const TemporaryFolder folder;
  folder.write("0.pcd", timed_pcd(1.0F, 1623370000.5));
  folder.write("1.pcd", timed_pcd(1.0F, 1623370000.25));
  const auto recording = open_recording(folder.path());
  const auto events = recording->events({});
  EXPECT_TRUE(events->next().has_value());
  EXPECT_THROW(events->next(), InputError);
}

TEST(Recording, OneFileIsOneSweep) {
  const TemporaryFolder folder;
  const auto recording = open_recording(folder.write("scan.PCD", pcd(4.0F)));
  ASSERT_EQ(recording->topics().at(0).messages, 1U);
  EXPECT_EQ(read_sweep(*recording, 0).points.at(0).x, 4.0F);
  EXPECT_EQ(read_sweep(*open_recording(folder.write("a.bin", bin(5.0F))), 0).points.at(0).x, 5.0F);
}

TEST(Recording, DamagedSweepIsReportedAndTheOthersCanBeRead) {
  const TemporaryFolder folder;
  folder.write("velodyne/0.bin", bin(1.0F));
  folder.write("velodyne/1.bin", bin(2.0F) + "123456789");
  folder.write("velodyne/2.bin", bin(3.0F));
  const auto recording = open_recording(folder.path());
  EXPECT_EQ(read_sweep(*recording, 0).points.size(), 1U);
  try {
    read_sweep(*recording, 1);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.file().filename(), "1.bin");
    EXPECT_EQ(error.place(), "byte 16");
    EXPECT_TRUE(contains(error.found(), "25 bytes")) << error.found();
    EXPECT_TRUE(contains(error.found(), "9 are left over after 1 points")) << error.found();
  }
  EXPECT_EQ(read_sweep(*recording, 2).points.at(0).x, 3.0F);
  const test::ReadEvents read = test::read_all(*recording);
  EXPECT_EQ(read.events.size(), 2U);
  EXPECT_EQ(read.errors.size(), 1U);
}

TEST(Recording, SweepsAreChosenByTimeAndSkipped) {
  const TemporaryFolder folder;
  folder.write("times.txt", "5.0\n5.1\n5.2\n5.3\n");
  for (int i = 0; i < 4; ++i) {
    folder.write("velodyne/" + std::to_string(i) + ".bin", bin(static_cast<float>(i)));
  }
  const auto recording = open_recording(folder.path());
  const auto first_x = [&](const EventSelection& selection) {
    std::vector<float> x;
    for (const Event& event : test::read_all(*recording, selection).events) {
      x.push_back(std::get<Sweep>(event.value).points.at(0).x);
    }
    return x;
  };
  const Nanoseconds from(5100000000);
  EXPECT_EQ(first_x({.begin = from}), (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(first_x({.begin = from, .skip = 1}), (std::vector<float>{2, 3}));
  EXPECT_EQ(first_x({.begin = from, .end = Nanoseconds(5200000000)}), (std::vector<float>{1, 2}));
  EXPECT_TRUE(first_x({.skip = 5}).empty());
}

TEST(Recording, EmptyFileIsASweepWithoutPoints) {
  const TemporaryFolder folder;
  EXPECT_TRUE(read_sweep(*open_recording(folder.write("a.bin", "")), 0).points.empty());
}

TEST(Recording, EmptyFileOfAnotherKindIsSaidToBeEmpty) {
  const TemporaryFolder folder;
  EXPECT_EQ(open_error(folder.write("a.mcap", "")).found(), "it is empty");
}

TEST(Recording, MissingFolderIsNamed) {
  const TemporaryFolder folder;
  const InputError error = open_error(folder / "nowhere");
  EXPECT_TRUE(contains(error.what(), (folder / "nowhere").string()));
  EXPECT_TRUE(contains(error.found(), "no such file or folder"));
}

TEST(Recording, EmptyFoldersSayWhatIsExpected) {
  const TemporaryFolder folder;
  EXPECT_TRUE(contains(open_error(folder.path()).remedy(), "velodyne/*.bin"));
  std::filesystem::create_directories(folder / "drive/velodyne");
  EXPECT_TRUE(contains(open_error(folder / "drive").found(), "no .bin files"));
  std::filesystem::create_directories(folder / "dataset/sequences/00");
  EXPECT_TRUE(contains(open_error(folder / "dataset").remedy(), "sequences"));
  EXPECT_TRUE(contains(open_error(folder.write("drive.bag", "x")).found(), ".bag"));
}

TEST(Recording, TimesThatDoNotMatchTheSweepsNameTheFile) {
  const TemporaryFolder folder;
  folder.write("times.txt", "0\n0.1\n0.2\n");
  folder.write("velodyne/000000.bin", bin(1.0F));
  folder.write("velodyne/000002.bin", bin(2.0F));
  const InputError error = open_error(folder.path());
  EXPECT_EQ(error.file(), folder / "times.txt");
  EXPECT_TRUE(contains(error.found(), "3 times for 2 sweeps")) << error.found();
  EXPECT_TRUE(contains(error.found(), "the first number missing in their names is 1"))
      << error.found();
}

TEST(Recording, TheFolderOfARunIsNone) {
  const TemporaryFolder folder;
  folder.write("map.ply", "ply\n");
  folder.write("summary.json", "{}\n");
  folder.write("sweeps.csv", "sweep\n");
  folder.write("trajectory.tum", "");
  const InputError error = open_error(folder.path());
  EXPECT_TRUE(contains(error.what(), "folder of a run")) << error.what();
  EXPECT_TRUE(contains(error.what(), "--as foxglove")) << error.what();
}

TEST(Recording, TimesThatGoBackNameTheLine) {
  const TemporaryFolder folder;
  folder.write("times.txt", "0\n0.1\n0.05\n");
  for (const char* name : {"velodyne/0.bin", "velodyne/1.bin", "velodyne/2.bin"}) {
    folder.write(name, bin(1.0F));
  }
  EXPECT_EQ(open_error(folder.path()).place(), "line 3");
}

TEST(Recording, MixedKindsAreAnError) {
  const TemporaryFolder folder;
  folder.write("a.pcd", pcd(1.0F));
  folder.write("b.bin", bin(1.0F));
  EXPECT_TRUE(contains(open_error(folder.path()).found(), ".pcd"));
}

TEST(Recording, RealKittiDrive) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "kitti_0001");
  const auto recording = open_recording(folder);
  ASSERT_EQ(recording->topics().at(0).messages, 60U);
  EXPECT_EQ(read_sweep(*recording, 0).points.size(), 1936240U / 16U);
  EXPECT_EQ(read_sweep(*recording, 1).stamp, Nanoseconds(110000000));
  for (std::size_t i = 0; i < 60; ++i) {
    const Sweep sweep = read_sweep(*recording, i);
    EXPECT_GT(sweep.points.size(), 98000U);
    EXPECT_LT(sweep.points.size(), 124000U);
  }
}

}  // namespace
}  // namespace adit
