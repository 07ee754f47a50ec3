// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace adit::python {

/// adit.Slam and its results.
void bind_slam(pybind11::module_& module);

}  // namespace adit::python
