// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a recording yields and a Slam takes, as Python objects: the measurement with where it comes
// from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <pybind11/pybind11.h>

#include "adit/slam/core/types.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit::python {

namespace py = pybind11;

template <class Value>
struct Measured {
  Value value;
  std::string frame{};                    ///< the sensor's; empty: not told
  std::string topic{};                    ///< empty: none
  std::optional<Nanoseconds> received{};  ///< the recorder's clock
};

/// "none", "single", "satellite_augmented", "ground_augmented".
std::string name_of(GnssFixKind kind);

/// The event as the Python object of its kind; takes it over.
py::object object_of(Event&& event, const std::vector<Topic>& topics);

void bind_measurements(py::module_& module);

}  // namespace adit::python
