// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/verify/cases.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "adit/benchmarks/verify/synthetic_world.hpp"

namespace adit::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Point to_point(const Eigen::Vector3d& p, double intensity) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
          static_cast<float>(intensity)};
}

Lidar lidar_of(int points) {
  Lidar lidar;
  lidar.beams = points < 20'000 ? 16 : (points < 60'000 ? 32 : (points < 200'000 ? 64 : 128));
  lidar.columns = points / lidar.beams;
  return lidar;
}

engine::PreprocessSettings settings_of(double r_input, double beam_spacing) {
  return {.c_min = 0.5, .c_max = 100.0, .r_input = r_input, .beam_spacing = beam_spacing};
}

Eigen::Isometry3d over_the_street(double x, double yaw) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(x, 0.3, 1.8));
  pose.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d(0.05, -0.08, 1.0).normalized()));
  return pose;
}

std::vector<Point> street(const Eigen::Isometry3d& pose, const Lidar& lidar, uint64_t seed) {
  static const World world = make_street(60.0);
  return scan(world, {.stamp = Nanoseconds(0), .pose = pose}, lidar, seed).points;
}

// A plain with a few walls, seen up to 100 m away: beams hit the ground at grazing angles, far
// apart.
std::vector<Point> plain(const Lidar& lidar) {
  World world;
  world.blocks = {{{60.0, -40.0, 0.0}, {70.0, 40.0, 20.0}},
                  {{-98.0, -60.0, 0.0}, {-96.0, 60.0, 20.0}},
                  {{-40.0, 85.0, 0.0}, {50.0, 95.0, 20.0}}};
  StampedPose pose;
  pose.pose.translation().z() = 2.0;
  return scan(world, pose, lidar).points;
}

// The next float32 below, but no denormal number: devices may take those for zero.
float just_below(float value) {
  return value == 0.0F ? -std::numeric_limits<float>::min() : std::nextafter(value, -kInfinity);
}

// Every point of a lattice of spacing `step`, and its nearest neighbour below in x.
std::vector<Point> lattice(int half_width, float step) {
  std::vector<Point> points;
  for (int x = -half_width; x <= half_width; ++x) {
    for (int y = -half_width; y <= half_width; ++y) {
      for (int z = -2; z <= 2; ++z) {
        const Point point{static_cast<float>(x) * step, static_cast<float>(y) * step,
                          static_cast<float>(z) * step, 1.0F};
        points.push_back(point);
        points.push_back({just_below(point.x), point.y, point.z, 2.0F});
      }
    }
  }
  return points;
}

// Patches of points on both sides of the ranges at which surface cells double, 32 m, 64 m and
// (float32's next) just beyond: with r_input = 0.25 m and a beam spacing of 2^-7 all these numbers
// are exact.
std::vector<Point> around_level_borders() {
  std::vector<Point> points;
  for (const float range : {32.0F, 64.0F}) {
    for (int i = 0; i < 40; ++i) {
      for (int j = 0; j < 40; ++j) {
        const float y = 0.3F * static_cast<float>(i - 20);
        const float z = 0.3F * static_cast<float>(j - 20);
        const float x = std::sqrt(range * range - y * y - z * z);
        points.push_back({x, y, z, 0.0F});
        points.push_back({-std::nextafter(x, kInfinity), y, z, 0.0F});
      }
    }
    points.push_back({range, 0.0F, 0.0F, 0.0F});
    points.push_back({0.0F, std::nextafter(range, kInfinity), 0.0F, 0.0F});
  }
  return points;
}

// Thin poles, and wires that sag under nothing: lines across the beams and along them.
std::vector<Point> poles_and_wires() {
  Random random(6);
  std::vector<Point> points;
  for (int line = 0; line < 40; ++line) {
    const double angle = 0.157 * line;
    const double distance = 4.0 + 0.2 * line;
    const Eigen::Vector3d foot(distance * std::cos(angle), distance * std::sin(angle), -1.5);
    // Steep, at the limit between steep and flat, flat.
    const Eigen::Vector3d direction =
        Eigen::Vector3d(-std::sin(angle), std::cos(angle),
                        std::array{8.0, 1.0, 0.1}[static_cast<size_t>(line % 3)])
            .normalized();
    for (double along = 0.0; along < 4.0; along += 0.02) {
      const Eigen::Vector3d noise(random.gaussian(), random.gaussian(), random.gaussian());
      points.push_back(to_point(foot + along * direction + 0.005 * noise, line));
    }
  }
  return points;
}

}  // namespace

std::vector<Point> room(int points, uint64_t seed, double noise) {
  const Eigen::Vector3d low(-7.3, -4.1, -1.6);
  const Eigen::Vector3d high(6.2, 5.4, 2.3);
  Random random(seed);
  std::vector<Point> result;
  for (int i = 0; i < points; ++i) {
    Eigen::Vector3d p(random.uniform(low.x(), high.x()), random.uniform(low.y(), high.y()),
                      random.uniform(low.z(), high.z()));
    const auto side = static_cast<int>(random.uniform(0.0, 6.0));
    p[side / 2] = (side % 2 == 0 ? low : high)[side / 2] + noise * random.gaussian();
    result.push_back(to_point(p, i % 256));
  }
  return result;
}

std::vector<Point> random_points(int points, uint64_t seed, const Eigen::Vector3d& low,
                                 const Eigen::Vector3d& high) {
  Random random(seed);
  std::vector<Point> result;
  for (int i = 0; i < points; ++i) {
    const double x = random.uniform(low.x(), high.x());
    const double y = random.uniform(low.y(), high.y());
    const double z = random.uniform(low.z(), high.z());
    result.push_back(to_point({x, y, z}, i % 256));
  }
  return result;
}

SweepCase street_sweep(int points) {
  const Lidar lidar = lidar_of(points);
  return {"street, " + std::to_string(points) + " points", settings_of(0.25, lidar.beam_spacing()),
          street(over_the_street(3.0, 0.2), lidar, 1)};
}

std::vector<SweepCase> sweep_cases() {
  std::vector<SweepCase> cases;
  const auto add = [&cases](std::string name, const engine::PreprocessSettings& settings,
                            std::vector<Point> raw) {
    cases.push_back({std::move(name), settings, std::move(raw)});
  };
  constexpr double kBeam = 0.01;  // rad
  add("no points", settings_of(0.25, kBeam), {});
  add("one point", settings_of(0.25, kBeam), {{3.0F, -4.0F, 1.0F, 7.0F}});
  add("two points of one cell", settings_of(0.25, kBeam),
      {{3.1F, 4.1F, 1.1F, 7.0F}, {3.2F, 4.2F, 1.2F, 8.0F}});
  add("all NaN", settings_of(0.25, kBeam), std::vector<Point>(1000, {kNan, kNan, kNan, kNan}));
  add("one coordinate NaN or infinite, no returns, too near, too far", settings_of(0.25, kBeam),
      {{kNan, 1.0F, 1.0F, 0.0F},
       {1.0F, kNan, 1.0F, 0.0F},
       {1.0F, 1.0F, kNan, 0.0F},
       {kInfinity, 1.0F, 1.0F, 0.0F},
       {1.0F, -kInfinity, 1.0F, 0.0F},
       {0.0F, 0.0F, 0.0F, 0.0F},
       {0.0F, -0.0F, 0.0F, 0.0F},
       {0.2F, 0.2F, 0.2F, 0.0F},
       {100.1F, 0.0F, 0.0F, 0.0F},
       {1e30F, 1e30F, -1e30F, 0.0F},
       {1e-40F, 0.0F, 0.0F, 0.0F},
       {5.0F, 5.0F, 5.0F, 3.0F}});
  add("identical points", settings_of(0.25, kBeam),
      std::vector<Point>(5000, {-12.34F, 5.67F, -0.89F, 1.0F}));
  add("room", settings_of(0.25, kBeam), room(30'000, 1));
  add("room, fine cells", settings_of(0.07, kBeam), room(20'000, 2, 0.002));
  add("room, coarse cells", settings_of(2.0, kBeam), room(5000, 3));
  add("random, dense", settings_of(0.5, kBeam), random_points(20'000, 4, {-6, -6, -3}, {6, 6, 3}));
  add("random, all coordinates negative", settings_of(0.25, kBeam),
      random_points(8000, 5, {-9, -8, -5}, {-4, -3, -1}));
  // No lattice point lies at c_min: whether such a point is valid is a matter of rounding.
  const auto lattice_settings = [](double r_input) {
    return engine::PreprocessSettings{
        .c_min = 0.47, .c_max = 100.0, .r_input = r_input, .beam_spacing = kBeam};
  };
  add("borders of cells, a power of two", lattice_settings(0.25), lattice(20, 0.25F));
  add("borders of cells, not a power of two", lattice_settings(0.1), lattice(20, 0.1F));
  add("borders of surface cells", lattice_settings(0.25), lattice(20, 0.625F));
  add("poles and wires", settings_of(0.1, kBeam), poles_and_wires());
  add("ranges at which surface cells double", settings_of(0.25, 0.0078125), around_level_borders());
  for (const int points : {5'000, 30'000}) {
    cases.push_back(street_sweep(points));
  }
  const Lidar sparse{
      .beams = 16, .columns = 900, .lowest = -0.26, .highest = 0.26, .max_range = 100.0};
  add("plain to 100 m, 16 rings", settings_of(0.25, sparse.beam_spacing()), plain(sparse));
  const Lidar dense{
      .beams = 64, .columns = 450, .lowest = -0.3, .highest = 0.1, .max_range = 100.0};
  add("plain to 100 m, 64 rings", settings_of(0.4, dense.beam_spacing()), plain(dense));
  return cases;
}

AlignmentCase street_alignment(int points) {
  const Lidar lidar = lidar_of(points);
  const Eigen::Isometry3d T_world_target = over_the_street(3.0, 0.2);
  const Eigen::Isometry3d T_world_source = over_the_street(3.6, 0.2 + 0.026);
  return {.name = "street, " + std::to_string(points) + " points",
          .preprocess = settings_of(0.25, lidar.beam_spacing()),
          .target = street(T_world_target, lidar, 1),
          .source = street(T_world_source, lidar, 2),
          .T_target_source = T_world_target.inverse() * T_world_source,
          .voxel_size = 1.0,
          .settings = {.d_max = 1.0,
                       .translation_epsilon = 1e-4,
                       .rotation_epsilon = 2e-5,
                       .max_iterations = 30}};
}

std::vector<SweepMotion> sweep_motions() {
  Vector6d drive;
  drive << 20.0, 0.5, -0.2, 0.02, -0.03, 0.6;
  Vector6d hand;
  hand << 0.5, -0.8, 0.3, 1.5, -1.2, 2.4;
  return {steady_motion(drive, 0.0, 0.1), steady_motion(hand, -0.02, 0.08)};
}

std::vector<float> spread_times(size_t count, const SweepMotion& motion) {
  std::vector<float> times;
  for (size_t i = 0; i < count; ++i) {
    times.push_back(
        static_cast<float>(motion.first + (motion.last - motion.first) * static_cast<double>(i) /
                                              static_cast<double>(count)));
  }
  return times;
}

engine::DeskewSettings deskew_settings(const SweepMotion& motion, double c_min) {
  return {.c_min = c_min, .c_max = 100.0, .first_time = motion.first, .last_time = motion.last};
}

}  // namespace adit::test
