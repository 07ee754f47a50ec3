// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a map holds after a kill, on a full disk, in a folder that is read-only, and beside a second
// writer.
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::dump_of;
using test::record;

/// A process that stores keyframes from `first` on and writes a byte into a pipe after each.
class Writer {
 public:
  Writer(const fs::path& file, NodeId first) {
    if (::pipe(pipe_) != 0) {
      throw std::runtime_error("no pipe");
    }
    child_ = ::fork();
    if (child_ == 0) {
      write_for_ever(file, first);
    }
    ::close(pipe_[1]);
  }

  /// Waits for a number of keyframes that are reported as stored.
  int wait_for(int count) {
    int stored = 0;
    char byte = 0;
    while (stored < count && ::read(pipe_[0], &byte, 1) == 1) {
      ++stored;
    }
    return stored;
  }

  /// kill -9. Returns how many more were reported meanwhile.
  int kill() {
    ::kill(child_, SIGKILL);
    int status = 0;
    ::waitpid(child_, &status, 0);
    const int more = wait_for(1 << 30);
    ::close(pipe_[0]);
    return more;
  }

 private:
  [[noreturn]] void write_for_ever(const fs::path& file, NodeId first) {
    try {
      MapDatabase map(file, MapAccess::write);
      const SessionId session = test::add_session(map);
      for (NodeId id = first;; ++id) {
        KeyframeRecord next = record(id, session);
        map.store(next);
        if (::write(pipe_[1], "x", 1) != 1) {
          break;
        }
      }
    } catch (const std::exception&) {
    }
    ::_exit(3);
  }

  int pipe_[2] = {-1, -1};
  pid_t child_ = -1;
};

// Ten kills at random moments into one map: it opens each time, is whole, and holds every keyframe
// that was reported as stored.
TEST(MapFaults, NothingThatWasStoredIsLostByAKill) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  Random random(7);
  NodeId next = 0;
  for (int kill = 0; kill < 10; ++kill) {
    Writer writer(file, next);
    int reported = writer.wait_for(1 + static_cast<int>(random.uniform(0.0, 20.0)));
    std::this_thread::sleep_for(
        std::chrono::microseconds(static_cast<int>(random.uniform(0.0, 5000.0))));
    reported += writer.kill();
    const MapDatabase map(file, MapAccess::read);
    EXPECT_TRUE(map.check().empty());
    const auto keyframes = map.keyframes();
    ASSERT_GE(keyframes.size(), static_cast<std::size_t>(next + reported));
    ASSERT_LE(keyframes.size(), static_cast<std::size_t>(next + reported + 1));  // one on its way
    EXPECT_EQ(map.submap(keyframes.back().id).chunks, record(keyframes.back().id, 1).submap.chunks);
    EXPECT_EQ(map.graph().edges().size() + 1, keyframes.size());
    next = static_cast<NodeId>(keyframes.size());
  }
}

TEST(MapFaults, AKillLeavesAMapThatAWriterGoesOnWith) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  Writer writer(file, 0);
  writer.wait_for(5);
  writer.kill();
  EXPECT_TRUE(fs::exists(file.string() + ".lock")) << "left behind, but held by nobody";
  std::size_t count = 0;
  {
    MapDatabase map(file, MapAccess::write);
    count = map.keyframes().size();
    map.store(record(static_cast<NodeId>(count), 1));
  }
  EXPECT_FALSE(fs::exists(file.string() + "-wal"));
  EXPECT_EQ(MapDatabase(file, MapAccess::read).keyframes().size(), count + 1);
}

TEST(MapFaults, ASecondWriterIsToldWhoTheFirstIs) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  const MapDatabase first(file, MapAccess::write);
  try {
    const MapDatabase second(file, MapAccess::write);
    FAIL() << "two writers";
  } catch (const LockedError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("is being written by process " + std::to_string(::getpid()) + " on "),
              std::string::npos)
        << text;
  }
}

TEST(MapFaults, AFullDiskLosesNothingThatWasStored) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  NodeId stored = 0;
  std::string before;
  {
    MapDatabase map(file, MapAccess::write, 60);
    const SessionId session = test::add_session(map);
    try {
      for (; stored < 10000; ++stored) {
        map.store(record(stored, session));
        before = dump_of(map);
      }
      FAIL() << "the disk is never full";
    } catch (const OutputError& error) {
      EXPECT_NE(std::string(error.what()).find("full"), std::string::npos) << error.what();
    }
    EXPECT_GT(stored, 5);
    EXPECT_EQ(dump_of(map), before);
  }
  {
    const MapDatabase map(file, MapAccess::read);
    EXPECT_EQ(dump_of(map), before);
    EXPECT_TRUE(map.check().empty());
  }
  MapDatabase more(file, MapAccess::write);
  more.store(record(stored, 1));
  EXPECT_EQ(more.keyframes().size(), static_cast<std::size_t>(stored + 1));
}

/// Runs a check as a user whom permissions bind: root may write everywhere.
bool holds_unprivileged(const std::function<bool()>& check) {
  const pid_t child = ::fork();
  if (child == 0) {
    bool good = false;
    if (::getuid() != 0 || (::setgid(65534) == 0 && ::setuid(65534) == 0)) {
      try {
        good = check();
      } catch (const std::exception&) {
      }
    }
    ::_exit(good ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(MapFaults, AMapInAReadOnlyFolderOpensToRead) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  {
    MapDatabase map(file, MapAccess::write);
    map.store(record(0, test::add_session(map)));
  }
  ::chmod(file.c_str(), 0444);
  ::chmod(folder.path().c_str(), 0555);
  EXPECT_TRUE(holds_unprivileged([&] {
    return ::access(folder.path().c_str(), W_OK) != 0 &&
           MapDatabase(file, MapAccess::read).keyframes().size() == 1;
  }));
  EXPECT_TRUE(holds_unprivileged([&] {
    try {
      const MapDatabase map(file, MapAccess::write);
    } catch (const OutputError& error) {
      return std::string(error.what()).find("Permission denied") != std::string::npos;
    }
    return false;
  }));
  ::chmod(folder.path().c_str(), 0755);
}

std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

TEST(MapFaults, ReadersLeaveNothingBesideAMap) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  {
    MapDatabase map(file, MapAccess::write);
    map.store(record(0, test::add_session(map)));
    EXPECT_EQ(MapDatabase(file, MapAccess::read).keyframes().size(), 1U) << "beside a writer";
  }
  const std::set<std::string> alone = {"map.adit"};
  EXPECT_EQ(files_in(folder.path()), alone);
  const auto written = fs::last_write_time(file);
  {
    const MapDatabase first(file, MapAccess::read);
    const MapDatabase second(file, MapAccess::read);
    EXPECT_EQ(first.keyframes().size() + second.keyframes().size(), 2U);
  }
  EXPECT_EQ(files_in(folder.path()), alone);
  EXPECT_EQ(fs::last_write_time(file), written);
  ::chmod(folder.path().c_str(), 0777);
  ::chmod(file.c_str(), 0444);  // who may not write it must not leave anything either
  EXPECT_TRUE(holds_unprivileged(
      [&] { return MapDatabase(file, MapAccess::read).keyframes().size() == 1; }));
  EXPECT_EQ(files_in(folder.path()), alone);
}

// Where all that was stored lies in the log, a copy without it holds nothing, and says why.
TEST(MapFaults, ACopyWithNothingButALogMissesIt) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  Writer writer(file, 0);
  const int reported = writer.wait_for(2) + writer.kill();
  fs::create_directories(folder / "alone");
  fs::copy_file(file, folder / "alone/map.adit");
  try {
    const MapDatabase alone(folder / "alone/map.adit", MapAccess::read);
    EXPECT_LT(alone.keyframes().size(), static_cast<std::size_t>(reported));  // a checkpoint came
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("without the map.adit-wal"), std::string::npos)
        << error.what();
  }
  fs::copy_file(file.string() + "-wal", folder / "alone/map.adit-wal");
  const MapDatabase both(folder / "alone/map.adit", MapAccess::read);
  EXPECT_GE(both.keyframes().size(), static_cast<std::size_t>(reported));
}

// What lies in the log alone is not in a copy without it; the copy is a whole map of what was
// there before.
TEST(MapFaults, ACopyWithoutItsLogIsAnOlderMap) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  {
    MapDatabase map(file, MapAccess::write);
    test::add_session(map);
  }
  Writer writer(file, 0);
  const int reported = writer.wait_for(5) + writer.kill();
  fs::copy_file(file, folder / "copy.adit");
  const MapDatabase copy(folder / "copy.adit", MapAccess::read);
  EXPECT_TRUE(copy.check().empty());
  EXPECT_LT(copy.keyframes().size(), static_cast<std::size_t>(reported));
}

}  // namespace
}  // namespace adit
