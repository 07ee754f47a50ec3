#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""How right the colours of `adit export --colorize` and `--raster color` are, against the simulator's truth.

Usage: colors.py ADIT -o FOLDER [--products dense cloud orthophoto] [--scenes NAME...] [--setups NAME...] [--seeds N...]
[--find-moving]. Simulates scenes with cameras, maps them, and exports every return with its colour (dense), the points
of the submaps (cloud), or the map from above (orthophoto). Recordings and maps that FOLDER holds already are used again.
Each takes some 200 MB; the clouds are deleted after they were compared.

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

The truth of a submap's point is that of the nearest return, at most 5 cm away; points without one are not compared. The
truth of an orthophoto's cell is the mean of the returns in it. Compared are flat cells: those whose returns, as far as
they are below the sensor, differ by at most 10 cm in height. Returns above the sensor are of surfaces whose upper side
it did not see. Edges are not looked for in these two. Their lines begin with the product, and "returns" are points of
the cloud, or flat cells.

One line a run: returns; the share that has a colour; the gains; of the compared ones the median, 90 % and 99 % of the
errors and the share that is visible; the share at edges, and how many of these err visibly; seconds of the export, those
of the same export without colours, and points a second with them. Exit codes: 0 done, 1 a command failed, 2 usage.
"""

import argparse
import pathlib
import struct
import subprocess
import sys
import time
import zlib

try:
    import numpy as np
    from scipy.spatial import cKDTree
except ImportError as error:
    print(f"colors.py: {error}; pip install numpy scipy", file=sys.stderr)
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
PRODUCTS = ("dense", "cloud", "orthophoto")
GLASS, MATERIAL = 14, 127
VISIBLE = 30  # of 255
JUMP = 0.3  # m
ASIDE = 0.05  # m
BESIDE = 0.05  # m, from a point of a submap to the return that is its truth
FLAT = 0.1  # m
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


def read_geotiff(file):
    """Red, green, blue and opacity of a GeoTIFF of adit, the x and y of its upper left corner, and its cells' size."""
    data = file.read_bytes()
    begin, = struct.unpack_from("<I", data, 4)
    tags = {}
    for at in range(begin + 2, begin + 2 + 12 * struct.unpack_from("<H", data, begin)[0], 12):
        tag, kind, count = struct.unpack_from("<HHI", data, at)
        code, size = {2: ("s", 1), 3: ("H", 2), 4: ("I", 4), 12: ("d", 8)}[kind]
        start = at + 8 if size * count <= 4 else struct.unpack_from("<I", data, at + 8)[0]
        tags[tag] = struct.unpack_from(f"<{count}{code}", data, start)
    (width,), (height,), (side,), channels = tags[256], tags[257], tags[322], tags[277][0]
    across, down = -(-width // side), -(-height // side)
    image = np.empty((down * side, across * side, channels), np.uint8)
    for i, (start, size) in enumerate(zip(tags[324], tags[325])):
        y, x = divmod(i, across)
        block = np.frombuffer(zlib.decompress(data[start:start + size]), np.uint8).reshape(side, side, channels)
        image[y * side:(y + 1) * side, x * side:(x + 1) * side] = block
    return image[:height, :width], np.array(tags[33922][3:5]), tags[33550][0]


def share(part, whole):
    return f"{100 * part.sum() / whole.sum():.2f}" if whole.any() else "-"


def export(program, out, file, *more):
    begin = time.perf_counter()
    adit(program, "export", out, *more, "-o", file)
    return time.perf_counter() - begin


def compare(colors, truth, compared):
    """Errors of the compared colours, after one gain a channel, and the gains."""
    pairs = np.float32(colors[compared]), np.float32(truth[compared])
    gains = [np.median(a[b > 0] / b[b > 0]) for a, b in zip(pairs[0].T, pairs[1].T)]
    return np.abs(pairs[0] / gains - pairs[1]).max(1), gains


def say(name, count, colored, found, edges, seconds):
    """One line of the table; `found`: errors and gains; `edges`: the texts of the two columns of edges."""
    errors, gains = found
    parts = " | ".join(f"{part:.1f}" for part in np.percentile(errors, (50, 90, 99)))
    print(f"| {name} | {count} | {100 * colored:.1f} | {' '.join(f'{gain:.3f}' for gain in gains)} | {parts} | "
          f"{100 * np.mean(errors > VISIBLE):.2f} | {edges[0]} | {edges[1]} | {seconds[0]:.1f} | {seconds[1]} | "
          f"{count / seconds[0]:.0f} |", flush=True)


def measure_cloud(program, folder, name, out, returns, more):
    """The points of the submaps; `returns`: places, true colours, and which can be compared."""
    places, truth, usable = returns
    ply = folder / "cloud.ply"
    seconds = export(program, out, ply, "--cloud", "ply", "--colorize", *more)
    points = read_ply(ply)
    colors = np.stack([points["red"], points["green"], points["blue"]], 1)
    distance, nearest = cKDTree(places).query(np.stack([points["x"], points["y"], points["z"]], 1), distance_upper_bound=BESIDE)
    near = np.isfinite(distance)
    nearest[~near] = 0
    compared = near & colors.any(1) & usable[nearest]
    say(f"cloud {name}", len(points), colors.any(1).mean(), compare(colors, truth[nearest], compared), "--", (seconds, "-"))
    ply.unlink()


def measure_orthophoto(program, folder, name, out, returns, sensor, more):
    """The map from above; `sensor`: height of the sensor at each return."""
    places, truth, usable = returns
    tif = folder / "orthophoto.tif"
    seconds = export(program, out, tif, "--raster", "color", "--frame", "map", *more)
    image, corner, cell = read_geotiff(tif)
    below = usable & (places[:, 2] < sensor)
    at = np.floor((places[below, :2] - corner) / cell * (1, -1)).astype(int)
    height, width = image.shape[:2]
    inside = ((at >= 0) & (at < (width, height))).all(1)
    index = at[inside, 1] * width + at[inside, 0]
    z = places[below, 2][inside]
    lowest, highest = np.full(height * width, np.inf), np.full(height * width, -np.inf)
    np.minimum.at(lowest, index, z)
    np.maximum.at(highest, index, z)
    counts = np.bincount(index, minlength=height * width)
    true = np.stack([np.bincount(index, truth[below][inside, k], height * width) for k in range(3)], 1) / np.maximum(counts, 1)[:, None]
    flat = (counts > 0) & (highest - np.where(counts > 0, lowest, 0) <= FLAT)
    cells = image.reshape(-1, 4)
    colored = cells[:, 3] > 0
    say(f"orthophoto {name}", int(flat.sum()), colored[flat].mean(), compare(cells[:, :3], true, colored & flat), "--", (seconds, "-"))
    tif.unlink()


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
    without = export(program, out, ply, "--dense", "ply", *more)
    seconds = export(program, out, ply, "--dense", "ply", "--colorize", *more) if "dense" in options.products else 0.0
    points = read_ply(ply)
    truth = np.fromfile(recording.with_suffix(".truth.colors"), np.uint8).reshape(-1, 3)
    surfaces = np.fromfile(recording.with_suffix(".truth.surfaces"), np.uint8)
    if not len(truth) == len(surfaces) == len(points):
        sys.exit(f"colors.py: {recording}: {len(truth)} colours for {len(points)} returns")
    usable = truth.any(1) & (surfaces & MATERIAL != GLASS)
    row = f"{scene} | {setup} | {seed}"
    if "dense" in options.products:
        colors = np.stack([points["red"], points["green"], points["blue"]], 1)
        compared = colors.any(1) & usable
        if not compared.any():
            sys.exit(f"colors.py: {ply}: no return has a colour that could be compared")
        errors, gains = compare(colors, truth, compared)
        wrong = np.zeros(len(points), bool)
        wrong[compared] = errors > VISIBLE
        edges = at_edges(points, out / "trajectory.tum") & compared
        say(f"dense {row}", len(points), colors.any(1).mean(), (errors, gains),
            (share(edges, compared), share(wrong & edges, edges)), (seconds, f"{without:.1f}"))
    places = np.stack([points["x"], points["y"], points["z"]], 1).astype(float)
    poses = np.loadtxt(out / "trajectory.tum")
    sensor = np.interp(points["time"], poses[:, 0], poses[:, 3])
    if "cloud" in options.products:
        measure_cloud(program, folder, row, out, (places, truth, usable), more)
    if "orthophoto" in options.products:
        measure_orthophoto(program, folder, row, out, (places, truth, usable), sensor, more)
    del points
    if not options.keep:
        ply.unlink()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="adit")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, help="folder for recordings and maps")
    parser.add_argument("--products", nargs="+", choices=PRODUCTS, default=PRODUCTS[:1])
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--setups", nargs="+", choices=SETUPS, default=list(SETUPS), help="cameras and their faults")
    parser.add_argument("--seeds", nargs="+", type=int, default=[7201, 7202, 7203])
    parser.add_argument("--duration", type=float, default=20.0, help="s")
    parser.add_argument("--find-moving", action="store_true", help="what is found to move stays black")
    parser.add_argument("--keep", action="store_true", help="keep the clouds")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    print("| product, scene | setup | seed | returns | coloured, % | gains | error, median | 90 % | 99 % | visible, % | "
          "at edges, % | of these visible, % | s | without colours | points a second |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    for scene in options.scenes:
        for setup in options.setups:
            for seed in options.seeds:
                measure(options.program, options.output, scene, setup, seed, options)


if __name__ == "__main__":
    main()
