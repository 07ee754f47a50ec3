// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/device.hpp"

#include <mutex>
#include <string>

#include <fmt/core.h>
#include <pybind11/stl.h>

#include "adit/engine/device_info.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit::python {
namespace {

struct Default {
  std::mutex mutex;
  SharedDevice device;
  std::string name;
};

Default& of_process() {
  static Default one;
  return one;
}

SharedDevice open(const std::string& name, uint64_t max_vram) {
  const py::gil_scoped_release released;
  try {
    return std::make_shared<DeviceSession>(
        DeviceOptions{.device = name, .max_vram_bytes = max_vram});
  } catch (const UsageError& error) {
    const std::string text = error.what();
    constexpr std::string_view kOption = "--device: ";
    throw UsageError(text.starts_with(kOption) ? text.substr(kOption.size()) : text);
  }
}

SharedDevice open_default() {
  Default& shared = of_process();
  const std::string name = requested_device({});
  const py::gil_scoped_release released;
  const std::lock_guard lock(shared.mutex);
  if (!shared.device || shared.name != name) {
    shared.device = std::make_shared<DeviceSession>(DeviceOptions{});
    shared.name = name;
  }
  return shared.device;
}

}  // namespace

SharedDevice device_of(const py::object& device) {
  if (device.is_none()) {
    return open_default();
  }
  if (py::isinstance<py::str>(device)) {
    return open(device.cast<std::string>(), 0);
  }
  if (py::isinstance<DeviceSession>(device)) {
    return device.cast<SharedDevice>();
  }
  throw py::type_error(
      fmt::format("device: None, a name or a Device, not {}", std::string(py::repr(device))));
}

void bind_device(py::module_& module) {
  py::class_<DeviceSession, SharedDevice>(
      module, "Device",
      "An open Vulkan device, for any number of objects and threads. Without one, all share the\n"
      "device that the environment's ADIT_DEVICE names, or the best there is.")
      .def(
          py::init(&open), py::arg("name") = "", py::kw_only(), py::arg("max_vram") = 0,
          "Index, UUID or part of the name of a device, as `adit devices` lists them. max_vram:\n"
          "bytes of device memory at most; 0: no limit. The first time that a device is used, its\n"
          "kernels are compiled and compared with known answers, which takes seconds. UsageError:\n"
          "no such device. DeviceError: none at all, or its answers are wrong.")
      .def_property_readonly(
          "name", [](DeviceSession& self) { return self.context().device().name; },
          "As its driver calls it.")
      .def_property_readonly(
          "driver",
          [](DeviceSession& self) {
            const engine::DeviceInfo& device = self.context().device();
            return device.driver + " " + device.driver_version;
          },
          "Driver and its version.")
      .def_property_readonly(
          "software", [](DeviceSession& self) { return self.context().device().software; },
          "True where the CPU does the device's work.")
      .def_property_readonly(
          "memory_in_use", [](DeviceSession& self) { return self.context().memory_in_use(); },
          "Bytes of the buffers alive.")
      .def_property_readonly(
          "memory_peak", [](DeviceSession& self) { return self.context().memory_peak(); },
          "The most that memory_in_use was.")
      .def("__repr__", [](DeviceSession& self) {
        return "<adit.Device " + describe(self.context().device()) + ">";
      });
  module.def(
      "devices",
      [] {
        std::vector<std::string> names;
        for (const engine::DeviceInfo& device : engine::list_devices()) {
          names.push_back(describe(device));
        }
        return names;
      },
      "The devices of this machine, by index: name, driver, version. DeviceError: there is none.");
  // Before the interpreter ends: the driver's threads must not outlive the driver.
  py::module_::import("atexit").attr("register")(py::cpp_function([] {
    Default& shared = of_process();
    const std::lock_guard lock(shared.mutex);
    shared.device.reset();
  }));
}

}  // namespace adit::python
