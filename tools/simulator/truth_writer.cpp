// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/truth_writer.hpp"

#include <cstring>
#include <string>
#include <vector>

#include <fmt/core.h>

namespace adit {
namespace {

std::string stamp_text(Nanoseconds stamp) {
  return fmt::format("{}.{:09}", stamp.count() / 1000000000, stamp.count() % 1000000000);
}

void append(std::string& line, double value) {
  line += ',';
  append_number(line, value);
}

void append(std::string& line, const Eigen::Vector3d& v) {
  for (const double value : {v.x(), v.y(), v.z()}) {
    append(line, value);
  }
}

template <class T>
void append_bytes(std::vector<char>& bytes, const T& value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof(T));
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

/// The meshes of a scene in one frame.
Mesh whole(const Scene& scene) {
  Mesh mesh = scene.mesh;
  for (const MovingObject& object : scene.moving) {
    const auto base = static_cast<uint32_t>(mesh.vertices.size());
    const Eigen::Isometry3d T_world_object = object.T_world_object(0.0);
    for (const Eigen::Vector3f& vertex : object.mesh.vertices) {
      mesh.vertices.emplace_back((T_world_object * vertex.cast<double>()).cast<float>());
    }
    for (Triangle triangle : object.mesh.triangles) {
      for (uint32_t& corner : triangle.corners) {
        corner += base;
      }
      mesh.triangles.push_back(triangle);
    }
  }
  return mesh;
}

}  // namespace

TruthWriter::TruthWriter(const std::filesystem::path& poses, const std::filesystem::path& states,
                         const Eigen::Isometry3d& T_imu_lidar)
    : poses_(poses, TrajectoryFormat::tum), states_(states), T_imu_lidar_(T_imu_lidar) {
  states_.write(
      "t_s,x_m,y_m,z_m,qx,qy,qz,qw,vx_m_s,vy_m_s,vz_m_s,gyro_bias_x_rad_s,gyro_bias_y_rad_s,"
      "gyro_bias_z_rad_s,accel_bias_x_m_s2,accel_bias_y_m_s2,accel_bias_z_m_s2\n");
}

void TruthWriter::write(Nanoseconds epoch, const SimulatedImu& imu) {
  const Nanoseconds stamp = epoch + imu.sample.stamp;
  const Eigen::Isometry3d& T_world_imu = imu.truth.T_world_body;
  poses_.write({.stamp = stamp, .pose = T_world_imu * T_imu_lidar_});
  std::string line = stamp_text(stamp);
  const Eigen::Quaterniond q(T_world_imu.linear());
  append(line, T_world_imu.translation());
  append(line, q.vec());
  append(line, q.w());
  append(line, imu.truth.velocity);
  append(line, imu.gyroscope_bias);
  append(line, imu.accelerometer_bias);
  states_.write(line + "\n");
}

void TruthWriter::close() {
  poses_.close();
  states_.close();
}

AntennaTruthWriter::AntennaTruthWriter(const std::filesystem::path& file) : file_(file) {
  file_.write("t_s,x_m,y_m,z_m,open_sky,outlier\n");
}

void AntennaTruthWriter::write(Nanoseconds epoch, const SimulatedFix& fix) {
  std::string line = stamp_text(epoch + fix.fix.stamp);
  append(line, fix.p_world_antenna);
  append(line, fix.sky);
  file_.write(line + (fix.outlier ? ",1\n" : ",0\n"));
}

WheelTruthWriter::WheelTruthWriter(const std::filesystem::path& file) : file_(file) {
  file_.write("t_s,vx_m_s,vy_m_s,vz_m_s,scale\n");
}

void WheelTruthWriter::write(Nanoseconds epoch, const SimulatedWheels& wheels) {
  std::string line = stamp_text(epoch + wheels.velocity.stamp);
  append(line, wheels.truth);
  append(line, wheels.scale);
  file_.write(line + "\n");
}

ReturnTruthWriter::ReturnTruthWriter(const std::filesystem::path& surfaces,
                                     const std::optional<std::filesystem::path>& labels,
                                     const std::optional<std::filesystem::path>& colors)
    : surfaces_(surfaces) {
  if (labels) {
    labels_.emplace(*labels);
  }
  if (colors) {
    colors_.emplace(*colors);
  }
}

void ReturnTruthWriter::write(const RangeSweep& sweep) {
  std::vector<char> surfaces;
  std::vector<char> labels;
  std::vector<char> colors;
  for (const Return& back : sweep.returns) {
    if (back.range != 0.0) {
      append_bytes(surfaces, back.surface);
      append_bytes(labels, back.object);
      append_bytes(colors, back.color);
    }
  }
  surfaces_.write(surfaces.data(), surfaces.size());
  if (labels_) {
    labels_->write(labels.data(), labels.size());
  }
  if (colors_) {
    colors_->write(colors.data(), colors.size());
  }
}

void ReturnTruthWriter::close() {
  surfaces_.close();
  if (labels_) {
    labels_->close();
  }
  if (colors_) {
    colors_->close();
  }
}

void write_scene_ply(const std::filesystem::path& file, const Scene& scene) {
  const Mesh mesh = whole(scene);
  std::vector<char> bytes;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    append_bytes(bytes, vertex.x());
    append_bytes(bytes, vertex.y());
    append_bytes(bytes, vertex.z());
  }
  for (const Triangle& triangle : mesh.triangles) {
    append_bytes(bytes, uint8_t{3});
    for (const uint32_t corner : triangle.corners) {
      append_bytes(bytes, corner);
    }
    for (const uint8_t part : optics_of(triangle.material).color) {
      append_bytes(bytes, part);
    }
  }
  OutputFile out(file);
  out.write("ply\nformat binary_little_endian 1.0\nelement vertex " +
            std::to_string(mesh.vertices.size()) +
            "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
            std::to_string(mesh.triangles.size()) +
            "\nproperty list uchar uint vertex_indices\nproperty uchar red\nproperty uchar green\n"
            "property uchar blue\nend_header\n");
  out.write(bytes.data(), bytes.size());
  out.close();
}

}  // namespace adit
