#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Kills `adit run --map --extend`, `adit merge` and `adit split` at random moments, and looks at the maps after it.

Usage: kill_map_use.py ADIT [--kills N] [--seed S] [--seconds S] [--folder FOLDER]. N kills (50) of each command. The
maps that a command reads must have the bytes that they had. A killed extension leaves no map, or one that passes
`adit check`, holds each submap of the earlier map as it was, and each keyframe of its own session that its sweeps.csv
says has ended. A killed merge or split leaves no map under the name that was asked for, or the whole one; done again
over what the kill left, it must give the bytes of one that nobody disturbed. Exits 1 where one of this does not hold.
"""

import argparse
import csv
import hashlib
import json
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time


def output_of(*command):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def digest(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


def submaps_of(adit, file):
    return [line for line in output_of(adit, "export", file, "--dump").splitlines() if line.startswith("submap ")]


def ended_keyframes(table):
    """All but the last keyframe of the sweeps that are written have ended; half a line counts for nothing."""
    if not table.exists():
        return 0
    rows = table.read_text(errors="replace").split("\n")
    return max(sum(row.get("keyframe") == "1" for row in csv.DictReader(rows[:-1])) - 1, 0)


def killed(command, delay):
    """True if the command was killed before it had ended by itself."""
    run = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        run.wait(delay)
        return False
    except subprocess.TimeoutExpired:
        run.send_signal(signal.SIGKILL)
        run.wait()
        return True


class Inputs:
    """Files that must not change."""

    def __init__(self, files):
        self.digests = {file: digest(file) for file in files}

    def complaints(self):
        found = [f"{file} has changed" for file, known in self.digests.items() if digest(file) != known]
        return found + [f"{file} has a log" for file in self.digests
                        if pathlib.Path(f"{file}-wal").exists() and pathlib.Path(f"{file}-wal").stat().st_size > 0]


def extended(adit, folder, earlier, known):
    """Complaints about a killed extension."""
    map_file = folder / "map.adit"
    ended = ended_keyframes(folder / "sweeps.csv")
    if not map_file.exists():
        return ["there is no map, but a keyframe has ended"] if ended else []
    check = subprocess.run([adit, "check", map_file], capture_output=True, text=True, check=False)
    if check.returncode != 0:
        return [f"adit check: {check.stdout}{check.stderr}"] if ended else []
    found = []
    if submaps_of(adit, map_file)[:len(known)] != known:
        found.append("submaps of the earlier map are not as they were")
    stored = json.loads(output_of(adit, "info", map_file, "--json"))["keyframes"] - earlier
    if stored < ended:
        found.append(f"{ended} keyframes have ended, {stored} are stored")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("adit", type=lambda path: pathlib.Path(path).absolute())
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=8.0, help="of each recording")
    parser.add_argument("--folder", type=pathlib.Path)
    arguments = parser.parse_args()
    adit = arguments.adit.resolve()
    chance = random.Random(arguments.seed)
    failures, kills = 0, {}
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.folder or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for name, more in (("first", []), ("second", ["--noise-seed", arguments.seed + 1, "--later", 600])):
            output_of(adit, "simulate", "room", "--seed", arguments.seed, "--duration", arguments.seconds, "--trajectory",
                      "handheld", *more, "-o", folder / f"{name}.mcap", "--quiet", "--overwrite")
            output_of(adit, "run", folder / f"{name}.mcap", "-o", folder / name, "--quiet", "--no-map", "--overwrite")
        first, second = folder / "first" / "map.adit", folder / "second" / "map.adit"
        merged, part = folder / "merged.adit", folder / "again.adit"
        output_of(adit, "merge", first, second, "--same-site", "-o", merged)
        known = submaps_of(adit, first)
        commands = {
            "extend": ([adit, "run", folder / "second.mcap", "--map", first, "--extend", "-o", folder / "both", "--quiet",
                        "--no-map", "--overwrite"], [first], folder / "both" / "map.adit"),
            "merge": ([adit, "merge", first, second, "--same-site", "-o", folder / "killed.adit"], [first, second],
                      folder / "killed.adit"),
            "split": ([adit, "split", merged, "--session", "1", "-o", part], [merged], part)}
        for name, (command, reads, output) in commands.items():
            inputs = Inputs(reads)
            start = time.monotonic()
            output_of(*command)
            duration = time.monotonic() - start
            whole = digest(output)
            kills[name] = 0
            for number in range(arguments.kills):
                for left in output.parent.glob(output.name + "*"):
                    left.unlink()
                if name == "extend":
                    shutil.rmtree(output.parent, ignore_errors=True)
                delay = chance.uniform(0.0, duration)
                kills[name] += killed(command, delay)
                found = inputs.complaints()
                if name == "extend":
                    found += extended(adit, output.parent, len(known), known)
                elif output.exists():
                    found += ["the output is not whole"] if digest(output) != whole else []
                elif number % 10 == 0:  # over what the kill left
                    output_of(*command)
                    found += ["done again it has other bytes"] if digest(output) != whole else []
                for complaint in found:
                    failures += 1
                    print(f"{name} {number} after {delay:.3f} of {duration:.1f} s: {complaint}")
            print(f"{name}: {kills[name]} of {arguments.kills} killed", flush=True)
    print(f"{failures} complaints")
    return 1 if failures or not all(kills.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
