// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/scene_file.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/faults.hpp"
#include "adit/tools/simulator/gnss_model.hpp"
#include "adit/tools/simulator/imu_model.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/simulator/simulation_limits.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/toml.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr double kLargest = 1e6;  // of any number: m, degrees, s

/// A file that is being read, for its complaints.
class Reader {
 public:
  explicit Reader(std::filesystem::path file) : file_(std::move(file)) {}

  [[noreturn]] void refuse(const toml::source_position& where, const std::string& found,
                           const std::string& remedy) const {
    throw InputError(file_,
                     Place::named("line " + std::to_string(where.line) + ", column " +
                                  std::to_string(where.column)),
                     found, remedy);
  }

  /// What a value must not be, with its place.
  [[noreturn]] void refuse(const toml::node& node, const UsageError& error) const {
    std::string found = error.what();
    if (found.ends_with('.')) {
      found.pop_back();
    }
    refuse(node.source().begin, found, "`adit simulate --help` and --example tell what there is");
  }

  double number(const toml::node& node) const {
    const auto value = node.value<double>();
    if (!value || node.is_boolean()) {
      refuse(node.source().begin, "this is no number", "Write a number, such as 0.5");
    }
    if (!(std::abs(*value) <= kLargest)) {
      refuse(node.source().begin,
             std::isfinite(*value) ? "this is too large" : "this is not a finite number",
             "Write a number within 1000000");
    }
    return *value;
  }

  int whole_number(const toml::node& node) const {
    const auto value = node.is_integer() ? node.value<int>() : std::nullopt;
    if (!value) {
      refuse(node.source().begin, "this is no whole number", "Write a whole number, such as 10");
    }
    return *value;
  }

  uint64_t seed(const toml::node& node) const {
    const int seed = whole_number(node);
    if (seed < 0) {
      refuse(node.source().begin, "a seed is not negative", "Write 0 or more");
    }
    return static_cast<uint64_t>(seed);
  }

  bool truth(const toml::node& node) const {
    const auto value = node.is_boolean() ? node.value<bool>() : std::nullopt;
    if (!value) {
      refuse(node.source().begin, "this is neither true nor false", "Write true or false");
    }
    return *value;
  }

  std::string text(const toml::node& node) const {
    const auto value = node.value<std::string>();
    if (!value) {
      refuse(node.source().begin, "this is no text", "Write a text in quotes");
    }
    return *value;
  }

  Eigen::Vector3d vector(const toml::node& node) const {
    const toml::array* values = node.as_array();
    if (values == nullptr || values->size() != 3) {
      refuse(node.source().begin, "these are not three numbers", "Write [1.0, 2.0, 3.0]");
    }
    return {number(*values->get(0)), number(*values->get(1)), number(*values->get(2))};
  }

  const toml::array& list(const toml::node& node) const {
    if (!node.is_array()) {
      refuse(node.source().begin, "this is no list", "Write the entries in brackets");
    }
    return *node.as_array();
  }

  const toml::table& table(const toml::node& node) const {
    if (!node.is_table()) {
      refuse(node.source().begin, "this is no section",
             "Write its keys below its name in brackets");
    }
    return *node.as_table();
  }

  using Key = std::pair<std::string, std::function<void(const toml::node&)>>;

  /// Hands each value to its key's function. What that throws of a value is reported with its
  /// place.
  void read(const toml::table& values, const std::vector<Key>& keys) const {
    for (const auto& [key, node] : values) {
      const auto found = std::ranges::find(keys, key.str(), &Key::first);
      if (found == keys.end()) {
        std::vector<std::string> names;
        for (const Key& known : keys) {
          names.push_back(known.first);
        }
        refuse(key.source().begin, "there is no key '" + std::string(key.str()) + "' here",
               suggestion(key.str(), names));
      }
      try {
        found->second(node);
      } catch (const UsageError& error) {
        refuse(node, error);
      }
    }
  }

 private:
  std::filesystem::path file_;
};

/// A pose from its two keys.
struct MountKeys {
  Eigen::Vector3d position;
  Eigen::Vector3d yaw_pitch_roll = Eigen::Vector3d::Zero();  ///< degrees

  Eigen::Isometry3d pose() const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const Eigen::Vector3d angles = kDegree * yaw_pitch_roll;
    pose.linear() = rotation_from_yaw_pitch_roll(angles.x(), angles.y(), angles.z());
    pose.translation() = position;
    return pose;
  }
};

LidarOptions read_lidar(const Reader& reader, const toml::table& table) {
  LidarOptions lidar;
  MountKeys mount{.position = lidar.T_imu_lidar.translation()};
  reader.read(
      table,
      {{"sensor",
        [&](const auto& node) { lidar.sensor = range_sensor_named(reader.text(node)).name; }},
       {"topic", [&](const auto& node) { lidar.topic = reader.text(node); }},
       {"frame", [&](const auto& node) { lidar.frame = reader.text(node); }},
       {"fields", [&](const auto& node) { lidar.layout = cloud_layout_named(reader.text(node)); }},
       {"position", [&](const auto& node) { mount.position = reader.vector(node); }},
       {"yaw_pitch_roll", [&](const auto& node) { mount.yaw_pitch_roll = reader.vector(node); }},
       {"begin", [&](const auto& node) { lidar.begin = reader.number(node); }},
       {"end", [&](const auto& node) { lidar.end = reader.number(node); }},
       {"noise", [&](const auto& node) { lidar.effects.noise = reader.truth(node); }},
       {"dropout", [&](const auto& node) { lidar.effects.dropout = reader.truth(node); }},
       {"mixed_pixels", [&](const auto& node) { lidar.effects.mixed_pixels = reader.truth(node); }},
       {"dust", [&](const auto& node) { lidar.effects.dust = reader.truth(node); }},
       {"reflections", [&](const auto& node) { lidar.effects.reflections = reader.truth(node); }},
       {"doppler", [&](const auto& node) { lidar.doppler = reader.truth(node); }}});
  lidar.T_imu_lidar = mount.pose();
  return lidar;
}

void read_trajectory_keys(const Reader& reader, const toml::table& table,
                          SimulationOptions& options) {
  reader.read(
      table,
      {{"style",
        [&](const auto& node) { options.trajectory = motion_named(reader.text(node)).name; }},
       {"speed",
        [&](const auto& node) { require_speed(options.speed.emplace(reader.number(node))); }},
       {"begin", [&](const auto& node) { require_begin(options.begin = reader.number(node)); }},
       {"reverse", [&](const auto& node) { options.reverse = reader.truth(node); }},
       {"corner_radius",
        [&](const auto& node) {
          require_corner_radius(options.corner_radius.emplace(reader.number(node)));
        }},
       {"waypoints", [&](const auto& node) {
          for (const toml::node& corner : reader.list(node)) {
            options.waypoints.push_back(reader.vector(corner));
          }
          require_way(options.waypoints);
        }}});
}

void read_lidars(const Reader& reader, const toml::node& node, SimulationOptions& options) {
  options.lidars.clear();
  for (const toml::node& lidar : reader.list(node)) {
    const LidarOptions read = read_lidar(reader, reader.table(lidar));
    if (std::ranges::count(options.lidars, read.topic, &LidarOptions::topic) > 0) {
      reader.refuse(lidar.source().begin, "another range sensor is on " + read.topic,
                    "Give it a topic of its own");
    }
    options.lidars.push_back(read);
  }
}

void read_imu(const Reader& reader, const toml::table& table, SimulationOptions& options) {
  reader.read(table, {{"model",
                       [&](const auto& node) {
                         options.imu = reader.text(node);
                         if (options.imu != "none") {
                           imu_named(options.imu);
                         }
                       }},
                      {"rate", [&](const auto& node) {
                         require_imu_rate(options.imu_rate = reader.whole_number(node));
                       }}});
}

void read_gnss(const Reader& reader, const toml::table& table, SimulationOptions& options) {
  if (!table.empty() && !table.contains("receiver")) {
    reader.refuse(table.begin()->first.source().begin, "there is no receiver that it is of",
                  "Name one: receiver = \"" + gnss_names().front() + "\"");
  }
  reader.read(table,
              {{"receiver",
                [&](const auto& node) {
                  options.gnss = reader.text(node);
                  if (options.gnss != "none") {
                    gnss_named(options.gnss);
                  }
                }},
               {"rate",
                [&](const auto& node) {
                  require_gnss_rate(options.gnss_rate = reader.whole_number(node));
                }},
               {"position", [&](const auto& node) { options.p_imu_antenna = reader.vector(node); }},
               {"heading", [&](const auto& node) { options.heading = reader.truth(node); }},
               {"heading_sigma",
                [&](const auto& node) {
                  options.heading_errors.sigma = reader.number(node);
                  require_heading_errors(options.heading_errors);
                }},
               {"heading_offset", [&](const auto& node) {
                  options.heading_errors.offset = reader.number(node);
                  require_heading_errors(options.heading_errors);
                }}});
}

void read_visual_odometry(const Reader& reader, const toml::table& table,
                          SimulationOptions& options) {
  MountKeys mount{.position = options.T_imu_camera.translation()};
  reader.read(
      table,
      {{"use", [&](const auto& node) { options.visual_odometry = reader.truth(node); }},
       {"rate",
        [&](const auto& node) {
          require_wheel_rate(options.visual_odometry_rate = reader.whole_number(node));
        }},
       {"position", [&](const auto& node) { mount.position = reader.vector(node); }},
       {"yaw_pitch_roll", [&](const auto& node) { mount.yaw_pitch_roll = reader.vector(node); }}});
  options.T_imu_camera = mount.pose();
}

/// A camera with the mount of its name, unless the file says another.
CameraOptions read_camera(const Reader& reader, const toml::table& table) {
  CameraOptions camera;
  std::optional<Eigen::Vector3d> position;
  std::optional<Eigen::Vector3d> yaw_pitch_roll;
  reader.read(
      table,
      {{"name",
        [&](const auto& node) {
          camera.name = reader.text(node);
          require_camera(camera.name);
        }},
       {"lens",
        [&](const auto& node) {
          camera.lens = reader.text(node);
          camera_lens(camera.lens);
        }},
       {"rate",
        [&](const auto& node) { require_camera_rate(camera.rate = reader.whole_number(node)); }},
       {"position", [&](const auto& node) { position = reader.vector(node); }},
       {"yaw_pitch_roll", [&](const auto& node) { yaw_pitch_roll = reader.vector(node); }}});
  Eigen::Isometry3d T_imu_mount = camera_mount_of(camera.name);
  if (yaw_pitch_roll) {
    T_imu_mount =
        MountKeys{.position = T_imu_mount.translation(), .yaw_pitch_roll = *yaw_pitch_roll}.pose();
  }
  if (position) {
    T_imu_mount.translation() = *position;
  }
  camera.T_imu_camera = optical_frame(T_imu_mount);
  return camera;
}

void read_cameras(const Reader& reader, const toml::node& node, SimulationOptions& options) {
  for (const toml::node& camera : reader.list(node)) {
    options.cameras.push_back(read_camera(reader, reader.table(camera)));
    try {
      require_cameras(options.cameras);
    } catch (const UsageError& error) {
      reader.refuse(camera, error);
    }
  }
}

void read_wheels(const Reader& reader, const toml::table& table, SimulationOptions& options) {
  MountKeys mount{.position = options.T_imu_wheels.translation()};
  reader.read(table, {{"use", [&](const auto& node) { options.wheels = reader.truth(node); }},
                      {"rate",
                       [&](const auto& node) {
                         require_wheel_rate(options.wheel_rate = reader.whole_number(node));
                       }},
                      {"position", [&](const auto& node) { mount.position = reader.vector(node); }},
                      {"yaw_pitch_roll",
                       [&](const auto& node) { mount.yaw_pitch_roll = reader.vector(node); }}});
  options.T_imu_wheels = mount.pose();
}

}  // namespace

SimulationOptions read_scene_file(const std::filesystem::path& file) {
  const Reader reader(file);
  SimulationOptions options;
  toml::table table;
  try {
    table = toml::parse_file(file.string());
  } catch (const toml::parse_error& error) {
    if (error.source().begin.line == 0) {
      throw InputError(file, {}, std::string(error.description()), "Give a scene or a TOML file");
    }
    reader.refuse(error.source().begin, std::string(error.description()), "Write valid TOML");
  }
  reader.read(
      table,
      {{"scene",
        [&](const auto& node) {
          options.scene = reader.text(node);
          require_scene(options.scene);
        }},
       {"seed", [&](const auto& node) { options.seed = reader.seed(node); }},
       {"noise_seed", [&](const auto& node) { options.noise_seed = reader.seed(node); }},
       {"later", [&](const auto& node) { require_later(options.later = reader.number(node)); }},
       {"change",
        [&](const auto& node) { require_change(options.change.share = reader.number(node)); }},
       {"change_seed", [&](const auto& node) { options.change.seed = reader.seed(node); }},
       {"duration",
        [&](const auto& node) { require_duration(options.duration = reader.number(node)); }},
       {"faults",
        [&](const auto& node) {
          for (const toml::node& fault : reader.list(node)) {
            options.faults.push_back(reader.text(fault));
            fault_named(options.faults.back());
          }
        }},
       {"trajectory",
        [&](const auto& node) { read_trajectory_keys(reader, reader.table(node), options); }},
       {"lidar", [&](const auto& node) { read_lidars(reader, node, options); }},
       {"imu", [&](const auto& node) { read_imu(reader, reader.table(node), options); }},
       {"gnss", [&](const auto& node) { read_gnss(reader, reader.table(node), options); }},
       {"visual_odometry",
        [&](const auto& node) { read_visual_odometry(reader, reader.table(node), options); }},
       {"camera", [&](const auto& node) { read_cameras(reader, node, options); }},
       {"wheels", [&](const auto& node) { read_wheels(reader, reader.table(node), options); }}});
  try {
    require_seen(options.faults, options.duration,
                 {.imu = options.imu != "none",
                  .wheels = options.wheels,
                  .visual_odometry = options.visual_odometry,
                  .heading = options.heading,
                  .camera = !options.cameras.empty()});
  } catch (const UsageError& error) {
    reader.refuse(*table.get("faults"), error);
  }
  return options;
}

std::string scene_file_example() {
  return R"(# What `adit simulate FILE.toml -o NAME.mcap` simulates. What is left out has the value shown here,
# waypoints apart.
scene = "mine"
seed = 1
# noise_seed = 1  # of the sensors' errors alone: the same place, recorded again; that of seed
later = 0.0  # s after the simulation's epoch that the recording begins: what moves has gone on
change = 0.0  # share of the scene's movable objects that are gone, elsewhere, or more than without it
change_seed = 1
duration = 60.0  # s
faults = []

[trajectory]
style = "drive"
# speed = 1.6  # m/s; the scene's
begin = 0.0  # m along the way
reverse = false  # from the way's end to its beginning
# A closed way of one's own, from the first corner on: corners on the floor (m, world), rounded.
# waypoints = [[0, 0, 0], [25, 0, 0.7], [25, 40, 0.6], [0, 40, -0.1]]
# corner_radius = 2.5  # m; the scene's

# The truth is that of the first.
[[lidar]]
sensor = "VLP-16"
topic = "/points"
frame = "lidar"
# fields = "velodyne"  # its driver's
position = [0.03, -0.01, 0.08]  # m, in the IMU's frame
yaw_pitch_roll = [0.0, 0.0, 0.0]  # degrees
noise = true
dropout = true
mixed_pixels = true
dust = true
reflections = false  # panes of glass mirror, too
doppler = false  # measures the radial speed of each return
begin = 0.0  # s after the recording's start: it sends nothing before
# end = 30.0  # s: and nothing after, as one that was unplugged

[imu]
model = "industrial"  # or "none"
rate = 200  # Hz

[gnss]
receiver = "none"
rate = 5  # Hz
position = [-0.2, 0.05, 0.35]  # m, of the antenna in the IMU's frame
heading = false  # headings by two antennas, on /heading
heading_sigma = 1.0  # degrees
heading_offset = 0.0  # degrees, counter-clockwise, the same throughout

[wheels]
use = false  # velocities of a vehicle on /wheels
rate = 50  # Hz
position = [0.0, 0.2, -0.5]  # m, in the IMU's frame; they roll along x
yaw_pitch_roll = [0.0, 0.0, 0.0]  # degrees

[visual_odometry]
use = false  # poses of a camera's odometry, whose scale drifts, on /visual_odometry
rate = 20  # Hz
position = [0.15, 0.02, -0.03]  # m, in the IMU's frame
yaw_pitch_roll = [0.0, 0.0, 0.0]  # degrees

# Images of a camera on /camera_NAME/image_raw; there may be several, and there is none by default.
# [[camera]]
# name = "front"  # where it looks; or "left", "right", "back"
# lens = "perspective"  # 640 x 480 pixels, 80 degrees across; or "fisheye", 640 x 640 and 180
# rate = 2  # Hz
# position = [0.13, -0.01, -0.04]  # m, in the IMU's frame; 0.1 m off the lidar, to where it looks
# yaw_pitch_roll = [0.0, 0.0, 0.0]  # degrees; it looks along x of that. The left one's yaw is 90.
)";
}

}  // namespace adit
