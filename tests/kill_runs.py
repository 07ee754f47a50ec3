#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Kills `adit run` at random moments, or lets its disk be full, and looks at the map that is left.

Usage: kill_runs.py ADIT [--kills N] [--full N] [--seed S] [--sweeps N] [--folder FOLDER]. Each map must open, pass
`adit check`, hold every keyframe that sweeps.csv says has ended, and hold of them what an undisturbed run holds. `adit
run --continue` must then end with the bytes of an undisturbed run; every third one is killed, and every third
interrupted (Ctrl-C), before it comes to that. For a full disk no file may grow beyond a random size (RLIMIT_FSIZE):
the run must exit 1 and say what could not be written, and --continue must end as above. Exits 1 where one of this does
not hold.
"""

import argparse
import csv
import json
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

SETTINGS = ["--set", "mapping.loops=false", "--set", "keyframe.delta_trans=0.05", "--quiet", "--no-map"]


def output_of(command):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def submaps_of(adit, map_file):
    """The lines of the dump that tell of submaps: they do not change once a keyframe has ended."""
    return [line for line in output_of([adit, "export", map_file, "--dump"]).splitlines() if line.startswith("submap ")]


def ended_keyframes(table):
    """All but the last keyframe of the sweeps that are written have ended; half a line counts for nothing."""
    if not table.exists():
        return 0
    rows = table.read_text(errors="replace").split("\n")
    count = sum(row.get("keyframe") == "1" for row in csv.DictReader(rows[:-1]))
    return max(count - 1, 0)


def rows_of(table):
    return table.read_bytes().count(b"\n") if table.exists() else 0


def end_after(command, delay, how, table=None, rows=0):
    """True where the command was ended by the signal before it had ended by itself: after a time, or where a table is
    given, so long after it has that many rows."""
    run = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while table is not None and run.poll() is None and rows_of(table) < rows:
        time.sleep(0.002)
    try:
        run.wait(delay)
        return False
    except subprocess.TimeoutExpired:
        run.send_signal(how)
        run.wait()
        return True


def complaints(arguments, out, expected, interrupted=False, full=False):
    """The submap that grew when a run was interrupted is stored as it was then. Where the map could not be written the
    table also has the sweeps that were placed by then."""
    map_file = out / "map.adit"
    if not map_file.exists():
        return ["there is no map, but a keyframe has ended"] if ended_keyframes(out / "sweeps.csv") else []
    check = subprocess.run([arguments.adit, "check", map_file], capture_output=True, text=True, check=False)
    if check.returncode != 0:
        nothing = "stopped before it had begun" in check.stderr and ended_keyframes(out / "sweeps.csv") == 0
        return [] if nothing else [f"adit check: {check.stdout}{check.stderr}"]
    found = []
    stored = json.loads(output_of([arguments.adit, "info", map_file, "--json"]))["keyframes"]
    ended = ended_keyframes(out / "sweeps.csv")
    if stored < ended and not full:
        found.append(f"{ended} keyframes have ended, {stored} are stored")
    whole = max(stored - interrupted, 0)
    if submaps_of(arguments.adit, map_file)[:whole] != expected[:whole]:
        found.append("its submaps are not those of an undisturbed run")
    return found


def can_go_on(adit, out):
    """False where the run was killed before its map had a session."""
    command = [str(adit), "info", str(out / "map.adit"), "--json"]
    info = subprocess.run(command, capture_output=True, text=True, check=False)
    return info.returncode == 0 and bool(json.loads(info.stdout)["sessions"])


def contents(adit, out):
    """What a run leaves, by name; its map as text."""
    files = {name: (out / name).read_bytes() for name in ("trajectory.tum", "odometry.tum", "online.tum")}
    return files | {"map.adit": output_of([adit, "export", out / "map.adit", "--dump"])}


def continuing(adit, out):
    return [str(adit), "run", "-o", str(out), "--continue", "--quiet", "--no-map"]


def differences_of_continued(arguments, out, whole):
    run = subprocess.run(continuing(arguments.adit, out), capture_output=True, text=True, check=False)
    if run.returncode != 0:
        return [f"--continue: {run.stdout}{run.stderr}"]
    found = contents(arguments.adit, out)
    return [f"after --continue {name} is not that of an undisturbed run" for name in whole if found[name] != whole[name]]


def differences_of_full(arguments, recording, out, most_bytes, expected, whole):
    """Of a run none of whose files may become larger, and of what goes on with it once there is room."""
    shutil.rmtree(out, ignore_errors=True)
    run = subprocess.run([str(arguments.adit), "run", str(recording), "-o", str(out), *SETTINGS], capture_output=True,
                         text=True, check=False, restore_signals=False,  # a write fails instead of ending the process
                         preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes)))
    found = complaints(arguments, out, expected, full=True)
    if run.returncode != 1 or "cannot be written" not in run.stderr:
        found.append(f"exit code {run.returncode}, {run.stderr.strip()}")
    if can_go_on(arguments.adit, out):
        found += differences_of_continued(arguments, out, whole)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("adit", type=lambda path: pathlib.Path(path).absolute())
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--full", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--sweeps", type=int, default=60)
    parser.add_argument("--folder", type=pathlib.Path)
    arguments = parser.parse_args()
    arguments.adit = arguments.adit.resolve()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.folder or pathlib.Path(temporary)
        recording, whole, out = folder / "room.mcap", folder / "whole", folder / "killed"
        output_of([arguments.adit, "simulate", "room", "-o", recording, "--duration", arguments.sweeps / 10,
                   "--seed", arguments.seed])
        start = time.monotonic()
        output_of([arguments.adit, "run", recording, "-o", whole, *SETTINGS])
        duration = time.monotonic() - start
        expected = submaps_of(arguments.adit, whole / "map.adit")
        everything = contents(arguments.adit, whole)
        chance = random.Random(arguments.seed)
        killed, with_keyframes, continued, failures = 0, 0, 0, 0
        for number in range(arguments.kills):
            # Every fourth one at any time, mostly while it starts; the others while it maps.
            table = None if number % 4 == 0 else out / "sweeps.csv"
            delay = chance.uniform(0.0, duration if table is None else duration / arguments.sweeps)
            shutil.rmtree(out, ignore_errors=True)
            killed += end_after([arguments.adit, "run", recording, "-o", out, *SETTINGS], delay, signal.SIGKILL, table,
                                1 + chance.randrange(arguments.sweeps))
            with_keyframes += ended_keyframes(out / "sweeps.csv") > 0
            found = complaints(arguments, out, expected)
            if can_go_on(arguments.adit, out):
                continued += 1
                if number % 3 > 0:
                    how = (signal.SIGKILL, signal.SIGINT)[number % 3 - 1]
                    end_after(continuing(arguments.adit, out), chance.uniform(0.0, duration), how)
                    found += complaints(arguments, out, expected, how == signal.SIGINT)
                found += differences_of_continued(arguments, out, everything)
            for complaint in found:
                failures += 1
                print(f"kill {number} after {delay:.3f} s: {complaint}")
        largest = (whole / "map.adit").stat().st_size
        for number in range(arguments.full):
            most_bytes = int(chance.uniform(0.1, 0.7) * largest)
            for complaint in differences_of_full(arguments, recording, out, most_bytes, expected, everything):
                failures += 1
                print(f"full disk {number}, {most_bytes} bytes: {complaint}")
        print(f"{killed} of {arguments.kills} runs of {duration:.1f} s killed, {with_keyframes} with a keyframe that "
              f"had ended; an undisturbed run has {len(expected)}; {continued} gone on with; {arguments.full} full disks; "
              f"{failures} complaints")
        return 1 if failures or killed == 0 or continued == 0 or len(expected) < 3 else 0


if __name__ == "__main__":
    sys.exit(main())
