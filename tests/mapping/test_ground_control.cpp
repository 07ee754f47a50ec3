// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/ground_control.hpp"

#include <gtest/gtest.h>

#include "adit/tests/mapping/control_survey.hpp"
#include "adit/tests/support/error_text.hpp"

namespace adit {
namespace {

PoseGraph surveyed_graph() {
  const test::TemporaryFolder folder;
  test::store_surveyed(folder / "map.adit");
  return MapDatabase(folder / "map.adit", MapAccess::read).graph();
}

double rms(const std::vector<Eigen::Vector3d>& errors, const std::vector<ControlPoint>& points,
           ControlRole role) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].role == role) {
      sum += errors[i].squaredNorm();
      ++count;
    }
  }
  return std::sqrt(sum / static_cast<double>(count));
}

TEST(GroundControl, PlacesAMapAndTakesItsBendOut) {
  const std::vector<ControlPoint> points = test::Survey().points();
  const GroundControl found = adjust_to_control(surveyed_graph(), std::nullopt, points);
  EXPECT_GT(rms(found.before, points, ControlRole::check), 0.3) << "by its place alone";
  EXPECT_LT(rms(found.after, points, ControlRole::control), 0.02);
  EXPECT_LT(rms(found.after, points, ControlRole::check), 0.03) << "between control points";
  const WorldFrame frame(found.georeference.origin);
  const Eigen::Vector3d first = found.georeference.T_world_map * Eigen::Vector3d::Zero();
  const Geodetic right =
      test::Survey().frame.place_of(test::Survey::T_world_keyframe(0) * Eigen::Vector3d::Zero());
  EXPECT_LT((first - frame.position_of(right)).norm(), 0.1) << "nothing levels this map";
  EXPECT_LT(std::sqrt(found.georeference.covariance(0, 0)), 0.05);
  EXPECT_GT(found.georeference.covariance(0, 0), 0.0);
}

TEST(GroundControl, CheckPointsMoveNothing) {
  test::Survey survey;
  const GroundControl right = adjust_to_control(surveyed_graph(), std::nullopt, survey.points());
  survey.marks.back().mistake = {0.0, 7.0, 0.0};
  const GroundControl wrong = adjust_to_control(surveyed_graph(), std::nullopt, survey.points());
  EXPECT_EQ(test::largest_difference(right.optimum.poses, wrong.optimum.poses), 0.0);
  EXPECT_NEAR((wrong.after.back() - right.after.back()).norm(), 7.0, 1e-3) << "but it is told";
}

TEST(GroundControl, AMistakeIsNamedAndNothingAdjusted) {
  for (const Eigen::Vector3d& mistake :
       {Eigen::Vector3d(0.0, 60.0, 0.0), Eigen::Vector3d(-15.0, 8.0, 0.0),
        Eigen::Vector3d(0.0, 0.0, 48.0)}) {
    test::Survey survey;
    survey.marks[2].mistake = mistake;
    const std::string error = test::error_of<ControlError>([&] {
      static_cast<void>(adjust_to_control(surveyed_graph(), std::nullopt, survey.points()));
    });
    EXPECT_EQ(error, "the others do not agree with C10") << mistake.transpose();
  }
}

TEST(GroundControl, TwoPointsThatAreExchangedAreRefused) {
  test::Survey survey;
  std::swap(survey.marks[0].name, survey.marks[3].name);
  std::swap(survey.marks[0].keyframe, survey.marks[3].keyframe);
  std::vector<ControlPoint> points = survey.points();
  std::swap(points[0].place, points[3].place);
  const std::string error = test::error_of<ControlError>(
      [&] { static_cast<void>(adjust_to_control(surveyed_graph(), std::nullopt, points)); });
  EXPECT_NE(error.find("C0"), std::string::npos) << error;
  EXPECT_NE(error.find("C15"), std::string::npos) << error;
}

TEST(GroundControl, AMapWithoutAPlaceNeedsThree) {
  test::Survey survey;
  survey.marks.resize(2);
  const auto adjust = [&](const std::optional<Georeference>& georeference) {
    return adjust_to_control(surveyed_graph(), georeference, survey.points());
  };
  EXPECT_EQ(test::error_of<ControlError>([&] { static_cast<void>(adjust(std::nullopt)); }),
            "a map that GNSS has not placed needs three control points or more, there are 2");
  // One that has a place is moved by one alone.
  const Georeference there{.origin = survey.frame.origin(),
                           .T_world_map = test::Survey::T_world_keyframe(0)};
  PoseGraph graph = surveyed_graph();
  graph.set_T_world_map(there.T_world_map);
  survey.marks.resize(1);
  survey.marks[0].mistake = {2.0, 0.0, 0.0};
  const GroundControl moved = adjust_to_control(graph, there, survey.points());
  EXPECT_NEAR(moved.before[0].x(), -2.0, 1e-6);
  EXPECT_LT(moved.after[0].norm(), 1e-3);
  survey.marks[0].role = ControlRole::check;
  EXPECT_EQ(test::error_of<ControlError>(
                [&] { static_cast<void>(adjust_to_control(graph, there, survey.points())); }),
            "none of the points is control");
}

TEST(GroundControl, OneOrTwoAreHeldAgainstTheFixes) {
  test::Survey survey;
  const Georeference there{.origin = survey.frame.origin(),
                           .T_world_map = test::Survey::T_world_keyframe(0)};
  PoseGraph graph = surveyed_graph();
  graph.set_T_world_map(there.T_world_map);
  for (NodeId id = 0; id < test::kSurveyed; ++id) {
    const Eigen::Vector3d antenna(0.0, id % 2 == 0 ? 1.0 : -1.0, 1.0);  // tells the roll, too
    graph.add_fix({.node = id,
                   .p_node = antenna,
                   .p_world = test::Survey::T_world_keyframe(id) * antenna,
                   .information = 2500.0 * Eigen::Matrix3d::Identity()});
  }
  for (const std::size_t count : {1U, 2U}) {
    for (const Eigen::Vector3d& mistake :
         {Eigen::Vector3d(0.0, 11.1, 0.0), Eigen::Vector3d(0.0, 0.0, -48.0)}) {
      survey.marks = test::Survey().marks;
      survey.marks.resize(count);
      const GroundControl right = adjust_to_control(graph, there, survey.points());
      EXPECT_LT(rms(right.after, survey.points(), ControlRole::control), 0.05);
      survey.marks.back().mistake = mistake;
      const std::string error = test::error_of<ControlError>(
          [&] { static_cast<void>(adjust_to_control(graph, there, survey.points())); });
      EXPECT_EQ(error.find("the GNSS fixes do not agree with " + survey.marks.back().name + " ("),
                0U)
          << error;
      survey.marks.back().role = ControlRole::check;  // a mistake in a check point moves nothing
      survey.marks.push_back({.name = "C20", .keyframe = 20});
      EXPECT_NO_THROW(static_cast<void>(adjust_to_control(graph, there, survey.points())));
    }
  }
}

TEST(GroundControl, AMapKeepsItsPoints) {
  const test::TemporaryFolder folder;
  const auto file = folder / "map.adit";
  test::store_surveyed(file);
  const std::vector<ControlPoint> points = test::Survey().points();
  {
    MapDatabase map(file, MapAccess::write);
    const GroundControl found = adjust_to_control(map.graph(), map.georeference(), points);
    map.revise(
        {.poses = found.graph.nodes(), .georeference = found.georeference, .control = points});
    EXPECT_TRUE(map.check().empty());
  }
  MapDatabase map(file, MapAccess::read);
  const std::vector<ControlPoint> kept = map.control_points();
  ASSERT_EQ(kept.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(kept[i].name, points[i].name);
    EXPECT_EQ(kept[i].role, points[i].role);
    EXPECT_EQ(kept[i].keyframe, points[i].keyframe);
    EXPECT_EQ(kept[i].p_keyframe, points[i].p_keyframe);
    EXPECT_EQ(kept[i].p_marked, points[i].p_marked);
    EXPECT_EQ(kept[i].place.latitude, points[i].place.latitude);
    EXPECT_EQ(kept[i].sigma, points[i].sigma);
  }
  EXPECT_EQ(map.graph().fixes().size(), 5U) << "what re-optimises the map keeps to them";
  EXPECT_EQ(map.control_point(6)->name, "K3");
  EXPECT_NE(test::dump_of(map).find("control C0 role control keyframe 0 point"), std::string::npos);
}

}  // namespace
}  // namespace adit
