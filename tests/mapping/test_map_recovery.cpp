// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Maps that a disk has spoilt: what is told of them and what is recovered. Which page holds what is
// what SQLite itself says of the whole map (its table dbstat).
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/map_database/map_recovery.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_database/write_ahead_log.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::dump_of;

constexpr std::size_t kPage = 4096;
constexpr NodeId kKeyframes = 22;

/// A record whose submap is one, of points that do not fit into one page.
KeyframeRecord whole_record(NodeId id, SessionId session) {
  KeyframeRecord whole = test::record(id, session);
  KeyframeSubmap submap{
      .r_submap = 0.25, .sweeps = {SubmapSweep{.stamp = whole.keyframe.stamp}}, .points = {}};
  Random random(static_cast<uint64_t>(id) + 1);
  for (int i = 0; i < 900; ++i) {
    const auto place = [&] { return static_cast<int32_t>(random.uniform(-40000.0, 40000.0)); };
    submap.points.push_back({.place = {place(), place(), place()}});
  }
  whole.submap = encode(submap);
  if (id > 3 && id % 3 == 0) {
    whole.candidates.push_back({.from = id - 3, .to = id, .reason = "overlap"});
    MapFix fix;
    fix.id = id / 3 - 1;
    fix.keyframe = id;
    whole.fixes.push_back(fix);
  }
  return whole;
}

/// What SQLite says of a page.
struct PageUse {
  std::string table;
  std::string kind;
  std::size_t rows = 0;
};

class MapRecoveries : public testing::Test {
 protected:
  void SetUp() override {
    {
      MapDatabase map(file_, MapAccess::write);
      const SessionId session = test::add_session(map);
      for (NodeId id = 0; id < kKeyframes; ++id) {
        map.store(whole_record(id, session));
      }
    }
    before_ = dump_of(MapDatabase(file_, MapAccess::read));
    edges_ = MapDatabase(file_, MapAccess::read).graph().edges().size();
    const SqliteDatabase raw(file_, SqliteDatabase::Mode::frozen);
    SqliteStatement rows = raw.prepare("SELECT pageno, name, pagetype, ncell FROM dbstat");
    while (rows.step()) {
      uses_[static_cast<std::size_t>(rows.integer(0))] = {
          .table = rows.text(1),
          .kind = rows.text(2),
          .rows = static_cast<std::size_t>(rows.integer(3))};
    }
    std::ifstream in(file_, std::ios::binary);
    bytes_ = std::string(std::istreambuf_iterator<char>(in), {});
  }

  fs::path with(const std::string& name, const std::string& bytes) const {
    return folder_.write(name, bytes);
  }

  /// With a page (from 1) of random bytes.
  fs::path spoilt(std::size_t page) const {
    return with("spoilt.adit", spoilt_at(bytes_, (page - 1) * kPage));
  }

  static std::string spoilt_at(std::string bytes, std::size_t offset) {
    Random random(offset + 1);
    for (std::size_t i = offset; i < std::min(bytes.size(), offset + kPage); ++i) {
      bytes[i] = static_cast<char>(static_cast<int>(random.uniform(0.0, 256.0)));
    }
    return bytes;
  }

  MapRecovery recovered(const fs::path& damaged) const {
    fs::remove(whole());
    return recover_map(damaged, whole());
  }

  /// The new map can be used, and has nothing that the old one had not.
  void expect_whole(const MapRecovery& done, const std::string& which) const {
    const MapDatabase map(whole(), MapAccess::read);
    EXPECT_TRUE(map.check().empty()) << which;
    std::istringstream lines(dump_of(map));
    for (std::string line; std::getline(lines, line);) {
      const bool counted_anew = line.starts_with("edge ");
      const bool emptied = line.starts_with("submap ") && !done.without_points.empty();
      const bool stand_in = line.starts_with("session ");
      if (!counted_anew && !emptied && !stand_in) {
        EXPECT_NE(before_.find(line), std::string::npos) << which << ": " << line;
      }
    }
    for (const MapKeyframe& keyframe : map.keyframes()) {
      EXPECT_EQ(load_submap(map, keyframe.id, whole()).points.empty(),
                done.without_points.contains(keyframe.id))
          << which;
    }
    EXPECT_EQ(done.keyframes, map.keyframes().size());
    EXPECT_EQ(done.edges, map.graph().edges().size());
    EXPECT_EQ(done.parts, connected_components(map.graph()).components.size());
    if (!done.may_lack_more) {
      EXPECT_EQ(done.keyframes + done.lost_keyframes.size(), std::size_t{kKeyframes}) << which;
      EXPECT_EQ(done.edges + done.lost_edges, edges_) << which;
    }
  }

  fs::path whole() const { return folder_ / "whole.adit"; }

  test::TemporaryFolder folder_;
  fs::path file_ = folder_ / "map.adit";
  std::string before_;
  std::string bytes_;
  std::size_t edges_ = 0;
  std::map<std::size_t, PageUse> uses_;
};

bool is_content(const std::string& table) {
  return table == "keyframes" || table == "chunks" || table == "edges" || table == "sessions" ||
         table == "candidates" || table == "fixes" || table == "provenance";
}

TEST_F(MapRecoveries, AMapThatIsWholeIsCopied) {
  const MapRecovery done = recovered(file_);
  EXPECT_TRUE(done.problems.empty());
  EXPECT_TRUE(done.damaged_pages.empty());
  EXPECT_EQ(dump_of(MapDatabase(whole(), MapAccess::read)), before_);
}

// Whichever page a disk has spoilt: all is recovered but for what lay on it, and that is counted.
TEST_F(MapRecoveries, AnyPageMayBeSpoilt) {
  std::size_t of_chunks = 0;
  for (const auto& [page, use] : uses_) {
    if (use.table == "chunks" && use.kind != "internal" && ++of_chunks % 9 != 0) {
      continue;  // a sample of those that are alike
    }
    const std::string which = std::to_string(page) + " " + use.table + " " + use.kind;
    const MapRecovery done = recovered(spoilt(page));
    expect_whole(done, which);
    if (use.kind == "internal" || !is_content(use.table)) {
      EXPECT_EQ(dump_of(MapDatabase(whole(), MapAccess::read)), before_) << which;
      EXPECT_EQ(done.lost_keyframes.size() + done.without_points.size() + done.lost_edges, 0U);
      continue;
    }
    const std::size_t rows = use.kind == "overflow" ? 1 : use.rows;
    const std::size_t keyframes = use.table == "keyframes" ? rows : 0;
    EXPECT_EQ(done.keyframes, kKeyframes - keyframes) << which;
    EXPECT_EQ(done.lost_keyframes.size(), keyframes) << "their submaps and edges tell: " << which;
    if (use.table == "edges") {
      EXPECT_EQ(done.edges, edges_ - rows) << which;
    } else {
      EXPECT_GE(done.edges + keyframes + 1, keyframes > 0 ? edges_ : edges_ + 1) << which;
      EXPECT_EQ(done.edges + done.lost_edges, edges_) << which;
    }
    EXPECT_LE(done.without_points.size(), use.table == "chunks" ? rows : 0) << which;
    EXPECT_EQ(done.parts > 1, done.edges + 1 < done.keyframes) << which;
    EXPECT_FALSE(use.rows > 0 && done.problems.empty()) << which;
  }
}

TEST_F(MapRecoveries, AFileThatIsCutOffKeepsWhatIsBeforeTheCut) {
  for (const int percent : {25, 50, 75, 95}) {
    const std::size_t cut = bytes_.size() * static_cast<std::size_t>(percent) / 100 + 100;
    std::size_t keyframes = 0;
    for (const auto& [page, use] : uses_) {
      const bool is_there = page * kPage <= cut;
      keyframes += is_there && use.table == "keyframes" && use.kind == "leaf" ? use.rows : 0;
    }
    if (keyframes == 0) {
      EXPECT_THROW(recovered(with("spoilt.adit", bytes_.substr(0, cut))), InputError);
      EXPECT_FALSE(fs::exists(whole()));
      continue;
    }
    const MapRecovery done = recovered(with("spoilt.adit", bytes_.substr(0, cut)));
    expect_whole(done, std::to_string(percent) + " %");
    EXPECT_EQ(done.keyframes, keyframes);
    EXPECT_GE(done.edges + 1, done.keyframes / 2);
    EXPECT_FALSE(done.problems.empty());
  }
}

TEST_F(MapRecoveries, WhatIsNoMapIsRefused) {
  for (const std::string& bytes : {std::string(), std::string(10000, '\x5a'), before_}) {
    EXPECT_THROW(recovered(with("none.adit", bytes)), InputError);
  }
  EXPECT_THROW(recovered(folder_ / "missing.adit"), InputError);
  EXPECT_FALSE(fs::exists(whole()));
  const MapDatabase writer(file_, MapAccess::write);
  EXPECT_THROW(recovered(file_), LockedError);
}

// What is told of a damaged page names the place, and each cause once.
TEST_F(MapRecoveries, ACheckNamesTheTable) {
  for (const auto& [page, use] : uses_) {
    const bool is_root = use.kind == "internal" && use.table != "sqlite_schema";
    if (!is_root || use.table.starts_with("places")) {
      continue;
    }
    const std::vector<std::string> problems = MapDatabase(spoilt(page), MapAccess::read).check();
    EXPECT_FALSE(problems.empty()) << use.table;
    EXPECT_LE(problems.size(), 8U) << use.table;
    const std::string name = use.table.find("chunks") == std::string::npos ? use.table : "chunks";
    EXPECT_TRUE(std::ranges::any_of(problems, [&](const std::string& problem) {
      return problem.find(name) != std::string::npos;
    })) << use.table;
  }
}

/// Copies of a map that is being written, and of its log, as a kill leaves them.
class MapLogs : public MapRecoveries {
 protected:
  void SetUp() override {
    MapRecoveries::SetUp();
    MapDatabase writer(folder_ / "logged.adit", MapAccess::write);
    const SessionId session = test::add_session(writer);
    for (NodeId id = 0; id < kKeyframes; ++id) {
      writer.store(whole_record(id, session));
    }
    fs::create_directories(folder_ / "copy");
    fs::copy_file(folder_ / "logged.adit", map_);
    std::ifstream in(folder_ / "logged.adit-wal", std::ios::binary);
    log_ = std::string(std::istreambuf_iterator<char>(in), {});
  }

  void write_log(const std::string& bytes) const { with("copy/map.adit-wal", bytes); }
  std::vector<std::string> check() const { return MapDatabase(map_, MapAccess::read).check(); }

  fs::path map_ = folder_ / "copy/map.adit";
  std::string log_;
};

TEST_F(MapLogs, WhatAKillLeavesIsNoFault) {
  constexpr std::size_t kFrame = kPage + 24;
  for (const std::size_t missing : {std::size_t{0}, std::size_t{100}, kFrame, 2 * kFrame + 5}) {
    write_log(log_.substr(0, log_.size() - missing));
    EXPECT_TRUE(check().empty()) << missing;
  }
  // Nor is a last transaction without its end, or what an older log has left behind it.
  std::string older = log_.substr(0, log_.size() - kFrame) + log_.substr(32, 40 * kFrame);
  for (std::size_t at = log_.size() - kFrame; at < older.size(); at += kFrame) {
    older[at + 8] = static_cast<char>(older[at + 8] + 1);
  }
  write_log(older);
  EXPECT_TRUE(check().empty());
}

TEST_F(MapLogs, ADamagedFrameIsToldAndWhatFollowsItIsSalvaged) {
  write_log(spoilt_at(log_, log_.size() / 2));
  const std::size_t read = MapDatabase(map_, MapAccess::read).keyframes().size();
  ASSERT_LT(read, std::size_t{kKeyframes} - 5);
  const std::vector<std::string> problems = check();
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_NE(problems[0].find("map.adit-wal, frame "), std::string::npos) << problems[0];
  const MapRecovery done = recovered(map_);
  expect_whole(done, "log");
  EXPECT_TRUE(done.may_lack_more);
  EXPECT_GE(done.keyframes, std::size_t{kKeyframes} - 10);
  EXPECT_GE(done.edges + 11, std::size_t{kKeyframes});
}

TEST_F(MapLogs, ALogWithoutItsHeadIsToldAndSalvaged) {
  std::string headless = log_;
  headless.replace(0, 32, 32, '\x5a');
  write_log(headless);
  const std::vector<std::string> problems = check_log(map_);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_NE(problems[0].find("header"), std::string::npos) << problems[0];
  const MapRecovery done = recovered(map_);
  expect_whole(done, "log");
  EXPECT_EQ(done.keyframes, std::size_t{kKeyframes});
}

/// Runs it in a process of its own; returns that.
template <class Action>
pid_t apart(const Action& action) {
  const pid_t child = ::fork();
  if (child == 0) {
    int code = 3;
    try {
      code = action();
    } catch (const std::exception&) {
    }
    ::_exit(code);
  }
  return child;
}

TEST_F(MapRecoveries, AKillLeavesNoMapThatLooksWhole) {
  Random random(5);
  for (int i = 0; i < 5; ++i) {
    const pid_t child = apart([&] {
      recover_map(file_, whole());
      return 0;
    });
    std::this_thread::sleep_for(
        std::chrono::microseconds(static_cast<int>(random.uniform(0.0, 60000.0))));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    if (fs::exists(whole())) {
      EXPECT_EQ(dump_of(MapDatabase(whole(), MapAccess::read)), before_);
      fs::remove(whole());
    }
  }
  with("whole.adit.part", "of an earlier one");
  EXPECT_EQ(recovered(file_).keyframes, std::size_t{kKeyframes});
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_.path())) {
    names.insert(entry.path().filename().string());
  }
  EXPECT_EQ(names, (std::set<std::string>{"map.adit", "whole.adit"}));
}

TEST_F(MapRecoveries, AFullDiskNamesTheFileAndLeavesNothing) {
  const pid_t child = apart([&] {
    const rlimit limit{.rlim_cur = 60 * kPage, .rlim_max = 60 * kPage};
    std::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      recover_map(file_, whole());
    } catch (const OutputError& error) {
      const std::string text = error.what();
      const bool told = text.find("whole.adit.part") != std::string::npos &&
                        text.find("make room") != std::string::npos;
      return told ? 0 : 1;
    }
    return 2;
  });
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace adit
