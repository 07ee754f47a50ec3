// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/recordings/camera_support.hpp"
#include "adit/tests/support/error_text.hpp"
#include "adit/tools/cameras/find_cameras.hpp"
#include "adit/tools/cameras/image_folder.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::CameraRecorder;
using test::Container;
using test::kStart;

constexpr Nanoseconds kImagePeriod = std::chrono::milliseconds(100);

template <class Action>
std::string input_error(const Action& action) {
  return test::error_of<InputError>(action);
}

std::vector<std::string> camera_names(const std::vector<CameraSource>& cameras) {
  std::vector<std::string> names;
  for (const CameraSource& camera : cameras) {
    names.push_back(camera.name);
  }
  return names;
}

void write_rounds(CameraRecorder& recorder, unsigned first, unsigned count) {
  ros::CameraInfo fisheye = test::color_camera_info(8, 6);
  fisheye.distortion_model = "equidistant";
  fisheye.d = {0.1, 0.2, 0.3, 0.4};
  for (unsigned i = first; i < first + count; ++i) {
    const Nanoseconds stamp = kStart + i * kImagePeriod;
    recorder.write("/front/camera_info", stamp, test::color_camera_info(8, 6));
    recorder.write("/rear/camera_info", stamp, fisheye);
    recorder.write("/mono/camera_info", stamp, test::color_camera_info(8, 6));
    recorder.write_jpeg("/front/image_raw/compressed", stamp, stamp, i);
    recorder.write_image("/front/image_raw", stamp, stamp, i);
    recorder.write_image("/front/image_rect_color", stamp, stamp, i);
    recorder.write_jpeg("/rear/image_raw/compressed", stamp, stamp, i);
    recorder.write_jpeg("/mono/image/compressed", stamp, stamp, i, true);
    recorder.write_image("/other/image_raw", stamp, stamp, i);
    ros::Image depth = test::depth_image_message(0).message;
    depth.data = {};
    recorder.write("/front/depth", stamp, depth);
  }
}

class FindCameras : public testing::TestWithParam<Container> {
 protected:
  fs::path record(const std::string& name, unsigned first, unsigned count) const {
    CameraRecorder recorder(folder_, name, GetParam());
    write_rounds(recorder, first, count);
    return recorder.close();
  }
  test::TemporaryFolder folder_;
};

TEST_P(FindCameras, AreThoseWithColoursAndACalibration) {
  const auto cameras = find_cameras({record("drive", 0, 5)});
  ASSERT_EQ(camera_names(cameras),
            (std::vector<std::string>{"/front/image_raw", "/rear/image_raw/compressed"}));
  EXPECT_EQ(cameras[0].frame, "camera_optical_frame");
  EXPECT_EQ(cameras[0].model.lens, Lens::perspective);
  EXPECT_EQ(cameras[0].model.fx, 100.0);
  EXPECT_EQ(cameras[0].model.distortion[0], 0.1);
  EXPECT_EQ(cameras[0].images->stamps().size(), 5U);
  EXPECT_EQ(cameras[0].images->image(3).rgb, test::color_picture(8, 6, 3).rgb);
  EXPECT_FALSE(cameras[0].T_lidar_camera);
  EXPECT_FALSE(cameras[0].T_imu_camera);
  EXPECT_EQ(cameras[1].frame, "jpeg_frame");
  EXPECT_EQ(cameras[1].model.lens, Lens::fisheye);
  EXPECT_EQ(cameras[1].model.distortion[3], 0.4);
  EXPECT_EQ(cameras[1].images->stamps()[4], kStart + 4 * kImagePeriod);
}

TEST_P(FindCameras, ThatAreNamedAreUsedAll) {
  const fs::path drive = record("drive", 0, 3);
  const auto cameras = find_cameras(
      {drive}, {.topics = {"/front/image_rect_color", "/rear/image_raw", "/mono/image"}});
  ASSERT_EQ(camera_names(cameras),
            (std::vector<std::string>{"/front/image_rect_color", "/rear/image_raw/compressed",
                                      "/mono/image/compressed"}));
  EXPECT_EQ(cameras[0].model.fx, 50.0);  // of rectified images, without distortion
  EXPECT_EQ(cameras[0].model.distortion, (std::array<double, 8>{}));
}

TEST_P(FindCameras, OfSeveralFilesHaveTheImagesOfAll) {
  const auto cameras = find_cameras({record("b", 5, 5), record("a", 0, 5)});
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].images->stamps().size(), 10U);
  EXPECT_EQ(cameras[0].images->image(7).rgb[2], 7);
}

INSTANTIATE_TEST_SUITE_P(Containers, FindCameras,
                         testing::Values(Container::mcap, Container::bag, Container::rosbag2));

TEST(FindCamerasErrors, NameWhatIsMissing) {
  const test::TemporaryFolder folder;
  CameraRecorder recorder(folder, "drive", Container::mcap);
  write_rounds(recorder, 0, 2);
  const std::vector<fs::path> drive = {recorder.close()};
  const auto error_of_topic = [&](const std::string& topic) {
    return input_error([&] { find_cameras(drive, {.topics = {topic}}); });
  };
  EXPECT_NE(error_of_topic("/nothing").find("it has no images on the topic /nothing"),
            std::string::npos);
  EXPECT_NE(error_of_topic("/nothing").find("/front/image_raw/compressed, /front/image_raw"),
            std::string::npos);
  EXPECT_NE(error_of_topic("/front/depth").find("of the encoding '16UC1' are not read as colours"),
            std::string::npos);
  EXPECT_NE(error_of_topic("/other/image_raw")
                .find("no sensor_msgs/CameraInfo on "
                      "/other/camera_info"),
            std::string::npos);
  CameraRecorder other(folder, "other", Container::mcap);
  other.write_image("/other/image_raw", kStart, kStart, 1);
  const fs::path uncalibrated = other.close();
  EXPECT_NE(input_error([&] { find_cameras({uncalibrated}); })
                .find("it has no camera with a calibration; its topics with images: "
                      "/other/image_raw"),
            std::string::npos);
}

TEST(FindCamerasErrors, CalibrationsThatDoNotFitAreNamed) {
  const test::TemporaryFolder folder;
  CameraRecorder recorder(folder, "drive", Container::mcap);
  recorder.write("/a/camera_info", kStart, test::color_camera_info(16, 6));
  recorder.write_image("/a/image", kStart, kStart, 1);
  ros::CameraInfo unknown = test::color_camera_info(8, 6);
  unknown.distortion_model = "thin_prism";
  recorder.write("/b/camera_info", kStart, unknown);
  recorder.write_image("/b/image", kStart, kStart, 1);
  const fs::path drive = recorder.close();
  EXPECT_NE(input_error([&] { find_cameras({drive}); })
                .find("the images of the camera /a/image have 8 x 6 pixels, its calibration has 16 "
                      "x 6"),
            std::string::npos);
  EXPECT_NE(input_error([&] { find_cameras({drive}, {.topics = {"/b/image"}}); })
                .find("of the camera with images on /b/image: the camera's distortion model "
                      "'thin_prism'"),
            std::string::npos);
}

TEST(FindCamerasByColour, MonochromeCamerasCountWhereThereAreNoOthers) {
  const test::TemporaryFolder folder;
  CameraRecorder recorder(folder, "mono", Container::mcap);
  recorder.write("/mono/camera_info", kStart, test::color_camera_info(8, 6));
  recorder.write_jpeg("/mono/image/compressed", kStart, kStart, 9, true);
  EXPECT_EQ(camera_names(find_cameras({recorder.close()})),
            (std::vector<std::string>{"/mono/image/compressed"}));
}

constexpr const char* kLens = "width = 8\nheight = 6\nfocal = [10, 11]\ncenter = [4, 3]\n";

TEST(CamerasOfAFile, HaveTheirImagesOnTopicsAndInFolders) {
  const test::TemporaryFolder folder;
  CameraRecorder recorder(folder, "drive", Container::bag);
  write_rounds(recorder, 0, 4);
  const fs::path drive = recorder.close();
  folder.write("left/1700000000.5.jpg", test::jpeg_bytes(test::color_picture(8, 6, 10)));
  folder.write("left/1700000000.25.JPG", test::jpeg_bytes(test::color_picture(8, 6, 20)));
  const fs::path file = folder.write(
      "cameras.toml", std::string("[[camera]]\nname = \"rear\"\ntopic = \"/rear/image_raw\"\n") +
                          "T_lidar_camera = [1, 2, 3, 0, 0, 0, 1]\ntime_offset = 0.5\n"
                          "[[camera]]\ntopic = \"/other/image_raw\"\nframe = \"mine\"\n" +
                          kLens + "[[camera]]\nname = \"left\"\nfolder = \"left\"\n" + kLens);
  const auto cameras = find_cameras({drive}, {.calibration = file});
  ASSERT_EQ(camera_names(cameras), (std::vector<std::string>{"rear", "/other/image_raw", "left"}));
  EXPECT_EQ(cameras[0].model.lens, Lens::fisheye);  // by the recording's camera_info
  EXPECT_EQ(cameras[0].time_offset, 0.5);
  EXPECT_EQ(cameras[0].images->stamps().size(), 4U);
  ASSERT_TRUE(cameras[0].T_lidar_camera);
  EXPECT_EQ(cameras[0].T_lidar_camera->translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(cameras[1].model.fy, 11.0);
  EXPECT_EQ(cameras[1].frame, "mine");
  EXPECT_EQ(cameras[1].images->image(2).rgb[2], 2);
  ASSERT_EQ(cameras[2].images->stamps().size(), 2U);
  EXPECT_EQ(cameras[2].images->stamps()[0], Nanoseconds(1700000000250000000));
  EXPECT_NEAR(cameras[2].images->image(0).rgb[2], 20, 8);
  EXPECT_EQ(
      camera_names(find_cameras({drive}, {.topics = {"/rear/image_raw"}, .calibration = file})),
      (std::vector<std::string>{"rear"}));
  EXPECT_NE(input_error([&] {
              find_cameras({drive}, {.topics = {"/rear/image_raw", "/front/image_raw"},
                                     .calibration = file});
            }).find("it lists no camera with images on /front/image_raw"),
            std::string::npos);
}

TEST(CamerasOfAFile, WithoutATopicAreThatWhichIsNamedOrTheOnlyOne) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.write(
      "camera.yaml",
      "image_width: 8\nimage_height: 6\ncamera_name: only\ncamera_matrix:\n"
      "  data: [10, 0, 4, 0, 11, 3, 0, 0, 1]\ndistortion_coefficients:\n  data: [0, 0, 0, 0, 0]\n");
  CameraRecorder one(folder, "one", Container::mcap);
  one.write_image("/a", kStart, kStart, 1);
  const fs::path single = one.close();
  const auto cameras = find_cameras({single}, {.calibration = file});
  EXPECT_EQ(camera_names(cameras), (std::vector<std::string>{"only"}));
  EXPECT_EQ(cameras[0].model.fx, 10.0);
  EXPECT_EQ(cameras[0].frame, "camera_optical_frame");
  CameraRecorder two(folder, "two", Container::mcap);
  two.write_image("/a", kStart, kStart, 1);
  two.write_image("/b", kStart, kStart, 2);
  const fs::path both = two.close();
  EXPECT_NE(input_error([&] {
              find_cameras({both}, {.calibration = file});
            }).find("the file of cameras names no topic"),
            std::string::npos);
  const auto named = find_cameras({both}, {.topics = {"/b"}, .calibration = file});
  ASSERT_EQ(named.size(), 1U);
  EXPECT_EQ(named[0].images->image(0).rgb[2], 2);
}

TEST(CamerasOfAFile, MayBeBesideFoldersOfSweeps) {
  const test::TemporaryFolder folder;
  folder.write("sweeps/000000.pcd", "none is read here");
  folder.write("left/1700000000000000000.jpg", test::jpeg_bytes(test::color_picture(8, 6, 10)));
  const fs::path file =
      folder.write("cameras.toml", std::string("[[camera]]\nfolder = \"left\"\n") + kLens);
  EXPECT_EQ(find_cameras({folder / "sweeps"}, {.calibration = file}).size(), 1U);
  EXPECT_NE(input_error([&] { find_cameras({folder / "sweeps"}); }).find("it has no camera"),
            std::string::npos);
}

TEST(ImageFolder, TakesTimesFromAFileInTheOrderOfTheNames) {
  const test::TemporaryFolder folder;
  for (unsigned i = 0; i < 12; ++i) {
    folder.write("a/image_" + std::to_string(i) + ".jpeg",
                 test::jpeg_bytes(test::color_picture(8, 6, 20 * i)));
  }
  std::string times;
  for (unsigned i = 0; i < 12; ++i) {
    times += "10." + std::to_string(100 + i) + "\n";
  }
  folder.write("a/times.txt", times);
  const auto series = open_image_folder(folder / "a");
  ASSERT_EQ(series->stamps().size(), 12U);
  EXPECT_EQ(series->stamps()[10], Nanoseconds(10110000000));
  EXPECT_NEAR(series->image(10).rgb[2], 200, 10);  // image_10 follows image_9
  // As KITTI has them.
  fs::create_directories(folder / "image_02");
  fs::rename(folder / "a", folder / "image_02/data");
  fs::remove(folder / "image_02/data/times.txt");
  std::string dates;
  for (unsigned i = 0; i < 12; ++i) {
    dates += "2011-09-26 13:02:" + std::to_string(25 + i) + ".964389445\n";
  }
  folder.write("image_02/timestamps.txt", dates);
  const auto kitti = open_image_folder(folder / "image_02/data");
  EXPECT_EQ(kitti->stamps()[0], Nanoseconds(1317042145964389445));
  EXPECT_EQ(kitti->stamps()[11] - kitti->stamps()[0], std::chrono::seconds(11));
}

TEST(ImageFolder, MistakesAreNamed) {
  const test::TemporaryFolder folder;
  const std::string jpeg = test::jpeg_bytes(test::color_picture(8, 6, 1));
  const auto error_of_folder = [&](const char* name) {
    return input_error([&] { open_image_folder(folder / name); });
  };
  EXPECT_NE(error_of_folder("none").find("it is no folder of images that can be read"),
            std::string::npos);
  folder.write("empty/readme.txt", "");
  EXPECT_NE(error_of_folder("empty").find("a folder without images"), std::string::npos);
  folder.write("untimed/000001.jpg", jpeg);
  EXPECT_NE(error_of_folder("untimed").find("000001.jpg: the name of the image is not a time"),
            std::string::npos);
  folder.write("untimed/times.txt", "1\n2\n");
  EXPECT_NE(error_of_folder("untimed").find("it holds 2 times for 1 images"), std::string::npos);
  folder.write("untimed/times.txt", "1\n");
  EXPECT_EQ(open_image_folder(folder / "untimed")->stamps().size(), 1U);
  folder.write("broken/1700000000000000000.jpg", jpeg.substr(0, jpeg.size() / 2));
  const auto broken = open_image_folder(folder / "broken");
  EXPECT_NE(input_error([&] { broken->image(0); }).find("1700000000000000000.jpg: "),
            std::string::npos);
}

}  // namespace
}  // namespace adit
