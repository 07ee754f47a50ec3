// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace adit::engine {

class Context;

/// Where a buffer lies, and who maps it.
enum class Memory {
  device,    ///< fastest for kernels; mapped only on devices with unified memory
  upload,    ///< mapped and coherent; the host writes, the device reads
  readback,  ///< mapped, coherent and cached where possible; the device writes, the host reads
};

/// Offsets of slices that kernels bind are multiples of this on every baseline device.
inline constexpr uint64_t kSliceAlignment = 256;

/// A texel of a uniform texel buffer: four 32-bit words. Every device can bind slices of up to
/// kMinTexels of them; what a device can is DeviceInfo::max_texel_buffer_elements.
inline constexpr uint64_t kTexelBytes = 16;
inline constexpr uint64_t kMinTexels = 65536;  ///< that every device binds at least

/// The next multiple of kSliceAlignment, for laying several slices out in one buffer.
constexpr uint64_t align_slice(uint64_t bytes) {
  return (bytes + kSliceAlignment - 1) / kSliceAlignment * kSliceAlignment;
}

struct Slice;

/// Device memory with one owner. Made by Context::make_buffer(); the context must outlive it, and
/// it must outlive every submission that uses it. Contents are undefined until written.
class Buffer {
 public:
  Buffer(Buffer&&) noexcept;
  Buffer& operator=(Buffer&&) noexcept;
  ~Buffer();

  uint64_t size() const;            ///< bytes, as asked for
  const std::string& name() const;  ///< for messages and profiles
  /// The host's view, null where there is none. Coherent: no flush is needed, but the device's
  /// writes are there only after Submission::wait(), and the host's only for submissions made after
  /// them.
  std::byte* mapped() const;

  /// The mapped bytes as an array, as many whole elements as fit. Throws std::logic_error if not
  /// mapped.
  template <class T>
  std::span<T> as() const {
    static_assert(std::is_trivially_copyable_v<T>);
    if (mapped() == nullptr) {
      throw std::logic_error("buffer '" + name() + "' is not mapped: copy it to a readback buffer");
    }
    return {reinterpret_cast<T*>(mapped()), static_cast<std::size_t>(size() / sizeof(T))};
  }

  /// The whole of it, or a part; offset and size in bytes.
  Slice slice() const;
  /// As above.
  Slice slice(uint64_t offset, uint64_t bytes) const;
  /// The whole of it.
  operator Slice() const;  // NOLINT(google-explicit-constructor): binds as a whole

  struct State;

 private:
  friend class Context;
  explicit Buffer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// A range of a buffer: what kernels bind and what fill() and copy() act on. It refers to the
/// buffer's memory: it stays good where the Buffer is moved, and ends with it.
struct Slice {
  const Buffer::State* buffer = nullptr;  ///< whose memory it is
  uint64_t offset = 0;  ///< bytes; a multiple of kSliceAlignment where a kernel binds it
  uint64_t bytes = 0;   ///< its size

  /// The range [at, at + length) of this slice, bytes. Throws std::out_of_range past its end.
  Slice sub(uint64_t at, uint64_t length) const;
  /// The rest of this slice from `at` on, bytes.
  Slice from(uint64_t at) const;
  /// The same bytes on the host; null where the buffer is not mapped.
  std::byte* mapped() const;
};

inline Slice Buffer::slice() const {
  return {state_.get(), 0, size()};
}
inline Slice Buffer::slice(uint64_t offset, uint64_t bytes) const {
  return slice().sub(offset, bytes);
}
inline Buffer::operator Slice() const {
  return slice();
}

}  // namespace adit::engine
