// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/odometry.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <fmt/core.h>
#include <pybind11/stl.h>

#include "adit/slam/odometry/odometry.hpp"
#include "adit/tools/python/arrays.hpp"
#include "adit/tools/python/configuration.hpp"
#include "adit/tools/python/device.hpp"
#include "adit/tools/python/gil.hpp"
#include "adit/tools/python/measurements.hpp"

namespace adit::python {
namespace {

constexpr Nanoseconds kAssumedPeriod = std::chrono::milliseconds(100);

/// An Odometry on a device of its own or a shared one. One thread at a time is in it.
class DeviceOdometry {
 public:
  DeviceOdometry(SharedDevice device, const Config& config)
      : device_(std::move(device)), odometry_(device_->context(), config) {}

  SweepResult step(const Sweep& sweep) {
    const std::lock_guard lock(mutex_);
    if (last_ && sweep.stamp <= last_->stamp) {
      throw py::value_error(fmt::format("stamp: {} ns is not after {} ns, that of the sweep before",
                                        sweep.stamp.count(), last_->stamp.count()));
    }
    SweepResult result = odometry_.step(sweep);
    last_ = StampedPose{.stamp = sweep.stamp, .pose = result.T_map_lidar};
    return result;
  }

  Nanoseconds next_stamp() {
    const std::lock_guard lock(mutex_);
    return last_ ? last_->stamp + kAssumedPeriod : Nanoseconds(0);
  }

  void add(const ImuSample& sample) {
    const std::lock_guard lock(mutex_);
    static_cast<void>(odometry_.add(sample));
  }

  void mount(const Eigen::Isometry3d& T_imu_lidar) {
    const std::lock_guard lock(mutex_);
    if (last_) {
      throw py::value_error("T_imu_lidar: it is set before the first sweep");
    }
    odometry_.mount(T_imu_lidar);
  }

  Config config() {
    const std::lock_guard lock(mutex_);
    return odometry_.config();
  }

  std::vector<Point> cloud() {
    const std::lock_guard lock(mutex_);
    if (!last_) {
      return {};
    }
    return odometry_.cloud();
  }

  std::optional<Eigen::Isometry3d> pose() {
    const std::lock_guard lock(mutex_);
    return last_ ? std::optional(last_->pose) : std::nullopt;
  }

 private:
  std::mutex mutex_;
  SharedDevice device_;
  Odometry odometry_;
  std::optional<StampedPose> last_;
};

bool is_return(const Point& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) &&
         (p.x != 0.0F || p.y != 0.0F || p.z != 0.0F);
}

SweepResult register_frame(DeviceOdometry& self, const py::object& points,
                           const py::object& timestamps, const std::optional<int64_t>& stamp) {
  Sweep sweep;
  sweep.points = points_of(points, "points");
  sweep.source = "from Python";
  if (std::ranges::none_of(sweep.points, is_return)) {
    throw py::value_error(fmt::format(
        "points: none of {} is a return: all are NaN, infinite or 0 0 0", sweep.points.size()));
  }
  if (!timestamps.is_none()) {
    sweep.times = floats_of(timestamps, "timestamps");
    if (sweep.times.size() != sweep.points.size()) {
      throw py::value_error(
          fmt::format("timestamps: {} for {} points", sweep.times.size(), sweep.points.size()));
    }
    if (!std::ranges::all_of(sweep.times, [](float time) { return std::isfinite(time); })) {
      throw py::value_error("timestamps: not finite");
    }
  }
  const py::gil_scoped_release released;
  sweep.stamp = stamp ? Nanoseconds(*stamp) : self.next_stamp();
  return self.step(sweep);
}

}  // namespace

void bind_odometry(py::module_& module) {
  using Self = DeviceOdometry;
  py::class_<Self, std::shared_ptr<Self>>(
      module, "Odometry",
      "Odometry from a range sensor and, where its samples are added, an IMU: one call a sweep.\n"
      "The map's origin is the lidar of the first sweep; with an IMU its z is up, without one its\n"
      "axes are that lidar's. Whoever has measurements in any order of arrival takes a Slam.")
      .def(py::init([](const py::object& config, const py::object& device) {
             const Config wanted = config_of(config);
             SharedDevice on = device_of(device);
             const py::gil_scoped_release released;
             return std::make_shared<Self>(std::move(on), wanted);
           }),
           py::arg("config") = py::none(), py::kw_only(), py::arg("device") = py::none(),
           "config: as Config() takes it. device: None, a name or a Device. DeviceError: there is\n"
           "no device, or its memory is exhausted.")
      .def(
          "register_frame",
          [](Self& self, const Measured<Sweep>& sweep) {
            const py::gil_scoped_release released;
            return self.step(sweep.value);
          },
          py::arg("sweep"), "Places a Sweep, with its own stamp and times.")
      .def(
          "register_frame", &register_frame, py::arg("points"), py::arg("timestamps") = py::none(),
          py::kw_only(), py::arg("stamp") = py::none(),
          "The same by its parts. points: (n, 3) or (n, 4) numbers, lidar axes, m, and\n"
          "intensity; NaN, infinite or 0 0 0 is no return. timestamps: (n,), s after the sweep's\n"
          "start; None: all of one moment. stamp: of the start, ns, rising; None: 0.1 s after the\n"
          "one before. IMU samples up to the sweep's end are added before.\n\n"
          "TypeError: no numbers. ValueError: another shape, no return at all, times that\n"
          "are not finite, a stamp that does not rise. DeviceError: the device failed.")
      .def(
          "add_imu",
          [](Self& self, const Measured<ImuSample>& sample) {
            const py::gil_scoped_release released;
            self.add(sample.value);
          },
          py::arg("sample"), "Adds the next reading of the IMU.")
      .def(
          "add_imu",
          [](Self& self, int64_t stamp, const py::object& angular_velocity,
             const py::object& linear_acceleration) {
            const ImuSample sample{
                .stamp = Nanoseconds(stamp),
                .angular_velocity = vector_of(angular_velocity, "angular_velocity", false),
                .linear_acceleration =
                    vector_of(linear_acceleration, "linear_acceleration", false)};
            const py::gil_scoped_release released;
            self.add(sample);
          },
          py::arg("stamp"), py::arg("angular_velocity"), py::arg("linear_acceleration"),
          "The same by its parts: ns, (3,) rad/s, (3,) m/s^2; what is not measured is NaN.")
      .def(
          "mount",
          [](Self& self, const py::object& T_imu_lidar) {
            const Eigen::Isometry3d pose = pose_of_array(T_imu_lidar, "T_imu_lidar");
            without_gil([&] { self.mount(pose); });
          },
          py::arg("T_imu_lidar"),
          "(4, 4): pose of the lidar in the IMU's axes, in place of imu.T_imu_lidar; before the\n"
          "first sweep, ValueError after it.")
      .def_property_readonly(
          "pose",
          [](Self& self) -> py::object {
            const auto pose = without_gil([&] { return self.pose(); });
            return pose ? array_of(*pose) : py::none().cast<py::object>();
          },
          "(4, 4), T_map_lidar of the last sweep; None before the first.")
      .def_property_readonly(
          "config", [](Self& self) { return without_gil([&] { return self.config(); }); },
          "The configuration in use; lengths that were left at 0 are as the first sweep shows "
          "them.")
      .def(
          "cloud", [](Self& self) { return array_of(without_gil([&] { return self.cloud(); })); },
          "(n, 4) float32: the last sweep, down-sampled, lidar axes, m.")
      .def("__repr__", [](Self& self) {
        const auto pose = without_gil([&] { return self.pose(); });
        if (!pose) {
          return std::string("<adit.Odometry before its first sweep>");
        }
        const Eigen::Vector3d p = pose->translation();
        return fmt::format("<adit.Odometry at ({:.3f}, {:.3f}, {:.3f}) m>", p.x(), p.y(), p.z());
      });
}

}  // namespace adit::python
