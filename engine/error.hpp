// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the device layer throws. Messages are for people: what was attempted, what Vulkan answered,
// what to do. Mistakes of the calling code (a wrong binding, a misaligned slice) are
// std::logic_error.
#pragma once

#include <stdexcept>

namespace adit::engine {

/// Any failure of the device layer that is not a mistake of the calling code.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What was asked for names no device, or several. what() lists those there are.
class NoSuchDevice : public Error {
 public:
  using Error::Error;
};

/// A buffer does not fit into the budget or the device. The context stays usable.
class OutOfMemory : public Error {
 public:
  using Error::Error;
};

/// The device stopped (a hang, a reset, a driver crash). The context is of no more use.
class DeviceLost : public Error {
 public:
  using Error::Error;
};

}  // namespace adit::engine
