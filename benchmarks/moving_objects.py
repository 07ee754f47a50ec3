#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""How much of what moves `adit export --find-moving` finds, and what it costs of what stands still.

Usage: moving_objects.py ADIT -o FOLDER. Simulates scenes, maps them, exports every return with its class and holds
that against the labels of the simulation. Where nothing moves (office, forest, mine) all that is found is an error.
One line a run: returns, the share of them that moves, the share of these that is found, the share of the others that
is lost, and the time of the search a keyframe.

Exit codes: 0 done, 1 a command failed, 2 usage.
"""

import argparse
import pathlib
import re
import subprocess
import sys
import time

try:
    import numpy as np
except ImportError as error:
    print(f"moving_objects.py: {error}; pip install numpy", file=sys.stderr)
    sys.exit(2)

MOVING = 64
# Scene: sensor, way of moving.
SCENES = {"city": ("VLP-16", "drive"), "office": ("VLP-16", "walk"), "forest": ("VLP-16", "walk"),
          "mine": ("VLP-16", "drive")}


def adit(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"moving_objects.py: adit {' '.join(map(str, arguments))}: {done.stderr.strip()}")
    return done.stdout


def classes(file):
    """The class of every point of a LAS 1.4 file of format 6 or above."""
    data = np.memmap(file, dtype=np.uint8, mode="r")
    begin = int(data[96:100].view("<u4")[0])
    size = int(data[105:107].view("<u2")[0])
    count = int(np.frombuffer(data[247:255].tobytes(), "<u8")[0])
    return np.asarray(data[begin : begin + count * size].reshape(count, size)[:, 16])


def measure(program, folder, scene, seed, duration):
    sensor, trajectory = SCENES[scene]
    recording = folder / f"{scene}-{seed}.mcap"
    out = folder / f"{scene}-{seed}"
    if not recording.exists():
        adit(program, "simulate", scene, "--sensor", sensor, "--trajectory", trajectory, "--duration", duration,
             "--seed", seed, "-o", recording)
    if not out.exists():
        adit(program, "run", recording, "-o", out, "--set", "mapping.loops=false", "--quiet")
    keyframes = int(re.search(r"keyframes\s+(\d+)", adit(program, "info", out / "map.adit")).group(1))
    las = folder / f"{scene}-{seed}.las"
    seconds = []
    for more in ((), ("--find-moving",)):
        begin = time.perf_counter()
        adit(program, "export", out / "map.adit", "--dense", "las", *more, "-o", las)
        seconds.append(time.perf_counter() - begin)
    found = classes(las) == MOVING
    las.unlink()
    labels = recording.with_suffix(".truth.labels")
    moves = np.fromfile(labels, "<u2") > 0 if labels.exists() else np.zeros(len(found), bool)
    if len(moves) != len(found):
        sys.exit(f"moving_objects.py: {recording}: {len(moves)} labels for {len(found)} returns")
    share = f"{(found & moves).sum() / moves.sum():.3f}" if moves.any() else "-"
    print(f"| {scene} | {seed} | {len(found)} | {keyframes} | {100 * moves.mean():.2f} % | {share} | "
          f"{100 * (found & ~moves).sum() / (~moves).sum():.2f} % | "
          f"{1e3 * (seconds[1] - seconds[0]) / keyframes:.0f} ms |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="adit")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, help="folder for recordings and maps")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--seeds", nargs="+", type=int, default=[1, 2, 3])
    parser.add_argument("--duration", type=float, default=40.0, help="s")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    print("| scene | seed | returns | keyframes | moving | found | lost of the rest | search, a keyframe |")
    print("|---|---|---|---|---|---|---|---|")
    for scene in options.scenes:
        for seed in options.seeds:
            measure(options.program, options.output, scene, seed, options.duration)


if __name__ == "__main__":
    main()
