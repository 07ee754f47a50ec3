// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Calibrations of cameras that other programs write.
#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "adit/tools/cameras/camera_file.hpp"
#include "adit/tools/containers/yaml_text.hpp"
#include "adit/tools/recordings/ros_codec.hpp"
#include "adit/tools/recordings/ros_images.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// A mapping of the file, for messages with its name.
class Section {
 public:
  Section(const fs::path& file, const YamlNode& node, std::string name)
      : file_(&file), node_(&node), name_(std::move(name)) {}

  [[noreturn]] void refuse(const std::string& key, const std::string& found) const {
    throw InputError(*file_, Place::named(name_.empty() ? key : name_ + "." + key), found,
                     "Take the file as the calibration wrote it, or write the camera into a .toml "
                     "file (docs/recordings.md)");
  }

  bool has(const std::string& key) const { return node_->find(key) != nullptr; }

  std::string text(const std::string& key, const std::string& otherwise = {}) const {
    const YamlNode* const node = node_->find(key);
    return node == nullptr ? otherwise : node->scalar;
  }

  double number(const std::string& key, std::optional<double> otherwise = {}) const {
    const YamlNode* const node = node_->find(key);
    if (node == nullptr && otherwise) {
      return *otherwise;
    }
    return value_of(node == nullptr ? YamlNode{} : *node, key);
  }

  /// The numbers of a list, of a list of lists, or of a matrix that has them as "data".
  std::vector<double> numbers(const std::string& key) const {
    const YamlNode* node = node_->find(key);
    const YamlNode* const data = node == nullptr ? nullptr : node->find("data");
    node = data == nullptr ? node : data;
    std::vector<double> all;
    for (std::size_t i = 0; node != nullptr && i < node->items.size(); ++i) {
      const YamlNode& item = node->items[i];
      if (item.items.empty()) {
        all.push_back(value_of(item, key));
      }
      for (const YamlNode& inner : item.items) {
        all.push_back(value_of(inner, key));
      }
    }
    return all;
  }

  std::vector<double> numbers(const std::string& key, std::size_t expected) const {
    std::vector<double> all = numbers(key);
    if (all.size() != expected) {
      refuse(key, fmt::format("it has {} numbers, expected {}", all.size(), expected));
    }
    return all;
  }

  Eigen::Isometry3d transform(const std::string& key) const {
    const std::optional<Eigen::Isometry3d> T = rigid_transform(numbers(key, 16));
    if (!T) {
      refuse(key, "it is no rotation and translation");
    }
    return *T;
  }

 private:
  double value_of(const YamlNode& node, const std::string& key) const {
    const std::optional<double> value = parse_double(node.scalar);
    if (!value || !std::isfinite(*value)) {
      refuse(key, node.scalar.empty() ? "expected a number, found none"
                                      : "expected a number, found " + in_quotes(node.scalar));
    }
    return *value;
  }

  const fs::path* file_;
  const YamlNode* node_;
  std::string name_;
};

std::size_t pixels(const Section& section, const std::string& key, double number) {
  constexpr double kMost = 1e6;
  if (!(number >= 1.0 && number <= kMost) || std::floor(number) != number) {
    section.refuse(key, fmt::format("{:g} is no number of pixels", number));
  }
  return static_cast<std::size_t>(number);
}

void require_sound(const Section& section, const std::string& key, const CameraModel& model) {
  if (const std::string problem = problem_of(model); !problem.empty()) {
    section.refuse(key, problem);
  }
}

/// The lens of one of Kalibr's cameras.
CameraModel kalibr_model(const Section& section) {
  const std::string projection = section.text("camera_model");
  if (projection != "pinhole") {
    section.refuse("camera_model", "the projection " + in_quotes(projection) +
                                       " is not read; pinhole is, with radtan or equidistant");
  }
  const std::vector<double> f = section.numbers("intrinsics", 4);
  const std::vector<double> size = section.numbers("resolution", 2);
  CameraModel model{.width = pixels(section, "resolution", size[0]),
                    .height = pixels(section, "resolution", size[1]),
                    .fx = f[0],
                    .fy = f[1],
                    .cx = f[2],
                    .cy = f[3]};
  const std::string distortion = section.text("distortion_model", "none");
  if (distortion == "equidistant") {
    model.lens = Lens::fisheye;
  } else if (distortion != "radtan" && distortion != "none") {
    section.refuse("distortion_model", "the distortion " + in_quotes(distortion) +
                                           " is not read; radtan, equidistant and none are");
  }
  if (distortion != "none") {
    std::ranges::copy(section.numbers("distortion_coeffs", 4), model.distortion.begin());
  }
  require_sound(section, "intrinsics", model);
  return model;
}

/// cam0, cam1 ... of Kalibr. Its T_cam_imu maps from the inertial sensor to the camera, and its
/// T_cn_cnm1 from the camera before to this one.
std::vector<ListedCamera> kalibr_cameras(const YamlNode& root, const fs::path& file) {
  std::vector<ListedCamera> cameras;
  for (std::size_t i = 0;; ++i) {
    const std::string name = "cam" + std::to_string(i);
    const YamlNode* const node = root.find(name);
    if (node == nullptr) {
      return cameras;
    }
    const Section section(file, *node, name);
    ListedCamera camera{.name = name,
                        .topic = section.text("rostopic"),
                        .model = kalibr_model(section),
                        .time_offset = section.number("timeshift_cam_imu", 0.0)};
    if (!to_nanoseconds(camera.time_offset)) {
      section.refuse("timeshift_cam_imu", fmt::format("it is {:g} s", camera.time_offset));
    }
    if (section.has("T_cam_imu")) {
      camera.T_imu_camera = section.transform("T_cam_imu").inverse();
    } else if (section.has("T_cn_cnm1") && i > 0 && cameras.back().T_imu_camera) {
      camera.T_imu_camera = *cameras.back().T_imu_camera * section.transform("T_cn_cnm1").inverse();
    }
    cameras.push_back(std::move(camera));
  }
}

/// The calibration of one camera, which ROS has in messages of the same content.
ListedCamera plain_camera(const YamlNode& root, const fs::path& file) {
  const Section section(file, root, "");
  ros::CameraInfo info;
  info.width = static_cast<uint32_t>(pixels(section, "image_width", section.number("image_width")));
  info.height =
      static_cast<uint32_t>(pixels(section, "image_height", section.number("image_height")));
  info.d = section.numbers("distortion_coefficients");
  const bool rational = info.d.size() > 5;
  info.distortion_model =
      section.text("distortion_model", rational ? "rational_polynomial" : "plumb_bob");
  std::ranges::copy(section.numbers("camera_matrix", 9), info.k.begin());
  ListedCamera camera{.name = section.text("camera_name", file.stem().string())};
  try {
    camera.model = ros::to_camera(info, false);
  } catch (const ros::CodecError& error) {
    section.refuse("camera_matrix", error.what());
  }
  require_sound(section, "camera_matrix", *camera.model);
  return camera;
}

}  // namespace

std::vector<ListedCamera> parse_camera_yaml(std::string_view text, const fs::path& file) {
  const std::optional<YamlNode> root = parse_yaml(text);
  if (root && root->find("camera_matrix") != nullptr) {
    return {plain_camera(*root, file)};
  }
  std::vector<ListedCamera> cameras;
  if (root) {
    cameras = kalibr_cameras(*root, file);
  }
  if (cameras.empty()) {
    throw InputError(file, {},
                     root ? "it has neither a camera_matrix nor a camera cam0"
                          : "it is no YAML that adit understands",
                     "Files of Kalibr (camchain), of ROS's camera_calibration and of OpenCV are "
                     "read; write others as .toml (docs/recordings.md)");
  }
  return cameras;
}

}  // namespace adit
