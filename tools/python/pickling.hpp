// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Results and measurements as bytes, so that they pickle and copy: for other processes of the same
// adit, not for archives. What another version pickled is refused, for its structs may differ.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/core.h>
#include <pybind11/pybind11.h>
#include <Eigen/Geometry>

#include "adit/slam/core/types.hpp"
#include "adit/tools/python/fields.hpp"
#include "adit/tools/support/version.hpp"

namespace adit::python {

namespace py = pybind11;

/// Values without pointers: copied as a block, alone or in a vector.
template <class Value>
inline constexpr bool kIsPlain = (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) ||
                                 std::is_enum_v<Value> || std::is_same_v<Value, Point>;

/// Appends values field by field.
class ByteWriter {
 public:
  template <class Value>
  requires kIsPlain<Value>
  void put(const Value& value) { put_block(&value, sizeof(value)); }
  void put(bool value) { put(static_cast<uint8_t>(value ? 1 : 0)); }
  void put(const std::string& text) {
    put(uint64_t{text.size()});
    put_block(text.data(), text.size());
  }
  void put(const std::filesystem::path& path) { put(path.string()); }
  template <class Count, class Period>
  void put(std::chrono::duration<Count, Period> duration) {
    put(duration.count());
  }
  template <class Clock, class Duration>
  void put(std::chrono::time_point<Clock, Duration> time) {
    put(time.time_since_epoch());
  }
  template <class Derived>
  void put(const Eigen::PlainObjectBase<Derived>& matrix) {
    put_block(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(*matrix.data()));
  }
  void put(const Eigen::Isometry3d& pose) { put(pose.matrix()); }
  template <class Value>
  void put(const std::optional<Value>& value) {
    put(value.has_value());
    if (value) {
      put(*value);
    }
  }
  template <class Value>
  void put(const std::vector<Value>& values) {
    put(uint64_t{values.size()});
    if constexpr (kIsPlain<Value>) {
      put_block(values.data(), values.size() * sizeof(Value));
    } else {
      for (const Value& value : values) {
        put(value);
      }
    }
  }
  template <class Value, std::size_t Size>
  void put(const std::array<Value, Size>& values) {
    for (const Value& value : values) {
      put(value);
    }
  }
  template <class First, class Second>
  void put(const std::pair<First, Second>& both) {
    put(both.first);
    put(both.second);
  }
  template <class... Values>
  void put(const std::variant<Values...>& value) {
    put(static_cast<uint8_t>(value.index()));
    std::visit([this](const auto& held) { put(held); }, value);
  }
  template <class Struct>
  requires(std::is_aggregate_v<Struct> && !kIsPlain<Struct>) void put(const Struct& value) {
    std::apply([this](const auto&... field) { (put(field), ...); }, fields(value));
  }

  const std::string& bytes() const { return bytes_; }

 private:
  void put_block(const void* from, std::size_t size) {
    bytes_.append(static_cast<const char*>(from), size);
  }

  std::string bytes_;
};

/// Reads what a ByteWriter wrote. Throws ValueError for missing or invalid bytes.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : left_(bytes) {}

  template <class Value>
  requires kIsPlain<Value>
  void get(Value& value) { get_block(&value, sizeof(value)); }
  void get(bool& value) {
    uint8_t number = 0;
    get(number);
    require(number <= 1);
    value = number == 1;
  }
  void get(std::string& text) {
    text.resize(get_size());
    get_block(text.data(), text.size());
  }
  void get(std::filesystem::path& path) {
    std::string text;
    get(text);
    path = text;
  }
  template <class Count, class Period>
  void get(std::chrono::duration<Count, Period>& duration) {
    Count count{};
    get(count);
    duration = std::chrono::duration<Count, Period>(count);
  }
  template <class Clock, class Duration>
  void get(std::chrono::time_point<Clock, Duration>& time) {
    Duration since{};
    get(since);
    time = std::chrono::time_point<Clock, Duration>(since);
  }
  template <class Derived>
  void get(Eigen::PlainObjectBase<Derived>& matrix) {
    get_block(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(*matrix.data()));
  }
  void get(Eigen::Isometry3d& pose) { get(pose.matrix()); }
  template <class Value>
  void get(std::optional<Value>& value) {
    bool has_value = false;
    get(has_value);
    value.reset();
    if (has_value) {
      get(value.emplace());
    }
  }
  template <class Value>
  void get(std::vector<Value>& values) {
    const std::size_t size = get_size();  // each takes a byte at least
    if constexpr (kIsPlain<Value>) {
      require(size <= left_.size() / sizeof(Value));
      values.resize(size);
      get_block(values.data(), size * sizeof(Value));
    } else {
      values.clear();
      for (std::size_t i = 0; i < size; ++i) {
        get(values.emplace_back());
      }
    }
  }
  template <class Value, std::size_t Size>
  void get(std::array<Value, Size>& values) {
    for (Value& value : values) {
      get(value);
    }
  }
  template <class First, class Second>
  void get(std::pair<First, Second>& both) {
    get(both.first);
    get(both.second);
  }
  template <class... Values>
  void get(std::variant<Values...>& value) {
    uint8_t index = 0;
    get(index);
    require(index < sizeof...(Values));
    get_alternative<0>(value, index);
  }
  template <class Struct>
  requires(std::is_aggregate_v<Struct> && !kIsPlain<Struct>) void get(Struct& value) {
    std::apply([this](auto&... field) { (get(field), ...); }, fields(value));
  }

  /// Nothing may be left.
  void finish() const { require(left_.empty()); }

 private:
  static void require(bool holds) {
    if (!holds) {
      throw py::value_error("the pickled bytes are damaged");
    }
  }
  std::size_t get_size() {
    uint64_t size = 0;
    get(size);
    require(size <= left_.size());
    return static_cast<std::size_t>(size);
  }
  void get_block(void* to, std::size_t size) {
    require(size <= left_.size());
    if (size > 0) {
      std::memcpy(to, left_.data(), size);
    }
    left_.remove_prefix(size);
  }
  template <std::size_t Index, class Variant>
  void get_alternative(Variant& value, std::size_t wanted) {
    if constexpr (Index < std::variant_size_v<Variant>) {
      if (Index == wanted) {
        get(value.template emplace<Index>());
      } else {
        get_alternative<Index + 1>(value, wanted);
      }
    }
  }

  std::string_view left_;
};

/// The state that pickle stores: the version that made it, whose structs other versions may not
/// share, and the content.
inline py::tuple state_of(const py::object& content) {
  return py::make_tuple(std::string(version()), content);
}

/// The content that state_of() was given, a text or bytes. Throws ValueError for any other state.
inline std::string content_of(const py::tuple& state) {
  if (state.size() != 2 || !py::isinstance<py::str>(state[0]) ||
      !(py::isinstance<py::str>(state[1]) || py::isinstance<py::bytes>(state[1]))) {
    throw py::value_error("the pickled state is none of adit's");
  }
  if (const auto made_by = state[0].cast<std::string>(); made_by != version()) {
    throw py::value_error(
        fmt::format("pickled by adit {}, this is {}. Pickles go from process to "
                    "process of one version; write files to keep results",
                    made_by, version()));
  }
  return state[1].cast<std::string>();
}

/// Lets pickle and copy work on a struct that is bound: `.def(pickling<Struct>())`.
template <class Struct>
auto pickling() {
  return py::pickle(
      [](const Struct& value) {
        ByteWriter writer;
        writer.put(value);
        return state_of(py::bytes(writer.bytes()));
      },
      [](const py::tuple& state) {
        const std::string bytes = content_of(state);
        Struct value;
        ByteReader reader(bytes);
        reader.get(value);
        reader.finish();
        return value;
      });
}

}  // namespace adit::python
