// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// To the device and back, each with a submission of its own and a wait: for tests and for what
// benchmarks do before the clock starts, not for a sweep.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/engine/context.hpp"

namespace adit::test {

/// A device buffer that holds `values`; room for one where there are none.
template <class T>
engine::Buffer upload(engine::Context& context, const std::vector<T>& values,
                      std::string_view name) {
  const uint64_t bytes = std::max<uint64_t>(values.size(), 1) * sizeof(T);
  engine::Buffer staging = context.make_buffer(bytes, engine::Memory::upload, "staging");
  std::memset(staging.mapped(), 0, bytes);
  if (!values.empty()) {
    std::memcpy(staging.mapped(), values.data(), values.size() * sizeof(T));
  }
  engine::Buffer buffer = context.make_buffer(bytes, engine::Memory::device, name);
  engine::Recorder recorder = context.make_recorder();
  recorder.copy(staging, buffer);
  context.submit(std::move(recorder)).wait();
  return buffer;
}

/// What `slice` holds, once all submitted work is done.
template <class T>
std::vector<T> download(engine::Context& context, engine::Slice slice) {
  std::vector<T> values(slice.bytes / sizeof(T));
  if (values.empty()) {
    return values;
  }
  engine::Buffer staging = context.make_buffer(slice.bytes, engine::Memory::readback, "staging");
  engine::Recorder recorder = context.make_recorder();
  recorder.copy(slice, staging);
  context.submit(std::move(recorder)).wait();
  std::memcpy(values.data(), staging.mapped(), values.size() * sizeof(T));
  return values;
}

}  // namespace adit::test
