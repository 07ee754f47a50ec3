// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/measurements.hpp"

#include <array>
#include <cmath>
#include <utility>
#include <variant>

#include <fmt/core.h>
#include <pybind11/stl.h>

#include "adit/tools/python/arrays.hpp"
#include "adit/tools/python/pickling.hpp"

namespace adit::python {
namespace {

std::string in_seconds(Nanoseconds stamp) {
  return fmt::format("{:.9f} s", seconds(stamp));
}

Sweep make_sweep(const py::object& points, const py::object& times, const py::object& rings,
                 const py::object& doppler, int64_t stamp) {
  Sweep sweep{.stamp = Nanoseconds(stamp),
              .points = points_of(points, "points"),
              .times = times.is_none() ? std::vector<float>{} : floats_of(times, "times"),
              .rings = {},
              .source = "from Python"};
  if (!times.is_none() && sweep.times.size() != sweep.points.size()) {
    throw py::value_error(
        fmt::format("times: {} for {} points", sweep.times.size(), sweep.points.size()));
  }
  for (const float time : sweep.times) {
    if (!std::isfinite(time)) {
      throw py::value_error("times: not finite");
    }
  }
  if (!rings.is_none()) {
    sweep.rings = rings_of(rings, "rings");
    if (sweep.rings.size() != sweep.points.size()) {
      throw py::value_error(
          fmt::format("rings: {} for {} points", sweep.rings.size(), sweep.points.size()));
    }
  }
  if (!doppler.is_none()) {
    sweep.doppler = floats_of(doppler, "doppler");
    if (sweep.doppler.size() != sweep.points.size()) {
      throw py::value_error(
          fmt::format("doppler: {} for {} points", sweep.doppler.size(), sweep.points.size()));
    }
  }
  return sweep;
}

constexpr std::array kKinds = {std::pair(GnssFixKind::none, "none"),
                               std::pair(GnssFixKind::single, "single"),
                               std::pair(GnssFixKind::satellite_augmented, "satellite_augmented"),
                               std::pair(GnssFixKind::ground_augmented, "ground_augmented")};

GnssFixKind kind_named(const std::string& name) {
  for (const auto& [kind, its_name] : kKinds) {
    if (name == its_name) {
      return kind;
    }
  }
  throw py::value_error("kind: none, single, satellite_augmented or ground_augmented, not " + name);
}

GnssFix make_fix(int64_t stamp, double latitude, double longitude, double altitude,
                 const py::object& covariance, const std::string& kind) {
  for (const auto& [name, value] :
       {std::pair("latitude", latitude), {"longitude", longitude}, {"altitude", altitude}}) {
    if (!std::isfinite(value)) {
      throw py::value_error(fmt::format("{}: not finite", name));
    }
  }
  return {.stamp = Nanoseconds(stamp),
          .kind = kind_named(kind),
          .latitude = latitude,
          .longitude = longitude,
          .altitude = altitude,
          .covariance = covariance.is_none() ? std::nullopt
                                             : std::optional(matrix_of(covariance, "covariance"))};
}

/// What all of them have. The stamp is the measurement's own.
template <class Value>
py::class_<Measured<Value>> bind(py::module_& module, const char* name, const char* doc) {
  using Held = Measured<Value>;
  py::class_<Held> bound(module, name, doc);
  bound
      .def_property_readonly(
          "frame", [](const Held& self) { return self.frame; },
          "The sensor's frame; empty where it is not told.")
      .def_property_readonly(
          "topic", [](const Held& self) { return self.topic; },
          "The topic of the recording that it comes from; empty: none.")
      .def_property_readonly(
          "received",
          [](const Held& self) {
            return self.received ? std::optional(self.received->count()) : std::nullopt;
          },
          "Time of the recorder's clock (ns); None where no recording told it.")
      .def(pickling<Held>());
  if constexpr (requires(Value value) { value.stamp; }) {
    bound.def_property_readonly(
        "stamp", [](const Held& self) { return self.value.stamp.count(); },
        "Time of the measurement (ns); of a sweep that of its start.");
  }
  return bound;
}

void bind_sweep(py::module_& module) {
  using Held = Measured<Sweep>;
  bind<Sweep>(module, "Sweep", "One turn of a range sensor, in its own frame.")
      .def(py::init([](const py::object& points, const py::object& times, int64_t stamp,
                       const py::object& rings, const py::object& doppler, std::string frame) {
             return Held{.value = make_sweep(points, times, rings, doppler, stamp),
                         .frame = std::move(frame)};
           }),
           py::arg("points"), py::arg("times") = py::none(), py::kw_only(), py::arg("stamp") = 0,
           py::arg("rings") = py::none(), py::arg("doppler") = py::none(), py::arg("frame") = "",
           "points: (n, 3) or (n, 4), m and intensity; NaN or 0 0 0 is no return. times: (n,), s\n"
           "after the stamp. stamp: ns. rings: (n,), the beam of each point. doppler: (n,), m/s, "
           "how\n"
           "fast the distance of each point grows; NaN is not measured. ValueError, TypeError.")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            return view_of(self.cast<const Held&>().value.points, self);
          },
          "(n, 4) float32: x y z in m, intensity. A view, not writable.")
      .def_property_readonly(
          "offset", [](const Held& self) { return array_of(self.value.offset); },
          "(3,) float64, m: points + offset are the coordinates of the recording. Zero unless "
          "these\n"
          "are so large that float32 would round them.")
      .def_property_readonly(
          "times",
          [](const py::object& self) -> py::object {
            const Sweep& sweep = self.cast<const Held&>().value;
            return sweep.times.empty() ? py::none().cast<py::object>() : view_of(sweep.times, self);
          },
          "(n,) float32, s after the stamp; a view. None where points have no times.")
      .def_property_readonly(
          "rings",
          [](const py::object& self) -> py::object {
            const Sweep& sweep = self.cast<const Held&>().value;
            return sweep.rings.empty() ? py::none().cast<py::object>() : view_of(sweep.rings, self);
          },
          "(n,) uint16, the beam of each point; a view. None where it is not told.")
      .def_property_readonly(
          "doppler",
          [](const py::object& self) -> py::object {
            const Sweep& sweep = self.cast<const Held&>().value;
            return sweep.doppler.empty() ? py::none().cast<py::object>()
                                         : view_of(sweep.doppler, self);
          },
          "(n,) float32, m/s, how fast the distance of each point grows; a view. None where the\n"
          "source has none.")
      .def("__len__", [](const Held& self) { return self.value.points.size(); })
      .def("__repr__", [](const Held& self) {
        return fmt::format("<adit.Sweep of {} points at {}>", self.value.points.size(),
                           in_seconds(self.value.stamp));
      });
}

void bind_imu_sample(py::module_& module) {
  using Held = Measured<ImuSample>;
  bind<ImuSample>(module, "ImuSample", "One reading of an inertial sensor, in its own axes.")
      .def(py::init([](int64_t stamp, const py::object& angular_velocity,
                       const py::object& linear_acceleration, std::string frame) {
             return Held{.value = {.stamp = Nanoseconds(stamp),
                                   .angular_velocity =
                                       vector_of(angular_velocity, "angular_velocity", false),
                                   .linear_acceleration = vector_of(linear_acceleration,
                                                                    "linear_acceleration", false)},
                         .frame = std::move(frame)};
           }),
           py::arg("stamp"), py::arg("angular_velocity"), py::arg("linear_acceleration"),
           py::kw_only(), py::arg("frame") = "",
           "stamp: ns. angular_velocity: (3,), rad/s. linear_acceleration: (3,), m/s^2; at rest "
           "with\n"
           "z up it is +9.8 along z. What is not measured is NaN. ValueError, TypeError.")
      .def_property_readonly(
          "angular_velocity",
          [](const Held& self) { return array_of(self.value.angular_velocity); }, "(3,), rad/s.")
      .def_property_readonly(
          "linear_acceleration",
          [](const Held& self) { return array_of(self.value.linear_acceleration); },
          "(3,), m/s^2, gravity included.")
      .def("__repr__", [](const Held& self) {
        return "<adit.ImuSample at " + in_seconds(self.value.stamp) + ">";
      });
}

void bind_gnss_fix(py::module_& module) {
  using Held = Measured<GnssFix>;
  bind<GnssFix>(module, "GnssFix", "One position of a GNSS antenna on WGS 84.")
      .def(py::init([](int64_t stamp, double latitude, double longitude, double altitude,
                       const py::object& covariance, const std::string& kind, std::string frame) {
             return Held{.value = make_fix(stamp, latitude, longitude, altitude, covariance, kind),
                         .frame = std::move(frame)};
           }),
           py::arg("stamp"), py::arg("latitude"), py::arg("longitude"), py::arg("altitude"),
           py::arg("covariance") = py::none(), py::kw_only(), py::arg("kind") = "single",
           py::arg("frame") = "",
           "stamp: ns. latitude, longitude: degrees. altitude: m above the ellipsoid. covariance:\n"
           "(3, 3), m^2, east north up; None: the receiver gives none. kind: none, single,\n"
           "satellite_augmented, ground_augmented. ValueError, TypeError.")
      .def_property_readonly(
          "kind", [](const Held& self) { return name_of(self.value.kind); },
          "none, single, satellite_augmented or ground_augmented.")
      .def_property_readonly(
          "latitude", [](const Held& self) { return self.value.latitude; },
          "Degrees, north positive.")
      .def_property_readonly(
          "longitude", [](const Held& self) { return self.value.longitude; },
          "Degrees, east positive.")
      .def_property_readonly(
          "altitude", [](const Held& self) { return self.value.altitude; },
          "m above the ellipsoid.")
      .def_property_readonly(
          "covariance",
          [](const Held& self) -> py::object {
            return self.value.covariance ? array_of(*self.value.covariance)
                                         : py::none().cast<py::object>();
          },
          "(3, 3), m^2, east north up; None: the receiver gives none.")
      .def("__repr__", [](const Held& self) {
        return fmt::format("<adit.GnssFix {:.7f} {:.7f} at {}>", self.value.latitude,
                           self.value.longitude, in_seconds(self.value.stamp));
      });
}

void bind_body_velocity(py::module_& module) {
  using Held = Measured<BodyVelocity>;
  bind<BodyVelocity>(module, "BodyVelocity",
                     "Velocity of a sensor that is fixed to the body, in the sensor's own axes.")
      .def(
          py::init([](int64_t stamp, const py::object& linear, const py::object& covariance,
                      const std::string& frame) {
            return Held{
                .value = {.stamp = Nanoseconds(stamp),
                          .linear = vector_of(linear, "linear", false),
                          .covariance = covariance.is_none()
                                            ? std::nullopt
                                            : std::optional(matrix_of(covariance, "covariance")),
                          .frame = frame},
                .frame = frame};
          }),
          py::arg("stamp"), py::arg("linear"), py::arg("covariance") = py::none(), py::kw_only(),
          py::arg("frame") = "",
          "stamp: ns. linear: (3,), m/s; an axis that is not measured is NaN. covariance: (3, 3),\n"
          "(m/s)^2; None: the source gives none. ValueError, TypeError.")
      .def_property_readonly(
          "linear", [](const Held& self) { return array_of(self.value.linear); }, "(3,), m/s.")
      .def_property_readonly(
          "covariance",
          [](const Held& self) -> py::object {
            return self.value.covariance ? array_of(*self.value.covariance)
                                         : py::none().cast<py::object>();
          },
          "(3, 3), (m/s)^2; None: the source gives none.")
      .def("__repr__", [](const Held& self) {
        const Eigen::Vector3d& v = self.value.linear;
        return fmt::format("<adit.BodyVelocity {:.3f} {:.3f} {:.3f} m/s at {}>", v.x(), v.y(),
                           v.z(), in_seconds(self.value.stamp));
      });
}

void bind_heading(py::module_& module) {
  using Held = Measured<Heading>;
  bind<Heading>(module, "Heading", "Which way the x axis of a sensor points, against true east.")
      .def(py::init([](int64_t stamp, double yaw, const std::optional<double>& sigma,
                       const std::string& frame) {
             if (!std::isfinite(yaw)) {
               throw py::value_error("yaw: not finite");
             }
             return Held{
                 .value = {.stamp = Nanoseconds(stamp), .yaw = yaw, .sigma = sigma, .frame = frame},
                 .frame = frame};
           }),
           py::arg("stamp"), py::arg("yaw"), py::arg("sigma") = py::none(), py::kw_only(),
           py::arg("frame") = "",
           "stamp: ns. yaw: rad, counter-clockwise from true east: pi/2 less a compass's bearing.\n"
           "sigma: rad; None: the source gives none. ValueError.")
      .def_property_readonly(
          "yaw", [](const Held& self) { return self.value.yaw; }, "rad, from true east.")
      .def_property_readonly(
          "sigma", [](const Held& self) { return self.value.sigma; },
          "rad; None: the source gives none.")
      .def("__repr__", [](const Held& self) {
        return fmt::format("<adit.Heading {:.4f} rad at {}>", self.value.yaw,
                           in_seconds(self.value.stamp));
      });
}

/// Frames and the pose between them.
template <class Value>
void add_transform(py::class_<Measured<Value>>& bound) {
  using Held = Measured<Value>;
  bound
      .def_property_readonly(
          "parent", [](const Held& self) { return self.value.parent; },
          "Name of the parent's frame.")
      .def_property_readonly(
          "child", [](const Held& self) { return self.value.child; }, "Name of the child's frame.")
      .def_property_readonly(
          "T_parent_child", [](const Held& self) { return array_of(self.value.T_parent_child); },
          "(4, 4): maps coordinates of the child to the parent's; m.")
      .def("__repr__", [bound](const Held& self) {
        return fmt::format("<adit.{} {} <- {}>", std::string(py::str(bound.attr("__name__"))),
                           self.value.parent, self.value.child);
      });
}

}  // namespace

std::string name_of(GnssFixKind kind) {
  for (const auto& [one, name] : kKinds) {
    if (one == kind) {
      return name;
    }
  }
  return "none";
}

py::object object_of(Event&& event, const std::vector<Topic>& topics) {
  const std::string& topic = topics[event.topic].name;
  if (auto* sweep = std::get_if<Sweep>(&event.value)) {
    sweep->number = event.number;
  }
  return std::visit(
      [&]<class Value>(Value& value) {
        return py::cast(Measured<Value>{.value = std::move(value),
                                        .frame = std::move(event.frame),
                                        .topic = topic,
                                        .received = event.received});
      },
      event.value);
}

void bind_measurements(py::module_& module) {
  bind_sweep(module);
  bind_imu_sample(module);
  bind_gnss_fix(module);
  bind_body_velocity(module);
  bind_heading(module);
  auto transform = bind<StaticTransform>(module, "StaticTransform", "How two frames are mounted.");
  transform.def(py::init([](std::string parent, std::string child, const py::object& pose) {
                  return Measured<StaticTransform>{
                      .value = {.parent = std::move(parent),
                                .child = std::move(child),
                                .T_parent_child = pose_of_array(pose, "T_parent_child")}};
                }),
                py::arg("parent"), py::arg("child"), py::arg("T_parent_child"),
                "T_parent_child: (4, 4), m. ValueError, TypeError.");
  add_transform(transform);
  auto pose = bind<ReferencePose>(module, "ReferencePose", "A pose that somebody else determined.");
  add_transform(pose);
}

}  // namespace adit::python
