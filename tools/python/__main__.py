# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""The program `adit` as `python -m adit`, with its exit codes."""

import os
import sys

from ._adit import run_program


def main() -> int:
    return run_program([os.fsdecode(argument) for argument in sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
