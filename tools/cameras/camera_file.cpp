// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cameras/camera_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/core.h>

#include "adit/tools/cameras/image_codec.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/toml_table.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 13> kKeys = {
    "name",   "topic",      "folder",         "width",        "height", "model",      "focal",
    "center", "distortion", "T_lidar_camera", "T_imu_camera", "frame",  "time_offset"};
constexpr std::array<std::string_view, 6> kModelKeys = {"width", "height", "model",
                                                        "focal", "center", "distortion"};

/// A number of pixels.
std::size_t side(const TomlTable& table, std::string_view key) {
  const int64_t pixels = table.number(key).value_or(0);
  if (pixels < 1 || pixels > static_cast<int64_t>(kMostImageSide)) {
    table.refuse(key, fmt::format("{} is {}; an image has 1 to {} pixels in each direction", key,
                                  pixels, kMostImageSide));
  }
  return static_cast<std::size_t>(pixels);
}

Lens lens(const TomlTable& table) {
  const std::string model = table.text("model").value_or("perspective");
  if (model != "perspective" && model != "fisheye") {
    table.refuse("model", "the model " + in_quotes(model) +
                              " is not known: perspective and "
                              "fisheye are");
  }
  return model == "fisheye" ? Lens::fisheye : Lens::perspective;
}

std::array<double, 2> pair(const TomlTable& table, std::string_view key) {
  const std::vector<double> numbers = table.reals(key);
  if (numbers.size() != 2) {
    table.refuse(key, fmt::format("{} has {} numbers; expected two, across and down, in pixels",
                                  key, numbers.size()));
  }
  return {numbers[0], numbers[1]};
}

/// All of it, or nothing.
std::optional<CameraModel> model_of(const TomlTable& table) {
  if (std::ranges::none_of(kModelKeys, [&](auto key) { return table.has(key); })) {
    return std::nullopt;
  }
  for (const std::string_view key : {"width", "height", "focal", "center"}) {
    if (!table.has(key)) {
      table.refuse("the camera has a lens without " + std::string(key) +
                   ": width, height, focal and center belong together");
    }
  }
  const auto [fx, fy] = pair(table, "focal");
  const auto [cx, cy] = pair(table, "center");
  CameraModel model{.width = side(table, "width"),
                    .height = side(table, "height"),
                    .fx = fx,
                    .fy = fy,
                    .cx = cx,
                    .cy = cy,
                    .lens = lens(table)};
  const std::vector<double> distortion = table.reals("distortion");
  if (!is_distortion(distortion.size(), model.lens)) {
    table.refuse("distortion", fmt::format("distortion has {} numbers; expected {}",
                                           distortion.size(), expected_distortion(model.lens)));
  }
  std::ranges::copy(distortion, model.distortion.begin());
  if (const std::string problem = problem_of(model); !problem.empty()) {
    table.refuse(problem);
  }
  return model;
}

std::optional<Eigen::Isometry3d> transform(const TomlTable& table, std::string_view key) {
  if (!table.has(key)) {
    return std::nullopt;
  }
  std::optional<Eigen::Isometry3d> T = rigid_transform(table.reals(key));
  if (!T) {
    table.refuse(key, std::string(key) +
                          " is no rotation and translation: expected 16 numbers row by row, or x "
                          "y z (m) and a quaternion x y z w");
  }
  return T;
}

ListedCamera camera_of(const TomlTable& table, const fs::path& file) {
  table.require_only(kKeys, "a camera");
  ListedCamera camera{.name = table.text("name").value_or(""),
                      .topic = table.text("topic").value_or(""),
                      .folder = table.text("folder").value_or(""),
                      .model = model_of(table),
                      .T_lidar_camera = transform(table, "T_lidar_camera"),
                      .T_imu_camera = transform(table, "T_imu_camera"),
                      .frame = table.text("frame").value_or(""),
                      .time_offset = table.real("time_offset").value_or(0.0)};
  if (camera.topic.empty() == camera.folder.empty()) {
    table.refuse(camera.topic.empty() ? "the camera has neither a topic nor a folder of images"
                                      : "the camera has a topic and a folder of images: one is "
                                        "expected");
  }
  if (!camera.folder.empty()) {
    if (!camera.model) {
      table.refuse(
          "the camera has a folder of images and no calibration: width, height, focal "
          "and center");
    }
    camera.folder = file.parent_path() / camera.folder;
  }
  if (camera.name.empty()) {
    camera.name = camera.topic.empty() ? camera.folder.string() : camera.topic;
  }
  if (!to_nanoseconds(camera.time_offset)) {
    table.refuse("time_offset", fmt::format("time_offset is {:g} s", camera.time_offset));
  }
  return camera;
}

}  // namespace

bool is_distortion(std::size_t numbers, Lens lens) {
  return numbers == 0 || numbers == 4 ||
         (lens == Lens::perspective && (numbers == 5 || numbers == 8));
}

std::string expected_distortion(Lens lens) {
  return lens == Lens::fisheye ? "k1 k2 k3 k4" : "k1 k2 p1 p2, then k3, then k4 k5 k6";
}

std::string problem_of(const CameraModel& model) {
  constexpr double kLeastFocal = 0.1;  // pixels
  constexpr double kMostFocal = 1e6;
  const auto is_focal = [](double f) { return f > kLeastFocal && f < kMostFocal; };
  if (!is_focal(model.fx) || !is_focal(model.fy)) {
    return fmt::format("the focal lengths of the camera are {:g} and {:g} pixels", model.fx,
                       model.fy);
  }
  const auto finite = [](double number) { return std::isfinite(number); };
  if (!finite(model.cx) || !finite(model.cy) || !std::ranges::all_of(model.distortion, finite)) {
    return "a number of the camera is not finite";
  }
  try {
    require_image_size(model.width, model.height);
  } catch (const ImageError& error) {
    return error.what();
  }
  return {};
}

std::optional<Eigen::Isometry3d> rigid_transform(std::span<const double> numbers) {
  constexpr double kNearlyOne = 1e-3;  // calibrations are written with few digits
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  if (numbers.size() == 7) {
    const Eigen::Quaterniond q(numbers[6], numbers[3], numbers[4], numbers[5]);
    if (!(std::abs(q.norm() - 1.0) < kNearlyOne)) {
      return std::nullopt;
    }
    T.linear() = q.normalized().toRotationMatrix();
    T.translation() = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
  } else if (numbers.size() == 16) {
    using Matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
    const Matrix M = Eigen::Map<const Matrix>(numbers.data());
    const Eigen::Matrix3d R = M.topLeftCorner<3, 3>();
    if (!(R * R.transpose()).isIdentity(kNearlyOne) || R.determinant() < 0.0 ||
        !M.row(3).isApprox(Eigen::RowVector4d::UnitW(), kNearlyOne)) {
      return std::nullopt;
    }
    T.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
    T.translation() = M.topRightCorner<3, 1>();
  } else {
    return std::nullopt;
  }
  return T.matrix().allFinite() ? std::optional(T) : std::nullopt;
}

std::vector<ListedCamera> parse_camera_toml(std::string_view text, const fs::path& file) {
  const TomlFile content(text, file, "docs/recordings.md has an example");
  const TomlTable root(content);
  constexpr std::array<std::string_view, 1> kRootKeys = {"camera"};
  root.require_only(kRootKeys, "a file of cameras");
  std::vector<ListedCamera> cameras;
  for (const TomlTable& table : root.tables("camera")) {
    cameras.push_back(camera_of(table, file));
  }
  if (cameras.empty()) {
    throw InputError(file, {}, "it lists no camera: there is no [[camera]]",
                     "docs/recordings.md has an example");
  }
  return cameras;
}

std::vector<ListedCamera> read_camera_file(const fs::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".toml") {
    return parse_camera_toml(read_text_file(file), file);
  }
  if (ending == ".yaml" || ending == ".yml") {
    return parse_camera_yaml(read_text_file(file), file);
  }
  throw InputError(file, {}, "a file of cameras ends in .toml, .yaml or .yml",
                   "Rename it: adit's own is TOML, those of Kalibr, ROS and OpenCV are YAML");
}

}  // namespace adit
