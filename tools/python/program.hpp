// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace adit::python {

/// adit.simulate, and the program itself.
void bind_program(pybind11::module_& module);

}  // namespace adit::python
