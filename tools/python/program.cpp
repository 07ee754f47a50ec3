// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/program.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#ifdef ADIT_BENCHMARKS
#include <array>

#include "adit/benchmarks/command_bench.hpp"
#endif
#include "adit/tools/commands/program.hpp"
#include "adit/tools/python/gil.hpp"
#include "adit/tools/python/pickling.hpp"
#include "adit/tools/simulator/scene_file.hpp"
#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/support/commit.hpp"
#include "adit/tools/support/version.hpp"

namespace adit::python {
namespace {

namespace py = pybind11;

int run_program(const std::vector<std::string>& arguments) {
  std::vector<const char*> words{"adit"};
  for (const std::string& argument : arguments) {
    words.push_back(argument.c_str());
  }
  const int count = static_cast<int>(words.size());
  words.push_back(nullptr);
  return without_gil([&] {
#ifdef ADIT_BENCHMARKS
    const std::array<AddCommand, 1> more = {bench::add_bench_command};
    return program(count, words.data(), more);
#else
    return program(count, words.data());
#endif
  });
}

SimulationOptions scene_named(const std::string& scene) {
  if (std::filesystem::path(scene).extension() == ".toml") {
    return read_scene_file(scene);
  }
  SimulationOptions options;
  options.scene = scene;
  return options;
}

/// What is None is the scene file's, or the program's default.
struct Wanted {
  std::optional<std::string> sensor;
  std::optional<std::string> trajectory;
  std::optional<double> duration;
  std::optional<double> speed;
  std::optional<uint64_t> seed;
  std::optional<std::string> imu;
  std::optional<std::string> gnss;
  std::optional<std::vector<std::string>> faults;
  bool perfect = false;
};

template <class To, class From>
void set(To& to, const std::optional<From>& from) {
  if (from) {
    to = *from;
  }
}

SimulationSummary simulated(const std::string& scene, const std::filesystem::path& output,
                            const Wanted& wanted) {
  SimulationOptions options = scene_named(scene);
  options.output = output;
  LidarOptions& lidar = options.lidars.front();
  set(lidar.sensor, wanted.sensor);
  set(options.trajectory, wanted.trajectory);
  set(options.duration, wanted.duration);
  set(options.speed, wanted.speed);
  set(options.seed, wanted.seed);
  set(options.imu, wanted.imu);
  set(options.gnss, wanted.gnss);
  set(options.faults, wanted.faults);
  if (wanted.perfect) {
    lidar.effects = {.noise = false, .dropout = false, .mixed_pixels = false, .dust = false};
  }
  return simulate(options, {}, signal_checks());
}

}  // namespace

void bind_program(py::module_& module) {
  py::class_<SimulationSummary>(module, "SimulationSummary", "What was simulated.")
      .def_readonly("sweeps", &SimulationSummary::sweeps)
      .def_readonly("points", &SimulationSummary::points, "Returns, of all sweeps.")
      .def_readonly("imu_samples", &SimulationSummary::imu_samples)
      .def_readonly("gnss_fixes", &SimulationSummary::gnss_fixes)
      .def_readonly("path", &SimulationSummary::path, "Length of the way, m.")
      .def(pickling<SimulationSummary>());
  module.def(
      "simulate",
      [](const std::string& scene, const std::filesystem::path& output,
         const std::optional<std::string>& sensor, const std::optional<std::string>& trajectory,
         const std::optional<double>& duration, const std::optional<double>& speed,
         const std::optional<uint64_t>& seed, const std::optional<std::string>& imu,
         const std::optional<std::string>& gnss,
         const std::optional<std::vector<std::string>>& faults, bool perfect) {
        const Wanted wanted{sensor, trajectory, duration, speed, seed, imu, gnss, faults, perfect};
        return without_gil([&] { return simulated(scene, output, wanted); });
      },
      py::arg("scene"), py::arg("output"), py::kw_only(), py::arg("sensor") = py::none(),
      py::arg("trajectory") = py::none(), py::arg("duration") = py::none(),
      py::arg("speed") = py::none(), py::arg("seed") = py::none(), py::arg("imu") = py::none(),
      py::arg("gnss") = py::none(), py::arg("faults") = py::none(), py::arg("perfect") = false,
      "Writes a recording of a simulated place as MCAP, with its ground truth beside it:\n"
      "NAME.truth.tum is T_world_lidar. scene: a name, or the path of a TOML file that says\n"
      "everything; `adit simulate --help` lists the names of scenes, sensors, trajectories, IMUs,\n"
      "receivers and faults. duration: s. speed: m/s. perfect: a range sensor without errors.\n"
      "None: the program's default. The same arguments give the same bytes on any machine. Ctrl-C\n"
      "leaves unfinished files.\n"
      "UsageError: a name that does not exist. InputError, OutputError.");
  module.def(
      "run_program", &run_program, py::arg("arguments"),
      "The program `adit` with these arguments: prints, and returns its exit code. A signal\n"
      "that comes meanwhile is the program's.");
  module.def(
      "version", [] { return std::string(version()); }, "As `adit --version` tells it.");
}

}  // namespace adit::python
