// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/results.hpp"

#include <optional>
#include <string>

#include <fmt/core.h>
#include <pybind11/stl.h>

#include "adit/slam/odometry/odometry.hpp"
#include "adit/tools/python/arrays.hpp"
#include "adit/tools/python/pickling.hpp"
#include "adit/tools/report/run_statistics.hpp"

namespace adit::python {
namespace {

/// The directions that matches hold least, weakest first.
py::list directions(const std::array<ObservedDirection, 3>& observed) {
  py::list list;
  for (const ObservedDirection& one : observed) {
    if (one.axis.norm() > 0.5) {
      list.append(one);
    }
  }
  return list;
}

void bind_registration(py::module_& module) {
  py::class_<ObservedDirection>(module, "ObservedDirection",
                                "How well matches hold a direction, or an axis of rotation.")
      .def_property_readonly(
          "axis", [](const ObservedDirection& self) { return array_of(self.axis); },
          "(3,), unit, in the axes of the cloud that was aligned.")
      .def_property_readonly(
          "localizability",
          [](const ObservedDirection& self) { return std::string(to_string(self.localizability)); },
          "full, partial or none.")
      .def_readonly("information", &ObservedDirection::information,
                    "1/m^2 or 1/rad^2, the other directions free.")
      .def(pickling<ObservedDirection>());
  using Result = RegistrationResult;
  py::class_<Result>(module, "RegistrationResult", "How an alignment ended, at its final pose.")
      .def_property_readonly(
          "status", [](const Result& self) { return std::string(to_string(self.status)); },
          "converged, degenerate, not_converged, too_little_overlap, too_few_points, diverged or\n"
          "doubtful.")
      .def_readonly("overlap", &Result::overlap, "Share of the points that found a match.")
      .def_readonly("residual_rms", &Result::residual_rms,
                    "Root mean square distance of matches along surface normals, m.")
      .def_readonly("inliers", &Result::inliers, "Points with a match.")
      .def_readonly("source_points", &Result::source_points, "Points that were to be matched.")
      .def_readonly("iterations", &Result::iterations, "Gauss-Newton iterations.")
      .def_property_readonly(
          "information", [](const Result& self) { return array_of(self.information); },
          "(6, 6): what the matches say of the pose, [translation, rotation], right perturbation;\n"
          "1/m^2, 1/(m rad), 1/rad^2.")
      .def_property_readonly(
          "translation", [](const Result& self) { return directions(self.translation); },
          "Directions of translation, weakest first; empty where none was assessed.")
      .def_property_readonly(
          "rotation", [](const Result& self) { return directions(self.rotation); },
          "Axes of rotation, weakest first.")
      .def(pickling<Result>());
}

void bind_inertial(py::module_& module) {
  using Report = InertialReport;
  py::class_<Report>(module, "InertialReport", "What the inertial sensor did for a sweep.")
      .def_property_readonly(
          "state", [](const Report& self) { return std::string(to_string(self.state)); },
          "absent, starting, fused, lost or refused.")
      .def_property_readonly(
          "velocity",
          [](const Report& self) -> py::object {
            return self.nav ? array_of(self.nav->v_map_body) : py::none().cast<py::object>();
          },
          "(3,), m/s, map axes; None where it is not fused.")
      .def_property_readonly(
          "gyro_bias",
          [](const Report& self) -> py::object {
            return self.nav ? array_of(self.nav->bias.gyro) : py::none().cast<py::object>();
          },
          "(3,), rad/s, body axes; None where it is not fused.")
      .def_property_readonly(
          "accel_bias",
          [](const Report& self) -> py::object {
            return self.nav ? array_of(self.nav->bias.accel) : py::none().cast<py::object>();
          },
          "(3,), m/s^2, body axes; None where it is not fused.")
      .def_property_readonly(
          "gravity", [](const Report& self) { return array_of(self.gravity_map); },
          "(3,), m/s^2, map axes; zero before the sensor has been started.")
      .def_property_readonly(
          "state_covariance",
          [](const Report& self) -> py::object {
            return self.nav ? array_of(self.nav_covariance) : py::none().cast<py::object>();
          },
          "(20, 20): of position, rotation, velocity, gyro_bias, accel_bias, the direction of "
          "gravity\n"
          "(2), scale (1) and turn (2) of a sensor of velocities; m, rad, m/s, rad/s, m/s^2, rad, "
          "1,\n"
          "rad. None where it is not fused.")
      .def(pickling<Report>());
}

}  // namespace

void bind_results(py::module_& module) {
  bind_registration(module);
  bind_inertial(module);
  using Result = SweepResult;
  py::class_<Result>(module, "SweepResult", "What the odometry knows after a sweep.")
      .def_property_readonly(
          "stamp", [](const Result& self) { return self.stamp.count(); }, "Of the sweep, ns.")
      .def_property_readonly(
          "pose", [](const Result& self) { return array_of(self.T_map_lidar); },
          "(4, 4), T_map_lidar: maps coordinates of the lidar at the sweep's start to the map; m.")
      .def_property_readonly(
          "position",
          [](const Result& self) {
            return array_of(Eigen::Vector3d(self.T_map_lidar.translation()));
          },
          "(3,), m: of the lidar in the map.")
      .def_property_readonly(
          "covariance", [](const Result& self) { return array_of(self.uncertainty.in_map()); },
          "(6, 6), of pose since the first sweep: right perturbation [translation, rotation],\n"
          "lidar axes, m and rad.")
      .def_property_readonly(
          "local_covariance", [](const Result& self) { return array_of(self.uncertainty.local); },
          "(6, 6), the part of it that is relative to the submap.")
      .def_property_readonly(
          "state", [](const Result& self) { return std::string(to_string(self.state)); },
          "initializing, tracking, coasting (could not be aligned: the pose is predicted) or\n"
          "restarted (the submap starts anew).")
      .def_property_readonly(
          "failure", [](const Result& self) { return failure_reason(self, Config{}); },
          "Why the sweep could not be aligned, a sentence; None: it could.")
      .def_readonly("registration", &Result::registration, "Its alignment with the submap.")
      .def_readonly("inertial", &Result::inertial, "What the inertial sensor did.")
      .def_readonly("keyframe", &Result::keyframe, "True where it is far enough from the last one.")
      .def_readonly("deskewed", &Result::deskewed,
                    "True where points were moved to the sweep's start.")
      .def_readonly("raw_points", &Result::raw_points, "Points of the sweep as it came.")
      .def_readonly("valid_points", &Result::valid_points, "Left after those that are no return.")
      .def_readonly("cloud_points", &Result::cloud_points, "Left after down-sampling.")
      .def_readonly("host_ms", &Result::host_ms, "Host work, ms.")
      .def_readonly("wait_ms", &Result::wait_ms, "Waiting for the device, ms.")
      .def_property_readonly(
          "cloud",
          [](const py::object& self) { return view_of(self.cast<const Result&>().cloud, self); },
          "(n, 4) float32, keyframes only: the down-sampled sweep, lidar axes, m; a view.")
      .def(pickling<Result>())
      .def("__repr__", [](const Result& self) {
        const Eigen::Vector3d p = self.T_map_lidar.translation();
        return fmt::format("<adit.SweepResult {} at ({:.3f}, {:.3f}, {:.3f}) m>",
                           to_string(self.state), p.x(), p.y(), p.z());
      });
}

}  // namespace adit::python
