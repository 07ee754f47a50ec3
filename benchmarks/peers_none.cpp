// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/peers.hpp"

namespace adit::bench {

std::string register_peers() {
  return "none: PCL was not found when this was built (Debian: libpcl-dev)";
}

}  // namespace adit::bench
