// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// adit.Device, and the one that everything uses which names none.
#pragma once

#include <memory>

#include <pybind11/pybind11.h>

#include "adit/tools/setup/device_session.hpp"

namespace adit::python {

namespace py = pybind11;

/// An open device. Its functions may be called from any thread.
using SharedDevice = std::shared_ptr<DeviceSession>;

/// A Device as it is; a text names one, as --device does; None is the one that ADIT_DEVICE names or
/// the best there is, opened once. Throws UsageError, engine::Error. Releases the GIL while it
/// opens one.
SharedDevice device_of(const py::object& device);

void bind_device(py::module_& module);

}  // namespace adit::python
