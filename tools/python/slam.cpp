// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/slam.hpp"

#include <utility>
#include <variant>
#include <vector>

#include <fmt/core.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "adit/tools/python/arrays.hpp"
#include "adit/tools/python/configuration.hpp"
#include "adit/tools/python/gil.hpp"
#include "adit/tools/python/measurements.hpp"
#include "adit/tools/python/pickling.hpp"
#include "adit/tools/python/slam_session.hpp"

namespace adit::python {
namespace {

using SharedSlam = std::shared_ptr<SlamSession>;

// Without checks for signals: what was taken from the Slam would be lost.
std::vector<SlamResult> due(SlamSession& slam) {
  std::vector<SlamResult> results;
  while (std::optional<SlamResult> result = slam.next()) {
    results.push_back(std::move(*result));
  }
  return results;
}

/// Sweeps, and readings where high-rate odometry is wanted: those without a motion say nothing.
py::list list_of(std::vector<SlamResult> results) {
  py::list list;
  for (SlamResult& result : results) {
    std::visit([&](auto& value) { list.append(py::cast(std::move(value))); }, result);
  }
  return list;
}

template <class Value>
py::list add(SlamSession& self, const Measured<Value>& measured) {
  return list_of(without_gil([&] {
    if constexpr (std::is_same_v<Value, StaticTransform>) {
      self.add(measured.value);
    } else {
      self.add(Measurement(measured.value), measured.frame);
    }
    return due(self);
  }));
}

SharedSlam make(const py::object& config, bool inertial,
                const std::optional<std::filesystem::path>& map,
                const std::optional<double>& high_rate_smoothing, const std::string& name,
                const py::object& device) {
  const Config wanted = config_of(config);
  SharedDevice on = device_of(device);
  return without_gil([&] {
    return std::make_shared<SlamSession>(std::move(on), wanted,
                                         SessionOptions{.inertial = inertial,
                                                        .high_rate_smoothing = high_rate_smoothing,
                                                        .map = map,
                                                        .name = name});
  });
}

SharedSlam make_for(const RecordingFile& recording, const std::optional<std::filesystem::path>& map,
                    const std::optional<double>& high_rate_smoothing, const py::object& device) {
  SharedDevice on = device_of(device);
  return without_gil([&] {
    return std::make_shared<SlamSession>(
        std::move(on), recording.config(),
        SessionOptions{.inertial = recording.opened()->sensors().imu.has_value(),
                       .high_rate_smoothing = high_rate_smoothing,
                       .map = map,
                       .name = recording.path().filename().string(),
                       .recording = recording.path()});
  });
}

void bind_slam_results(py::module_& module) {
  py::class_<SweepPlaced>(module, "SweepPlaced", "A sweep with its place.")
      .def_property_readonly(
          "stamp", [](const SweepPlaced& self) { return self.result.stamp.count(); }, "ns.")
      .def_property_readonly(
          "pose",
          [](const SweepPlaced& self) {
            return array_of(self.mapped ? self.mapped->T_map_lidar : self.result.T_map_lidar);
          },
          "(4, 4), T_map_lidar, m: where the map sees it by now; without a map, the odometry's.")
      .def_property_readonly(
          "keyframe_id",
          [](const SweepPlaced& self) {
            return self.mapped ? std::optional(self.mapped->keyframe) : std::nullopt;
          },
          "The keyframe whose submap it belongs to; None without a map.")
      .def_readonly("result", &SweepPlaced::result, "What the odometry tells of it.")
      .def_property_readonly(
          "state",
          [](const SweepPlaced& self) { return std::string(to_string(self.result.state)); },
          "As result.state.")
      .def_property_readonly(
          "number", [](const SweepPlaced& self) { return self.sweep.number; },
          "Among its recording's sweeps, from 0; None where that is not known.")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            return view_of(self.cast<const SweepPlaced&>().sweep.points, self);
          },
          "(n, 4) float32: the sweep as it came, lidar axes, m, and intensity; a view.")
      .def(pickling<SweepPlaced>())
      .def("__repr__", [](const SweepPlaced& self) {
        const Eigen::Vector3d p = self.result.T_map_lidar.translation();
        return fmt::format("<adit.SweepPlaced {} at ({:.3f}, {:.3f}, {:.3f}) m>",
                           to_string(self.result.state), p.x(), p.y(), p.z());
      });
  py::class_<SweepLeftOut>(
      module, "SweepLeftOut",
      "A sweep that has no place in a trajectory: its stamp is not after that of\n"
      "the sweep before it.")
      .def_property_readonly(
          "stamp", [](const SweepLeftOut& self) { return self.sweep.stamp.count(); }, "ns.")
      .def_property_readonly(
          "last", [](const SweepLeftOut& self) { return self.last.count(); },
          "Stamp of the sweep before it, ns.")
      .def(pickling<SweepLeftOut>());
  py::class_<LidarMotion>(module, "LidarMotion", "The lidar at the time of an IMU sample.")
      .def_property_readonly(
          "stamp", [](const LidarMotion& self) { return self.stamp.count(); }, "ns.")
      .def_property_readonly(
          "pose", [](const LidarMotion& self) { return array_of(self.T_map_lidar); },
          "(4, 4), T_map_lidar, m.")
      .def_property_readonly(
          "velocity", [](const LidarMotion& self) { return array_of(self.v_map_lidar); },
          "(3,), m/s, map axes.")
      .def_property_readonly(
          "angular_velocity",
          [](const LidarMotion& self) { return array_of(self.angular_velocity); },
          "(3,), rad/s, lidar axes.")
      .def_property_readonly(
          "covariance", [](const LidarMotion& self) { return array_of(self.covariance); },
          "(9, 9), of translation, rotation (lidar axes) and velocity (map axes).")
      .def(pickling<LidarMotion>());
  py::class_<ReadingTaken>(module, "ReadingTaken", "What became of an IMU sample is known.")
      .def_property_readonly(
          "arrival", [](const ReadingTaken& self) { return std::string(to_string(self.arrival)); },
          "appended, inserted, or why it was dropped.")
      .def_readonly("motion", &ReadingTaken::motion,
                    "A LidarMotion; None where high-rate odometry is not wanted or not known.")
      .def(pickling<ReadingTaken>());
}

void bind_reports(py::module_& module) {
  py::class_<DoubtfulStretch>(module, "DoubtfulStretch", "Sweeps in a row that are not reliable.")
      .def_property_readonly(
          "cause", [](const DoubtfulStretch& self) { return std::string(to_string(self.cause)); },
          "unheld, predicted, contradicted, new start or silence.")
      .def_property_readonly(
          "trust", [](const DoubtfulStretch& self) { return std::string(to_string(self.trust)); },
          "doubtful or lost.")
      .def_property_readonly(
          "begin", [](const DoubtfulStretch& self) { return self.begin.count(); },
          "Stamp of its first sweep, ns.")
      .def_property_readonly(
          "end", [](const DoubtfulStretch& self) { return self.end.count(); },
          "Stamp of its last sweep, ns.")
      .def_readonly("distance", &DoubtfulStretch::distance, "Travelled in it, m.")
      .def(pickling<DoubtfulStretch>());
  py::class_<Verdict>(module, "Verdict",
                      "What a trajectory is worth: as much as its worst stretch.")
      .def_property_readonly(
          "trust", [](const Verdict& self) { return std::string(to_string(self.trust)); },
          "reliable, doubtful or lost.")
      .def_readonly("stretches", &Verdict::stretches, "What is not reliable, and why.")
      .def(pickling<Verdict>());
  py::class_<MapReport>(module, "MapReport", "What has become of a map.")
      .def_readonly("keyframes", &MapReport::keyframes)
      .def_readonly("sweeps", &MapReport::sweeps)
      .def_readonly("edges", &MapReport::edges, "Of the pose graph.")
      .def_readonly("components", &MapReport::components, "Parts that nothing ties together.")
      .def_readonly("points", &MapReport::points, "Of all submaps.")
      .def_property_readonly(
          "loops",
          [](const MapReport& self) {
            return self.loops ? std::optional(self.loops->accepted) : std::nullopt;
          },
          "Loops that were accepted; None: mapping.loops is off.")
      .def_property_readonly(
          "fixes", [](const MapReport& self) { return self.gnss.fixes; },
          "GNSS fixes that fall among its sweeps.")
      .def_property_readonly(
          "georeferenced", [](const MapReport& self) { return self.gnss.georeference.has_value(); },
          "True where its place on the Earth is known.")
      .def(pickling<MapReport>());
}

}  // namespace

void bind_slam(py::module_& module) {
  bind_slam_results(module);
  bind_reports(module);
  py::class_<PlacedSweeps>(module, "PlacedSweeps", "The placed sweeps of a recording, an iterator.")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", [](PlacedSweeps& self) {
        std::optional<SweepPlaced> placed = without_gil([&] { return self.next(); });
        if (!placed) {
          throw py::stop_iteration();
        }
        return std::move(*placed);
      });
  py::class_<SlamSession, SharedSlam>(
      module, "Slam",
      "The whole system: measurements in, in any order of arrival, placed sweeps out. With an IMU "
      "a\n"
      "measurement is held until one has come whose stamp is 0.5 s later. The same measurements\n"
      "give the same bytes.")
      .def(py::init(&make), py::arg("config") = py::none(), py::kw_only(),
           py::arg("inertial") = true, py::arg("map") = py::none(),
           py::arg("high_rate_smoothing") = py::none(), py::arg("name") = "Python",
           py::arg("device") = py::none(),
           "config: as Config() takes it. inertial: there is an IMU; without one sweeps do not "
           "wait.\n"
           "map: a new file for the map; None: odometry alone. high_rate_smoothing: poses at the\n"
           "rate of the IMU, corrections spread over so many s. name: of the map's session. "
           "device:\n"
           "None, a name or a Device. UsageError, InputError, OutputError, DeviceError.")
      .def_static(
          "for_recording", &make_for, py::arg("recording"), py::kw_only(),
          py::arg("map") = py::none(), py::arg("high_rate_smoothing") = py::none(),
          py::arg("device") = py::none(),
          "The same with the configuration of a recording, and with an IMU where it has one.")
      .def("add", &add<Sweep>, py::arg("measurement"))
      .def("add", &add<ImuSample>, py::arg("measurement"))
      .def("add", &add<GnssFix>, py::arg("measurement"))
      .def("add", &add<BodyVelocity>, py::arg("measurement"))
      .def("add", &add<Heading>, py::arg("measurement"))
      .def("add", &add<StaticTransform>, py::arg("measurement"),
           "Adds a measurement, or how two frames are mounted, and returns what has become known:\n"
           "SweepPlaced, SweepLeftOut and ReadingTaken, in the order of their stamps. Fixes count\n"
           "where there is a map, velocities where there is an IMU. DeviceError, OutputError (the "
           "map's disk is full).")
      .def(
          "flush",
          [](SlamSession& self) {
            return list_of(without_gil([&] {
              self.flush();
              return due(self);
            }));
          },
          "Nothing more comes for now: what is held is placed and returned. add() may follow.")
      .def(
          "process",
          [](const SharedSlam& self, RecordingFile& recording) {
            return without_gil([&] { return std::make_unique<PlacedSweeps>(self, recording); });
          },
          py::arg("recording"),
          "Iterates over the placed sweeps of a recording, which are those of `adit run`. Reads,\n"
          "adds and flushes; nothing is copied into Python but what is asked for.")
      .def_property_readonly(
          "mounting",
          [](SlamSession& self) -> py::object {
            const auto mounting = without_gil([&] { return self.mounting(); });
            return mounting ? array_of(mounting->T_imu_lidar) : py::none().cast<py::object>();
          },
          "(4, 4), T_imu_lidar, m: as it is used. None before the first sweep or without an IMU.")
      .def_property_readonly(
          "mounting_source",
          [](SlamSession& self) -> std::optional<std::string> {
            const auto mounting = without_gil([&] { return self.mounting(); });
            if (!mounting) {
              return std::nullopt;
            }
            return mounting->source == MountingSource::configured   ? "configured"
                   : mounting->source == MountingSource::transforms ? "transforms"
                                                                    : "assumed";
          },
          "configured, transforms or assumed; None where mounting is.")
      .def_property_readonly(
          "config", [](SlamSession& self) { return without_gil([&] { return self.config(); }); },
          "The configuration in use; lengths that were left at 0 are as the first sweep shows "
          "them.")
      .def_property_readonly(
          "verdict", [](SlamSession& self) { return without_gil([&] { return self.verdict(); }); },
          "What the trajectory is worth so far.")
      .def(
          "finish_map",
          [](SlamSession& self) { return without_gil([&] { return self.finish_map(); }); },
          "Ends the map: its last keyframe and its final poses are stored, and its file is "
          "closed.\n"
          "Nothing can be added after that. Returns a MapReport; None where no map is made.");
}

}  // namespace adit::python
