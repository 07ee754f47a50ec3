// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "adit/engine/buffer.hpp"
#include "adit/engine/device_info.hpp"

namespace adit::engine {

/// Whether kernels read their tables as uniform texel buffers (constant kTexels of
/// shaders/include/texels.glsl): on software devices, where that is several times faster, if all of
/// a table that fits a storage buffer can be bound so.
inline bool reads_texels(const DeviceInfo& device) {
  return !device.gpu_shapes &&
         device.max_texel_buffer_elements >= device.max_storage_buffer_bytes / kTexelBytes;
}

/// The slice for a texel binding. Where texels are not read it is as much as every device can bind.
inline Slice texel_slice(Slice slice, bool reads) {
  const uint64_t most = reads ? slice.bytes : std::min(slice.bytes, kMinTexels * kTexelBytes);
  return slice.sub(0, most / kTexelBytes * kTexelBytes);
}

}  // namespace adit::engine
