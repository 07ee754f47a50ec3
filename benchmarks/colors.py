#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""How right the colours of `adit export --dense ply --colorize` are, against the simulator's truth.

Usage: colors.py ADIT -o FOLDER [--scenes NAME...] [--setups NAME...] [--seeds N...] [--find-moving]. Simulates scenes
with cameras, maps them, and exports every return with its colour. Recordings and maps that FOLDER holds already are
used again. Each takes some 200 MB; the clouds are deleted after they were compared.

The truth of a return is its colour in NAME.truth.colors. Returns whose truth is 0 0 0 are of no surface, and returns of
glass show what no camera sees; neither is compared. The error of a return is the largest difference of its three
channels, of 0 to 255. A scene's brightness is unknown but for a factor: before errors are taken, each channel is divided
by its gain, the median ratio of the colours to their truth. Errors above 30 are called visible.

Bleeding is measured at depth edges. Consecutive beams of one ring in one turn, at most one and a half of the usual time
apart, have an edge between them if neither surface goes on behind it: along a plane, 1/range is linear in the beams. If
this line through the last two beams before the edge misses the range after it by more than 0.3 m, and the line through
the two after it misses the range before it by as much, it is an edge. A return is at the edge if its beam passes the
edge's at most 5 cm aside, at the return's own range: those of the surface in front and of the one behind. Edges between
the rings are not looked for: the rings are too far apart.

One line a run: returns; the share that has a colour; the gains; of the compared ones the median, 90 % and 99 % of the
errors and the share that is visible; the share at edges, and how many of these err visibly; seconds of the export, those
of the same export without colours, and points a second with them. Exit codes: 0 done, 1 a command failed, 2 usage.
"""

import argparse
import pathlib
import subprocess
import sys
import time

try:
    import numpy as np
except ImportError as error:
    print(f"colors.py: {error}; pip install numpy", file=sys.stderr)
    sys.exit(2)

SCENES = {"office": "walk", "city": "drive"}
# Setup: cameras, and their fault.
SETUPS = {
    "front": (("front",), None),
    "three": (("front", "left", "right"), None),
    "fisheye": (("front:fisheye",), None),
    "turned": (("front",), "camera-turned"),
    "late": (("front",), "camera-late"),
    "exposure": (("front",), "camera-exposure"),
}
GLASS, MATERIAL = 14, 127
VISIBLE = 30  # of 255
JUMP = 0.3  # m
ASIDE = 0.05  # m
MOST_BEAMS = 60  # aside of an edge: 5 cm at a quarter of a metre
TYPES = {"float": "<f4", "double": "<f8", "ushort": "<u2", "uchar": "u1"}


def adit(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"colors.py: adit {' '.join(map(str, arguments))}: {done.stderr.strip()}")
    return done.stdout


def read_ply(file):
    """The vertices of a binary PLY file of adit, by the names of their properties."""
    begin, fields = 0, []
    with open(file, "rb") as stream:
        for line in stream:
            words = line.decode().split()
            if words[0] == "property":
                fields.append((words[2], TYPES[words[1]]))
            if words[0] == "end_header":
                begin = stream.tell()
                break
    return np.memmap(file, fields, "r", begin)


def at_edges(points, trajectory):
    """Whether each return is at a depth edge along its ring."""
    poses = np.loadtxt(trajectory)
    sensor = np.stack([np.interp(points["time"], poses[:, 0], poses[:, k]) for k in (1, 2, 3)], 1)
    beams = np.stack([points["x"], points["y"], points["z"]], 1) - sensor
    order = np.argsort(points["ring"], kind="stable")  # the file is in the order of times
    ring, stamp, beams = points["ring"][order], points["time"][order], beams[order]
    ranges = np.linalg.norm(beams, axis=1)
    ranges[ranges == 0.0] = np.nan
    beams /= ranges[:, None]
    gaps = np.diff(stamp)
    same = ring[1:] == ring[:-1]
    joined = same & (gaps < 1.5 * np.median(gaps[same]))
    nearness = 1.0 / ranges
    with np.errstate(divide="ignore", invalid="ignore"):
        goes_on = np.abs(1.0 / (2.0 * nearness[1:-1] - nearness[:-2]) - ranges[2:]) <= JUMP
        came_from = np.abs(1.0 / (2.0 * nearness[1:-1] - nearness[2:]) - ranges[:-2]) <= JUMP
    # Of four beams in a row, between the second and the third.
    first = np.flatnonzero(joined[:-2] & joined[1:-1] & joined[2:] & ~goes_on[:-1] & ~came_from[1:]) + 1
    middle = beams[first] + beams[first + 1]
    middle /= np.linalg.norm(middle, axis=1)[:, None]
    found = np.zeros(len(ranges), bool)
    for start, step in ((first, -1), (first + 1, 1)):
        at, rays = start, middle
        for _ in range(MOST_BEAMS):
            close = np.linalg.norm(beams[at] - rays, axis=1) * ranges[at] <= ASIDE
            at, rays = at[close], rays[close]
            found[at] = True
            after = at + step
            inside = (after >= 0) & (after < len(ranges))
            inside[inside] = joined[np.minimum(at, after)[inside]]
            at, rays = after[inside], rays[inside]
    result = np.zeros(len(ranges), bool)
    result[order] = found
    return result


def share(part, whole):
    return f"{100 * part.sum() / whole.sum():.2f}" if whole.any() else "-"


def export(program, out, ply, *more):
    begin = time.perf_counter()
    adit(program, "export", out, "--dense", "ply", *more, "-o", ply)
    return time.perf_counter() - begin


def measure(program, folder, scene, setup, seed, options):
    cameras, fault = SETUPS[setup]
    name = f"{scene}-{setup}-{seed}"
    recording, out, ply = folder / f"{name}.mcap", folder / name, folder / f"{name}.ply"
    if not recording.exists():
        more = [word for camera in cameras for word in ("--camera", camera)] + (["--fault", fault] if fault else [])
        adit(program, "simulate", scene, "--trajectory", SCENES[scene], "--duration", options.duration, "--seed", seed,
             *more, "--quiet", "-o", recording)
    if not (out / "summary.json").exists():
        adit(program, "run", recording, "-o", out, "--overwrite", "--quiet")
    more = ["--find-moving"] if options.find_moving else []
    without = export(program, out, ply, *more)
    seconds = export(program, out, ply, "--colorize", *more)
    points = read_ply(ply)
    truth = np.fromfile(recording.with_suffix(".truth.colors"), np.uint8).reshape(-1, 3)
    surfaces = np.fromfile(recording.with_suffix(".truth.surfaces"), np.uint8)
    if not len(truth) == len(surfaces) == len(points):
        sys.exit(f"colors.py: {recording}: {len(truth)} colours for {len(points)} returns")
    colors = np.stack([points["red"], points["green"], points["blue"]], 1)
    colored = colors.any(1)
    compared = colored & truth.any(1) & (surfaces & MATERIAL != GLASS)
    if not compared.any():
        sys.exit(f"colors.py: {ply}: no return has a colour that could be compared")
    pairs = np.float32(colors[compared]), np.float32(truth[compared])
    gains = [np.median(a[b > 0] / b[b > 0]) for a, b in zip(pairs[0].T, pairs[1].T)]
    errors = np.abs(pairs[0] / gains - pairs[1]).max(1)
    wrong = np.zeros(len(points), bool)
    wrong[compared] = errors > VISIBLE
    edges = at_edges(points, out / "trajectory.tum") & compared
    parts = " | ".join(f"{part:.1f}" for part in np.percentile(errors, (50, 90, 99)))
    print(f"| {scene} | {setup} | {seed} | {len(points)} | {100 * colored.mean():.1f} | "
          f"{' '.join(f'{gain:.3f}' for gain in gains)} | {parts} | {share(wrong, compared)} | "
          f"{share(edges, compared)} | {share(wrong & edges, edges)} | {seconds:.1f} | {without:.1f} | "
          f"{len(points) / seconds:.0f} |", flush=True)
    del points
    if not options.keep:
        ply.unlink()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="adit")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, help="folder for recordings and maps")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--setups", nargs="+", choices=SETUPS, default=list(SETUPS), help="cameras and their faults")
    parser.add_argument("--seeds", nargs="+", type=int, default=[7201, 7202, 7203])
    parser.add_argument("--duration", type=float, default=20.0, help="s")
    parser.add_argument("--find-moving", action="store_true", help="what is found to move stays black")
    parser.add_argument("--keep", action="store_true", help="keep the clouds")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    print("| scene | setup | seed | returns | coloured, % | gains | error, median | 90 % | 99 % | visible, % | "
          "at edges, % | of these visible, % | s | without colours | points a second |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    for scene in options.scenes:
        for setup in options.setups:
            for seed in options.seeds:
                measure(options.program, options.output, scene, setup, seed, options)


if __name__ == "__main__":
    main()
