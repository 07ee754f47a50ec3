// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Trajectories as KML, for programs that read `gx:Track` and for those that do not.
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_export.hpp"

namespace adit {
namespace {

/// The trajectory of a map whose keyframes are recorded from `first` on, 0.1 s apart.
std::string kml_of(NodeId keyframes, Nanoseconds first) {
  const test::TemporaryFolder folder;
  ExportCommandOptions options{.map = folder / "map.adit",
                               .output = folder / "path.kml",
                               .trajectory = "kml",
                               .origin = "47.0,8.0,400,30"};
  {
    MapDatabase map(options.map, MapAccess::write);
    const SessionId session = test::add_session(map);
    for (NodeId id = 0; id < keyframes; ++id) {
      KeyframeRecord record = test::record_of_a_point(id, session);
      KeyframeSubmap submap;
      submap.sweeps.push_back({.stamp = first + id * Nanoseconds(100'000'000)});
      record.submap = encode(submap);
      map.store(record);
    }
  }
  const test::Ran done = test::ran(export_command, options);
  EXPECT_EQ(done.code, 0) << done.err;
  return test::content(*options.output);
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t at = text.find(begin);
  return at == std::string::npos
             ? ""
             : text.substr(at + begin.size(), text.find(end, at) - at - begin.size());
}

TEST(KmlTrajectory, IsALineAndBesideItATrackWithTimes) {
  const std::string kml = kml_of(6, Nanoseconds(1'700'000'000'250'000'000));
  EXPECT_EQ(test::count(kml, "<Placemark>"), 2U) << kml;
  const std::string line =
      between(kml, "<LineString>\n<altitudeMode>absolute</altitudeMode>\n<coordinates>\n",
              "</coordinates>\n</LineString>\n</Placemark>");
  EXPECT_EQ(test::count(line, "\n"), 6U) << kml;
  EXPECT_TRUE(line.starts_with("8.0000000000,47.0000000000,400.0000\n")) << line;
  const std::string track = between(kml, "<gx:Track>", "</gx:Track>\n</Placemark>");
  EXPECT_EQ(test::count(track, "<gx:coord>"), 6U);
  EXPECT_NE(track.find("<when>2023-11-14T22:13:20.250Z</when>"), std::string::npos) << track;
}

TEST(KmlTrajectory, IsALineAloneWhereTimesAreTheRecordingsOwn) {
  const std::string kml = kml_of(6, Nanoseconds(0));
  EXPECT_EQ(test::count(kml, "<Placemark>"), 1U) << kml;
  EXPECT_EQ(test::count(kml, "<LineString>"), 1U);
}

// A line has two ends.
TEST(KmlTrajectory, OfOneSweepIsAPoint) {
  const std::string kml = kml_of(1, Nanoseconds(0));
  EXPECT_EQ(between(kml, "<Point>\n<altitudeMode>absolute</altitudeMode>\n<coordinates>\n", "\n</"),
            "8.0000000000,47.0000000000,400.0000")
      << kml;
  EXPECT_EQ(test::count(kml, "<LineString>"), 0U);
}

}  // namespace
}  // namespace adit
