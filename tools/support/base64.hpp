// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace adit {

/// Bytes as text (RFC 4648), for what is part of a page.
std::string base64(std::span<const std::byte> bytes);

}  // namespace adit
