#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Whether `adit run --max-ram` keeps its word with the least that it says is needed, seen from outside.

Usage: memory_bound.py ADIT [--sensor NAME] [--duration SECONDS]. For odometry, a map, and a map with loops: a run that
is allowed too little names what it needs (exit 2); with that, and what starts differ by, it ends well and never had
more resident. Exits 1 where one of this does not hold.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

APART = 2  # MiB that the same program has more or less of from start to start
KINDS = {"odometry": ["--odometry"], "map": ["--set", "mapping.loops=false"], "loops": []}


def run(command):
    """Exit code, what it said on stderr, and the most that was resident, MiB."""
    process = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    said = process.stderr.read().decode(errors="replace")
    _, status, usage = os.wait4(process.pid, 0)
    return os.waitstatus_to_exitcode(status), said, usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("adit", type=lambda path: pathlib.Path(path).absolute())
    parser.add_argument("--sensor", default="VLP-16")
    parser.add_argument("--duration", default="12")
    options = parser.parse_args()
    failed = False
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        recording = folder / "mine.mcap"
        code, said, _ = run([options.adit, "simulate", "mine", "--sensor", options.sensor, "--duration",
                             options.duration, "-o", recording, "--quiet"])
        if code != 0:
            sys.exit(f"memory_bound: the recording could not be made: {said}")
        for kind, settings in KINDS.items():
            command = [options.adit, "run", recording, "-o", folder / kind, "--quiet", *settings, "--max-ram"]
            code, said, _ = run([*command, "1MiB"])
            needed = re.search(r"at least (\d+) MiB", said)
            if code != 2 or not needed:
                sys.exit(f"memory_bound: {kind}: 1 MiB was not refused with what is needed: exit {code}, {said}")
            allowed = int(needed[1]) + APART
            code, said, most = run([*command, f"{allowed}MiB"])
            good = code == 0 and most <= allowed
            failed |= not good
            print(f"{kind}: {needed[1]} MiB are needed, {most:.0f} of {allowed} were resident: "
                  f"{'good' if good else f'exit {code}, {said}'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
