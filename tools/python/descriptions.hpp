// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Signatures and reprs for everything that is bound, as Python's inspect and help() want them.
#pragma once

#include <string>
#include <string_view>

#include <pybind11/pybind11.h>

namespace adit::python {

/// "(self, a, *, b='x')" of the line "name(self: adit.A, a: int, *, b: str = 'x') -> int" that
/// pybind11 writes; what is no literal of Python becomes "...".
std::string text_signature(std::string_view line);

/// Everything must be bound before. Functions and classes get the signature that inspect.signature
/// and help() read; of several overloads the one with the most parameters. Classes without a repr
/// of their own get one that shows their properties of plain types.
void describe_all(pybind11::module_& module);

}  // namespace adit::python
