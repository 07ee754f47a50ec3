// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/clouds.hpp"

#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <pybind11/stl.h>

#include "adit/engine/context.hpp"
#include "adit/slam/registration/alignment_clouds.hpp"
#include "adit/slam/registration/cloud_aligner.hpp"
#include "adit/slam/submaps/keyframe_submap.hpp"
#include "adit/tools/export/align_report.hpp"
#include "adit/tools/python/arrays.hpp"
#include "adit/tools/python/device.hpp"
#include "adit/tools/python/gil.hpp"
#include "adit/tools/python/pickling.hpp"

namespace adit::python {
namespace {

constexpr double kFarthest = 1000.0;  // m: float32 on the device is exact enough so far

RegistrationMethod method_named(const std::string& name) {
  std::string known;
  for (const auto& [its_name, method] : alignment_methods()) {
    if (name == its_name) {
      return method;
    }
    known += (known.empty() ? "" : ", ") + its_name;
  }
  throw py::value_error("method: one of " + known + ", not " + name);
}

std::string name_of(RegistrationMethod method) {
  for (const auto& [its_name, its_method] : alignment_methods()) {
    if (method == its_method) {
      return its_name;
    }
  }
  return {};
}

/// Two clouds of a batch, by their places among its clouds.
struct Pair {
  std::size_t a = 0;
  std::size_t b = 0;
  std::optional<Eigen::Isometry3d> guess{};
};

/// What became of a pair, with what explains it.
struct Alignment {
  AlignedPair pair;
  CloudAlignerSettings settings;
};

class DeviceAligner {
 public:
  DeviceAligner(SharedDevice device, const CloudAlignerSettings& settings)
      : device_(std::move(device)), settings_(settings), aligner_(device_->context(), settings) {}

  std::vector<Alignment> align(const std::vector<std::vector<Point>>& clouds,
                               const std::vector<Pair>& pairs) {
    const std::lock_guard lock(mutex_);
    const Checkpoint checkpoint = signal_checks();
    std::vector<AlignableCloud> prepared;
    prepared.reserve(clouds.size());
    for (const std::vector<Point>& points : clouds) {
      prepared.push_back(aligner_.prepare(points, std::nullopt, checkpoint));
    }
    std::vector<CloudPair> wanted;
    for (const Pair& pair : pairs) {
      wanted.push_back({.a = &prepared[pair.a], .b = &prepared[pair.b], .guess = pair.guess});
    }
    std::vector<CloudAlignment> alignments = aligner_.align(wanted, checkpoint);
    std::vector<Alignment> results;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      results.push_back({.pair = {.named = {.a = "a", .b = "b", .guess = pairs[i].guess},
                                  .r_input = prepared[pairs[i].b].r_input,
                                  .alignment = std::move(alignments[i])},
                         .settings = settings_});
    }
    return results;
  }

  std::string text() const {
    return fmt::format("<adit.Aligner {}, resolution {}, min_overlap {}>",
                       name_of(settings_.method), settings_.r_input, settings_.min_overlap);
  }

 private:
  std::mutex mutex_;
  SharedDevice device_;
  CloudAlignerSettings settings_;
  CloudAligner aligner_;
};

std::optional<Eigen::Isometry3d> guess_of(const py::object& guess) {
  return guess.is_none() ? std::nullopt : std::optional(pose_of_array(guess, "guess"));
}

Alignment align(DeviceAligner& self, const py::object& a, const py::object& b,
                const py::object& guess) {
  const std::vector<std::vector<Point>> clouds{points_of(a, "a"), points_of(b, "b")};
  const std::vector<Pair> pairs{{.a = 0, .b = 1, .guess = guess_of(guess)}};
  return without_gil([&] { return std::move(self.align(clouds, pairs).front()); });
}

/// An array that several pairs share is prepared once.
std::vector<Alignment> align_batch(DeviceAligner& self, const py::iterable& given) {
  std::vector<std::vector<Point>> clouds;
  std::map<PyObject*, std::size_t> places;
  std::vector<py::object> arrays;  // stay alive: their addresses are their names here
  const auto place_of = [&](const py::object& array, const std::string& name) {
    const auto [found, is_new] = places.try_emplace(array.ptr(), clouds.size());
    if (is_new) {
      clouds.push_back(points_of(array, name));
      arrays.push_back(array);
    }
    return found->second;
  };
  std::vector<Pair> pairs;
  for (const py::handle one : given) {
    const std::string name = fmt::format("pairs[{}]", pairs.size());
    if (!py::isinstance<py::sequence>(one) || py::isinstance<py::array>(one) ||
        (py::len(one) != 2 && py::len(one) != 3)) {
      throw py::value_error(name + ": (a, b) or (a, b, guess) is expected");
    }
    const auto parts = py::reinterpret_borrow<py::sequence>(one);
    pairs.push_back({.a = place_of(parts[0], name + "[0]"),
                     .b = place_of(parts[1], name + "[1]"),
                     .guess = parts.size() == 3 ? guess_of(parts[2]) : std::nullopt});
  }
  return without_gil([&] { return self.align(clouds, pairs); });
}

void require_near(const std::vector<Point>& points) {
  for (const Point& p : points) {
    const double distance = std::hypot(p.x, p.y, p.z);
    if (std::isfinite(distance) && distance > kFarthest) {
      throw py::value_error(
          fmt::format("points: lie up to {:.0f} m from the origin; {:.0f} m is the most. Subtract "
                      "a place among them first",
                      distance, kFarthest));
    }
  }
}

PreprocessConfig preprocess_of(double size) {
  if (!(size >= 0.01 && size <= 10.0)) {
    throw py::value_error(fmt::format("size: is {}; must be between 0.01 and 10 m", size));
  }
  Config config;
  config.preprocess.c_min = 0.0;
  config.preprocess.r_input = size;
  PreprocessConfig preprocess = with_lengths(config).preprocess;
  preprocess.c_max = kFarthest;
  return preprocess;
}

py::array voxel_down_sample(const py::object& points, double size, const py::object& device) {
  Sweep sweep;
  sweep.points = points_of(points, "points");
  sweep.source = "of the cloud";
  require_near(sweep.points);
  const PreprocessConfig preprocess = preprocess_of(size);
  const SharedDevice on = device_of(device);
  return array_of(without_gil([&] {
    engine::Context& context = on->context();
    FrontEnd front_end(context, preprocess);
    front_end.measure_beam_spacing(sweep.points);
    front_end.upload(sweep);
    const engine::Buffer surfaces = context.make_buffer(sweep.points.size() * sizeof(Point),
                                                        engine::Memory::device, "surface cloud");
    engine::Recorder recorder = context.make_recorder();
    front_end.record(recorder, surfaces);
    context.submit(std::move(recorder)).wait();
    return front_end.read_cloud();
  }));
}

/// A cloud with the surface at each point.
struct Surfaces {
  std::vector<Point> points;
  std::vector<double> directions;  ///< three a point
  std::vector<uint8_t> planes;
};

/// As on the device: the bits of x, y, z, and the packed surface.
struct SurfacePoint {
  float x, y, z;
  uint32_t surface;
};

Surfaces read_surfaces(engine::Context& context, const SurfaceCloud& cloud) {
  const uint64_t bytes = uint64_t{cloud.size} * sizeof(SurfacePoint);
  Surfaces surfaces;
  if (bytes == 0) {
    return surfaces;
  }
  const engine::Buffer back = context.make_buffer(bytes, engine::Memory::readback, "surfaces back");
  engine::Recorder recorder = context.make_recorder();
  recorder.copy(cloud.points.slice(0, bytes), back);
  context.submit(std::move(recorder)).wait();
  for (const SurfacePoint& p : back.as<SurfacePoint>()) {
    const Eigen::Vector3d direction =
        has_direction(p.surface) ? surface_direction(p.surface) : Eigen::Vector3d::Zero();
    surfaces.points.push_back({.x = p.x, .y = p.y, .z = p.z});
    surfaces.directions.insert(surfaces.directions.end(), direction.data(), direction.data() + 3);
    surfaces.planes.push_back(is_plane(p.surface) ? 1 : 0);
  }
  return surfaces;
}

Surfaces estimate_surfaces(const py::object& points, double size, const py::object& device) {
  const std::vector<Point> given = points_of(points, "points");
  require_near(given);
  const PreprocessConfig preprocess = preprocess_of(size);
  const SharedDevice on = device_of(device);
  return without_gil([&] {
    AlignmentClouds clouds(on->context(), preprocess);
    return read_surfaces(on->context(), clouds.make_cloud(given));
  });
}

void bind_alignment(py::module_& module) {
  py::class_<Alignment>(module, "Alignment",
                        "The relative pose of two clouds, or why there is none.")
      .def_property_readonly(
          "usable", [](const Alignment& self) { return self.pair.usable(); },
          "True where the pose may be used.")
      .def_property_readonly(
          "refusal",
          [](const Alignment& self) -> std::optional<std::string> {
            if (self.pair.usable()) {
              return std::nullopt;
            }
            return std::string(to_string(self.pair.alignment.refusal));
          },
          "Why not, a word as in the JSON of `adit align`; None: it may be used.")
      .def_property_readonly(
          "reason",
          [](const Alignment& self) -> std::optional<std::string> {
            if (self.pair.usable()) {
              return std::nullopt;
            }
            return reason_of(self.pair, self.settings);
          },
          "The same as a sentence, with its figures.")
      .def_property_readonly(
          "T_a_b", [](const Alignment& self) { return array_of(self.pair.alignment.T_a_b); },
          "(4, 4): maps coordinates of b to a's, m; also where it is refused.")
      .def_property_readonly(
          "covariance",
          [](const Alignment& self) { return array_of(self.pair.alignment.covariance); },
          "(6, 6), of T_a_b: right perturbation [translation, rotation], b's axes, m and rad.")
      .def_property_readonly(
          "registration", [](const Alignment& self) { return self.pair.alignment.registration; },
          "What was measured at that pose: overlap, residual_rms, directions, iterations.")
      .def_property_readonly(
          "competing",
          [](const Alignment& self) -> py::object {
            const auto& other = self.pair.alignment.competing;
            return other ? array_of(other->result.T_target_source) : py::none().cast<py::object>();
          },
          "(4, 4): another pose that fits as well; None: there is none.")
      .def_property_readonly(
          "poses_tried", [](const Alignment& self) { return self.pair.alignment.poses_tried; },
          "Of the search, where there was no guess.")
      .def_property_readonly(
          "resolution", [](const Alignment& self) { return self.pair.r_input; },
          "One point per so many m was left of b.")
      .def(pickling<Alignment>())
      .def("__repr__", [](const Alignment& self) {
        return "<adit.Alignment " +
               (self.pair.usable() ? "usable" : "refused: " + reason_of(self.pair, self.settings)) +
               ">";
      });
}

}  // namespace

void bind_clouds(py::module_& module) {
  bind_alignment(module);
  py::class_<DeviceAligner, std::shared_ptr<DeviceAligner>>(
      module, "Aligner",
      "Aligns pairs of clouds, from a guess or from nothing, and refuses what it cannot vouch "
      "for.\n"
      "The same clouds and guesses give the same bits.")
      .def(
          py::init([](const std::string& method, double resolution, double min_overlap,
                      const py::object& device) {
            CloudAlignerSettings settings;
            settings.method = method_named(method);
            settings.r_input = resolution;
            settings.min_overlap = min_overlap;
            if (!(resolution == 0.0 || (resolution >= 0.01 && resolution <= 10.0))) {
              throw py::value_error(
                  fmt::format("resolution: is {}; must be 0 or between 0.01 and 10 m", resolution));
            }
            if (!(min_overlap >= 0.0 && min_overlap <= 1.0)) {
              throw py::value_error(
                  fmt::format("min_overlap: is {}; must be between 0 and 1", min_overlap));
            }
            SharedDevice on = device_of(device);
            return without_gil(
                [&] { return std::make_shared<DeviceAligner>(std::move(on), settings); });
          }),
          py::kw_only(), py::arg("method") = "vgicp", py::arg("resolution") = 0.0,
          py::arg("min_overlap") = CloudAlignerSettings{}.min_overlap,
          py::arg("device") = py::none(),
          "method: vgicp, ndt, point-to-plane or ndt-to-ndt. resolution: one point per so many m;\n"
          "0: by each cloud's extent, 0.05 to 0.25. min_overlap: share of b's points that must "
          "lie\n"
          "on a. device: None, a name or a Device. ValueError, DeviceError.")
      .def("align", &align, py::arg("a"), py::arg("b"), py::arg("guess") = py::none(),
           "a, b: (n, 3) or (n, 4), m; NaN and 0 0 0 are dropped. Arrays of any number type and\n"
           "layout and lists are taken, and copied once. guess: (4, 4), T_a_b to some 2 m\n"
           "and 20 degrees; None: it is searched for, which wants clouds with z up. Returns an\n"
           "Alignment. TypeError, ValueError, DeviceError (more points than fit).")
      .def(
          "align_batch", &align_batch, py::arg("pairs"),
          "Many pairs at once: (a, b) or (a, b, guess) each. An array that several pairs share is\n"
          "prepared once. Returns an Alignment a pair, in their order.")
      .def("__repr__", [](const DeviceAligner& self) { return self.text(); });
  module.def(
      "voxel_down_sample", &voxel_down_sample, py::arg("points"), py::arg("size"), py::kw_only(),
      py::arg("device") = py::none(),
      "One point, their centroid, for the points of each voxel. points: (n, 3) or (n, 4), m,\n"
      "within 1000 m of the origin; NaN and 0 0 0 are dropped. size: edge of a voxel, m.\n"
      "Returns (m, 4) float32. TypeError, ValueError, DeviceError.");
  py::class_<Surfaces>(module, "Surfaces", "A down-sampled cloud with the surface at each point.")
      .def_property_readonly(
          "points",
          [](const py::object& self) { return view_of(self.cast<const Surfaces&>().points, self); },
          "(m, 4) float32, m; the fourth column is 0. A view.")
      .def_property_readonly(
          "directions",
          [](const py::object& self) {
            return view_of(self.cast<const Surfaces&>().directions, self).attr("reshape")(-1, 3);
          },
          "(m, 3) float64, unit: the normal of a plane, the direction of a line; zero where the\n"
          "neighbours show neither. A view.")
      .def_property_readonly(
          "planes",
          [](const py::object& self) {
            return view_of(self.cast<const Surfaces&>().planes, self).attr("view")("bool");
          },
          "(m,) bool: the direction is the normal of a plane. A view.")
      .def("__len__", [](const Surfaces& self) { return self.points.size(); })
      .def(pickling<Surfaces>());
  module.def(
      "estimate_surfaces", &estimate_surfaces, py::arg("points"), py::arg("size"), py::kw_only(),
      py::arg("device") = py::none(),
      "Down-samples and estimates the surface at each point from its neighbours. points: as\n"
      "voxel_down_sample() takes them, seen from the origin. size: edge of a voxel, m.\n"
      "Returns Surfaces. TypeError, ValueError, DeviceError.");
}

}  // namespace adit::python
