// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The fields of a struct as a tuple of references. Pickling uses it instead of a list of fields for
// each struct, which somebody would forget to extend.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>

namespace adit::python {
namespace detail {

template <std::size_t Count>
using Number = std::integral_constant<std::size_t, Count>;

inline std::tuple<> fields(const auto&, Number<0>) {
  return {};
}

// A struct has at least so many fields as it can be made of empty braces; one line a number of
// fields, since C++ names each variable of a structured binding.
template <class Struct, std::size_t Count>
inline constexpr bool kTakes = false;
#define ADIT_UNWRAP(...) __VA_ARGS__
#define ADIT_FIELDS(count, names, braces)             \
  template <class Struct>                             \
  requires requires {                                 \
    Struct{ADIT_UNWRAP braces};                       \
  }                                                   \
  inline constexpr bool kTakes<Struct, count> = true; \
  auto fields(auto& value, Number<count>) {           \
    auto& [ADIT_UNWRAP names] = value;                \
    return std::tie(ADIT_UNWRAP names);               \
  }
// clang-format off
ADIT_FIELDS(1, (a), ({}))
ADIT_FIELDS(2, (a, b), ({}, {}))
ADIT_FIELDS(3, (a, b, c), ({}, {}, {}))
ADIT_FIELDS(4, (a, b, c, d), ({}, {}, {}, {}))
ADIT_FIELDS(5, (a, b, c, d, e), ({}, {}, {}, {}, {}))
ADIT_FIELDS(6, (a, b, c, d, e, f), ({}, {}, {}, {}, {}, {}))
ADIT_FIELDS(7, (a, b, c, d, e, f, g), ({}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(8, (a, b, c, d, e, f, g, h), ({}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(9, (a, b, c, d, e, f, g, h, i), ({}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(10, (a, b, c, d, e, f, g, h, i, j), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(11, (a, b, c, d, e, f, g, h, i, j, k), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(12, (a, b, c, d, e, f, g, h, i, j, k, l), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(13, (a, b, c, d, e, f, g, h, i, j, k, l, m), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(14, (a, b, c, d, e, f, g, h, i, j, k, l, m, n), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(15, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(16, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(17, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(18, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(19, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(20, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(21, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(22, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(23, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(24, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(25, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(26, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(27, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, A), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(28, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, A, B), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(29, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, A, B, C), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(30, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, A, B, C, D), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(31, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, A, B, C, D, E), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
ADIT_FIELDS(32, (a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, A, B, C, D, E, F), ({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}))
// clang-format on
#undef ADIT_FIELDS
#undef ADIT_UNWRAP

inline constexpr std::size_t kMostFields = 32;

template <class Struct, std::size_t Count = kMostFields>
constexpr std::size_t count_fields() {
  if constexpr (Count == 0 || kTakes<Struct, Count>) {
    return Count;
  } else {
    return count_fields<Struct, Count - 1>();
  }
}

}  // namespace detail

/// References to the fields of a struct without constructors, in their order; all of them have a
/// default, and there are at most 32.
template <class Struct>
auto fields(Struct& value) {
  using Bare = std::remove_const_t<Struct>;
  static_assert(std::is_aggregate_v<Bare>, "only of structs without constructors");
  return detail::fields(value, detail::Number<detail::count_fields<Bare>()>{});
}

}  // namespace adit::python
