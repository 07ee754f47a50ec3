// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Commands on maps take the folder of a run, say how a map is made where there is none, and do not
// depend on how files are named.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/commands/command_info.hpp"
#include "adit/tools/commands/command_loops.hpp"
#include "adit/tools/commands/command_optimize.hpp"
#include "adit/tools/commands/command_recover.hpp"
#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/map_database/writer_lock.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::Ran;
using test::ran;

/// Six keyframes with a loop, which the optimisation has nothing to quarrel with.
void write_map(const fs::path& file) {
  MapDatabase map(file, MapAccess::write);
  const SessionId session = test::add_session(map);
  for (NodeId id = 0; id < 6; ++id) {
    map.store(test::record_of_a_point(id, session));
  }
  map.revise(test::loops_of_six());
}

class MapFolders : public testing::Test {
 protected:
  /// Every command that takes a map.
  std::vector<Ran> all_of(const fs::path& map) const {
    fs::remove(folder_ / "new.adit");
    return {
        ran(info_command, InfoCommandOptions{.map = map}),
        ran(check_command, InfoCommandOptions{.map = map}),
        ran(loops_command, LoopsCommandOptions{.map = map}),
        ran(export_command,
            ExportCommandOptions{.map = map, .output = folder_ / "path.tum", .trajectory = "tum"}),
        ran(optimize_command, OptimizeCommandOptions{.input = map}),
        ran(recover_command, RecoverCommandOptions{.map = map, .output = folder_ / "new.adit"})};
  }

  void expect_all(const fs::path& map, int code, const std::string& words) const {
    for (const Ran& one : all_of(map)) {
      // The graph of the map is made up: that its optimisation converges is not said here.
      const bool optimised = one.err.find("not converged") != std::string::npos;
      EXPECT_TRUE(one.code == code || (optimised && code == 0)) << one.out << one.err;
      EXPECT_NE((one.out + one.err).find(words), std::string::npos) << one.out << one.err;
    }
  }

  void write_summary(const std::string& mapping) const {
    folder_.write("out/summary.json", R"({"schema": "summary/1", "input": {"path": "my drive.mcap"},
      "configuration": {"mapping": {"enabled": )" +
                                          mapping + "}}}");
  }

  test::TemporaryFolder folder_;
  fs::path out_ = folder_ / "out";
};

TEST_F(MapFolders, EveryCommandTakesTheFolderOfARun) {
  fs::create_directories(out_);
  write_map(out_ / "map.adit");
  for (const fs::path& name : {out_, out_ / "", out_ / "map.adit"}) {
    expect_all(name, 0, "");
    EXPECT_NE(ran(check_command, InfoCommandOptions{.map = name}).out.find("map.adit is whole"),
              std::string::npos);
  }
  const Ran json = ran(info_command, InfoCommandOptions{.map = out_, .json = true});
  EXPECT_EQ(nlohmann::json::parse(json.out).at("map"), (out_ / "map.adit").string());
  // The map of the folder is not written over, either.
  const Ran over =
      ran(export_command,
          ExportCommandOptions{.map = out_, .output = out_ / "map.adit", .trajectory = "tum"});
  EXPECT_EQ(over.code, 2);
  EXPECT_NE(over.err.find("cannot be written over"), std::string::npos) << over.err;
}

TEST_F(MapFolders, WhereThereIsNoMapTheySayHowOneIsMade) {
  expect_all(folder_ / "nowhere", 1, "");
  for (const fs::path& map : {out_, out_ / "map.adit"}) {
    fs::create_directories(out_);
    fs::remove(out_ / "summary.json");
    expect_all(map, 1, "map.adit: there is no such file. `adit run RECORDING -o OUT` makes");
    write_summary("false");
    expect_all(map, 1, "computed the odometry alone (--odometry or mapping.enabled=false)");
    expect_all(map, 1, "adit run my drive.mcap -o OUT");
    write_summary("true");
    expect_all(map, 1, "although the run in its folder makes one");
    folder_.write("out/summary.json", "{ damaged");
    expect_all(map, 1, "map.adit: there is no such file");
  }
  EXPECT_THROW(find_map(folder_ / "nowhere"), InputError);
  const fs::path recording = folder_.write("drive.mcap", std::string(5000, 'x'));
  EXPECT_NE(ran(info_command, InfoCommandOptions{.map = recording}).err.find("adit run RECORDING"),
            std::string::npos);
}

// Names that SQLite would take for something else, in folders whose names are as odd.
TEST_F(MapFolders, NamesOfFilesMeanNothing) {
  const fs::path whole = folder_ / "whole.adit";
  write_map(whole);
  const fs::path before = fs::current_path();
  for (const char* name : {"a?mode=ro&immutable=1#%41.adit", "file:a.adit", "file:a?mode=memory",
                           ":memory:", "two\nlines.adit", "50 %.adit", "\xff\xfe.adit", "-"}) {
    const fs::path folder = folder_ / (std::string("in ") + name);
    fs::create_directories(folder);
    fs::copy_file(whole, folder / name);
    fs::current_path(folder);
    for (const fs::path& map : {fs::path(name), fs::path(".") / name, folder / name}) {
      expect_all(map, 0, "");
      EXPECT_EQ(MapDatabase(map, MapAccess::write).keyframes().size(), 6U) << name;
    }
    fs::current_path(before);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1) << name;
  }
}

TEST_F(MapFolders, APathThatIsTooLongForSqliteIsNoDamage) {
  fs::path deep = folder_.path();
  for (int i = 0; i < 6; ++i) {
    deep /= std::string(100, 'd');
  }
  fs::create_directories(deep);
  write_map(folder_ / "map.adit");
  fs::copy_file(folder_ / "map.adit", deep / "map.adit");
  for (const fs::path& map : {deep / "map.adit", deep}) {
    const Ran check = ran(check_command, InfoCommandOptions{.map = map});
    EXPECT_EQ(check.code, 1);
    EXPECT_NE(check.err.find(" bytes long, and SQLite opens 504 at most"), std::string::npos)
        << check.err;
    EXPECT_EQ(check.err.find("damaged"), std::string::npos) << check.err;
    EXPECT_EQ(
        ran(recover_command, RecoverCommandOptions{.map = map, .output = folder_ / "new.adit"})
            .code,
        0);
    fs::remove(folder_ / "new.adit");
  }
  EXPECT_THROW(MapDatabase(deep / "new.adit", MapAccess::write), OutputError);
}

TEST_F(MapFolders, InfoTellsAMapThatIsBeingWrittenFromOneWhoseRunHasStopped) {
  const fs::path file = folder_ / "map.adit";
  const auto told = [&] { return ran(info_command, InfoCommandOptions{.map = file}).out; };
  {
    MapDatabase map(file, MapAccess::write);
    const SessionId session = test::add_session(map);
    map.begin_run(session);
    std::string text = told();
    EXPECT_NE(text.find("keyframes  none yet"), std::string::npos) << text;
    EXPECT_NE(text.find("writer     process "), std::string::npos) << text;
    map.store(test::record_of_a_point(0, session));
    text = told();
    EXPECT_NE(text.find("not complete: the map is being written"), std::string::npos) << text;
    EXPECT_EQ(text.find("stopped"), std::string::npos) << text;
    EXPECT_EQ(text.find("ended"), std::string::npos) << text;
    const Ran json = ran(info_command, InfoCommandOptions{.map = file, .json = true});
    EXPECT_EQ(nlohmann::json::parse(json.out).at("writer"), writer_of(file).value_or("nobody"));
  }
  EXPECT_FALSE(writer_of(file));
  EXPECT_EQ(told().find("writer"), std::string::npos);
  EXPECT_NE(told().find("not complete: it was stopped or killed"), std::string::npos) << told();
  // A killed writer leaves its lock's file behind, which nobody holds.
  folder_.write("map.adit.lock", "process 1 on nowhere");
  EXPECT_EQ(told().find("writer"), std::string::npos) << told();
}

}  // namespace
}  // namespace adit
