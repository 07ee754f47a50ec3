// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit convert RUN run.mcap --as foxglove`: what it writes is read back with adit's own reader.
#include "adit/tools/foxglove/foxglove_recording.hpp"

#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/recordings/container_support.hpp"
#include "adit/tests/support/error_text.hpp"
#include "adit/tests/support/protobuf_fields.hpp"
#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/ply_writer.hpp"
#include "adit/tools/commands/command_convert.hpp"
#include "adit/tools/containers/mcap_reader.hpp"
#include "adit/tools/results/sweep_table.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::ProtobufFields;

constexpr Nanoseconds kFirstShown(1'700'000'000'123'456'789);  // of test::record()
const Geodetic kShownOrigin{.latitude = 48.1, .longitude = 11.5, .altitude = 520.0};

/// Three keyframes 10 m apart with a point 1 m to the left of each and 2 m above; an accepted loop
/// has the last one 1 m nearer, and a rejected one ties it to the second.
void write_shown_map(const fs::path& file, bool georeferenced = false) {
  MapDatabase map(file, MapAccess::write);
  const SessionId session = test::add_session(map);
  for (NodeId id = 0; id < 3; ++id) {
    KeyframeRecord record = test::record_of_a_point(id, session);
    if (georeferenced) {
      record.fixes.push_back({.id = id + 1,
                              .keyframe = id,
                              .stamp = record.keyframe.stamp + Nanoseconds(1000),
                              .place = kShownOrigin,
                              .covariance = Eigen::Matrix3d::Identity() * 0.25,
                              .verdict = id == 1 ? FixVerdict::outlier : FixVerdict::thinned});
    }
    map.store(record);
  }
  MapRevision revision{.edges = {test::edge(0, 2, test::step(19.0), 400.0)},
                       .candidates = {{.id = 4,
                                       .from = 0,
                                       .to = 2,
                                       .verdict = CandidateVerdict::accepted,
                                       .reason = "none",
                                       .correction = 1.0},
                                      {.id = 5,
                                       .from = 1,
                                       .to = 2,
                                       .verdict = CandidateVerdict::rejected,
                                       .reason = "too_little_overlap"}}};
  if (georeferenced) {
    revision.georeference = Georeference{.origin = kShownOrigin};
  }
  map.revise(revision);
}

/// The folder of a run without a map: two sweeps, two points, a doubtful stretch.
void write_shown_run(const test::TemporaryFolder& folder) {
  const StampedPose first{.stamp = kFirstShown, .pose = test::step(0.0)};
  const StampedPose second{.stamp = kFirstShown + Nanoseconds(100'000'000),
                           .pose = test::step(2.0)};
  write_trajectory(folder / "trajectory.tum", TrajectoryFormat::tum, std::array{first, second});
  SweepTableWriter table(folder / "sweeps.csv");
  for (const StampedPose& pose : {first, second}) {
    SweepRecord record;
    record.index = 0.0;
    record.stamp = pose.stamp;
    record.state = "tracking";
    record.overlap = 0.5;
    table.write(record);
  }
  table.close();
  PlyWriter cloud(folder / "map.ply");
  cloud.write(std::array{Point{.x = 1.0F, .y = 2.0F, .z = 3.0F, .intensity = 7.0F},
                         Point{.x = 4.0F, .y = 5.0F, .z = 6.0F, .intensity = 8.0F}});
  cloud.close();
  folder.write("drive.mcap", "a recording");
  const nlohmann::json summary = {
      {"input", {{"path", (folder / "drive.mcap").string()}}},
      {"verdict",
       {{"state", "doubtful"},
        {"stretches",
         {{{"state", "doubtful"}, {"begin_s", 0.05}, {"text", "no match held it"}}}}}}};
  folder.write("summary.json", summary.dump());
}

class Foxglove : public testing::Test {
 protected:
  struct Message {
    Nanoseconds stamp{0};
    ProtobufFields fields;
  };

  FoxgloveReport write(const fs::path& input, const char* name = "run.mcap") {
    return write_foxglove({.input = input, .output = folder_ / name}, progress_);
  }

  /// Messages by topic; they must come in the order of their stamps.
  static std::map<std::string, std::vector<Message>> read(const fs::path& file) {
    const std::unique_ptr<MessageFile> mcap = open_mcap(file);
    EXPECT_FALSE(mcap->damage().has_value());
    const test::Reading reading = test::read(*mcap);
    EXPECT_TRUE(reading.errors.empty());
    std::map<std::string, std::vector<Message>> topics;
    Nanoseconds last{0};
    for (const auto& message : reading.messages) {
      EXPECT_GE(message.received, last);
      last = message.received;
      topics[mcap->channels().at(message.channel).topic].push_back(
          {message.received, ProtobufFields(std::span(message.bytes))});
    }
    return topics;
  }

  static Eigen::Vector3d vector(const ProtobufFields& fields) {
    return {fields.real(1), fields.real(2), fields.real(3)};
  }
  static std::vector<Point> points(const ProtobufFields& cloud) {
    const std::string bytes = cloud.text(6);
    std::vector<Point> points(bytes.size() / sizeof(Point));
    std::memcpy(points.data(), bytes.data(), bytes.size());
    return points;
  }

  test::TemporaryFolder folder_;
  std::ostringstream progress_;
};

TEST_F(Foxglove, AMapIsTransformsACloudAndAGraph) {
  write_shown_map(folder_ / "map.adit");
  const FoxgloveReport report = write(folder_.path());
  const auto topics = read(folder_ / "run.mcap");
  EXPECT_EQ(topics.size(), report.topics.size());
  for (const FoxgloveTopic& topic : report.topics) {
    EXPECT_EQ(topics.at(topic.topic).size(), topic.messages) << topic.topic;
  }
  ASSERT_EQ(topics.at("/tf").size(), 3U);
  const Message& last = topics.at("/tf")[2];
  EXPECT_EQ(last.stamp, kFirstShown + Nanoseconds(200'000'000));
  EXPECT_EQ(last.fields.part(1).integer(1), 1'700'000'000);
  EXPECT_EQ(last.fields.part(1).integer(2), 323'456'789);
  EXPECT_EQ(last.fields.text(2), "map");
  EXPECT_EQ(last.fields.text(3), "lidar");
  EXPECT_EQ(vector(last.fields.part(4)), Eigen::Vector3d(20.0, 0.0, 0.0));
  EXPECT_EQ(last.fields.part(5).real(4), 1.0);
  EXPECT_EQ(vector(topics.at("/pose")[1].fields.part(3).part(1)), Eigen::Vector3d(10.0, 0.0, 0.0));
  EXPECT_FALSE(topics.contains("/sweep"));
  EXPECT_FALSE(topics.contains("/gnss/pose"));
}

TEST_F(Foxglove, PointsAreWhereTheMapHasThem) {
  write_shown_map(folder_ / "map.adit");
  write(folder_ / "map.adit");
  const auto topics = read(folder_ / "run.mcap");
  ASSERT_EQ(topics.at("/keyframe/points").size(), 3U);
  const Message& last = topics.at("/keyframe/points")[2];
  EXPECT_EQ(last.stamp, kFirstShown + Nanoseconds(200'000'000));
  EXPECT_EQ(last.fields.text(2), "map");
  EXPECT_EQ(last.fields.part(3).part(2).real(4), 1.0) << "no pose of its own";
  EXPECT_EQ(last.fields.fixed(4), sizeof(Point));
  std::string names;
  for (const ProtobufFields& field : last.fields.parts(5)) {
    EXPECT_EQ(field.integer(3), 7) << "FLOAT32";
    names += field.text(1) + "@" + std::to_string(field.fixed(2)) + " ";
  }
  EXPECT_EQ(names, "x@0 y@4 z@8 moving@12 ");
  const std::vector<Point> seen = points(last.fields);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].x, 20.0F);
  EXPECT_EQ(seen[0].y, 1.0F);
  EXPECT_EQ(seen[0].z, 2.0F);
  EXPECT_EQ(seen[0].intensity, 1.0F) << "it moves";
  ASSERT_EQ(topics.at("/map/points").size(), 1U);
  EXPECT_EQ(topics.at("/map/points")[0].stamp, kFirstShown);
  EXPECT_EQ(points(topics.at("/map/points")[0].fields).size(), 3U);
}

TEST_F(Foxglove, TheGraphIsDrawnAtTheStart) {
  write_shown_map(folder_ / "map.adit");
  write(folder_.path());
  const auto topics = read(folder_ / "run.mcap");
  const auto entity = [&](const std::string& topic) {
    EXPECT_EQ(topics.at(topic).size(), 1U) << topic;
    EXPECT_EQ(topics.at(topic)[0].stamp, kFirstShown);
    return topics.at(topic)[0].fields.part(2);
  };
  EXPECT_EQ(entity("/graph/trajectory").part(11).count(5), 3U);
  EXPECT_EQ(entity("/graph/odometry").part(11).count(5), 3U);
  EXPECT_EQ(entity("/graph/keyframes").count(8), 3U);
  EXPECT_EQ(entity("/graph/constraints").part(11).count(5), 4U) << "two edges in pairs";
  EXPECT_EQ(entity("/graph/constraints").part(11).integer(1), 2) << "LINE_LIST";
  const auto loops = entity("/graph/loops").parts(11);
  ASSERT_EQ(loops.size(), 2U) << "rejected and accepted ones";
  EXPECT_EQ(vector(loops[0].parts(5)[0]), Eigen::Vector3d(10.0, 0.0, 0.0));
  EXPECT_GT(loops[0].part(6).real(1), loops[0].part(6).real(2)) << "red";
  EXPECT_LT(loops[1].part(6).real(1), loops[1].part(6).real(2)) << "green";
  const auto ellipsoids = entity("/graph/uncertainty").parts(9);
  ASSERT_EQ(ellipsoids.size(), 3U);
  EXPECT_NEAR(ellipsoids[0].part(2).real(1), 2.0 * 3.0 * std::sqrt(1.0 / 3.0), 1e-12);
  ASSERT_EQ(topics.at("/log").size(), 2U);
  EXPECT_EQ(topics.at("/log")[0].fields.text(3),
            "loop 4, keyframes 0 and 2: accepted, corrects by 1.00 m");
  EXPECT_EQ(topics.at("/log")[1].fields.text(3),
            "loop 5, keyframes 1 and 2: rejected (too_little_overlap)");
}

TEST_F(Foxglove, WhereTheMapIsOnTheEarthItSaysSo) {
  write_shown_map(folder_ / "map.adit", true);
  write(folder_.path());
  const auto topics = read(folder_ / "run.mcap");
  ASSERT_EQ(topics.at("/tf_static").size(), 1U);
  EXPECT_EQ(topics.at("/tf_static")[0].fields.text(2), "world");
  EXPECT_EQ(topics.at("/tf_static")[0].fields.text(3), "map");
  ASSERT_EQ(topics.at("/gnss/pose").size(), 3U);
  const ProtobufFields& last = topics.at("/gnss/pose")[2].fields;
  EXPECT_NEAR(last.real(1), kShownOrigin.latitude, 1e-9);
  EXPECT_NEAR(last.real(2), kShownOrigin.longitude + 20.0 / 74'490.0, 1e-6) << "20 m to the east";
  EXPECT_NEAR(last.real(3), kShownOrigin.altitude, 1e-3);
  EXPECT_EQ(last.text(7), "lidar");
  EXPECT_EQ(last.integer(5), 0) << "its covariance is not known";
  ASSERT_EQ(topics.at("/gnss/fix").size(), 3U);
  const ProtobufFields& outlier = topics.at("/gnss/fix")[1].fields;
  EXPECT_EQ(outlier.part(9).text(2), "outlier");
  EXPECT_EQ(outlier.integer(5), 3);
  EXPECT_EQ(outlier.text(4).size(), 9 * sizeof(double));
  EXPECT_GT(outlier.part(8).real(1), outlier.part(8).real(2)) << "red";
}

TEST_F(Foxglove, ARunWithoutAMapHasItsCloudSweepsAndVerdict) {
  write_shown_run(folder_);
  write(folder_.path());
  const auto topics = read(folder_ / "run.mcap");
  EXPECT_EQ(topics.at("/tf").size(), 2U);
  EXPECT_EQ(topics.at("/sweep").size(), 2U);
  EXPECT_FALSE(topics.contains("/keyframe/points"));
  EXPECT_FALSE(topics.contains("/graph/loops"));
  const std::vector<Point> cloud = points(topics.at("/map/points")[0].fields);
  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_EQ(cloud[1].y, 5.0F);
  EXPECT_EQ(cloud[1].intensity, 8.0F);
  ASSERT_EQ(topics.at("/log").size(), 2U);
  EXPECT_EQ(topics.at("/log")[0].fields.text(3), "the run is doubtful");
  EXPECT_EQ(topics.at("/log")[1].fields.text(3), "no match held it");
  EXPECT_EQ(topics.at("/log")[1].fields.integer(2), 3) << "WARNING";
  EXPECT_EQ(topics.at("/log")[1].stamp, kFirstShown + Nanoseconds(50'000'000));
}

TEST_F(Foxglove, SchemasAreOfProtobuf) {
  write_shown_map(folder_ / "map.adit");
  write(folder_.path());
  const std::unique_ptr<MessageFile> mcap = open_mcap(folder_ / "run.mcap");
  std::set<std::string> types;
  for (const Channel& channel : mcap->channels()) {
    types.insert(channel.type);
    const ProtobufFields set(channel.definition);
    EXPECT_FALSE(set.parts(1).empty()) << channel.topic;
  }
  EXPECT_EQ(types,
            (std::set<std::string>{"foxglove.FrameTransform", "foxglove.Log", "foxglove.PointCloud",
                                   "foxglove.PoseInFrame", "foxglove.SceneUpdate"}));
  EXPECT_EQ(mcap->format(), "MCAP zstd");
}

TEST_F(Foxglove, TheSameInputGivesTheSameBytes) {
  write_shown_map(folder_ / "map.adit", true);
  write(folder_.path(), "a.mcap");
  write(folder_.path(), "b.mcap");
  EXPECT_EQ(test::content_of(folder_ / "a.mcap"), test::content_of(folder_ / "b.mcap"));
  EXPECT_EQ(test::content_of(folder_ / "a.foxglove.json"),
            test::content_of(folder_ / "b.foxglove.json"));
}

TEST_F(Foxglove, TheLayoutNamesTopicsThatAreThere) {
  write_shown_run(folder_);
  const FoxgloveReport report = write(folder_.path());
  EXPECT_EQ(report.layout, folder_ / "run.foxglove.json");
  std::ifstream file(report.layout);
  const auto layout = nlohmann::json::parse(file);
  const auto& panels = layout.at("configById");
  EXPECT_TRUE(panels.contains("3D!scene"));
  EXPECT_TRUE(panels.at("3D!scene").at("topics").contains("/map/points"));
  EXPECT_EQ(panels.at("3D!scene").at("cameraState").at("targetOffset").at(0), 1.0);
  EXPECT_EQ(panels.at("Plot!alignment").at("paths").at(0).at("value"), "/sweep.overlap");
  EXPECT_FALSE(panels.contains("map!places"));
  for (const auto& [name, panel] : panels.items()) {
    EXPECT_NE(layout.at("layout").dump().find(name), std::string::npos) << name;
  }
}

TEST_F(Foxglove, WhatIsNeitherARunNorAMapSaysWhatIs) {
  const auto said = [&](const fs::path& input) {
    return test::error_of<InputError>([&] { write(input); });
  };
  EXPECT_NE(said(folder_.path()).find("neither map.adit nor trajectory.tum"), std::string::npos);
  EXPECT_NE(said(folder_ / "none").find("no such folder or file"), std::string::npos);
  EXPECT_NE(said(folder_ / "none.adit").find("none.adit"), std::string::npos);
  const fs::path recording = folder_.write("drive.mcap", "x");
  EXPECT_NE(said(recording).find("adit run RECORDING"), std::string::npos);
  folder_.write("map.adit", "no map");
  EXPECT_NE(said(folder_.path()).find("map.adit"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "run.mcap"));
  EXPECT_FALSE(fs::exists(folder_ / "run.mcap.part"));
}

TEST_F(Foxglove, ACloudThatIsCutOffLeavesNothing) {
  write_shown_run(folder_);
  fs::resize_file(folder_ / "map.ply", fs::file_size(folder_ / "map.ply") - 1);
  EXPECT_NE(test::error_of<InputError>([&] { write(folder_.path()); }).find("map.ply"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "run.mcap"));
  EXPECT_FALSE(fs::exists(folder_ / "run.mcap.part"));
}

TEST_F(Foxglove, NothingIsWrittenOverWhatItComesFrom) {
  write_shown_run(folder_);
  EXPECT_NE(test::error_of<UsageError>([&] {
              write(folder_.path(), "drive.mcap");
            }).find("cannot be written over"),
            std::string::npos);
  EXPECT_EQ(test::content_of(folder_ / "drive.mcap"), "a recording");
}

TEST_F(Foxglove, TheCommandTellsWhatItWroteAndRefusesTheRest) {
  write_shown_map(folder_ / "map.adit");
  const auto run = [&](ConvertOptions options) {
    options.input = folder_ / "map.adit";
    options.foxglove = true;
    return test::ran(convert_command, options);
  };
  const test::Ran done = run({.output = folder_ / "run.mcap", .compression = Compression::lz4});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.out.find("foxglove.SceneUpdate"), std::string::npos) << done.out;
  EXPECT_NE(done.out.find("run.foxglove.json"), std::string::npos) << done.out;
  EXPECT_EQ(open_mcap(folder_ / "run.mcap")->format(), "MCAP lz4");
  EXPECT_EQ(run({.output = folder_ / "run.bag"}).code, 2);
  EXPECT_EQ(run({.output = folder_ / "run.mcap", .topics = {"/tf"}}).code, 2);
  EXPECT_EQ(run({.output = folder_ / "run.mcap", .begin_s = 1.0}).code, 2);
  EXPECT_EQ(run({.output = folder_ / "run.mcap", .encoding = Encoding::cdr}).code, 2);
  EXPECT_EQ(run({.output = folder_ / "run.mcap", .compression = Compression::bz2}).code, 2);
  ConvertOptions missing{.input = folder_ / "none", .output = folder_ / "x.mcap"};
  missing.foxglove = true;
  const test::Ran failed = test::ran(convert_command, missing);
  EXPECT_EQ(failed.code, 1);
  EXPECT_NE(failed.err.find("none"), std::string::npos) << failed.err;
}

}  // namespace
}  // namespace adit
