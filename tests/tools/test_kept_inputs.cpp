// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is read is never written over, by any command.
#include "adit/tools/results/kept_inputs.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/program_support.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/drawing/html_page.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

TEST(KeptInputs, AFileIsKeptByAnyOfItsNames) {
  const test::TemporaryFolder folder;
  const fs::path map = folder.write("map.adit", "poses");
  fs::create_symlink(map, folder / "link.html");
  fs::create_hard_link(map, folder / "hard.html");
  for (const fs::path& output :
       {map, folder / "." / "map.adit", folder / "link.html", folder / "hard.html",
        folder / "map.adit-wal", folder / "map.adit-shm", folder / "map.adit-journal"}) {
    EXPECT_TRUE(would_change(output, map)) << output;
  }
  const fs::path draft = folder.write("new.adit.part", "what a killed recovery has left");
  EXPECT_TRUE(would_change(folder / "new.adit", draft)) << "it is written as a draft first";
  EXPECT_TRUE(fs::exists(draft)) << "asking takes nothing away";
  for (const fs::path& output : {folder / "map.html", folder / "map.adit-walk", fs::path()}) {
    EXPECT_FALSE(would_change(output, map)) << output;
  }
  EXPECT_FALSE(would_change("/dev/null", "/dev/null"));
  EXPECT_FALSE(would_change(folder / "new.html", "no such file"));
}

TEST(KeptInputs, OfAFolderWhatIsReadIsKeptAndPagesAreNot) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "drive" / "oxts");
  const fs::path sweep = folder.write("drive/oxts/0.txt", "a sweep");
  EXPECT_TRUE(would_change(sweep, folder / "drive"));
  EXPECT_FALSE(would_change(folder / "drive" / "new.html", folder / "drive"));
  folder.write("drive/page.html", html_page("a page", ""));
  EXPECT_FALSE(would_change(folder / "drive" / "page.html", folder / "drive"));

  fs::create_directories(folder / "out");
  folder.write("out/summary.json", R"({"adit": "0.1.0", "status": "completed"})");
  for (const char* name : {"map.adit", "trajectory.tum", "sweeps.csv"}) {
    folder.write(std::string("out/") + name, "a result");
    EXPECT_TRUE(would_change(folder / "out" / name, folder / "out")) << name;
  }
  EXPECT_TRUE(would_change(folder / "out" / "summary.json", folder / "out"));
  folder.write("out/error.svg", "of another program");
  EXPECT_FALSE(would_change(folder / "out" / "error.svg", folder / "out")) << "no run reads it";
}

TEST(KeptInputs, TheRefusalNamesTheOptionAndBothFiles) {
  const test::TemporaryFolder folder;
  const fs::path map = folder.write("map.adit", "poses");
  try {
    keep_input("--html", folder / "map.adit-wal", map);
    FAIL();
  } catch (const UsageError& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with("--html: " + map.string() + "-wal belongs to " + map.string()))
        << text;
    EXPECT_NE(text.find("cannot be written over"), std::string::npos) << text;
  }
}

/// Each output of each command, named as one of its inputs.
TEST(KeptInputs, EveryCommandLeavesWhatItReads) {
  const test::TemporaryFolder folder;
  const std::string map = (folder / "map.adit").string();
  {
    MapDatabase database(map, MapAccess::write);
    const SessionId session = test::add_session(database);
    database.store(test::record_of_a_point(0, session));
  }
  const std::string cloud = folder.write("a.ply", "points").string();
  const std::string truth = folder.write("truth.tum", "0 0 0 0 0 0 0 1\n").string();
  const std::string scene = folder.write("scene.toml", "scene = \"room\"\n").string();
  const std::string out = folder.path().string();
  folder.write("summary.json", R"({"adit": "0.1.0", "status": "completed"})");
  const std::string first = cloud + "@0";
  const std::string setting = "recording.metadata=" + scene;
  using Words = std::vector<const char*>;
  const auto of = [](const std::string& text) { return text.c_str(); };
  for (const Words& words : {
           Words{"loops", of(map), "--html", of(map)},
           Words{"evaluate", of(out), of(truth), "--html", of(map)},
           Words{"evaluate", of(out), of(truth), "--html", of(truth)},
           Words{"evaluate", of(truth), of(truth), "--plot", of(truth)},
           Words{"align", of(cloud), of(first), "--picture", of(cloud)},
           Words{"inspect", of(cloud), "--html", of(cloud)},
           Words{"inspect", of(cloud), "--write-config", of(cloud)},
           Words{"inspect", of(cloud), "--config", of(scene), "--html", of(scene)},
           Words{"inspect", of(cloud), "--set", of(setting), "--html", of(scene)},
           Words{"export", of(map), "--dump", "-o", of(map)},
           Words{"export", of(map), "--cloud", "ply", "--polygon", of(truth), "-o", of(truth)},
           Words{"convert", of(cloud), of(cloud)},
           Words{"recover", of(map), "-o", of(map)},
           Words{"simulate", of(scene), "-o", of(scene)},
           Words{"loops", of(map), "--log", of(map)},
           Words{"info", of(map), "--log", of(map)},
           Words{"check", of(map), "--log", of(map)},
       }) {
    std::string line;
    for (const char* word : words) {
      line += std::string(word) + " ";
    }
    const std::string before = test::content(map) + test::content(cloud) + test::content(truth) +
                               test::content(scene) + test::content(folder / "summary.json");
    const test::Answer answer = test::call(words);
    EXPECT_NE(answer.code, 0) << line;
    EXPECT_TRUE(answer.err.find("cannot be written over") != std::string::npos ||
                answer.err.find("is left as it is") != std::string::npos ||
                answer.err.find("is not replaced") != std::string::npos)
        << line << answer.err;
    EXPECT_EQ(test::content(map) + test::content(cloud) + test::content(truth) +
                  test::content(scene) + test::content(folder / "summary.json"),
              before)
        << line;
  }
}

}  // namespace
}  // namespace adit
