// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Descriptions of places and their comparison, beside their twins.
#include <bit>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/alignment_scene.hpp"
#include "adit/benchmarks/verify/places.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/layout.hpp"

namespace adit {
namespace {

constexpr double kCell = 0.5;                                        // m
constexpr uint32_t kUpright = 1U << 30U | 0x7ffeU << 15U | 0x3fffU;  // a plane that faces along x

using Bit = reference::DescribedPlace::Bit;
using Square = reference::DescribedPlace::Square;

gpu::uvec4 point(double x, double y, double z, uint32_t surface = kUpright) {
  const auto bits = [](double value) { return std::bit_cast<uint32_t>(static_cast<float>(value)); };
  return {bits(x), bits(y), bits(z), surface};
}

/// Points of all kinds up to `reach` m away.
std::vector<gpu::uvec4> random_place(int points, uint64_t seed, double reach = 40.0) {
  return test::with_random_surfaces(
      test::random_points(points, seed, {-reach, -reach, -3.0}, {reach, reach, 6.0}), seed);
}

std::vector<gpu::uvec4> turned(std::vector<gpu::uvec4> cloud, double angle, double x = 0.0,
                               double y = 0.0) {
  const Eigen::Rotation2Dd turn(angle);
  for (gpu::uvec4& one : cloud) {
    const Eigen::Vector2d at =
        turn * Eigen::Vector2d(std::bit_cast<float>(one.x), std::bit_cast<float>(one.y)) +
        Eigen::Vector2d(x, y);
    one = point(at.x(), at.y(), std::bit_cast<float>(one.z), kUpright);
  }
  return cloud;
}

class PlaceKernelsTest : public test::DeviceTest {
 protected:
  static test::Verdict described(test::PlaceRun& run, const std::vector<gpu::uvec4>& cloud) {
    run.describe(cloud, kCell);
    return test::verify_described(reference::describe_place(reference::decode(cloud), kCell),
                                  run.record(), run.block(), run.places() - 1);
  }
};

TEST(PlaceLayouts, StructsAreTheSameInCppAndGlsl) {
  using gpu::DescribePush;
  test::expect_layout<DescribePush>("DescribePush",
                                    {{"inverse_cell", offsetof(DescribePush, inverse_cell)},
                                     {"point_count", offsetof(DescribePush, point_count)},
                                     {"place", offsetof(DescribePush, place)}});
  test::expect_layout<gpu::MatchPush>("MatchPush",
                                      {{"place_count", offsetof(gpu::MatchPush, place_count)}});
  using gpu::PlanJob;
  test::expect_layout<PlanJob>("PlanJob", {{"cosine", offsetof(PlanJob, cosine)},
                                           {"sine", offsetof(PlanJob, sine)},
                                           {"place", offsetof(PlanJob, place)},
                                           {"unused0", offsetof(PlanJob, unused0)}});
  using gpu::CorrelatePush;
  test::expect_layout<CorrelatePush>("CorrelatePush",
                                     {{"cell_count", offsetof(CorrelatePush, cell_count)},
                                      {"first_job", offsetof(CorrelatePush, first_job)}});
}

TEST_F(PlaceKernelsTest, AFewPointsLieWhereTheyAreExpected) {
  test::PlaceRun run(context());
  const uint32_t lying = 1U << 30U | 0x3fffU << 15U | 0x3fffU;  // a plane that faces upwards
  run.describe({point(3.0, 0.1, 0.0), point(-0.2, 10.0, 1.0), point(-5.0, -5.0, 0.0, lying),
                point(1.0, 1.0, 0.0), point(90.0, 1.0, 0.0), point(0.0, -20.0, -1.0, 0)},
               kCell);
  const std::vector<uint32_t> record = run.record();
  // 6 (log2(3) - 1) = 3.5; 6 (log2(10) - 1) = 13.9. A lying plane is none of it, nor is what has no
  // surface and lies low; too near and too far are none of the polar view.
  EXPECT_EQ(reference::polar_bits(record), (std::set<Bit>{{0, 0, 3}, {16, 1, 13}}));
  const auto cells =
      reference::plan_cells(std::span(record).subspan(gpu::kPlanAt, gpu::kPlanWords));
  EXPECT_EQ(cells, (std::set<Square>{{70, 64}, {63, 84}, {66, 66}}));
}

TEST_F(PlaceKernelsTest, DescriptionsAreTheTwins) {
  test::PlaceRun run(context());
  for (const int points : {0, 1, 63, 64, 65, 5000, 30'000}) {
    const test::Verdict verdict =
        described(run, random_place(points, static_cast<uint64_t>(points) + 1));
    EXPECT_TRUE(verdict.passed()) << points << " points: " << verdict.text();
  }
}

TEST_F(PlaceKernelsTest, MatchesAreTheTwinsWhateverTheTurn) {
  test::PlaceRun run(context());
  const std::vector<gpu::uvec4> place = turned(random_place(300, 7), 0.0);
  std::vector<double> turns;
  for (int i = 0; i < 67; ++i) {  // more than a group
    turns.push_back(i % 2 == 0 ? 0.37 * i : 0.0);
    run.describe(i % 2 == 0 ? turned(place, turns.back())
                            : random_place(20 * i, 100U + static_cast<uint64_t>(i)),
                 kCell);
  }
  run.describe(place, kCell);
  run.match(run.places());
  const std::vector<uint32_t> first = run.matches();
  const test::Verdict verdict = test::verify_matches(run.record(), run.block(), first);
  EXPECT_TRUE(verdict.passed()) << verdict.text();
  const auto bits = static_cast<double>(reference::polar_bits(run.record()).size());
  for (std::size_t i = 0; i < turns.size(); i += 2) {
    EXPECT_GT(first[i] / gpu::kPlaceSectors, 1.1 * bits) << "the same place, turned";
    const double found =
        -2.0 * std::numbers::pi / gpu::kPlaceSectors * (first[i] % gpu::kPlaceSectors);
    EXPECT_LT(std::abs(std::remainder(found - turns[i], 2.0 * std::numbers::pi)), 0.06)
        << "half a sector, and a little";
  }
  run.match(run.places());
  EXPECT_EQ(run.matches(), first);
  run.match(0);
  EXPECT_TRUE(run.matches().empty());
}

// Hits share a word with the turn or the shift: the most there can be leave that alone.
TEST_F(PlaceKernelsTest, AViewAndAPlanWithEveryBitSetAreCountedWhole) {
  std::vector<gpu::uvec4> full;
  for (uint32_t sector = 0; sector < gpu::kPlaceSectors; ++sector) {
    for (int ring = 0; ring < 32; ++ring) {
      const double angle = (sector + 0.5) * 2.0 * std::numbers::pi / gpu::kPlaceSectors;
      const double range = std::exp2(1.0 + (ring + 0.5) / 6.0);
      for (const double z : {0.0, 2.0}) {
        full.push_back(point(range * std::cos(angle), range * std::sin(angle), z));
      }
    }
  }
  for (uint32_t i = 0; i < gpu::kPlanSide * gpu::kPlanSide; ++i) {
    const double half = gpu::kPlanSide / 2.0 - 0.5;
    full.push_back(
        point(kCell * (i % gpu::kPlanSide - half), kCell * (i / gpu::kPlanSide - half), 0.0));
  }
  test::PlaceRun run(context());
  run.describe(full, kCell);
  run.match(1);
  constexpr uint32_t kMostHits = 2 * gpu::kPolarWords * 32;
  EXPECT_EQ(run.matches()[0], kMostHits * gpu::kPlaceSectors + gpu::kPlaceSectors - 1);

  std::vector<Eigen::Vector2d> cells = test::plan_centres(run.record());
  ASSERT_EQ(cells.size(), gpu::kPlanSide * gpu::kPlanSide);
  // As many as are ever correlated, and near enough that every shift keeps them on the plan.
  std::erase_if(cells, [](const Eigen::Vector2d& c) { return c.cwiseAbs().maxCoeff() > 32.0; });
  ASSERT_EQ(cells.size(), engine::kMostPlanCells);
  run.correlate(cells, {{.cosine = 1.0F, .sine = 0.0F, .place = 0, .unused0 = 0}});
  EXPECT_EQ(run.matches()[0], (2 * engine::kMostPlanCells << gpu::kShiftBits) | (gpu::kShifts - 1));
}

TEST_F(PlaceKernelsTest, CorrelationsAreTheTwinsAndFindTheShift) {
  test::PlaceRun run(context());
  const std::vector<gpu::uvec4> place = turned(random_place(400, 3, 20.0), 0.0);
  // T_place_query is a turn by 0.6 and a shift by (1.5, -2) m: the query sees the place so.
  const Eigen::Rotation2Dd back(-0.6);
  const Eigen::Vector2d shift = back * Eigen::Vector2d(-1.5, 2.0);
  run.describe(place, kCell);
  run.describe(turned(place, -0.6, shift.x(), shift.y()), kCell);
  const std::vector<Eigen::Vector2d> cells = test::plan_centres(run.record());
  std::vector<gpu::PlanJob> jobs;
  for (const double angle : {0.5, 0.6, 0.7, -2.0}) {
    jobs.push_back({.cosine = static_cast<float>(std::cos(angle)),
                    .sine = static_cast<float>(std::sin(angle)),
                    .place = 0,
                    .unused0 = 0});
  }
  run.correlate(cells, jobs);
  const std::vector<uint32_t> matches = run.matches();
  const test::Verdict verdict = test::verify_correlations(cells, jobs, run.block(), matches);
  EXPECT_TRUE(verdict.passed()) << verdict.text();
  const auto hits = [&](std::size_t job) { return matches[job] >> gpu::kShiftBits; };
  EXPECT_GT(hits(1), hits(0));
  EXPECT_GT(hits(1), hits(2));
  EXPECT_GT(hits(1), 2 * hits(3));
  EXPECT_GT(hits(1), 1.5 * static_cast<double>(cells.size()));
  const uint32_t at = matches[1] & ((1U << gpu::kShiftBits) - 1U);
  const uint32_t reach = gpu::kShiftReach;
  EXPECT_EQ(at % gpu::kShiftSide, reach + 3);
  EXPECT_EQ(at / gpu::kShiftSide, reach - 4);
  run.correlate({}, jobs);
  EXPECT_EQ(run.matches()[0] >> gpu::kShiftBits, 0U);
}

}  // namespace
}  // namespace adit
