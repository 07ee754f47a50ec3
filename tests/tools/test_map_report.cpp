// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_export.hpp"

namespace adit {
namespace {

TEST(MapReport, HasWhatIsLeftOfFixes) {
  const test::TemporaryFolder folder;
  const auto file = folder / "placed.adit";
  const Geodetic origin{.latitude = 48.1, .longitude = 11.5, .altitude = 520.0};
  {
    MapDatabase map(file, MapAccess::write);
    const SessionId session = test::add_session(map);
    for (NodeId id = 0; id < 4; ++id) {
      KeyframeRecord record = test::record_of_a_point(id, session);
      MapFix fix{.id = id + 1,
                 .keyframe = id,
                 .stamp = record.keyframe.stamp,
                 .kind = GnssFixKind::ground_augmented,
                 .place = origin,
                 .covariance = Eigen::Matrix3d::Identity() * 0.01,
                 .verdict = id < 2 ? FixVerdict::used : FixVerdict::outlier,
                 .information = Eigen::Matrix3d::Identity() * 100.0};
      const Eigen::Vector3d off(id == 0 ? 0.3 : 0.1, 0.0, id == 0 ? 0.4 : -0.4);
      fix.p_keyframe_antenna = record.keyframe.T_map_keyframe.inverse() * off;
      record.fixes.push_back(fix);
      map.store(record);
    }
    map.revise({.georeference = Georeference{.origin = origin}});
  }
  const auto page = folder / "placed.html";
  const test::Ran ran =
      test::ran(export_command, ExportCommandOptions{.map = file, .output = page, .report = true});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const std::string report = test::content(page);
  for (const char* part :
       {"<dt>map less fixes, ground-augmented (RTK)</dt><dd>rmse level 0.224 m, "
        "up 0.400 m; largest 0.500 m</dd>",
        "<dt>range sensor</dt><dd>4 sweeps, ",
        "<dt>inertial sensor</dt><dd>no keyframe is levelled by one</dd>",
        "<dt>GNSS receiver</dt><dd>4 fixes, ",
        "<dt>the odometry alone</dt><dd>from the first keyframe on up to ", ">N</text>"}) {
    EXPECT_NE(report.find(part), std::string::npos) << part;
  }
}

}  // namespace
}  // namespace adit
