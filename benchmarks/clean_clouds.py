#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""How right the classes of `adit export --dense las --classify --clean mark` are, against the simulator's truth.

Usage: clean_clouds.py ADIT -o FOLDER [--scenes NAME...] [--seeds N...]. Simulates scenes, maps them, and exports every
return with its class. What FOLDER holds already of a scene and seed is not made again, but for the export.

Truth of a return: its surface (NAME.truth.surfaces), and whether it is of something that moves (NAME.truth.labels). It
is ground if its surface is level and of a material of the scene's ground; sills and roofs are excluded by their height.
In the office the upright sides of steps are neither: they are not counted. One line a run: returns; the share that is
ground; of this the share that has class 2; of those with class 2 the share that is ground, and the share that is
farther than 0.2 m from all ground; noise that was found (classes 7, 18 or 64), what moves that was found, and what was
lost of all others. Exit codes: 0 done, 1 a command failed, 2 usage.
"""

import argparse
import pathlib
import subprocess
import sys
import time

try:
    import numpy as np
except ImportError as error:
    print(f"clean_clouds.py: {error}; pip install numpy", file=sys.stderr)
    sys.exit(2)

GROUND, LOW, HIGH, MOVING = 2, 7, 18, 64
CONCRETE, ROCK, ASPHALT, SOIL = 1, 2, 3, 4
LEVEL = 128
# Scene: way of moving, materials of the ground, and more for `adit simulate`.
SCENES = {
    "room": ("walk", (CONCRETE,)),
    "office": ("walk", (CONCRETE,)),
    "city": ("drive", (ASPHALT, CONCRETE)),
    "forest": ("walk", (SOIL,)),
    "mine": ("drive", (ROCK,)),
    "rain": ("drive", (ASPHALT, CONCRETE), "--fault", "rain"),
}


def adit(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"clean_clouds.py: adit {' '.join(map(str, arguments))}: {done.stderr.strip()}")
    return done.stdout


def read_las(file):
    """Places (m) and classes of a LAS 1.4 file of format 6."""
    data = np.memmap(file, dtype=np.uint8, mode="r")
    begin, size = int(data[96:100].view("<u4")[0]), int(data[105:107].view("<u2")[0])
    count = int(np.frombuffer(data[247:255].tobytes(), "<u8")[0])
    rows = data[begin : begin + count * size].reshape(count, size)
    scale = np.frombuffer(data[131:179].tobytes(), "<f8")
    places = np.ascontiguousarray(rows[:, :12]).view("<i4") * scale[:3] + scale[3:]
    return places, np.asarray(rows[:, 16])


def read_poses(file):
    rows = [line.split() for line in file.read_text().splitlines() if line and not line.startswith("#")]
    return {row[0]: np.array(row[1:4], float) for row in rows}


def in_world(places, estimate, truth):
    """The map's places in the world: turned about the vertical and shifted by the trajectory."""
    common = sorted(estimate.keys() & truth.keys())
    a, b = (np.array([poses[t] for t in common]) for poses in (estimate, truth))
    x, y = (a - a.mean(0)).T[:2], (b - b.mean(0)).T[:2]
    turn = np.arctan2((x[0] * y[1] - x[1] * y[0]).sum(), (x[0] * y[0] + x[1] * y[1]).sum())
    c, s = np.cos(turn), np.sin(turn)
    return (places - a.mean(0)) @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + b.mean(0)


def is_ground(scene, surfaces, world):
    level = (surfaces & LEVEL) > 0
    ground = level & np.isin(surfaces & 127, SCENES[scene][1])
    if scene == "office":  # sills are 0.9 m above the floors of two storeys; roofs are above both
        storey = np.mod(world[:, 2], 3.4)
        inside = (world[:, 0] > -0.1) & (world[:, 0] < 43.9)
        ground &= ~(inside & (np.abs(storey - 0.9) < 0.2)) & (world[:, 2] < 6.0)
    return ground & (world[:, 2] < 3.0) if scene in ("city", "rain") else ground  # concrete roofs


def is_riser(scene, surfaces, world):
    """Concrete that is not level, between the steps of the office's staircase."""
    stairs = (world[:, 0] > 45.9) & (world[:, 0] < 52.9) & (np.abs(world[:, 1]) < 3.0)
    return stairs & (surfaces == CONCRETE) if scene == "office" else np.zeros(len(surfaces), bool)


def gross(world, ground, found):
    """Returns of class 2 that are no ground, and more than 0.2 m above or below all ground within 0.25 m, in %."""
    cells = np.floor(world[:, :2] / 0.25).astype(np.int64)
    keys = (cells[:, 0] << 32) + cells[:, 1]
    order = np.argsort(keys[ground], kind="stable")
    places, heights = keys[ground][order], world[ground, 2][order]
    starts = np.flatnonzero(np.r_[True, places[1:] != places[:-1]])
    low, high = np.minimum.reduceat(heights, starts), np.maximum.reduceat(heights, starts)
    known = places[starts]
    wrong = np.flatnonzero(found & ~ground)
    right = np.zeros(len(wrong), bool)
    for x in (-1, 0, 1):
        for y in (-1, 0, 1):
            at = keys[wrong] + (x << 32) + y
            i = np.minimum(np.searchsorted(known, at), len(known) - 1)
            z = world[wrong, 2]
            right |= (known[i] == at) & (z > low[i] - 0.2) & (z < high[i] + 0.2)
    return 100 * (~right).sum() / max(1, found.sum())


def share(part, whole):
    return f"{100 * part.sum() / whole.sum():.1f}" if whole.any() else "-"


def measure(program, folder, scene, seed, duration):
    trajectory, _, *more = SCENES[scene]
    recording, out = folder / f"{scene}-{seed}.mcap", folder / f"{scene}-{seed}"
    if not recording.exists():
        adit(program, "simulate", "city" if scene == "rain" else scene, "--trajectory", trajectory, "--duration",
             duration, "--seed", seed, *more, "--quiet", "-o", recording)
    if not (out / "summary.json").exists():
        adit(program, "run", recording, "-o", out, "--overwrite", "--quiet")
    las = folder / f"{scene}-{seed}.las"
    begin = time.perf_counter()
    adit(program, "export", out, "--dense", "las", "--classify", "--clean", "mark", "-o", las)
    seconds = time.perf_counter() - begin
    places, classes = read_las(las)
    surfaces = np.fromfile(recording.with_suffix(".truth.surfaces"), np.uint8)
    labels = recording.with_suffix(".truth.labels")
    moves = np.fromfile(labels, "<u2") > 0 if labels.exists() else np.zeros(len(surfaces), bool)
    if len(surfaces) != len(classes):
        sys.exit(f"clean_clouds.py: {recording}: {len(surfaces)} surfaces for {len(classes)} returns")
    world = in_world(places, read_poses(out / "trajectory.tum"), read_poses(recording.with_suffix(".truth.tum")))
    noise = (surfaces == 0) & ~moves
    ground = is_ground(scene, surfaces, world) & ~moves
    found = (classes == GROUND) & ~is_riser(scene, surfaces, world)
    marked = np.isin(classes, (LOW, HIGH, MOVING))
    alone = np.isin(classes, (LOW, HIGH))
    rest = ~noise & ~moves
    print(f"| {scene} | {seed} | {len(classes)} | {100 * ground.mean():.0f} | {share(found & ground, ground)} | "
          f"{share(found & ground, found)} | {gross(world, ground, found):.2f} | {100 * noise.mean():.2f} | {share(marked & noise, noise)} | "
          f"{share(alone & noise, alone)} | {100 * moves.mean():.2f} | {share(marked & moves, moves)} | "
          f"{100 * (marked & rest).sum() / rest.sum():.2f} | {100 * (alone & rest).sum() / rest.sum():.3f} | "
          f"{seconds:.1f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="adit")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, help="folder for recordings and maps")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--seeds", nargs="+", type=int, default=[7101, 7102, 7103, 7104, 7105])
    parser.add_argument("--duration", type=float, default=30.0, help="s")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    print("| scene | seed | returns | ground, % | ground found, % | right of class 2, % | grossly wrong, % | noise, % | noise found, % | "
          "right of 7 and 18, % | moving, % | moving found, % | lost of the rest, % | of these 7 and 18, % | s |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    for scene in options.scenes:
        for seed in options.seeds:
            measure(options.program, options.output, scene, seed, options.duration)


if __name__ == "__main__":
    main()
