// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include <pybind11/pybind11.h>

namespace adit::python {

/// Calls it while other Python threads run. What it returns must be no Python object. Locks of
/// adit's own are taken in here alone: whoever waited for one with the GIL would stop all.
template <class Call>
auto without_gil(Call&& call) {
  const pybind11::gil_scoped_release released;
  return std::forward<Call>(call)();
}

}  // namespace adit::python
