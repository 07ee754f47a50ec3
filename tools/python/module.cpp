// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The Python module adit._adit; the package adit gives its content on.
#include <exception>
#include <new>
#include <string>

#include <pybind11/pybind11.h>

#include "adit/engine/error.hpp"
#include "adit/slam/graph/pose_graph.hpp"
#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tools/python/clouds.hpp"
#include "adit/tools/python/configuration.hpp"
#include "adit/tools/python/descriptions.hpp"
#include "adit/tools/python/device.hpp"
#include "adit/tools/python/map.hpp"
#include "adit/tools/python/measurements.hpp"
#include "adit/tools/python/odometry.hpp"
#include "adit/tools/python/program.hpp"
#include "adit/tools/python/recording.hpp"
#include "adit/tools/python/results.hpp"
#include "adit/tools/python/slam.hpp"
#include "adit/tools/python/trajectories.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit::python {
namespace {

namespace py = pybind11;

/// Raises the module's class of that name.
void raise(const char* name, const std::exception& found) {
  PyErr_SetString(py::module_::import("adit._adit").attr(name).ptr(), found.what());
}

py::handle add_exception(py::module_& module, const char* name, const py::tuple& bases,
                         const char* doc) {
  PyObject* type =
      PyErr_NewExceptionWithDoc(("adit." + std::string(name)).c_str(), doc, bases.ptr(), nullptr);
  if (type == nullptr) {
    throw py::error_already_set();
  }
  module.add_object(name, type);
  return type;
}

void bind_exceptions(py::module_& module) {
  const py::handle runtime_error(PyExc_RuntimeError);
  const py::handle error = add_exception(module, "Error", py::make_tuple(runtime_error),
                                         "What adit raises, with the program's own message.");
  add_exception(
      module, "InputError", py::make_tuple(error),
      "A file that cannot be used: its name, the place in it, what was found, what to do.");
  add_exception(module, "OutputError", py::make_tuple(error), "A result that cannot be written.");
  add_exception(module, "UsageError", py::make_tuple(error, py::handle(PyExc_ValueError)),
                "Something is asked for that cannot be: a name, a setting.");
  add_exception(module, "DeviceError", py::make_tuple(error),
                "There is no device, it is refused, its memory is exhausted, or it failed.");
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) {
        std::rethrow_exception(thrown);
      }
    } catch (const InputError& found) {
      raise("InputError", found);
    } catch (const OutputError& found) {
      raise("OutputError", found);
    } catch (const FileError& found) {
      raise("InputError", found);
    } catch (const UsageError& found) {
      raise("UsageError", found);
    } catch (const SubmapDamaged& found) {
      raise("InputError", found);
    } catch (const GraphError& found) {
      raise("InputError", found);
    } catch (const engine::Error& found) {
      raise("DeviceError", found);
    }
  });
}

/// pybind11 before 2.12 misreads NumPy 2: what it returns then repeats its first number.
void require_known_numpy() {
#if PYBIND11_VERSION_HEX < 0x020C0000
  const std::string version = py::str(py::module_::import("numpy").attr("__version__"));
  if (std::stoi(version) >= 2) {
    throw py::import_error(
        "adit was compiled with pybind11 " + std::to_string(PYBIND11_VERSION_MAJOR) + "." +
        std::to_string(PYBIND11_VERSION_MINOR) + ", which cannot read NumPy " + version +
        ". Install numpy<2, or compile adit with pybind11 2.12 or later (pip install "
        "tools/python takes one).");
  }
#endif
}

}  // namespace
}  // namespace adit::python

PYBIND11_MODULE(_adit, module) {
  using namespace adit::python;
  module.attr("__pybind11__") = py::make_tuple(PYBIND11_VERSION_MAJOR, PYBIND11_VERSION_MINOR);
  require_known_numpy();
  module.doc() = "Range-inertial-GNSS SLAM on any Vulkan device.";
  bind_exceptions(module);
  bind_device(module);
  bind_configuration(module);
  bind_measurements(module);
  bind_recording(module);
  bind_results(module);
  bind_odometry(module);
  bind_trajectories(module);
  bind_slam(module);
  bind_clouds(module);
  bind_map(module);
  bind_program(module);
  describe_all(module);
}
