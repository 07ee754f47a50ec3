// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/camera_simulator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/simulator/trajectories.hpp"
#include "adit/tools/simulator/camera_options.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/simulator/range_simulator.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr uint64_t kPattern = 1;  // seed of the colours
constexpr std::array<const char*, 2> kLenses{"perspective", "fisheye"};

Vector3d color_vector(const SurfaceColor& color) {
  return {double(color[0]), double(color[1]), double(color[2])};
}

Vector3d pixel_color(const ColorImage& image, std::size_t column, std::size_t row) {
  const uint8_t* at = image.rgb.data() + 3 * (row * image.width + column);
  return {double(at[0]), double(at[1]), double(at[2])};
}

/// The greatest difference of a channel.
double difference(const Vector3d& a, const Vector3d& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

bool is_within(const ColorImage& image, const Vector2d& pixel) {
  return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() < static_cast<double>(image.width - 1) &&
         pixel.y() < static_cast<double>(image.height - 1);
}

/// Between four pixels, by bilinear interpolation.
Vector3d color_between(const ColorImage& image, const Vector2d& pixel) {
  const auto column = static_cast<std::size_t>(pixel.x());
  const auto row = static_cast<std::size_t>(pixel.y());
  const double right = pixel.x() - static_cast<double>(column);
  const double down = pixel.y() - static_cast<double>(row);
  return (1.0 - down) * ((1.0 - right) * pixel_color(image, column, row) +
                         right * pixel_color(image, column + 1, row)) +
         down * ((1.0 - right) * pixel_color(image, column, row + 1) +
                 right * pixel_color(image, column + 1, row + 1));
}

/// A wall across the x axis.
void add_wall(Mesh& mesh, double x, Material material) {
  add_block(mesh, {x, -30.0, -30.0}, {x + 0.2, 30.0, 30.0}, material);
}

TEST(SurfaceColorTest, IsSmoothDiffersFromPlaceToPlaceAndOnlyDarkensTheMaterial) {
  const Vector3d own = color_vector(optics_of(Material::plaster).color);
  double squares = 0.0;
  double others = 0.0;
  constexpr int kCount = 2000;
  for (int i = 0; i < kCount; ++i) {
    const Vector3d at(0.37 * i, 3.1 - 0.11 * i, 0.05 * i);
    const auto color = [&](const Vector3d& position, uint64_t seed) {
      return color_vector(surface_color(Material::plaster, position, seed));
    };
    const Vector3d here = color(at, 1);
    EXPECT_LE(difference(here, color(at + Vector3d::Constant(0.001), 1)), 2.0);
    EXPECT_TRUE(((own - here).array() >= 0.0).all());
    EXPECT_TRUE((here.array() >= 0.3 * own.array()).all());
    squares += (here - color(at + Vector3d(0.5, 0.0, 0.0), 1)).squaredNorm() / (3.0 * kCount);
    others += (here - color(at, 2)).squaredNorm() / (3.0 * kCount);
  }
  EXPECT_GT(std::sqrt(squares), 20.0);
  EXPECT_GT(std::sqrt(others), 20.0);
}

TEST(CameraOptionsTest, CamerasLookWhereTheirNameSays) {
  const auto axes = [](const char* text) {
    return Eigen::Matrix3d(camera_named(text).T_imu_camera.linear());
  };
  EXPECT_EQ(axes("front").col(2), Vector3d::UnitX());
  EXPECT_EQ(axes("left").col(2), Vector3d::UnitY());
  EXPECT_EQ(axes("right").col(2), -Vector3d::UnitY());
  EXPECT_EQ(axes("back").col(2), -Vector3d::UnitX());
  for (const std::string& name : camera_names()) {
    const Eigen::Matrix3d R = axes(name.c_str());
    EXPECT_EQ(R.col(1), -Vector3d::UnitZ()) << name;
    EXPECT_EQ(R.determinant(), 1.0) << name;
  }
  EXPECT_EQ(camera_named("front").lens, "perspective");
  EXPECT_EQ(camera_named("back:fisheye").lens, "fisheye");
  EXPECT_EQ(camera_named("back:fisheye").frame(), "camera_back");
}

TEST(CameraOptionsTest, OtherNamesAreRefusedWithTheNearest) {
  const auto refused = [](const char* text) -> std::string {
    try {
      camera_named(text);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "taken";
  };
  EXPECT_NE(refused("fron").find("'front'"), std::string::npos) << refused("fron");
  EXPECT_NE(refused("left:fisheyes").find("'fisheye'"), std::string::npos);
  EXPECT_NE(refused("left:").find("there is no lens ''"), std::string::npos);
  EXPECT_NE(refused("").find("there is no camera ''"), std::string::npos);
  std::vector<CameraOptions> cameras{camera_named("left"), camera_named("left:fisheye")};
  EXPECT_THROW(require_cameras(cameras), UsageError) << "both would be on the same topic";
  cameras.pop_back();
  EXPECT_NO_THROW(require_cameras(cameras));
  cameras.front().rate = 0;
  EXPECT_THROW(require_cameras(cameras), UsageError);
}

TEST(CameraSimulatorTest, PixelRaysAreThoseOfTheModelAndSpanTheStatedAngle) {
  for (const char* lens : kLenses) {
    const CameraProjection projection(camera_lens(lens));
    const CameraModel& camera = projection.camera();
    const std::vector<Vector3d> rays = pixel_rays(projection);
    ASSERT_EQ(rays.size(), camera.width * camera.height);
    for (std::size_t i = 0; i < rays.size(); i += 611) {
      const Vector2d pixel(double(i % camera.width), double(i / camera.width));
      const auto ray = projection.ray(pixel);
      ASSERT_TRUE(ray) << lens << ": even its corners show something";
      EXPECT_LT((rays[i] - *ray).norm(), 1e-12);
      EXPECT_LT((*projection.pixel(rays[i]) - pixel).norm(), 1e-5);
    }
    const std::size_t row = camera.height / 2 * camera.width;
    const double across = std::acos(rays[row].dot(rays[row + camera.width - 1]));
    EXPECT_NEAR(across * 180.0 / std::acos(-1.0), camera.lens == Lens::fisheye ? 179.0 : 80.0, 1.0);
  }
}

TEST(CameraSimulatorTest, EachPixelHasTheColourOfWhatItsRayMeets) {
  const Scene scene = make_room(1);
  const SplineTrajectory motion = make_trajectory(scene, motion_named("walk"), 3.0);
  const SceneCaster caster(scene);
  const RayScene still(scene.mesh);
  for (const char* lens : kLenses) {
    const CameraOptions options = camera_named(std::string("left:") + lens);
    const CameraProjection projection(camera_lens(lens));
    const CameraSimulator camera(caster, projection.camera(),
                                 {.trajectory = &motion, .T_body_camera = options.T_imu_camera},
                                 kPattern);
    const ColorImage image = camera.image(1.3);
    ASSERT_EQ(image.rgb.size(), 3 * image.width * image.height);
    EXPECT_EQ(image.width, projection.camera().width);
    const Eigen::Isometry3d pose = motion.pose(1.3) * options.T_imu_camera;
    std::size_t compared = 0;
    for (std::size_t i = 0; i < image.width * image.height; i += 487) {
      const std::size_t column = i % image.width;
      const std::size_t row = i / image.width;
      const Vector3d direction =
          pose.linear() * *projection.ray(Vector2d(double(column), double(row)));
      const auto hit = still.cast(pose.translation(), direction, 100.0);
      ASSERT_TRUE(hit) << "a room is closed";
      if (hit->material != Material::glass) {
        const Vector3d at = pose.translation() + hit->distance * direction;
        const Vector3d expected = color_vector(surface_color(hit->material, at, kPattern));
        EXPECT_LE(difference(pixel_color(image, column, row), expected), 1.0)
            << lens << " at " << column << ", " << row;
        ++compared;
      }
    }
    EXPECT_GT(compared, 500U);
    EXPECT_EQ(image.rgb, camera.image(1.3).rgb);
  }
}

TEST(CameraSimulatorTest, ItSeesTheSkyWhereNothingIsAndLooksThroughGlass) {
  const SplineTrajectory rest = test::at_rest();
  const Eigen::Isometry3d ahead = optical_frame(Eigen::Isometry3d::Identity());
  const CameraModel model = camera_lens("perspective");
  const auto middle = [&](const Scene& scene) {
    const SceneCaster caster(scene);
    const CameraSimulator camera(caster, model, {.trajectory = &rest, .T_body_camera = ahead},
                                 kPattern);
    return pixel_color(camera.image(0.0), 321, 238);
  };
  EXPECT_EQ(middle(Scene{}), color_vector(kColorOfSky));
  Scene plain;
  add_wall(plain.mesh, 9.0, Material::plaster);
  Scene behind_glass = plain;
  add_wall(behind_glass.mesh, 5.0, Material::glass);
  EXPECT_EQ(middle(behind_glass), middle(plain));
  EXPECT_NE(middle(plain), color_vector(kColorOfSky));
}

TEST(CameraSimulatorTest, ThePatternOfAMovingObjectMovesWithIt) {
  Scene scene;
  MovingObject box{.label = "box", .mesh = {}, .T_world_object = [](double time) {
                     Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
                     pose.translation() = Vector3d(8.0 + 2.0 * time, 0.0, 0.0);
                     return pose;
                   }};
  add_block(box.mesh, {-0.5, -30.0, -30.0}, {0.5, 30.0, 30.0}, Material::metal);
  scene.moving.push_back(box);
  const SceneCaster caster(scene);
  const SplineTrajectory rest = test::at_rest();
  CameraModel model = camera_lens("perspective");
  model.cx = 321.0;
  model.cy = 238.0;
  model.distortion = {};
  const CameraSimulator camera(
      caster, model,
      {.trajectory = &rest, .T_body_camera = optical_frame(Eigen::Isometry3d::Identity())},
      kPattern);
  const ColorImage first = camera.image(0.0);
  const ColorImage later = camera.image(0.6);
  EXPECT_EQ(pixel_color(first, 321, 238), pixel_color(later, 321, 238));
  EXPECT_NE(first.rgb, later.rgb) << "it is farther away, and looks smaller";
}

/// Share of a sweep's returns within an image whose colour the image shows.
double share_shown(const RangeSweep& sweep, const ColorImage& image, const CameraModel& model,
                   const Eigen::Isometry3d& T_world_camera,
                   const std::function<Eigen::Isometry3d(double)>& T_world_lidar) {
  constexpr double kInterpolation = 12.0;  // two pixels of the steepest pattern
  constexpr uint8_t kGlass = static_cast<uint8_t>(Material::glass) + 1;
  const CameraProjection projection(model);
  double shown = 0.0;
  double within = 0.0;
  for (std::size_t i = 0; i < sweep.firings.size(); ++i) {
    const Return& back = sweep.returns[i];
    if (back.range == 0.0 || (back.surface & ~kLevelSurface) == kGlass) {
      continue;
    }
    const double time = 1e-9 * static_cast<double>(sweep.start + sweep.firings[i].time);
    const Vector3d p_world =
        T_world_lidar(time) * (sweep.firings[i].origin + back.range * sweep.firings[i].direction);
    const auto pixel = projection.pixel(T_world_camera.inverse() * p_world);
    if (pixel && is_within(image, *pixel)) {
      within += 1.0;
      shown += difference(color_between(image, *pixel), color_vector(back.color)) < kInterpolation
                   ? 1.0
                   : 0.0;
    }
  }
  EXPECT_GT(within, 2000.0);
  return shown / within;
}

TEST(CameraSimulatorTest, ImagesShowTheColoursOfReturnsAtTheTruePoseAlone) {
  const Scene scene = make_room(1);
  const SplineTrajectory motion = make_trajectory(scene, motion_named("handheld"), 3.0);
  const RangeSimulator lidar(
      scene, range_sensor_named("OS0-128"), {.trajectory = &motion}, 1,
      {.noise = false, .dropout = false, .mixed_pixels = false, .dust = false}, kPattern);
  const RangeSweep sweep = lidar.sweep(12);
  for (const char* lens : kLenses) {
    const CameraModel model = camera_lens(lens);
    const Eigen::Isometry3d mount = camera_named("front").T_imu_camera;
    const CameraSimulator camera(lidar.caster(), model,
                                 {.trajectory = &motion, .T_body_camera = mount}, kPattern);
    const ColorImage image = camera.image(1.25);
    const auto pose = [&](double time) { return lidar.pose(time); };
    EXPECT_GT(share_shown(sweep, image, model, camera.pose(1.25), pose), 0.95) << lens;
    Eigen::Isometry3d turned = camera.pose(1.25);
    turned.linear() *= Eigen::AngleAxisd(0.1, Vector3d::UnitY()).toRotationMatrix();
    EXPECT_LT(share_shown(sweep, image, model, turned, pose), 0.4) << lens;
  }
}

TEST(CameraSimulatorTest, ReturnsHaveColoursWhereTheyAreAskedForAndASurfaceIsThere) {
  Scene scene;
  add_wall(scene.mesh, 8.0, Material::dark);
  scene.dust = 0.02;
  const SplineTrajectory rest = test::at_rest();
  const RangeEffects dusty{.noise = false, .dropout = false, .mixed_pixels = false, .dust = true};
  const RangeSensor sensor = range_sensor_named("VLP-16");
  const RangeSweep with =
      RangeSimulator(scene, sensor, {.trajectory = &rest}, 1, dusty, kPattern).sweep(0);
  const RangeSweep without =
      RangeSimulator(scene, sensor, {.trajectory = &rest}, 1, dusty).sweep(0);
  std::array<std::size_t, 2> seen{};
  for (std::size_t i = 0; i < with.returns.size(); ++i) {
    const Return& back = with.returns[i];
    EXPECT_EQ(back.range, without.returns[i].range);
    EXPECT_EQ(without.returns[i].color, SurfaceColor{});
    if (back.range > 0.0) {
      const bool surface = back.surface != 0;
      EXPECT_EQ(back.color != SurfaceColor{}, surface);
      ++seen[surface ? 1 : 0];
    }
  }
  EXPECT_GT(seen[0], 100U) << "dust";
  EXPECT_GT(seen[1], 1000U) << "the wall";
}

}  // namespace
}  // namespace adit
