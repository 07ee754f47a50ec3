// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/error_text.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/cameras/camera_file.hpp"
#include "adit/tools/containers/yaml_text.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

std::string with_changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

const std::string kToml =
    "[[camera]]\n"
    "name = \"front\"\n"
    "topic = \"/front/image_raw\"\n"
    "width = 640\n"
    "height = 480\n"
    "model = \"perspective\"\n"
    "focal = [400.5, 401]\n"
    "center = [320.25, 240]\n"
    "distortion = [0.1, -0.2, 0.001, 0.002, 0.05]\n"
    "T_lidar_camera = [[0, 0, 1, 0.1], [-1, 0, 0, 0.2], [0, -1, 0, 0.3], [0, 0, 0, 1]]\n"
    "time_offset = -0.012\n"
    "[[camera]]\n"
    "folder = \"images/left\"\n"
    "width = 100\n"
    "height = 50\n"
    "model = \"fisheye\"\n"
    "focal = [30, 31]\n"
    "center = [50, 25]\n"
    "distortion = [0.1, 0.2, 0.3, 0.4]\n"
    "T_imu_camera = [1, 2, 3, 0, 0, 0.6, 0.8]\n"
    "frame = \"left_optical\"\n";

TEST(CameraToml, SaysWhatACameraIs) {
  const std::vector<ListedCamera> cameras = parse_camera_toml(kToml, "/data/cameras.toml");
  ASSERT_EQ(cameras.size(), 2U);
  const ListedCamera& front = cameras[0];
  EXPECT_EQ(front.name, "front");
  EXPECT_EQ(front.topic, "/front/image_raw");
  EXPECT_TRUE(front.folder.empty());
  ASSERT_TRUE(front.model);
  EXPECT_EQ(front.model->width, 640U);
  EXPECT_EQ(front.model->height, 480U);
  EXPECT_EQ(front.model->fx, 400.5);
  EXPECT_EQ(front.model->fy, 401.0);
  EXPECT_EQ(front.model->cx, 320.25);
  EXPECT_EQ(front.model->cy, 240.0);
  EXPECT_EQ(front.model->lens, Lens::perspective);
  EXPECT_EQ(front.model->distortion,
            (std::array<double, 8>{0.1, -0.2, 0.001, 0.002, 0.05, 0.0, 0.0, 0.0}));
  EXPECT_EQ(front.time_offset, -0.012);
  ASSERT_TRUE(front.T_lidar_camera);
  EXPECT_FALSE(front.T_imu_camera);
  // What the camera sees ahead (z) is ahead (x) of the lidar.
  EXPECT_TRUE(
      (*front.T_lidar_camera * Eigen::Vector3d(0, 0, 5)).isApprox(Eigen::Vector3d(5.1, 0.2, 0.3)));
  const ListedCamera& left = cameras[1];
  EXPECT_EQ(left.folder, "/data/images/left");
  EXPECT_EQ(left.name, "/data/images/left");
  EXPECT_EQ(left.frame, "left_optical");
  EXPECT_EQ(left.model->lens, Lens::fisheye);
  EXPECT_FALSE(left.T_lidar_camera);
  ASSERT_TRUE(left.T_imu_camera);
  EXPECT_TRUE(left.T_imu_camera->translation().isApprox(Eigen::Vector3d(1, 2, 3)));
  EXPECT_TRUE((left.T_imu_camera->linear() * Eigen::Vector3d::UnitX())
                  .isApprox(Eigen::Vector3d(-0.28 + 0.56, 0.96, 0.0), 1e-9));
}

TEST(CameraToml, WithoutALensIsThatOfTheRecording) {
  const auto cameras = parse_camera_toml(
      "[[camera]]\ntopic = \"/a\"\nT_lidar_camera = [0, 0, 0, 0, 0, 0, 1]\n", "c.toml");
  EXPECT_FALSE(cameras.at(0).model);
  EXPECT_EQ(cameras.at(0).name, "/a");
}

TEST(CameraToml, MistakesNameTheirLine) {
  struct Mistake {
    std::string from, to, message;
  };
  const std::vector<Mistake> mistakes = {
      {"width = 640", "width = 0", "line 4: width is 0"},
      {"width = 640", "width = 20000", "line 4: width is 20000"},
      {"width = 640", "width = 6.5", "line 4: width is no whole number"},
      {"width = 640\n", "", "a lens without width"},
      {"model = \"perspective\"", "model = \"omni\"", "line 6: the model 'omni' is not known"},
      {"focal = [400.5, 401]", "focal = 400.5", "line 7: focal is no list of numbers"},
      {"focal = [400.5, 401]", "focal = [400.5]", "line 7: focal has 1 numbers"},
      {"focal = [400.5, 401]", "focal = [400.5, \"a\"]", "focal has something that is no number"},
      {"focal = [400.5, 401]", "focal = [0, 401]", "the focal lengths of the camera are 0"},
      {"focal = [400.5, 401]", "focal = [400.5, nan]", "the focal lengths of the camera are"},
      {"center = [320.25, 240]", "center = [inf, 240]", "not finite"},
      {"[0.1, -0.2, 0.001, 0.002, 0.05]", "[0.1, 0.2, 0.3]", "line 9: distortion has 3 numbers"},
      {"[0.1, 0.2, 0.3, 0.4]", "[0.1, 0.2, 0.3, 0.4, 0.5]", "expected k1 k2 k3 k4"},
      {"[0, 0, 1, 0.1]", "[0, 0, 2, 0.1]", "line 10: T_lidar_camera is no rotation"},
      {"[0, 0, 1, 0.1]", "[0, 0, -1, 0.1]", "line 10: T_lidar_camera is no rotation"},
      {"[0, 0, 0, 1]", "[0, 0, 1, 1]", "line 10: T_lidar_camera is no rotation"},
      {"0, 0, 0.6, 0.8]", "0, 0, 0.6]", "T_imu_camera is no rotation"},
      {"0, 0, 0.6, 0.8]", "0, 0, 6, 8]", "T_imu_camera is no rotation"},
      {"time_offset = -0.012", "time_offset = inf", "line 11: time_offset is inf s"},
      {"time_offset = -0.012", "time_offset = true", "time_offset is no number"},
      {"name = \"front\"", "nam = \"front\"", "a camera has no nam: name, topic"},
      {"folder = \"images/left\"\n", "", "neither a topic nor a folder"},
      {"folder = \"images/left\"\n", "folder = \"a\"\ntopic = \"/b\"\n", "a topic and a folder"},
      {"[[camera]]", "other = 1\n[[camera]]", "a file of cameras has no other"},
      {"[[camera]]", "[[camera]", "it is no TOML"},
  };
  for (const Mistake& mistake : mistakes) {
    const std::string error = test::error_of<InputError>(
        [&] { parse_camera_toml(with_changed(kToml, mistake.from, mistake.to), "cameras.toml"); });
    EXPECT_NE(error.find(mistake.message), std::string::npos) << mistake.to << "\n" << error;
  }
  EXPECT_NE(test::error_of<InputError>([] {
              parse_camera_toml("", "c.toml");
            }).find("it lists no camera"),
            std::string::npos);
  EXPECT_NE(test::error_of<InputError>([] {
              parse_camera_toml("[[camera]]\nfolder = \"a\"\n", "c.toml");
            }).find("a folder of images and no calibration"),
            std::string::npos);
}

const std::string kKalibr =
    "cam0:\n"
    "  T_cam_imu:\n"
    "  - [0.0, -1.0, 0.0, 0.5]\n"
    "  - [0.0, 0.0, -1.0, 0.25]\n"
    "  - [1.0, 0.0, 0.0, -0.125]\n"
    "  - [0.0, 0.0, 0.0, 1.0]\n"
    "  cam_overlaps: [1]\n"
    "  camera_model: pinhole\n"
    "  distortion_coeffs: [-0.28, 0.07, 0.0002, 0.00002]\n"
    "  distortion_model: radtan\n"
    "  intrinsics: [458.5, 457.25, 367.0, 248.0]\n"
    "  resolution: [752, 480]\n"
    "  rostopic: /cam0/image_raw\n"
    "  timeshift_cam_imu: 0.005\n"
    "cam1:\n"
    "  T_cn_cnm1:\n"
    "  - [1.0, 0.0, 0.0, -0.11]\n"
    "  - [0.0, 1.0, 0.0, 0.0]\n"
    "  - [0.0, 0.0, 1.0, 0.0]\n"
    "  - [0.0, 0.0, 0.0, 1.0]\n"
    "  camera_model: pinhole\n"
    "  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]\n"
    "  distortion_model: equidistant\n"
    "  intrinsics: [460.0, 461.0, 370.0, 250.0]\n"
    "  resolution: [752, 480]\n"
    "  rostopic: /cam1/image_raw\n";

TEST(KalibrCameras, AreMountedAgainstTheImu) {
  const std::vector<ListedCamera> cameras = parse_camera_yaml(kKalibr, "camchain.yaml");
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].name, "cam0");
  EXPECT_EQ(cameras[0].topic, "/cam0/image_raw");
  EXPECT_EQ(cameras[0].model->width, 752U);
  EXPECT_EQ(cameras[0].model->fy, 457.25);
  EXPECT_EQ(cameras[0].model->lens, Lens::perspective);
  EXPECT_EQ(cameras[0].model->distortion[1], 0.07);
  EXPECT_EQ(cameras[0].time_offset, 0.005);
  EXPECT_FALSE(cameras[0].T_lidar_camera);
  ASSERT_TRUE(cameras[0].T_imu_camera);
  // T_cam_imu takes a point 2 m ahead (x) of the IMU to (0.5, 0.25, 1.875) of the camera.
  EXPECT_TRUE((*cameras[0].T_imu_camera * Eigen::Vector3d(0.5, 0.25, 1.875))
                  .isApprox(Eigen::Vector3d(2, 0, 0)));
  EXPECT_EQ(cameras[1].model->lens, Lens::fisheye);
  EXPECT_EQ(cameras[1].model->distortion[3], 0.4);
  EXPECT_EQ(cameras[1].time_offset, 0.0);
  ASSERT_TRUE(cameras[1].T_imu_camera);
  // The second camera is 11 cm to the right (x) of the first.
  EXPECT_TRUE((cameras[0].T_imu_camera->inverse() * cameras[1].T_imu_camera->translation())
                  .isApprox(Eigen::Vector3d(0.11, 0, 0)));
}

TEST(KalibrCameras, WithoutAnImuHaveNoPose) {
  const std::string imu = kKalibr.substr(
      kKalibr.find("  T_cam_imu"), kKalibr.find("  cam_overlaps") - kKalibr.find("  T_cam_imu"));
  const auto cameras = parse_camera_yaml(with_changed(kKalibr, imu, ""), "camchain.yaml");
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_FALSE(cameras[0].T_imu_camera);
  EXPECT_FALSE(cameras[1].T_imu_camera);
}

TEST(KalibrCameras, MistakesNameTheirKey) {
  const std::vector<std::array<std::string, 3>> mistakes = {
      {"camera_model: pinhole", "camera_model: omni", "cam0.camera_model: the projection 'omni'"},
      {"distortion_model: radtan", "distortion_model: fov", "the distortion 'fov' is not read"},
      {"[-0.28, 0.07, 0.0002, 0.00002]", "[-0.28, 0.07]", "it has 2 numbers, expected 4"},
      {"[458.5, 457.25, 367.0, 248.0]", "[458.5, a, 367.0, 248.0]", "found 'a'"},
      {"[458.5, 457.25, 367.0, 248.0]", "[0, 457.25, 367.0, 248.0]", "the focal lengths"},
      {"[458.5, 457.25, 367.0, 248.0]", "[nan, 457.25, 367.0, 248.0]", "expected a number"},
      {"[752, 480]", "[752.5, 480]", "is no number of pixels"},
      {"[752, 480]", "[752, -480]", "is no number of pixels"},
      {"[0.0, -1.0, 0.0, 0.5]", "[0.0, -1.0, 0.0]", "it has 15 numbers, expected 16"},
      {"[0.0, -1.0, 0.0, 0.5]", "[0.0, 1.0, 0.0, 0.5]", "it is no rotation and translation"},
      {"timeshift_cam_imu: 0.005", "timeshift_cam_imu: 1e300", "cam0.timeshift_cam_imu"},
      {"cam0:", "kam0:", "it has neither a camera_matrix nor a camera cam0"},
      {"[752, 480]", "[752, 480", "it is no YAML"},
  };
  for (const auto& [from, to, message] : mistakes) {
    const std::string error = test::error_of<InputError>([&, &from = from, &to = to] {
      parse_camera_yaml(with_changed(kKalibr, from, to), "camchain.yaml");
    });
    EXPECT_NE(error.find(message), std::string::npos) << to << "\n" << error;
  }
}

TEST(PlainCameras, OfRosAreRead) {
  const std::string text =
      "image_width: 640\nimage_height: 480\ncamera_name: narrow\ncamera_matrix:\n  rows: 3\n"
      "  cols: 3\n  data: [438.78, 0, 305.59, 0, 437.35, 243.74, 0, 0, 1]\n"
      "distortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n"
      "  data: [-0.36, 0.11, 0.001, -0.0005, 0]\nrectification_matrix:\n  rows: 3\n  cols: 3\n"
      "  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n";
  const std::vector<ListedCamera> cameras = parse_camera_yaml(text, "head.yaml");
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras[0].name, "narrow");
  EXPECT_EQ(cameras[0].model->fx, 438.78);
  EXPECT_EQ(cameras[0].model->cy, 243.74);
  EXPECT_EQ(cameras[0].model->height, 480U);
  EXPECT_EQ(cameras[0].model->distortion[0], -0.36);
  EXPECT_EQ(cameras[0].model->lens, Lens::perspective);
  const auto fisheye = parse_camera_yaml(
      with_changed(with_changed(text, "plumb_bob", "equidistant"), "-0.0005, 0]", "-0.0005]"),
      "head.yaml");
  EXPECT_EQ(fisheye[0].model->lens, Lens::fisheye);
  EXPECT_NE(test::error_of<InputError>([&] {
              parse_camera_yaml(with_changed(text, "plumb_bob", "thin_prism"), "head.yaml");
            }).find("distortion model 'thin_prism' with 5 numbers is not known"),
            std::string::npos);
  EXPECT_NE(test::error_of<InputError>([&] {
              parse_camera_yaml(with_changed(text, "image_width: 640\n", ""), "head.yaml");
            }).find("image_width: expected a number, found none"),
            std::string::npos);
}

TEST(PlainCameras, OfOpenCvAreRead) {
  const auto cameras = parse_camera_yaml(
      "%YAML:1.0\n---\ncalibration_time: \"Thu 11 Nov\"\nimage_width: 640\nimage_height: 480\n"
      "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [ 5.35e+02, 0., 3.195e+02, 0., 5.36e+02,\n       2.395e+02, 0., 0., 1. ]\n"
      "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n"
      "   data: [ -2.6e-01, -4.6e-02, 1.8e-03, -3.1e-04, 2.5e-01 ]\n",
      "calib/out_camera.yml");
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras[0].name, "out_camera");
  EXPECT_EQ(cameras[0].model->fy, 536.0);
  EXPECT_EQ(cameras[0].model->distortion[4], 0.25);
}

TEST(CameraFile, IsReadByItsEnding) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_camera_file(folder.write("a.toml", kToml)).size(), 2U);
  EXPECT_EQ(read_camera_file(folder.write("a.yaml", kKalibr)).size(), 2U);
  EXPECT_EQ(read_camera_file(folder.write("a.yml", kKalibr)).size(), 2U);
  EXPECT_THROW(read_camera_file(folder.write("a.json", "{}")), InputError);
  EXPECT_THROW(read_camera_file(folder / "none.toml"), InputError);
}

TEST(YamlText, ListsInListsAndTagsAreRead) {
  const auto root = parse_yaml(
      "%YAML 1.2\n---\na: [[1, 2], [3, '4, ]'], []] # rows\nb: !!map\n  c: !x y\nd: [e,\n  [f]]\n");
  ASSERT_TRUE(root);
  const YamlNode& a = *root->find("a");
  ASSERT_EQ(a.items.size(), 3U);
  EXPECT_EQ(a.items[0].items[1].scalar, "2");
  EXPECT_EQ(a.items[1].items[1].scalar, "4, ]");
  EXPECT_TRUE(a.items[2].items.empty());
  EXPECT_EQ(root->find("b")->find("c")->scalar, "y");
  ASSERT_EQ(root->find("d")->items.size(), 2U);
  EXPECT_EQ(root->find("d")->items[1].items.at(0).scalar, "f");
  EXPECT_FALSE(parse_yaml("a: [[1, 2]"));
  EXPECT_FALSE(parse_yaml("a: [[1] 2]"));
  EXPECT_FALSE(parse_yaml("a: " + std::string(100, '[') + std::string(100, ']')));
}

}  // namespace
}  // namespace adit
