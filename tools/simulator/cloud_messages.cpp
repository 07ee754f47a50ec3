// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/cloud_messages.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "adit/tools/recordings/ros_visit.hpp"

namespace adit {
namespace {

using Eigen::Vector3f;

constexpr uint8_t kUint16 = 4;
constexpr uint8_t kUint32 = 6;
constexpr uint8_t kFloat32 = 7;
constexpr uint8_t kFloat64 = 8;

Vector3f point_of(const Firing& firing, const Return& back) {
  return (firing.origin + back.range * firing.direction).cast<float>();
}

/// A cloud that is filled point by point. Radial speeds come behind the driver's own fields.
class Cloud {
 public:
  Cloud(std::vector<ros::PointField> fields, uint32_t point_step, bool doppler) {
    message_.fields = std::move(fields);
    message_.point_step = point_step;
    if (doppler) {
      doppler_at_ = point_step;
      message_.fields.push_back({"doppler", point_step, kFloat32});
      message_.point_step += sizeof(float);
    }
  }

  void resize(std::size_t points) { data_.resize(points * message_.point_step); }

  template <class T>
  void put(std::size_t point, uint32_t offset, const T& value) {
    std::memcpy(data_.data() + point * message_.point_step + offset, &value, sizeof(T));
  }

  /// NaN where nothing came back.
  void put_doppler(std::size_t point, const Return& back) {
    if (doppler_at_) {
      put(point, *doppler_at_,
          back.range != 0.0 ? back.doppler : std::numeric_limits<float>::quiet_NaN());
    }
  }

  ros::EncodedEvent encode(Nanoseconds stamp, const std::string& frame, uint32_t height,
                           bool is_dense) {
    const auto points = static_cast<uint32_t>(data_.size() / message_.point_step);
    message_.header = {.sequence = 0, .stamp = stamp, .frame = frame};
    message_.height = height;
    message_.width = points / height;
    message_.row_step = message_.width * message_.point_step;
    message_.data = data_;
    message_.is_dense = is_dense;
    return {std::string(message_.kType), ros::encode(Encoding::cdr, message_)};
  }

 private:
  ros::PointCloud2 message_;
  std::vector<std::byte> data_;
  std::optional<uint32_t> doppler_at_;
};

std::vector<std::size_t> returned(const RangeSweep& sweep) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < sweep.returns.size(); ++i) {
    if (sweep.returns[i].range != 0.0) {  // a fault may have made it NaN
      indices.push_back(i);
    }
  }
  return indices;
}

void put_position(Cloud& cloud, std::size_t point, const Vector3f& p) {
  cloud.put(point, 0, p.x());
  cloud.put(point, 4, p.y());
  cloud.put(point, 8, p.z());
}

ros::EncodedEvent velodyne(const RangeSweep& sweep, Nanoseconds stamp, const std::string& frame) {
  Cloud cloud({{"x", 0, kFloat32},
               {"y", 4, kFloat32},
               {"z", 8, kFloat32},
               {"intensity", 12, kFloat32},
               {"ring", 16, kUint16},
               {"time", 18, kFloat32}},
              22, sweep.doppler);
  const std::vector<std::size_t> indices = returned(sweep);
  cloud.resize(indices.size());
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const Firing& firing = sweep.firings[indices[k]];
    const Return& back = sweep.returns[indices[k]];
    put_position(cloud, k, point_of(firing, back));
    cloud.put(k, 12, back.intensity);
    cloud.put(k, 16, firing.ring);
    cloud.put(k, 18, static_cast<float>(1e-9 * static_cast<double>(firing.time)));
    cloud.put_doppler(k, back);
  }
  return cloud.encode(stamp, frame, 1, true);
}

ros::EncodedEvent hesai(const RangeSweep& sweep, Nanoseconds stamp, const std::string& frame) {
  Cloud cloud({{"x", 0, kFloat32},
               {"y", 4, kFloat32},
               {"z", 8, kFloat32},
               {"intensity", 12, kFloat32},
               {"ring", 16, kUint16},
               {"timestamp", 18, kFloat64}},
              26, sweep.doppler);
  const std::vector<std::size_t> indices = returned(sweep);
  cloud.resize(indices.size());
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const Firing& firing = sweep.firings[indices[k]];
    const Return& back = sweep.returns[indices[k]];
    put_position(cloud, k, point_of(firing, back));
    cloud.put(k, 12, back.intensity);
    cloud.put(k, 16, firing.ring);
    cloud.put(k, 18, 1e-9 * static_cast<double>(stamp.count() + firing.time));
    cloud.put_doppler(k, back);
  }
  return cloud.encode(stamp, frame, 1, true);
}

/// Rows are beams, columns firings of all beams at once.
ros::EncodedEvent ouster(const RangeSweep& sweep, Nanoseconds stamp, const std::string& frame) {
  Cloud cloud({{"x", 0, kFloat32},
               {"y", 4, kFloat32},
               {"z", 8, kFloat32},
               {"intensity", 16, kFloat32},
               {"t", 20, kUint32},
               {"reflectivity", 24, kUint16},
               {"ring", 26, kUint16},
               {"ambient", 28, kUint16},
               {"range", 32, kUint32}},
              48, sweep.doppler);
  std::set<uint16_t> rings;
  for (const Firing& firing : sweep.firings) {
    rings.insert(firing.ring);
  }
  const std::size_t height = std::max<std::size_t>(1, rings.size());
  const std::size_t width = sweep.firings.size() / height;
  cloud.resize(width * height);
  for (std::size_t i = 0; i < width * height; ++i) {
    const Firing& firing = sweep.firings[i];
    const Return& back = sweep.returns[i];
    const std::size_t at = i % height * width + i / height;
    if (back.range != 0.0) {
      put_position(cloud, at, point_of(firing, back));
    }
    cloud.put(at, 16, back.intensity);
    cloud.put(at, 20, static_cast<uint32_t>(firing.time));
    cloud.put(at, 24, static_cast<uint16_t>(back.intensity));
    cloud.put(at, 26, firing.ring);
    cloud.put(at, 32, static_cast<uint32_t>(back.range > 0.0 ? 1e3 * back.range + 0.5 : 0.0));
    cloud.put_doppler(at, back);
  }
  return cloud.encode(stamp, frame, static_cast<uint32_t>(height), false);
}

/// A picture of points; its rows are the rings.
ros::EncodedEvent camera(const RangeSweep& sweep, Nanoseconds stamp, const std::string& frame) {
  Cloud cloud(
      {{"x", 0, kFloat32}, {"y", 4, kFloat32}, {"z", 8, kFloat32}, {"intensity", 12, kFloat32}}, 16,
      sweep.doppler);
  cloud.resize(sweep.firings.size());
  for (std::size_t i = 0; i < sweep.firings.size(); ++i) {
    const Return& back = sweep.returns[i];
    constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
    put_position(
        cloud, i,
        back.range != 0.0 ? point_of(sweep.firings[i], back) : Vector3f::Constant(kNothing));
    cloud.put(i, 12, back.intensity);
    cloud.put_doppler(i, back);
  }
  return cloud.encode(stamp, frame, sweep.firings.back().ring + 1U, false);
}

ros::EncodedEvent livox(const RangeSweep& sweep, Nanoseconds stamp, const std::string& frame) {
  ros::LivoxCustomMsg message;
  message.header = {.sequence = 0, .stamp = stamp, .frame = frame};
  message.timebase = static_cast<uint64_t>(stamp.count());
  for (const std::size_t i : returned(sweep)) {
    const Firing& firing = sweep.firings[i];
    const Vector3f p = point_of(firing, sweep.returns[i]);
    message.points.push_back({.offset_time = static_cast<uint32_t>(firing.time),
                              .x = p.x(),
                              .y = p.y(),
                              .z = p.z(),
                              .reflectivity = static_cast<uint8_t>(sweep.returns[i].intensity),
                              .tag = 0,
                              .line = static_cast<uint8_t>(firing.ring)});
  }
  message.point_num = static_cast<uint32_t>(message.points.size());
  return {std::string(message.kType), ros::encode(Encoding::cdr, message)};
}

}  // namespace

std::string_view message_type(CloudLayout layout) {
  return layout == CloudLayout::livox ? ros::LivoxCustomMsg::kType : ros::PointCloud2::kType;
}

ros::EncodedEvent cloud_message(const RangeSweep& sweep, CloudLayout layout, Nanoseconds epoch,
                                const std::string& frame) {
  const Nanoseconds stamp = epoch + Nanoseconds(sweep.start);
  switch (layout) {
    case CloudLayout::ouster:
      return ouster(sweep, stamp, frame);
    case CloudLayout::hesai:
      return hesai(sweep, stamp, frame);
    case CloudLayout::livox:
      return livox(sweep, stamp, frame);
    case CloudLayout::camera:
      return camera(sweep, stamp, frame);
    case CloudLayout::velodyne:
      break;
  }
  return velodyne(sweep, stamp, frame);
}

}  // namespace adit
