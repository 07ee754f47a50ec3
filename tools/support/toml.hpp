// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// toml++ without its claims about itself. Version 3.3 claims of the key in "[.5]" that it begins as
// a key does, before it complains that it does not: with assert() that ends the program, and a
// compiler that believes it (NDEBUG, clang) may leave the complaint out.
#pragma once

#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(claim) static_assert(true)
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")
