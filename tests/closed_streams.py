#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""With standard streams that are closed the program writes the same files, and nothing of what it says into them.

Usage: closed_streams.py ADIT.
"""

import pathlib
import subprocess
import sys
import tempfile

# What a shell closes, and the exit code: a report that cannot be written is a failure.
CASES = [("", 0), ("<&-", 0), ("2>&-", 0), (">&-", 1), ("<&- >&- 2>&-", 1)]


def simulated(adit, closed, code):
    """The files of a simulation, by name."""
    with tempfile.TemporaryDirectory() as folder:
        command = f'"$0" simulate room --duration 0.5 --gnss rtk -o x.mcap {closed}'
        done = subprocess.run(["sh", "-c", command, adit], cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != code:
            sys.exit(f"closed_streams: {command}: exit code {done.returncode} instead of {code}\n{done.stderr}")
        return {file.name: file.read_bytes() for file in pathlib.Path(folder).iterdir()}


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    adit = str(pathlib.Path(sys.argv[1]).resolve())
    whole = simulated(adit, *CASES[0])
    for closed, code in CASES[1:]:
        files = simulated(adit, closed, code)
        for name in whole.keys() | files.keys():
            if files.get(name) != whole.get(name):
                sys.exit(f"closed_streams: with {closed} {name} is another file")


if __name__ == "__main__":
    main()
