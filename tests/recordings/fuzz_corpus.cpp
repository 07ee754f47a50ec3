// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tests/recordings/fuzz_corpus.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>

#include "adit/tests/recordings/container_support.hpp"
#include "adit/tests/recordings/message_support.hpp"
#include "adit/tests/recordings/packet_support.hpp"
#include "adit/tests/recordings/sensor_support.hpp"
#include "adit/tests/support/color_images.hpp"
#include "adit/tests/support/depth_images.hpp"
#include "adit/tests/support/point_files.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/copc_writer.hpp"
#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/clouds/ply_writer.hpp"
#include "adit/tools/containers/bag_writer.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/containers/rosbag2_writer.hpp"

namespace adit::test {
namespace {

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

class Corpus {
 public:
  std::vector<FuzzSeed> take() && { return std::move(seeds_); }

  void add_containers() {
    for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
      const std::string suffix = encoding == Encoding::ros1 ? "_ros1" : "_ros2";
      add_mcap("plain" + suffix, {.compression = Compression::none}, encoding);
      add_mcap("lz4" + suffix, {.compression = Compression::lz4}, encoding);
      add_mcap("zstd" + suffix, {.compression = Compression::zstd}, encoding);
    }
    add_mcap("no_summary", {.compression = Compression::lz4, .summary = false}, Encoding::cdr);
    {
      McapWriter writer(folder_ / "seed", {.compression = Compression::none});
      write_depth_sample(writer, Encoding::cdr, "/camera/image_raw", 9);
      writer.close();
      add("containers", "mcap", "depth", content_of(folder_ / "seed"));
    }
    add_mcap("no_chunks", {.chunks = false, .summary = false}, Encoding::cdr);
    add_grouped();
    for (const auto& [name, compression] : {std::pair{"none", Compression::none},
                                            {"lz4", Compression::lz4},
                                            {"bz2", Compression::bz2}}) {
      BagWriter writer(folder_ / "seed", {.compression = compression});
      add_written("bag", name, writer, Encoding::ros1, folder_ / "seed");
    }
    for (const bool packed : {false, true}) {
      const std::string name = packed ? "packed" : "plain";
      Rosbag2Writer writer(folder_ / name, {.pack_messages = packed});
      add_written("rosbag2", name, writer, Encoding::cdr, folder_ / name / (name + "_0.db3"));
    }
  }

  void add_captures() {
    std::vector<CapturedFrame> frames;
    for (int i = 0; i < 3; ++i) {
      const Bytes packet = velodyne_packet(150.0 * i, 5.0, 1000, i == 2 ? 0x39 : 0x37, 0x22,
                                           [](auto block, auto k) { return block * 50 + k; });
      for (Bytes& frame : frames_of(packet, 2368, i == 0 ? 65000 : 800)) {
        frames.push_back({std::chrono::seconds(1700000000), std::move(frame)});
      }
    }
    const Bytes position = position_packet(kSentence);
    frames.push_back({std::chrono::seconds(1700000001), frames_of(position, 8308).front()});
    add("containers", "pcap", "nanoseconds", text_of(pcap(frames)));
    add("containers", "pcap", "microseconds", text_of(pcap(frames, false)));
    add("containers", "pcapng", "packets", text_of(pcapng(frames)));
  }

  void add_packets() {
    for (const auto& [name, mode, model] :
         {std::tuple{"vlp16", 0x37, 0x22}, {"vlp16_dual", 0x39, 0x22}, {"hdl32", 0x37, 0x21}}) {
      Bytes bytes;
      for (int i = 0; i < 2; ++i) {
        append(bytes, velodyne_packet(190.0 * i, 5.0, 1000, static_cast<uint8_t>(mode),
                                      static_cast<uint8_t>(model),
                                      [](auto block, auto k) { return block * 50 + k; }));
      }
      add("packets", "velodyne", name, text_of(bytes));
    }
    add("packets", "velodyne", "vlp32c",
        text_of(velodyne_packet(5.0, 0.2, 1000, 0x39, 0x28,
                                [](auto block, auto k) { return block * 50 + k; })));
    for (const bool dual : {false, true}) {
      const auto range = [](auto sequence, auto laser, auto returned) {
        return sequence * 50 + laser + returned;
      };
      Bytes bytes = vls128_packet(190.0, 0.2, 1000, dual, range);
      append(bytes, vls128_packet(10.0, 0.2, 2000, dual, range));
      add("packets", "velodyne", dual ? "vls128_dual" : "vls128", text_of(bytes));
    }
    add("packets", "velodyne", "position", text_of(position_packet(kSentence)));
    for (const bool legacy : {true, false}) {
      Bytes bytes;
      for (const std::size_t first : {0U, 16U}) {
        append(bytes, ouster_packet(legacy, 2, first, 7, 1000000, [](auto column, auto beam) {
                 return 1000 + 10 * column + beam;
               }));
      }
      add("packets", "ouster", legacy ? "legacy" : "rng19", text_of(bytes));
      add("metadata", "ouster_json", legacy ? "flat" : "sections",
          ouster_metadata(2, legacy ? "LEGACY" : "RNG19_RFL8_SIG16_NIR16", !legacy));
    }
  }

  void add_other_packets() {
    for (const auto& [name, pixel, fusa] : {std::tuple{"rng19_dual", 16U, false},
                                            {"rng15", 4U, false},
                                            {"rng15_dual", 8U, false},
                                            {"fusa", 8U, true}}) {
      Bytes bytes;
      for (const std::size_t first : {0U, 16U}) {
        append(bytes, ouster_profile_packet(pixel, fusa, 2, first, 7, 1000000,
                                            [](Bytes& packet, auto at, auto column, auto beam) {
                                              put(packet, at,
                                                  static_cast<uint32_t>(1000 + 10 * column + beam));
                                            }));
      }
      add("packets", "ouster", name, text_of(bytes));
    }
    const std::vector<std::array<int32_t, 5>> points = {{1000, -2000, 3000, 40, 0},
                                                        {4000, 5000, 6000, 50, 0x20}};
    add("packets", "livox", "mm", text_of(livox_packet(1000000, points)));
    add("packets", "livox", "cm", text_of(livox_packet(1000000, points, true)));
    add("packets", "livox", "imu", text_of(livox_imu_packet(1000000)));
    const auto range = [](auto block, auto laser) { return 500 + 10 * block + laser; };
    add("packets", "hesai", "xt", text_of(test::hesai_packet({}, {10.0, 10.2}, 1000, range)));
    add("packets", "hesai", "ot",
        text_of(
            test::hesai_packet({.major = 1, .minor = 4, .lasers = 4}, {10.0, 10.2}, 1000, range)));
    add("packets", "hesai", "pandar64",
        text_of(test::hesai_packet({.pandar64 = true, .lasers = 4}, {10.0, 10.2}, 1000, range)));
    add("packets", "hesai", "xt32m",
        text_of(
            test::hesai_packet({.mode = 0x3d}, {10.0, 10.0, 10.0, 10.2, 10.2, 10.2}, 1000, range)));
    add("packets", "hesai", "pandar40p",
        text_of(pandar40p_packet(std::vector<double>(10, 10.0), 1000, 0x39, true, range)));
    add("packets", "hesai", "qt64", text_of(qt64_packet({10.0, 10.2}, 1000, 0x37, range, 4)));
    for (const uint8_t mode : {uint8_t{0x37}, uint8_t{0x39}}) {
      add("packets", "hesai", mode == 0x37 ? "qt128" : "qt128_dual",
          text_of(qt128_packet({.mode = mode, .lasers = 4}, {10.0, 10.2}, 1000, range)));
    }
  }

  /// The first byte: twice the type's place in fuzz_messages.cpp, and one for ROS 2.
  void add_messages() {
    for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
      const auto add_one = [&](char type, const auto& message, const std::string& variant = "") {
        const char head = static_cast<char>(2 * type + (encoding == Encoding::cdr ? 1 : 0));
        add("messages", "ros", std::to_string(int{head}) + variant,
            head + text_of(ros::encode(encoding, message)));
      };
      add_one(0, cloud_message(1).message);
      add_one(1, imu_message(1));
      add_one(2, fix_message(1));
      add_one(3, odometry_message(1));
      add_one(4, pose_message(1));
      add_one(5, ros::TFMessage{{transform_message(1, "lidar"), transform_message(1, "imu")}});
      ros::TransformStamped zero = transform_message(1, "camera");
      zero.rotation = {0.0, 0.0, 0.0, 0.0};
      add_one(5,
              ros::TFMessage{{transform_message(1, "base_link"), transform_message(1, ""), zero,
                              transform_message(1, "/lidar")}},
              "_damaged");
      add_one(6, livox_message(1));
      add_one(7, depth_image_message(1).message);
      add_one(8, camera_info_message(1));
      add_one(9, velodyne_message(1, 2));
      add_one(10, twist_message(1));
      add_one(11, twist_with_covariance_message(1));
      add_one(12, quaternion_message(1));
      add_one(13, sentence_message(1));
      const ImageExample pixels = depth_image_message(1);
      ros::CompressedImage packed;
      packed.header = header(1, "camera");
      packed.format = "rgb8; jpeg compressed bgr8";
      packed.data = pixels.data;
      add_one(14, packed);
    }
  }

  void add_clouds() {
    const std::array<Point, 3> points = {{{1, 2, 3, 0.5F}, {4, 5, 6, 0.25F}, {7, 8, 9, 0.125F}}};
    PlyWriter writer(folder_ / "seed.ply");
    writer.write(points);
    writer.close();
    add("clouds", "ply", "binary", content_of(folder_ / "seed.ply"));
    add("clouds", "ply", "ascii",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
        "double z\nproperty uchar ring\nproperty uint t\nelement face 1\nproperty list uchar int "
        "vertex_indices\nend_header\n1 2 3 4 500\n3 0 0 0\n");
    std::string rows;
    for (int i = 0; i < 3; ++i) {
      rows += bytes_of_all(1.0F, 2.0F, 3.0F, static_cast<uint16_t>(i), 1.7e9 + 0.001 * i);
    }
    const std::string head =
        "VERSION .7\nFIELDS x y z ring timestamp\nSIZE 4 4 4 2 8\nTYPE F F F U F\nCOUNT 1 1 1 1 1\n"
        "WIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ";
    const std::string packed = lzf_compress(std::string(36, '\1') + std::string(30, '\0'));
    add("clouds", "pcd", "ascii", head + "ascii\n1 2 3 0 0\n4 5 6 1 0.01\nnan nan nan 2 0.02\n");
    add("clouds", "pcd", "binary", head + "binary\n" + rows);
    add("clouds", "pcd", "compressed",
        head + "binary_compressed\n" +
            bytes_of_all(static_cast<uint32_t>(packed.size()), uint32_t{66}) + packed);
    add("clouds", "las", "format_1", las_file(1, 2, 28, 20));
    add("clouds", "las", "format_6", las_file(6, 4, 30, 22));
    add_packed_clouds();
    add_other_clouds();
  }

  /// LAZ in the order of the points, and as an octree.
  void add_packed_clouds() {
    std::vector<LasPoint> points;
    for (int i = 0; i < 30; ++i) {
      points.push_back({.position = {0.1 * i, 2.0 - 0.05 * i, 0.01 * (i % 3)},
                        .time = std::chrono::milliseconds(i),
                        .intensity = static_cast<uint16_t>(100 + i % 7),
                        .ring = static_cast<uint16_t>(i % 4),
                        .color = {static_cast<uint8_t>(5 * i), 90, static_cast<uint8_t>(i % 3)}});
    }
    for (const bool colored : {false, true}) {
      LasWriter laz(folder_ / "seed.laz", {.colored = colored}, LasPacking::laz);
      laz.write(points);
      laz.close();
      add("clouds", "laz", colored ? "colored" : "packed", content_of(folder_ / "seed.laz"));
    }
    CopcWriter copc(folder_ / "seed.copc.laz", {});
    copc.write(points);
    copc.close();
    add("clouds", "laz", "octree", content_of(folder_ / "seed.copc.laz"));
  }

  /// Dialects, large coordinates, and numbers without a header.
  void add_other_clouds() {
    add("clouds", "pcd", "dialect",
        "version .7\nfields x _ y z intensity\nsize 4 1 4 4 4\ntype f u f f f\ncount 1 0 1 1 1\n"
        "points 2\ndata ASCII\n1 2 3 0.5\n4 5 6 0.25\n");
    add("clouds", "ply", "bool",
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty bool a\nproperty float32 "
        "x\nproperty float32 y\nproperty float32 z\nend_header\n\1" +
            bytes_of_all(1.0F, 2.0F, 3.0F));
    std::string far;
    std::string six;
    for (int i = 0; i < 40; ++i) {
      const double along = 0.25 * i;
      far += bytes_of_all(430000.0 + along, 5400000.0 - along, 300.125);
      six += bytes_of_all(static_cast<float>(along - 5.1), static_cast<float>(5.3 - along), -1.5F,
                          0.3F, static_cast<float>(i % 4), 0.0025F * static_cast<float>(i));
    }
    add("clouds", "ply", "utm",
        "ply\nformat binary_little_endian 1.0\nelement vertex 40\nproperty double x\nproperty "
        "double y\nproperty double z\nend_header\n" +
            far);
    std::string las = las_file(1, 2, 28, 20);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      put_at(las, 155 + 8 * axis, axis == 2 ? 300.0 : 430000.0);
    }
    add("clouds", "las", "utm", las);
    add("clouds", "bin", "six", six);
  }

  /// The first byte: the letter of fuzz_folders.cpp.
  void add_folders() {
    add("folders", "euroc", "imu",
        "i#timestamp [ns],w_RS_S_x [rad s^-1]\n"
        "1403715273262142976,-0.25,0.5,0.75,9.0,0.125,-3.5\r\n"
        "1403715273267142976, 0.0, 0.0, 0.0, 9.5, 0.0, -3.0\n");
    add("folders", "euroc", "names",
        "i\xef\xbb\xbftimestamp [us];a_x [g];a_y [g];a_z [g];w_x [deg/s];w_y;w_z\r\n"
        "1403715273262142;0;0;1;10;0.2;0.3\r\n");
    add("folders", "euroc", "poses", "p#t\n1403715273264142976,1.0,2.0,3.0,0.0,0.0,0.0,1.0,0.1\n");
    add("folders", "times", "seconds", "t0.0\n1.036224e-01\n");
    add("folders", "times", "dates",
        "t2011-09-26 13:02:25.594360375\n2011-09-26 13:02:25.697683842\n");
    add("folders", "kitti_raw", "reading",
        "o49.0 8.4 110.0 0.1 0.2 -2.6 0 0 0 0 0 0.5 -0.25 9.75 0 0 9.8 0.01 0.02 0.03 0.1 0.2 0.3 "
        "0.5 0.02 4 10 6 4 0\n");
    add("folders", "kitti_raw", "times", "s2011-09-26 13:02:25.5\n");
    add("folders", "kitti_raw", "calibration", "kR: 1 0 0 0 1 0 0 0 1\nT: -0.8 0.3 -0.7\n");
    add("folders", "tum", "list", "d# timestamp filename\n1305031102.160407 1.png\n");
    add("folders", "tum", "poses", "g1305031102.1758 1.0 2.0 3.0 0 0 0.6 0.8\n");
    add("folders", "tum", "accelerations", "a1305031102.1 -0.5 8.25 -2.5\n");
    add("folders", "tum", "calibration", "c525.0 525.0 319.5 239.5\n");
    const std::string bag = "mrosbag2_bagfile_information:\n  relative_file_paths:\n";
    const std::string topics =
        "  message_count: 9\n  topics_with_message_count:\n    - topic_metadata:\n        name: "
        "/imu\n        offered_qos_profiles: \"- depth: 1\\n\"\n      message_count: 9\n";
    add("folders", "rosbag2", "missing_split",
        bag + "    - drive_0.mcap\n    - drive_1.mcap\n" + topics);
    add("folders", "rosbag2", "wrong_counts", bag + "  - 'drive_0.mcap'\n" + topics);
    add("folders", "rosbag2", "flow",
        "mrosbag2_bagfile_information:\n  relative_file_paths: [\"drive_0.mcap\"]\n");
  }

  void add_images() {
    add("images", "png", "grey16", depth_png(3, {0, 5000, 10000, 2500, 65535, 1}));
    add("images", "png", "grey8", depth_png(3, {0, 5000, 10000}, {"\x08\x00", 2}));
    const ColorImage picture = color_picture(9, 5, 100);
    add("images", "jpeg", "halved", jpeg_bytes(picture, TJSAMP_420));
    add("images", "jpeg", "grey", jpeg_bytes(picture, TJSAMP_GRAY));
    add("images", "jpeg", "progressive", jpeg_bytes(picture, TJSAMP_444, TJFLAG_PROGRESSIVE));
    const std::string pixels = std::string(27, 'a') + "\x12\x02\x04";
    add("images", "messages", "rgb8", "rgb8\n" + pixels);
    add("images", "messages", "bayer", "bayer_grbg8\n" + pixels);
    add("images", "messages", "yuyv", "yuyv\n" + pixels);
    add("images", "cameras", "kalibr",
        "cam0:\n  T_cam_imu:\n  - [0.0, -1.0, 0.0, 0.1]\n  - [0.0, 0.0, -1.0, 0.2]\n"
        "  - [1.0, 0.0, 0.0, 0.3]\n  - [0.0, 0.0, 0.0, 1.0]\n  camera_model: pinhole\n"
        "  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]\n  distortion_model: equidistant\n"
        "  intrinsics: [400.0, 401.0, 320.0, 240.0]\n  resolution: [640, 480]\n"
        "  rostopic: /cam0/image_raw\n");
    add("images", "cameras", "opencv",
        "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n"
        "   rows: 3\n   cols: 3\n   dt: d\n   data: [ 400., 0., 320., 0., 401., 240., 0.,\n"
        "       0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   data: [ 0.1, 0., 0., 0., 0. "
        "]\n");
    add("images", "cameras", "toml",
        "[[camera]]\ntopic = \"/a\"\nwidth = 640\nheight = 480\nmodel = \"fisheye\"\n"
        "focal = [400, 401]\ncenter = [320.5, 240]\ndistortion = [0.1, 0, 0, 0]\n"
        "T_lidar_camera = [0, 0, 0.5, 0, 0, 0, 1]\ntime_offset = 0.01\n");
  }

 private:
  /// Topic by topic, in small chunks; also as a converter writes it, received in that order.
  void add_grouped() {
    for (const bool as_written : {false, true}) {
      const std::string name = as_written ? "grouped_as_written" : "grouped";
      McapWriter mcap(folder_ / "seed", {.compression = Compression::none, .chunk_bytes = 200});
      write_grouped(mcap, Encoding::cdr, as_written);
      add("containers", "mcap", name, content_of(folder_ / "seed"));
      BagWriter bag(folder_ / "seed", {.compression = Compression::none, .chunk_bytes = 200});
      write_grouped(bag, Encoding::ros1, as_written);
      add("containers", "bag", name, content_of(folder_ / "seed"));
    }
  }

  static void write_grouped(MessageWriter& writer, Encoding encoding, bool as_written) {
    std::vector<std::size_t> ids;
    for (Channel channel : sample_channels(encoding)) {
      channel.definition.clear();
      ids.push_back(writer.add_channel(channel));
    }
    std::vector<SampleMessage> messages = sample_messages(encoding, 8);
    std::ranges::stable_sort(messages, {}, &SampleMessage::channel);
    Nanoseconds time = kStart;
    for (const SampleMessage& message : messages) {
      time += std::chrono::milliseconds(1);
      writer.write(ids[message.channel], as_written ? time : message.received, message.bytes);
    }
    writer.close();
  }

  static constexpr const char* kSentence =
      "$GPRMC,220001,A,4139.0000,N,00052.8000,W,000.0,000.0,141123,,,A*67\r\n";

  void add(const char* fuzzer, const char* format, std::string name, std::string bytes) {
    seeds_.push_back({fuzzer, format, std::move(name), std::move(bytes)});
  }

  void add_mcap(const std::string& name, const McapOptions& options, Encoding encoding) {
    McapWriter writer(folder_ / "seed", options);
    add_written("mcap", name, writer, encoding, folder_ / "seed");
  }

  void add_written(const char* format, const std::string& name, MessageWriter& writer,
                   Encoding encoding, const std::filesystem::path& file) {
    write_sample(writer, encoding, 1, false);
    writer.close();
    add("containers", format, name, content_of(file));
  }

  TemporaryFolder folder_;
  std::vector<FuzzSeed> seeds_;
};

}  // namespace

std::vector<FuzzSeed> fuzz_corpus() {
  Corpus corpus;
  corpus.add_containers();
  corpus.add_captures();
  corpus.add_packets();
  corpus.add_other_packets();
  corpus.add_messages();
  corpus.add_clouds();
  corpus.add_folders();
  corpus.add_images();
  return std::move(corpus).take();
}

}  // namespace adit::test
