// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/trajectories.hpp"

#include <array>
#include <optional>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <nlohmann/json.hpp>

#include "adit/tools/evaluation/evaluate.hpp"
#include "adit/tools/evaluation/evaluation_report.hpp"
#include "adit/tools/evaluation/trajectory_source.hpp"
#include "adit/tools/python/arrays.hpp"
#include "adit/tools/python/gil.hpp"
#include "adit/tools/python/pickling.hpp"

namespace adit::python {
namespace {

Trajectory make_trajectory(const py::object& stamps, const py::object& poses) {
  const py::module_ numpy = py::module_::import("numpy");
  const py::array times = numpy.attr("asarray")(stamps);
  const py::array matrices = numpy.attr("asarray")(poses);
  if (times.ndim() != 1 || (times.dtype().kind() != 'i' && times.dtype().kind() != 'u')) {
    throw py::value_error("stamps: (n,) whole numbers are expected, ns");
  }
  if (matrices.ndim() != 3 || matrices.shape(0) != times.shape(0)) {
    throw py::value_error(
        fmt::format("poses: ({}, 4, 4) is expected, as there are stamps", times.shape(0)));
  }
  const auto numbers = py::array_t<int64_t, py::array::forcecast>(times).unchecked<1>();
  Trajectory trajectory;
  for (py::ssize_t i = 0; i < numbers.shape(0); ++i) {
    trajectory.poses.push_back(
        {.stamp = Nanoseconds(numbers(i)),
         .pose = pose_of_array(matrices[py::int_(i)], fmt::format("poses[{}]", i))});
  }
  return poses_of(std::move(trajectory.poses), {});
}

Trajectory trajectory_of(const py::object& source, const char* name) {
  if (py::isinstance<Trajectory>(source)) {
    return source.cast<const Trajectory&>();
  }
  if (!py::isinstance<py::str>(source) && !py::hasattr(source, "__fspath__")) {
    throw py::type_error(
        fmt::format("{}: a path or a Trajectory, not {}", name, std::string(py::repr(source))));
  }
  const auto path = source.cast<std::filesystem::path>();
  return without_gil([&] { return read_any_trajectory({.path = path}); });
}

Alignment alignment_named(const std::string& name) {
  for (const auto alignment :
       {Alignment::se3, Alignment::sim3, Alignment::origin, Alignment::none}) {
    if (name == to_string(alignment)) {
      return alignment;
    }
  }
  throw py::value_error("align: se3, sim3, origin or none, not " + name);
}

Evaluation evaluated(const py::object& estimate, const py::object& truth, const std::string& align,
                     double tolerance, double delta, const std::optional<std::size_t>& part) {
  EvaluationOptions options;
  options.alignment = alignment_named(align);
  options.tolerance = tolerance;
  options.rpe.delta = delta;
  options.part = part;
  if (!(tolerance >= 0.0) || !(delta > 0.0)) {
    throw py::value_error("tolerance: at least 0 s; delta: above 0 m");
  }
  const Trajectory from = trajectory_of(estimate, "estimate");
  const Trajectory to = trajectory_of(truth, "truth");
  return without_gil([&] { return evaluate(from, to, options); });
}

void bind_evaluation(py::module_& module) {
  py::class_<Statistics>(module, "Statistics", "Of a list of errors, in its unit.")
      .def_readonly("count", &Statistics::count)
      .def_readonly("rmse", &Statistics::rmse)
      .def_readonly("mean", &Statistics::mean)
      .def_readonly("median", &Statistics::median)
      .def_readonly("std", &Statistics::std)
      .def_readonly("min", &Statistics::min)
      .def_readonly("max", &Statistics::max)
      .def(pickling<Statistics>())
      .def("__repr__", [](const Statistics& self) {
        return fmt::format("<adit.Statistics rmse {:.6g} of {}>", self.rmse, self.count);
      });
  py::class_<Evaluation>(module, "Evaluation", "How far an estimate is from the ground truth.")
      .def_readonly("ate", &Evaluation::ate, "Statistics of position errors after alignment, m.")
      .def_readonly("ate_rotation", &Evaluation::ate_rotation, "Of attitude errors, degrees.")
      .def_readonly("ate_unaligned", &Evaluation::ate_unaligned, "Of positions as they are, m.")
      .def_property_readonly(
          "rpe_translation", [](const Evaluation& self) { return self.rpe.translation; },
          "Statistics of relative errors over delta, m.")
      .def_property_readonly(
          "rpe_rotation", [](const Evaluation& self) { return self.rpe.rotation; },
          "Likewise, degrees.")
      .def_property_readonly(
          "pairs", [](const Evaluation& self) { return self.association.pairs; }, "Matched poses.")
      .def_property_readonly(
          "position_errors",
          [](const py::object& self) {
            return view_of(self.cast<const Evaluation&>().position_errors, self);
          },
          "(n,) float64, m, one a pair; a view.")
      .def_readonly("warnings", &Evaluation::warnings, "For people, a sentence each.")
      .def(
          "to_dict",
          [](const Evaluation& self) {
            return py::module_::import("json").attr("loads")(evaluation_json(self, {}, {}));
          },
          "Everything that `adit evaluate --json` reports of a trajectory.")
      .def(pickling<Evaluation>())
      .def("__repr__", [](const Evaluation& self) {
        return fmt::format("<adit.Evaluation ATE {:.6g} m rmse of {} pairs>", self.ate.rmse,
                           self.association.pairs);
      });
  module.def(
      "evaluate", &evaluated, py::arg("estimate"), py::arg("truth"), py::kw_only(),
      py::arg("align") = "se3", py::arg("tolerance") = EvaluationOptions{}.tolerance,
      py::arg("delta") = RpeOptions{}.delta, py::arg("part") = py::none(),
      "ATE, RPE and KITTI errors, as `adit evaluate` has them. estimate, truth: a Trajectory, or\n"
      "the path of a file or folder that holds one. align: se3, sim3, origin or none. tolerance:\n"
      "largest time difference of a matched pair, s. delta: distance between the poses of a pair\n"
      "of the RPE, m. part: of an estimate whose odometry started anew, from 1.\n\n"
      "InputError: no trajectory in a file, nothing matches, alignment not determined.");
}

}  // namespace

Trajectory poses_of(Poses poses, std::vector<std::size_t> parts) {
  return {
      .file = "Trajectory", .stamped = true, .poses = std::move(poses), .parts = std::move(parts)};
}

void bind_trajectories(py::module_& module) {
  py::class_<Trajectory>(module, "Trajectory", "Poses with their stamps.")
      .def(py::init(&make_trajectory), py::arg("stamps"), py::arg("poses"),
           "stamps: (n,), ns. poses: (n, 4, 4), m. TypeError, ValueError.")
      .def_static(
          "read",
          [](const std::filesystem::path& path, const std::string& topic) {
            return without_gil([&] { return read_any_trajectory({.path = path, .topic = topic}); });
          },
          py::arg("path"), py::kw_only(), py::arg("topic") = "",
          "TUM or KITTI text, a table with named columns, the folder of a run, or the poses of a\n"
          "recording (topic: NAME or NAME:FRAME, where it has several). InputError.")
      .def(
          "write",
          [](const Trajectory& self, const std::filesystem::path& path, const std::string& format) {
            if (format != "tum" && format != "kitti") {
              throw py::value_error("format: tum or kitti, not " + format);
            }
            without_gil([&] {
              write_trajectory(path,
                               format == "tum" ? TrajectoryFormat::tum : TrajectoryFormat::kitti,
                               self.poses, self.parts);
            });
          },
          py::arg("path"), py::kw_only(), py::arg("format") = "tum",
          "As `adit run` writes trajectory.tum and trajectory.kitti. OutputError.")
      .def_property_readonly(
          "stamps",
          [](const Trajectory& self) {
            py::array_t<int64_t> stamps(static_cast<py::ssize_t>(self.poses.size()));
            for (std::size_t i = 0; i < self.poses.size(); ++i) {
              stamps.mutable_data()[i] = self.poses[i].stamp.count();
            }
            return stamps;
          },
          "(n,) int64, ns; zeros where the file has none.")
      .def_property_readonly(
          "poses",
          [](const Trajectory& self) {
            py::array_t<double> poses(
                std::vector<py::ssize_t>{static_cast<py::ssize_t>(self.poses.size()), 4, 4});
            double* to = poses.mutable_data();
            for (const StampedPose& one : self.poses) {
              const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = one.pose.matrix();
              to = std::copy_n(matrix.data(), 16, to);
            }
            return poses;
          },
          "(n, 4, 4) float64, m.")
      .def_property_readonly(
          "parts", [](const Trajectory& self) { return self.parts; },
          "Where parts begin that nothing ties to what comes before, but for the first.")
      .def("__len__", [](const Trajectory& self) { return self.poses.size(); })
      .def(pickling<Trajectory>())
      .def("__repr__", [](const Trajectory& self) {
        return fmt::format("<adit.Trajectory of {} poses>", self.poses.size());
      });
  bind_evaluation(module);
}

}  // namespace adit::python
