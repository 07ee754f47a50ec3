// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace adit {

/// The whole program: parses the command line, runs the command on the standard streams, returns
/// the exit code (0 done, 1 failed on the data or the device, 2 usage). Throws nothing.
int program(int argc, const char* const* argv);

}  // namespace adit
