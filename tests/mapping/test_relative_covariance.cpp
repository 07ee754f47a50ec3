// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/relative_covariance.hpp"

#include <random>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

using test::edge;
using test::step;

PoseEdge known_edge(NodeId from, NodeId to, const Eigen::Isometry3d& T_from_to,
                    const Matrix6d& known) {
  PoseEdge result = edge(from, to, T_from_to);
  result.information = known.inverse();
  return result;
}

double largest(const Matrix6d& matrix) {
  return matrix.cwiseAbs().maxCoeff();
}

TEST(RelativeCovariance, AnEdgesCovarianceIsTheInverseOfItsInformationWhereItHasSome) {
  PoseEdge known = known_edge(0, 1, step(1.0), test::diagonal_covariance(0.03, 0.002));
  EXPECT_LT(largest(covariance_of(known) - test::diagonal_covariance(0.03, 0.002)), 1e-12);
  known.information(0, 0) = 0.0;
  const Matrix6d half = covariance_of(known);
  EXPECT_NEAR(half(0, 0), 100.0, 1e-9) << "10 m in a direction without information";
  EXPECT_NEAR(half(1, 1), 9e-4, 1e-9);
  EXPECT_NEAR(half(0, 1), 0.0, 1e-9);
}

TEST(RelativeCovariance, AlongAChainItIsTheCompositionOfTheEdges) {
  // As seen from the last node, edges are walked against their direction.
  PoseGraph graph;
  std::vector<PoseEdge> edges;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (NodeId id = 0; id < 5; ++id) {
    graph.add_node({.id = id, .T_map_node = pose});
    if (id < 4) {
      const Eigen::Isometry3d way = step(1.5, 0.3 * static_cast<double>(id));
      edges.push_back(
          known_edge(id, id + 1, way,
                     test::diagonal_covariance(0.02 * (1.0 + static_cast<double>(id)), 0.01)));
      pose = pose * way;
    }
  }
  for (const PoseEdge& e : edges) {
    graph.add_edge(e);
  }
  const auto places = relative_places(graph, 4);
  Matrix6d expected = Matrix6d::Zero();
  EXPECT_EQ(largest(places[4]->covariance), 0.0);
  for (NodeId id = 3; id >= 0; --id) {
    const PoseEdge& e = edges[static_cast<std::size_t>(id)];
    const Matrix6d own = adjoint(e.T_from_to);
    expected = own * expected * own.transpose() + own * e.information.inverse() * own.transpose();
    ASSERT_TRUE(places[static_cast<std::size_t>(id)]);
    EXPECT_LT(largest(places[static_cast<std::size_t>(id)]->covariance - expected), 1e-9);
    EXPECT_NEAR(places[static_cast<std::size_t>(id)]->path, 1.5 * static_cast<double>(4 - id),
                1e-12);
  }
}

TEST(RelativeCovariance, IsWhatManyDrawnChainsScatterBy) {
  std::mt19937 engine(7);
  std::normal_distribution<double> normal;
  const auto drawn = [&](const Matrix6d& known) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) {
      xi(i) = normal(engine);
    }
    return Vector6d(known.llt().matrixL() * xi);
  };
  const Matrix6d known = test::diagonal_covariance(0.02, 0.004);
  const std::vector<Eigen::Isometry3d> ways = {step(4.0, 0.7), step(3.0, -1.2), step(5.0, 0.4)};
  PoseGraph graph;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  graph.add_node({.id = 0, .T_map_node = pose});
  for (NodeId id = 0; id < 3; ++id) {
    pose = pose * ways[static_cast<std::size_t>(id)];
    graph.add_node({.id = id + 1, .T_map_node = pose});
    graph.add_edge(known_edge(id, id + 1, ways[static_cast<std::size_t>(id)], known));
  }
  const Matrix6d expected = relative_places(graph, 3)[0]->covariance;  // T_3_0's
  constexpr int kDraws = 20000;
  Matrix6d scatter = Matrix6d::Zero();
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::Isometry3d T_0_3 = Eigen::Isometry3d::Identity();
    for (const Eigen::Isometry3d& way : ways) {
      T_0_3 = T_0_3 * retract(way, drawn(known));
    }
    const Vector6d off = se3_log(pose * T_0_3.inverse());  // error of T_3_0, right perturbation
    scatter += off * off.transpose() / kDraws;
  }
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(scatter(i, i) / expected(i, i), 1.0, 0.05) << i;
  }
  EXPECT_LT(largest(scatter - expected), 0.05 * largest(expected));
}

TEST(RelativeCovariance, TakesTheLeastUncertainPathAndItsLength) {
  // A short way that is hardly known, and a longer one that is well known.
  PoseGraph graph = test::line(3);
  graph.add_edge(known_edge(0, 2, step(2.0), test::diagonal_covariance(1.0, 0.2)));
  const auto places = relative_places(graph, 2);
  EXPECT_NEAR(places[0]->path, 2.0, 1e-12);
  EXPECT_LT((places[0]->T_start_node.translation() + 2.0 * Eigen::Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT(places[0]->covariance(0, 0), 0.1);
  graph.set_status(0, EdgeStatus::revoked);
  EXPECT_GT(relative_places(graph, 2)[0]->covariance(0, 0), 0.9) << "by the other way";
  graph.set_status(2, EdgeStatus::revoked);
  EXPECT_FALSE(relative_places(graph, 2)[0]) << "nothing ties it";
  const PoseGraph line = test::line(5);
  const Matrix6d once = relative_places(line, 4)[1]->covariance;
  const Matrix6d lumps = relative_places(line, 4, 4.0)[1]->covariance;
  EXPECT_LT(largest(lumps - 4.0 * once), 1e-12) << "the odometry counts four times";
}

TEST(RelativeCovariance, OnePlaceIsToTheBitWhatAllPlacesHave) {
  PoseGraph graph = test::line(40);
  graph.add_edge(known_edge(3, 31, step(28.0), test::diagonal_covariance(0.02, 0.001)));
  graph.add_edge(known_edge(10, 25, step(15.0), test::diagonal_covariance(0.2, 0.05)));
  graph.add_node({.id = 40, .T_map_node = step(40.0)});
  const RelativeCovariances covariances(graph);
  for (const NodeId from : {0, 17, 39}) {
    LeastUncertainPaths paths(covariances, from, 4.0);
    const auto places = LeastUncertainPaths(covariances, from, 4.0).places();
    for (NodeId to = 0; to < 40; ++to) {
      const auto one = paths.place(to);
      ASSERT_TRUE(one && places[static_cast<std::size_t>(to)]);
      EXPECT_EQ(one->covariance, places[static_cast<std::size_t>(to)]->covariance) << from << to;
      EXPECT_EQ(one->path, places[static_cast<std::size_t>(to)]->path);
    }
    EXPECT_FALSE(paths.place(40)) << "nothing ties it";
    EXPECT_FALSE(places[40]);
  }
}

}  // namespace
}  // namespace adit
