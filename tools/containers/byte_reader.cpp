// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/byte_reader.hpp"

namespace adit {

// Not in the header: inlined many times in a row, GCC 12 invents an overflow in it.
void ByteWriter::append(const void* data, std::size_t size) {
  const auto* begin = static_cast<const std::byte*>(data);
  bytes_.insert(bytes_.end(), begin, begin + size);
}

}  // namespace adit
