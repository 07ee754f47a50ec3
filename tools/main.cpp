// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/program.hpp"

int main(int argc, char** argv) {
  return adit::program(argc, argv);
}
