// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// adit.Config: settings by the same names, checks and messages as `adit run --set` and --config.
#pragma once

#include <pybind11/pybind11.h>

#include "adit/slam/core/config.hpp"

namespace adit::python {

namespace py = pybind11;

/// A configuration out of None (defaults), a Config, the path of a TOML file, or a dictionary:
/// {"preprocess": {"r_input": 0.5}} or {"preprocess.r_input": 0.5}. Throws TypeError, UsageError,
/// InputError.
Config config_of(const py::object& source);

void bind_configuration(py::module_& module);

}  // namespace adit::python
