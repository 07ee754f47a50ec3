// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Colours of clouds by cameras: the parts, and `adit export --colorize` as a whole.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/clouds/png_decoder.hpp"
#include "adit/tools/coloring/blurred_image.hpp"
#include "adit/tools/coloring/camera_mounting.hpp"
#include "adit/tools/coloring/map_views.hpp"
#include "adit/tools/coloring/view_pairs.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/simulator/simulation.hpp"

namespace adit {
namespace {

using std::chrono::milliseconds;

TEST(ViewPairs, AreHalfOfTheViewsApart) {
  // A surface with five views, one with one, and one with two.
  std::vector<Sighted> sighted;
  for (const auto& [surface, view] :
       {std::pair(7, 3), {4, 9}, {7, 1}, {2, 0}, {2, 5}, {2, 6}, {2, 7}, {2, 8}}) {
    sighted.push_back(
        {.surface = static_cast<uint64_t>(surface), .view = static_cast<std::size_t>(view)});
  }
  sort_by_surface(sighted);
  std::vector<std::pair<std::size_t, std::size_t>> views;
  for (const SightedPair& pair : far_pairs(sighted)) {
    EXPECT_EQ(sighted[pair.a].surface, sighted[pair.b].surface);
    views.emplace_back(sighted[pair.a].view, sighted[pair.b].view);
  }
  EXPECT_EQ(views,
            (std::vector<std::pair<std::size_t, std::size_t>>{{0, 6}, {5, 7}, {6, 8}, {1, 3}}));
  EXPECT_TRUE(far_pairs({}).empty());
}

/// Surfaces along a path, each seen by six views, of which every third sees something else before
/// it. `gain` is what a view multiplies each channel by.
std::vector<ViewRatio> seen_with(std::size_t views,
                                 const std::function<double(std::size_t)>& gain) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(30.0, 120.0);
  std::vector<Sighted> sighted;
  for (uint64_t key = 0; key < 40 * views; ++key) {
    const Eigen::Vector3d color(any(random), any(random), any(random));
    for (std::size_t view = key / 40; view < std::min<std::size_t>(views, key / 40 + 6); ++view) {
      const bool other = random() % 3 == 0;
      const Eigen::Vector3d shown = other ? Eigen::Vector3d(any(random), 40.0, 90.0) : color;
      sighted.push_back(
          {.surface = key, .view = view, .color = (gain(view) * shown).array().log().matrix()});
    }
  }
  return ratios_of(sighted, far_pairs(sighted));
}

TEST(ViewPairs, GainsMakeViewsAgreeAlthoughAThirdIsHidden) {
  const auto gain = [](std::size_t view) {
    return std::exp(0.5 * std::sin(0.3 * static_cast<double>(view)));
  };
  const std::vector<std::array<float, 3>> gains = balanced_gains(40, seen_with(40, gain));
  for (std::size_t i = 0; i + 1 < gains.size(); ++i) {
    for (const float channel : gains[i]) {
      EXPECT_NEAR(static_cast<double>(channel) * gain(i) /
                      (static_cast<double>(gains[i + 1][0]) * gain(i + 1)),
                  1.0, 0.05)
          << i;
    }
  }
}

TEST(ViewPairs, ViewsThatAgreeAndViewsThatShareNothingKeepTheirColors) {
  for (const auto& one : balanced_gains(10, seen_with(10, [](auto) { return 1.0; }))) {
    EXPECT_NEAR(one[0], 1.0F, 0.03F);
  }
  EXPECT_EQ(balanced_gains(2, {})[1], (std::array{1.0F, 1.0F, 1.0F}));
}

/// Views that turn and move among surfaces with smooth colours. A camera whose error is not what it
/// is assumed to be shows what lies beside each surface.
class TurningViews {
 public:
  explicit TurningViews(const CameraError& truth, double contrast = 0.5)
      : truth_(truth), contrast_(contrast) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> side(-6.0, 6.0);
    for (int i = 0; i < 1500; ++i) {
      surfaces_.emplace_back(side(random), side(random), side(random));
    }
  }

  std::vector<Sighted> operator()(const CameraError& error, const CameraError&, int) const {
    std::vector<Sighted> all;
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      for (std::size_t view = 0; view < 12; ++view) {
        const double turn = 0.25 * static_cast<double>(view);
        const Eigen::Matrix3d R = so3_exp({0.1 * std::sin(3.0 * turn), turn, 0.05 * turn});
        const Eigen::Vector3d at(0.3 * static_cast<double>(view), 0.1 * std::cos(turn), 0.0);
        const Eigen::Vector3d p = R.transpose() * (surfaces_[i] - at);
        if (p.z() < 1.0 || p.head<2>().norm() > p.z()) {
          continue;
        }
        const Eigen::Vector3d velocity(0.4, 0.0, 1.2);
        const CameraError off = error - truth_;
        const Eigen::Vector3d beside =
            surfaces_[i] + R * (off.head<3>().cross(p) + off[3] * velocity);
        all.push_back({.surface = i * 0x9e3779b97f4a7c15U, .view = view, .color = color(beside)});
      }
    }
    sort_by_surface(all);
    return all;
  }

 private:
  LogColor color(const Eigen::Vector3d& p) const {
    return contrast_ * LogColor(std::sin(2.0 * p.x() + p.y()), std::cos(1.7 * p.y() - p.z()),
                                std::sin(2.3 * p.z() + 0.5 * p.x()));
  }

  CameraError truth_;
  double contrast_;
  std::vector<Eigen::Vector3d> surfaces_;
};

const CameraError kStep(0.002, 0.002, 0.002, 0.005);

TEST(CameraMounting, AnErrorIsFound) {
  const CameraError truth(0.6 * kDegree, -0.8 * kDegree, 0.3 * kDegree, 0.015);
  const CameraErrorEstimate found = estimate_camera_error(TurningViews(truth), kStep);
  EXPECT_LT((found.error - truth).head<3>().norm(), 0.1 * kDegree);
  EXPECT_NEAR(found.error[3], truth[3], 0.004);
  EXPECT_TRUE(found.is_better()) << found.better << " " << found.worse;
}

TEST(CameraMounting, WhereThereIsNoneOrNothingShowsItNothingIsBetter) {
  const CameraErrorEstimate none = estimate_camera_error(TurningViews(CameraError::Zero()), kStep);
  EXPECT_LT(none.error.head<3>().norm(), 0.02 * kDegree);
  EXPECT_FALSE(none.is_better());
  const CameraError truth(0.6 * kDegree, 0.0, 0.0, 0.0);
  const CameraErrorEstimate grey = estimate_camera_error(TurningViews(truth, 0.0), kStep);
  EXPECT_FALSE(grey.determined);
  EXPECT_TRUE(grey.error.isZero());
  EXPECT_FALSE(grey.is_better());
  const CameraErrorEstimate blind = estimate_camera_error(
      [](const CameraError&, const CameraError&, int) { return std::vector<Sighted>(); }, kStep);
  EXPECT_FALSE(blind.determined);
  EXPECT_FALSE(blind.is_better());
}

TEST(BlurredImage, IsTheMeanOfWhatIsAround) {
  ColorImage image{.width = 7, .height = 5, .rgb = std::vector<uint8_t>(3 * 7 * 5, 40)};
  EXPECT_EQ(blurred(image, 3).rgb, image.rgb);
  image.rgb[3 * (2 * 7 + 3) + 1] = 130;
  const ColorImage soft = blurred(image, 1);
  EXPECT_EQ(soft.rgb[3 * (2 * 7 + 3) + 1], 50);
  EXPECT_EQ(soft.rgb[3 * (1 * 7 + 4) + 1], 50);
  EXPECT_EQ(soft.rgb[3 * (2 * 7 + 5) + 1], 40);
  EXPECT_EQ(soft.rgb[3 * (2 * 7 + 3)], 40);
  EXPECT_EQ(blurred(image, 0).rgb, image.rgb);
}

class Stamps : public ImageSeries {
 public:
  explicit Stamps(std::vector<Nanoseconds> stamps) : stamps_(std::move(stamps)) {}
  std::span<const Nanoseconds> stamps() const override { return stamps_; }
  ColorImage image(std::size_t) const override { return {}; }

 private:
  std::vector<Nanoseconds> stamps_;
};

TEST(MapViews, AreApartInPlaceOrDirection) {
  std::vector<StampedPose> poses;
  for (int i = 0; i <= 40; ++i) {  // 1 m/s for 2 s, then it turns by 45 degrees a second
    StampedPose pose{.stamp = milliseconds(100 * i)};
    pose.pose.translation().x() = std::min(0.1 * i, 2.0);
    pose.pose.linear() = so3_exp({0.0, 0.0, std::max(0, i - 20) * 4.5 * kDegree});
    poses.push_back(pose);
  }
  std::vector<Nanoseconds> stamps;
  for (int i = -3; i < 50; ++i) {
    stamps.push_back(milliseconds(100 * i + 10));
  }
  const CameraSource camera{.name = "front",
                            .model = {},
                            .frame = {},
                            .T_lidar_camera = Eigen::Isometry3d::Identity(),
                            .time_offset = -0.01,
                            .images = std::make_shared<Stamps>(stamps)};
  const std::vector<MapView> views = choose_views({&camera, 1}, SensorPath(poses));
  // At 0, 0.5, 1, 1.5 and 2 m, then 18 degrees apart, once behind the last pose.
  ASSERT_EQ(views.size(), 11U);
  EXPECT_EQ(views.front().image, 3U) << "the first that there is a pose for";
  EXPECT_NEAR(views[1].T_map_camera.translation().x(), 0.5, 1e-9);
  EXPECT_NEAR(Eigen::AngleAxisd(views[9].T_map_camera.linear()).angle(), 90.0 * kDegree, 1e-9);
}

/// A room, mapped, with a camera whose images are `fault`y.
class Colorized : public testing::Test {
 protected:
  void map(const char* camera, std::vector<std::string> faults, const char* trajectory = "handheld",
           int rate = 2) {
    SimulationOptions simulation;
    simulation.scene = "room";
    simulation.trajectory = trajectory;
    simulation.duration = 6.0;
    simulation.seed = 7203;
    simulation.picture = false;
    simulation.faults = std::move(faults);
    if (camera != nullptr) {
      simulation.cameras = {camera_named(camera)};
      simulation.cameras.front().rate = rate;
    }
    simulation.output = folder_ / "room.mcap";
    simulate(simulation, {});
    RunCommandOptions run;
    run.recording = simulation.output;
    run.output = folder_ / "out";
    ASSERT_EQ(test::ran(run_command, run).code, 0);
  }
  test::Ran colorized(const char* name, bool as_calibrated = false) const {
    return test::ran(export_command, ExportCommandOptions{.map = folder_ / "out",
                                                          .output = folder_ / name,
                                                          .dense = "ply",
                                                          .color = true,
                                                          .as_calibrated = as_calibrated});
  }
  struct Errors {
    double colored = 0.0;  ///< share of all points
    double median = 0.0;   ///< of 255, of the channel that is farthest off
  };
  /// Of a PLY file whose points have x, y, z, ..., red, green, blue at their end.
  Errors errors_of(const char* name) const {
    const std::string cloud = test::content(folder_ / name);
    const std::string truth = test::content(folder_ / "room.truth.colors");
    const std::size_t points = truth.size() / 3;
    const std::size_t begin = cloud.find("end_header\n") + 11;
    const std::size_t step = (cloud.size() - begin) / points;
    EXPECT_EQ((cloud.size() - begin) % points, 0U);
    std::vector<double> errors;
    double colored = 0.0;
    for (std::size_t i = 0; i < points; ++i) {
      int error = 0;
      int brightest = 0;
      int real = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto found = static_cast<uint8_t>(cloud[begin + (i + 1) * step - 3 + k]);
        const auto wanted = static_cast<uint8_t>(truth[3 * i + k]);
        error = std::max(error, std::abs(found - wanted));
        brightest = std::max<int>(brightest, found);
        real = std::max<int>(real, wanted);
      }
      colored += brightest > 0 ? 1.0 : 0.0;
      if (brightest > 0 && real > 0) {
        errors.push_back(error);
      }
    }
    if (errors.empty()) {
      ADD_FAILURE() << "no point has a colour";
      return {};
    }
    std::ranges::nth_element(errors, errors.begin() + static_cast<int>(errors.size() / 2));
    return {.colored = colored / static_cast<double>(points), .median = errors[errors.size() / 2]};
  }

  test::TemporaryFolder folder_;
};

TEST_F(Colorized, PointsHaveTheColorsOfTheirSurfaces) {
  map("front", {});
  const test::Ran done = colorized("a.ply");
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.out.find("camera /camera_front/image_raw: its views share too few surfaces"),
            std::string::npos);
  const Errors errors = errors_of("a.ply");
  EXPECT_GT(errors.colored, 0.2);
  EXPECT_LT(errors.median, 6.0);
  ASSERT_EQ(colorized("b.ply").code, 0);
  EXPECT_EQ(test::content(folder_ / "a.ply"), test::content(folder_ / "b.ply"));
}

TEST_F(Colorized, ACameraThatIsMountedOtherwiseThanIsSaidIsCorrected) {
  map("front:fisheye", {"camera-turned"}, "fast-handheld", 5);
  const test::Ran done = colorized("a.ply");
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.out.find(": corrected"), std::string::npos) << done.out;
  const test::Ran as_said = colorized("b.ply", true);
  ASSERT_EQ(as_said.code, 0) << as_said.err;
  EXPECT_EQ(as_said.out.find("turned by"), std::string::npos) << as_said.out;
  EXPECT_LT(errors_of("a.ply").median, errors_of("b.ply").median);
}

TEST_F(Colorized, WithoutACameraItSaysSo) {
  map(nullptr, {});
  const test::Ran none = colorized("a.ply");
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.err.find("camera"), std::string::npos) << none.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.ply"));
  for (const char* raster : {"", "color"}) {
    const test::Ran other =
        test::ran(export_command,
                  ExportCommandOptions{.map = folder_ / "out",
                                       .output = folder_ / (*raster != '\0' ? "x.tif" : "x.ply"),
                                       .cloud = *raster != '\0' ? "" : "ply",
                                       .color = *raster == '\0',
                                       .raster = raster});
    EXPECT_EQ(other.code, 1);
    EXPECT_NE(other.err.find("camera"), std::string::npos) << other.err;
  }
  const test::Ran height = test::ran(
      export_command,
      ExportCommandOptions{
          .map = folder_ / "out", .output = folder_ / "x.tif", .color = true, .raster = "height"});
  EXPECT_EQ(height.code, 2);
  EXPECT_NE(height.err.find("--colorize is for clouds"), std::string::npos) << height.err;
}

/// Of the simulator's truth, by places: the colours of the returns in each cell, which are as far
/// as `uses` says so. Of a dense cloud that has no colours.
class TruthByPlace {
 public:
  TruthByPlace(const std::filesystem::path& dense, const std::filesystem::path& truth,
               const Eigen::Vector3d& cell, const std::function<bool(const Point&)>& uses)
      : cell_(cell) {
    const std::string colors = test::content(truth);
    const std::vector<Point> points = read_ply(dense).sweep.points;
    EXPECT_EQ(colors.size(), 3 * points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d color = Eigen::Vector3d(static_cast<uint8_t>(colors[3 * i]),
                                                    static_cast<uint8_t>(colors[3 * i + 1]),
                                                    static_cast<uint8_t>(colors[3 * i + 2]));
      if (!color.isZero() && uses(points[i])) {
        auto& [sum, count] = cells_[index_of({points[i].x, points[i].y, points[i].z})];
        sum += color;
        ++count;
      }
    }
  }
  std::optional<Eigen::Vector3d> at(const Eigen::Vector3d& p) const {
    const auto found = cells_.find(index_of(p));
    return found == cells_.end()
               ? std::nullopt
               : std::optional(Eigen::Vector3d(found->second.first / found->second.second));
  }

 private:
  using Index = std::array<int64_t, 3>;
  Index index_of(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d share = p.cwiseQuotient(cell_);
    return {std::lround(std::floor(share.x())), std::lround(std::floor(share.y())),
            std::lround(std::floor(share.z()))};
  }
  Eigen::Vector3d cell_;  // m
  std::map<Index, std::pair<Eigen::Vector3d, int>> cells_;
};

double median_of(std::vector<double> values) {
  EXPECT_GT(values.size(), 500U);
  if (values.empty()) {
    return 255.0;
  }
  std::ranges::nth_element(values, values.begin() + static_cast<int>(values.size() / 2));
  return values[values.size() / 2];
}

TEST_F(Colorized, SubmapsAndTheMapFromAboveHaveThemToo) {
  map("front", {});
  ExportCommandOptions options{
      .map = folder_ / "out", .output = folder_ / "dense.ply", .dense = "ply"};
  ASSERT_EQ(test::ran(export_command, options).code, 0);
  options.dense = "";
  options.cloud = "ply";
  options.color = true;
  options.output = folder_ / "cloud.ply";
  const test::Ran cloud = test::ran(export_command, options);
  ASSERT_EQ(cloud.code, 0) << cloud.err;
  EXPECT_NE(cloud.out.find("% of the points have a colour, by"), std::string::npos) << cloud.out;
  const std::filesystem::path colors = folder_ / "room.truth.colors";
  const TruthByPlace near(folder_ / "dense.ply", colors, {0.05, 0.05, 0.05},
                          [](const Point&) { return true; });
  const CloudFile read = read_ply(folder_ / "cloud.ply", {.colors = true});
  ASSERT_EQ(read.colors.size(), read.sweep.points.size());
  std::vector<double> errors;
  std::size_t colored = 0;
  for (std::size_t i = 0; i < read.colors.size(); ++i) {
    const Point& p = read.sweep.points[i];
    const Eigen::Vector3d found(read.colors[i][0], read.colors[i][1], read.colors[i][2]);
    colored += found.isZero() ? 0U : 1U;
    if (const auto real = near.at({p.x, p.y, p.z}); real && !found.isZero()) {
      errors.push_back((found - *real).cwiseAbs().maxCoeff());
    }
  }
  EXPECT_GT(colored, read.colors.size() / 5);
  EXPECT_LT(median_of(errors), 10.0);

  // The floor is 1 m and more below the sensor, the ceiling above it is not in the picture.
  options.cloud = "";
  options.color = false;
  options.raster = "color";
  options.output = folder_ / "o.png";
  const test::Ran above = test::ran(export_command, options);
  ASSERT_EQ(above.code, 0) << above.err;
  EXPECT_NE(above.out.find("% of the surface have a colour"), std::string::npos) << above.out;
  const TruthByPlace floor(folder_ / "dense.ply", colors, {0.1, 0.1, 1e9},
                           [](const Point& p) { return p.z < -0.5F; });
  const std::string png = test::content(folder_ / "o.png");
  PngDecoder image(png, 10'000);
  const std::vector<uint8_t> pixels = image.read_rgb8();
  std::array<double, 6> numbers{};
  std::istringstream world(test::content(folder_ / "o.pgw"));
  for (double& number : numbers) {
    world >> number;
  }
  EXPECT_EQ(numbers[0], 0.1);
  EXPECT_EQ(numbers[3], -0.1);
  errors.clear();
  for (std::size_t i = 0; i < pixels.size() / 3; ++i) {
    const Eigen::Vector3d found(pixels[3 * i], pixels[3 * i + 1], pixels[3 * i + 2]);
    const auto real = floor.at({numbers[4] + 0.1 * static_cast<double>(i % image.width()),
                                numbers[5] - 0.1 * static_cast<double>(i / image.width()), -1.0});
    if (real && !found.isZero()) {
      errors.push_back((found - *real).cwiseAbs().maxCoeff());
    }
  }
  EXPECT_LT(median_of(errors), 10.0);
}

}  // namespace
}  // namespace adit
