// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/printed.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

namespace adit {

std::string printed(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  va_list again;
  va_copy(again, arguments);
  const int size = std::max(0, std::vsnprintf(nullptr, 0, format, arguments));
  va_end(arguments);
  std::string text(static_cast<std::size_t>(size) + 1, '\0');  // and the end that C wants
  std::vsnprintf(text.data(), text.size(), format, again);
  va_end(again);
  text.resize(static_cast<std::size_t>(size));
  return text;
}

}  // namespace adit
