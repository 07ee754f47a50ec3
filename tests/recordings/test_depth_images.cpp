// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/recordings/event_support.hpp"
#include "adit/tests/recordings/message_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/containers/bag_writer.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/recordings/ros_images.hpp"

namespace adit {
namespace {

std::size_t add_channel(McapWriter& writer, const char* topic, std::string_view type) {
  return writer.add_channel({.topic = topic,
                             .type = std::string(type),
                             .encoding = Encoding::cdr,
                             .definition = {},
                             .messages = std::nullopt});
}

/// A recording of three depth images with their calibration.
std::filesystem::path record(const test::TemporaryFolder& folder, const std::string& topic,
                             Encoding encoding = Encoding::cdr) {
  McapWriter writer(folder / "depth.mcap", {});
  test::write_depth_sample(writer, encoding, topic, 3);
  writer.close();
  return folder / "depth.mcap";
}

TEST(DepthImages, AreSweepsWhereTheirCalibrationIsBesideThem) {
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    const test::TemporaryFolder folder;
    const auto recording = open_recording(record(folder, "/camera/depth/image_raw", encoding));
    ASSERT_EQ(recording->topics()[0].kind, TopicKind::sweeps);
    EXPECT_EQ(recording->topics()[1].kind, TopicKind::other);
    const test::ReadEvents read = test::read_all(*recording);
    EXPECT_TRUE(read.errors.empty());
    ASSERT_EQ(read.events.size(), 3U);
    EXPECT_EQ(read.events[0].frame, "camera_depth_optical_frame");
    const auto& sweep = std::get<Sweep>(read.events[0].value);
    EXPECT_EQ(sweep.stamp, test::kStart + Nanoseconds(7));
    EXPECT_EQ(sweep.source, "/camera/depth/image_raw#0");
    ASSERT_EQ(sweep.points.size(), 6U);
    EXPECT_EQ(sweep.points[0].z, 0.0F);
    const Point& p = sweep.points[5];  // pixel (2, 1), 65.535 m; the row before has 8 bytes
    EXPECT_FLOAT_EQ(p.z, 65.535F);
    EXPECT_FLOAT_EQ(p.x, 65.535F * (2.0F - 1.0F) / 100.0F);
    EXPECT_FLOAT_EQ(p.y, 65.535F * (1.0F - 0.5F) / 200.0F);
  }
}

TEST(DepthImages, RectifiedOnesAreReadByTheRectifiedCamera) {
  const test::TemporaryFolder folder;
  const auto recording = open_recording(record(folder, "/camera/depth/image_rect_raw"));
  const Point p = test::read_sweep(*recording, 0).points.at(5);
  EXPECT_FLOAT_EQ(p.x, 65.535F * (2.0F - 1.0F) / 50.0F);
  EXPECT_FLOAT_EQ(p.y, 65.535F * (1.0F - 0.5F) / 60.0F);
}

TEST(DepthImages, ColoursAndImagesWithoutCalibrationAreNoSweeps) {
  const test::TemporaryFolder folder;
  for (const bool colours : {true, false}) {
    McapWriter writer(folder / "other.mcap", {});
    test::ImageExample image = test::depth_image_message(0);
    if (colours) {
      image.message.encoding = "rgb8";
    }
    const std::size_t images = add_channel(writer, "/camera/image", ros::Image::kType);
    const std::size_t info = add_channel(
        writer, colours ? "/camera/camera_info" : "/other/camera_info", ros::CameraInfo::kType);
    writer.write(images, test::kStart, ros::encode(Encoding::cdr, image.message));
    writer.write(info, test::kStart, ros::encode(Encoding::cdr, test::camera_info_message(0)));
    writer.close();
    const auto recording = open_recording(folder / "other.mcap");
    EXPECT_EQ(recording->topics()[0].kind, TopicKind::other);
    EXPECT_TRUE(test::read_all(*recording).events.empty());
  }
}

TEST(DepthImages, CamerasOfImagesThatAreNotThereAreNotWorkedOut) {
  // Found by libFuzzer: the rays of sixteen million pixels took a minute.
  const test::TemporaryFolder folder;
  McapWriter writer(folder / "large.mcap", {});
  test::ImageExample image = test::depth_image_message(0);
  ros::CameraInfo info = test::camera_info_message(0);
  image.message.width = image.message.height = info.width = info.height = 4096;
  image.message.step = 8192;
  info.d[0] = 1e3;
  const std::size_t images = add_channel(writer, "/camera/image", ros::Image::kType);
  const std::size_t infos = add_channel(writer, "/camera/camera_info", ros::CameraInfo::kType);
  writer.write(images, test::kStart, ros::encode(Encoding::cdr, image.message));
  writer.write(infos, test::kStart, ros::encode(Encoding::cdr, info));
  writer.close();
  EXPECT_FALSE(ros::is_whole_depth(image.message));
  EXPECT_EQ(open_recording(folder / "large.mcap")->topics()[0].kind, TopicKind::other);
}

TEST(DepthCamera, PixelsBeyondWhatTheLensShowsHaveNoRay) {
  CameraModel model{.width = 400, .height = 1, .fx = 100.0, .fy = 100.0, .cx = 0.0, .cy = 0.0};
  model.distortion[0] = -0.5;  // a direction is shown at 0.55 at most
  const std::vector<Point> points = DepthCamera(model).points(std::vector<float>(400, 1.0F));
  EXPECT_EQ(points[30].z, 1.0F);
  EXPECT_EQ(points[300].z, 0.0F);
}

TEST(DepthImages, MetresAndTheOtherByteOrderAreRead) {
  const DepthCamera camera({.width = 2, .height = 1, .fx = 1.0, .fy = 1.0});
  ros::Image image;
  image.height = 1;
  image.width = 2;
  image.encoding = "32FC1";
  image.step = 8;
  const float metres[] = {2.5F, NAN};
  image.data = std::as_bytes(std::span(metres));
  Sweep sweep = ros::to_sweep(image, camera, Nanoseconds(1));
  EXPECT_EQ(sweep.points[0].z, 2.5F);
  EXPECT_EQ(sweep.points[1].z, 0.0F);
  image.encoding = "16UC1";
  image.step = 4;
  image.is_bigendian = 1;
  const uint8_t bytes[] = {0x03, 0xe8, 0x00, 0x00};
  image.data = std::as_bytes(std::span(bytes));
  EXPECT_EQ(ros::to_sweep(image, camera, {}).points[0].z, 1.0F);
}

TEST(DepthImages, WhatDoesNotFitIsRefused) {
  const DepthCamera camera(ros::to_camera(test::camera_info_message(0), false));
  const test::ImageExample good = test::depth_image_message(0);
  EXPECT_NO_THROW(ros::to_sweep(good.message, camera, {}));
  const auto refused = [&](auto change) {
    ros::Image image = good.message;
    change(image);
    EXPECT_THROW(ros::to_sweep(image, camera, {}), ros::CodecError);
  };
  refused([](ros::Image& image) { image.width = 4; });
  refused([](ros::Image& image) { image.height = 3; });
  refused([](ros::Image& image) { image.step = 5; });
  refused([](ros::Image& image) { image.step = 0xffffffffU; });
  refused([](ros::Image& image) { image.data = image.data.first(13); });
  refused([](ros::Image& image) { image.encoding = "32FC1"; });
}

TEST(DepthImages, CamerasThatAreNoneAreRefused) {
  const auto refused = [](auto change) {
    ros::CameraInfo info = test::camera_info_message(0);
    change(info);
    EXPECT_THROW(ros::to_camera(info, false), ros::CodecError);
  };
  refused([](ros::CameraInfo& info) { info.k = {}; });
  refused([](ros::CameraInfo& info) { info.k[0] = NAN; });
  refused([](ros::CameraInfo& info) { info.k[2] = INFINITY; });
  refused([](ros::CameraInfo& info) { info.width = 0; });
  refused([](ros::CameraInfo& info) { info.width = 100000; });
  refused([](ros::CameraInfo& info) { info.d.assign(12, 0.1); });
  refused([](ros::CameraInfo& info) {
    info.distortion_model = "thin_prism";
    info.d = {0.1, 0.0, 0.0, 0.0};
  });
  refused([](ros::CameraInfo& info) {
    info.distortion_model = "equidistant";
    info.d = {0.1, 0.0, 0.0, 0.0, 0.0};
  });
}

TEST(DepthImages, FisheyesAreReadRawAndRectified) {
  ros::CameraInfo info = test::camera_info_message(0);
  info.distortion_model = "equidistant";
  info.d = {0.1, 0.2, 0.3, 0.4};
  const CameraModel raw = ros::to_camera(info, false);
  EXPECT_EQ(raw.lens, Lens::fisheye);
  EXPECT_EQ(raw.fx, 100.0);
  EXPECT_EQ(raw.distortion, (std::array<double, 8>{0.1, 0.2, 0.3, 0.4, 0.0, 0.0, 0.0, 0.0}));
  const CameraModel rectified = ros::to_camera(info, true);
  EXPECT_EQ(rectified.lens, Lens::perspective);
  EXPECT_EQ(rectified.fx, 50.0);
  EXPECT_EQ(rectified.distortion, (std::array<double, 8>{}));
}

TEST(DepthCamera, HasNoDepthsSidewaysOfAFisheye) {
  CameraModel model{.width = 400, .height = 1, .fx = 100.0, .fy = 100.0, .cx = 0.0, .cy = 0.0};
  model.lens = Lens::fisheye;
  const std::vector<Point> points = DepthCamera(model).points(std::vector<float>(400, 1.0F));
  EXPECT_NEAR(points[100].x, std::tan(1.0), 1e-5);  // 1 rad aside
  EXPECT_EQ(points[150].z, 1.0F);
  EXPECT_EQ(points[160].z, 0.0F);  // more than a quarter turn
}

TEST(DepthImages, RegionsAndBinningMoveTheCentre) {
  ros::CameraInfo info = test::camera_info_message(0);
  info.width = 640;
  info.height = 480;
  info.k = {500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0};
  info.binning_x = 2;
  info.binning_y = 2;
  info.x_offset = 100;
  info.roi_width = 400;
  info.roi_height = 480;
  const CameraModel model = ros::to_camera(info, false);
  EXPECT_EQ(model.width, 200U);
  EXPECT_EQ(model.height, 240U);
  EXPECT_EQ(model.fx, 250.0);
  EXPECT_EQ(model.cx, 110.0);
  EXPECT_EQ(model.cy, 120.0);
}

/// Where OpenCV's model shows the direction (x, y, 1), pixels.
Eigen::Vector2d seen(const CameraModel& m, double x, double y) {
  const auto& d = m.distortion;
  const double r2 = x * x + y * y;
  const double radial = (1 + d[0] * r2 + d[1] * r2 * r2 + d[4] * r2 * r2 * r2) /
                        (1 + d[5] * r2 + d[6] * r2 * r2 + d[7] * r2 * r2 * r2);
  return {m.fx * (x * radial + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x)) + m.cx,
          m.fy * (y * radial + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y) + m.cy};
}

TEST(DepthCamera, PixelsLookWhereTheLensShowsThem) {
  CameraModel model{
      .width = 640, .height = 480, .fx = 520.9, .fy = 521.0, .cx = 325.1, .cy = 249.7};
  for (const std::array<double, 8>& distortion :
       {std::array<double, 8>{0.2312, -0.7849, -0.0033, -0.0001, 0.9172, 0.0, 0.0, 0.0},
        {0.45, -2.6, 0.0005, -0.0002, 1.5, 0.33, -2.4, 1.43}}) {
    model.distortion = distortion;
    const std::vector<Point> points =
        DepthCamera(model).points(std::vector<float>(640 * 480, 2.0F));
    for (std::size_t v = 0; v < 480; v += 53) {
      for (std::size_t u = 0; u < 640; u += 71) {
        const Point& p = points[640 * v + u];
        ASSERT_EQ(p.z, 2.0F) << u << ' ' << v;
        const Eigen::Vector2d pixel =
            seen(model, static_cast<double>(p.x) / 2.0, static_cast<double>(p.y) / 2.0);
        EXPECT_NEAR(pixel.x(), static_cast<double>(u), 1e-3);
        EXPECT_NEAR(pixel.y(), static_cast<double>(v), 1e-3);
      }
    }
  }
}

}  // namespace
}  // namespace adit
