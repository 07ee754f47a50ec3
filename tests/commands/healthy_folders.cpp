// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Folders of every layout that is read.
#include <utility>

#include "adit/tests/commands/healthy_recordings.hpp"
#include "adit/tests/commands/small_room.hpp"
#include "adit/tests/support/depth_images.hpp"
#include "adit/tests/support/point_files.hpp"

namespace adit::test {
namespace {

namespace fs = std::filesystem;

std::string bin_of(const std::vector<Point>& points) {
  return text_of(std::as_bytes(std::span(points)));
}

std::string pcd_of(const std::vector<Point>& points) {
  const std::string count = std::to_string(points.size());
  return "VERSION .7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH " +
         count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n" +
         bin_of(points);
}

// UTM, m.
constexpr std::array<double, 3> kFarAway = {430000.0, 5400000.0, 300.0};

/// In UTM, in double precision.
template <class Body>
std::string far_away(const std::vector<Point>& points, const Body& begin) {
  std::string bytes = begin(std::to_string(points.size()));
  for (const Point& p : points) {
    bytes += bytes_of_all(kFarAway[0] + p.x, kFarAway[1] + p.y, kFarAway[2] + p.z);
  }
  return bytes;
}

/// A dialect: small letters, no COUNT, no WIDTH and HEIGHT.
std::string far_pcd_of(const std::vector<Point>& points) {
  return far_away(points, [](const std::string& count) {
    return "version 0.7\nfields x y z\nsize 8 8 8\ntype f f f\npoints " + count + "\ndata binary\n";
  });
}

std::string far_ply_of(const std::vector<Point>& points) {
  return far_away(points, [](const std::string& count) {
    return "ply\nformat binary_little_endian 1.0\nelement vertex " + count +
           "\nproperty float64 x\nproperty float64 y\nproperty float64 z\nend_header\n";
  });
}

/// x y z intensity ring.
std::string five_of(const std::vector<Point>& points) {
  std::string bytes;
  for (std::size_t i = 0; i < points.size(); ++i) {
    bytes += bytes_of(points[i]) + bytes_of(static_cast<float>(i % 16));
  }
  return bytes;
}

std::string ply_of(const std::vector<Point>& points) {
  return "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty float "
         "intensity\nend_header\n" +
         bin_of(points);
}

std::string las_of(const std::vector<Point>& points, const std::array<double, 3>& offset) {
  constexpr std::size_t kPointBytes = 28;
  std::string bytes = las_file(1, 2, kPointBytes, 20);
  const std::size_t header = bytes.size() - 2 * kPointBytes;
  bytes.resize(header + kPointBytes * points.size());
  put_at(bytes, 107, static_cast<uint32_t>(points.size()));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put_at(bytes, 155 + 8 * axis, offset[axis]);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t begin = header + kPointBytes * i;
    put_at(bytes, begin, static_cast<int32_t>(1000.0F * points[i].x));
    put_at(bytes, begin + 4, static_cast<int32_t>(1000.0F * points[i].y));
    put_at(bytes, begin + 8, static_cast<int32_t>(1000.0F * points[i].z));
    put_at(bytes, begin + 20, 1e-4 * static_cast<double>(i));
  }
  return bytes;
}

void write_kitti_raw(const fs::path& folder) {
  std::string sweep_times;
  std::string times;
  for (int i = 0; i < kSweeps; ++i) {
    const std::string name = "000000000" + std::to_string(i);
    write(folder / ("velodyne_points/data/" + name + ".bin"), bin_of(room_points()));
    sweep_times += as_date(0.1 * i) + "\n";
    times += as_date(0.1 * i + 0.01) + "\n";
    write(folder / ("oxts/data/" + name + ".txt"),
          "49.0 8.4 110.0 0.1 0.2 -2.6 0 0 0 0 0 0.5 -0.25 9.75 0 0 9.8 0.01 0.02 0.03 0.1 0.2 0.3 "
          "0.5 0.02 4 10 6 4 0\n");
  }
  write(folder / "velodyne_points/timestamps.txt", sweep_times);
  write(folder / "oxts/timestamps.txt", times);
  write(folder / "calib_imu_to_velo.txt",
        "calib_time: 25-May-2012 16:47:16\nR: 1 0 0 0 1 0 0 0 1\nT: -0.8 0.3 -0.7\n");
}

void write_euroc(const fs::path& folder) {
  std::string readings = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y,w_RS_S_z,a_x,a_y,a_z\n";
  std::string poses = "#timestamp,p_RS_R_x [m],p_y,p_z,q_w,q_x,q_y,q_z\n";
  for (int i = 0; i < 100 * kSweeps / 10; ++i) {
    const std::string stamp = std::to_string(at(0.01 * i).count());
    readings += stamp + ",-0.01,0.02,0.01,0.1,0.0,9.8\n";
    poses += stamp + "," + std::to_string(0.01 * i) + ",0.0,0.0,1.0,0.0,0.0,0.0\n";
  }
  write(folder / "mav0/imu0/data.csv", readings);
  // Another order, another separator, a mark at the start.
  std::string other = "\xef\xbb\xbftimestamp;a_x [g];a_y [g];a_z [g];w_x;w_y;w_z\r\n";
  for (int i = 0; i < 10 * kSweeps; ++i) {
    other += std::to_string(at(0.01 * i).count()) + ";0.01;0.0;1.0;-0.01;0.02;0.01\r\n";
  }
  write(folder / "mav0/imu1/data.csv", other);
  write(folder / "mav0/state_groundtruth_estimate0/data.csv", poses);
}

void write_tum(const fs::path& folder) {
  std::vector<uint16_t> depths;
  for (int row = 0; row < 36; ++row) {
    for (int column = 0; column < 48; ++column) {
      const double rise = row < 20 ? 3.0 : 3.0 - 0.06 * (row - 20);
      depths.push_back(static_cast<uint16_t>(5000.0 * rise + 10.0 * (column % 7)));
    }
  }
  std::string list = "# timestamp filename\n";
  std::string poses = "# timestamp tx ty tz qx qy qz qw\n";
  std::string accelerations = "# timestamp ax ay az\n";
  for (int i = 0; i < kSweeps; ++i) {
    const std::string name = "depth/" + std::to_string(i) + ".png";
    write(folder / name, depth_png(48, depths));
    list += in_seconds(0.1 * i) + " " + name + "\n";
    poses += in_seconds(0.1 * i) + " " + std::to_string(0.01 * i) + " 0 0 0 0 0 1\n";
    accelerations += in_seconds(0.1 * i) + " -0.5 8.25 -2.5\n";
  }
  write(folder / "depth.txt", list);
  write(folder / "groundtruth.txt", poses);
  write(folder / "accelerometer.txt", accelerations);
  write(folder / "calibration.txt", "40 40 24 18\n");
}

/// A folder of eight such files, with the time of each.
HealthyRecording write_series(const fs::path& folder, const std::string& suffix,
                              const std::string& file) {
  std::string times;
  for (int i = 0; i < kSweeps; ++i) {
    write(folder / ("00000" + std::to_string(i) + "." + suffix), file);
    times += std::to_string(0.1 * i) + "\n";
  }
  write(folder / "times.txt", times);
  return {.folder = folder, .opened = {}, .metadata = {}};
}

}  // namespace

std::vector<HealthyFormat> write_healthy_folders(const fs::path& folder) {
  std::vector<HealthyFormat> formats;
  const std::vector<Point> points = room_points();
  for (const auto& [suffix, file] :
       {std::pair{"bin", bin_of(points)}, std::pair{"pcd", pcd_of(points)},
        std::pair{"ply", ply_of(points)}, std::pair{"las", las_of(points, {1.0, 1.0, 1.0})}}) {
    formats.push_back(
        {suffix, {write_series(folder / (std::string(suffix) + "_series"), suffix, file)}});
  }
  const std::array others = {five_of(points), far_pcd_of(points), far_ply_of(points),
                             las_of(points, kFarAway)};
  for (std::size_t i = 0; i < others.size(); ++i) {
    const std::string suffix = formats[i].name;
    formats[i].recordings.push_back(
        write_series(folder / (suffix + "_other_series"), suffix, others[i]));
  }
  write_kitti_raw(folder / "kitti_raw");
  write_euroc(folder / "euroc");
  write_tum(folder / "tum");
  for (const char* name : {"kitti_raw", "euroc", "tum"}) {
    formats.push_back({name, {{.folder = folder / name, .opened = {}, .metadata = {}}}});
  }
  return formats;
}

}  // namespace adit::test
