// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace adit::python {

/// adit.Aligner, adit.voxel_down_sample, adit.estimate_surfaces.
void bind_clouds(pybind11::module_& module);

}  // namespace adit::python
