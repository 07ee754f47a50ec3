// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/run_loops_section.hpp"

#include <string>

#include <gtest/gtest.h>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/drawing/map_page.hpp"

namespace adit {
namespace {

/// The folder of a run with six keyframes and two loops, one of which was accepted.
class LoopsOfRun : public testing::Test {
 protected:
  void write_map(int64_t more_loops = 0) const {
    MapDatabase map(files_.database, MapAccess::write);
    const SessionId session = test::add_session(map);
    for (NodeId id = 0; id < 6; ++id) {
      map.store(test::record_of_a_point(id, session));
    }
    MapRevision revision = test::loops_of_six();
    for (int64_t i = 0; i < more_loops; ++i) {
      revision.candidates.push_back(revision.candidates.front());
      revision.candidates.back().id = 3 + i;
    }
    map.revise(revision);
  }

  test::TemporaryFolder folder_;
  RunFiles files_{folder_.path()};
};

TEST_F(LoopsOfRun, AreToldWithReasonsGraphAndTheDriftBeforeAndAfter) {
  write_map();
  folder_.write("odometry.tum", "0.0 0 0 0 0 0 0 1\n1.0 10 0 0 0 0 0 1\n2.0 20 0 0 0 0 0 1\n");
  folder_.write("trajectory.tum", "0.0 0 0 0 0 0 0 1\n1.0 9 0 0 0 0 0 1\n2.0 19.5 0 0 0 0 0 1\n");
  const LoopsSection section = run_loops_section(files_);
  EXPECT_EQ(section.headline, "1 of 2 loops accepted");
  for (const char* part :
       {"<dt>accepted</dt><dd>1</dd>", "<dt>rejected: too_little_overlap</dt><dd>1</dd>",
        "<dt>odometry alone</dt><dd>1.000 m (median), 1.000 m at most",
        "up to 1.000 m from the odometry (1.0 s after the start), and 0.500 m at the end",
        "Keyframes and loops from above", "<svg"}) {
    EXPECT_NE(section.body.find(part), std::string::npos) << part << "\n" << section.body;
  }
  EXPECT_EQ(section.body.find("http://example"), std::string::npos);
  const std::string page = map_page({.title = "run",
                                     .headline = "",
                                     .section = section.headline,
                                     .details = section.body,
                                     .points = {},
                                     .poses = {}});
  EXPECT_NE(page.find("<summary>1 of 2 loops accepted</summary>"), std::string::npos);
  EXPECT_EQ(page.find("@panel@"), std::string::npos);
}

TEST_F(LoopsOfRun, AreDrawnInABoundedSize) {
  write_map(20'000);
  const LoopsSection section = run_loops_section(files_);
  EXPECT_EQ(section.headline, "20001 of 20002 loops accepted");
  EXPECT_LT(section.body.size(), 1'000'000U);
}

TEST_F(LoopsOfRun, WithoutAMapOrWithOneThatCannotBeReadThereAreNone) {
  EXPECT_EQ(run_loops_section(files_).headline, "");
  const std::string page = map_page({.title = "run", .headline = "", .points = {}, .poses = {}});
  EXPECT_EQ(page.find("<details"), std::string::npos);
  folder_.write("map.adit", "no database");
  const LoopsSection broken = run_loops_section(files_);
  EXPECT_EQ(broken.headline, "The loops cannot be shown");
  EXPECT_NE(broken.body.find("map.adit"), std::string::npos) << broken.body;
}

}  // namespace
}  // namespace adit
