#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""How well `adit export --plan` draws the walls of a simulated office, laid over the scene's own surfaces.

Usage: tests/plan_walls.py ADIT FOLDER [SEED...]

Needs `adit` and a device (lavapipe will do); what FOLDER holds already of a seed is not made again. For each storey
that has a plan the mesh of the scene is cut 1.2 m above its floor, and the map is placed in the world by its trajectory
(turn about the vertical and shift). A line's error is its distance from the nearest surface, every 5 cm. It is false
where there is none within 10 cm. Of the surfaces' length that counts which has a line within 10 cm or a point of the
plan within 5 cm; it is found where there is a line.
"""

import collections
import math
import pathlib
import re
import statistics
import struct
import subprocess
import sys

STEP = 0.05  # m
NEAR = 0.05  # m, of points
FALSE = 0.10  # m
HEIGHT = 1.2  # m above a floor, as of --plan
STOREY = 3.4  # m, of the scene `office`


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, stdout=subprocess.PIPE, text=True).stdout


def read_poses(file):
    lines = (line.split() for line in file.read_text().splitlines() if line and not line.startswith("#"))
    return {line[0]: tuple(map(float, line[1:4])) for line in lines}


def placement(estimate, truth):
    """cos, sin and shift that take the map to the world."""
    pairs = [(estimate[t], truth[t]) for t in estimate if t in truth]
    mean = [[sum(pair[side][axis] for pair in pairs) / len(pairs) for axis in range(3)] for side in range(2)]
    dot = cross = 0.0
    for a, b in pairs:
        ax, ay, bx, by = a[0] - mean[0][0], a[1] - mean[0][1], b[0] - mean[1][0], b[1] - mean[1][1]
        dot += ax * bx + ay * by
        cross += ax * by - ay * bx
    c, s = dot / math.hypot(dot, cross), cross / math.hypot(dot, cross)
    x, y, z = mean[0]
    return c, s, mean[1][0] - c * x + s * y, mean[1][1] - s * x - c * y, mean[1][2] - z


def placed(place, p):
    c, s, x, y, z = place
    return c * p[0] - s * p[1] + x, s * p[0] + c * p[1] + y, (p[2] if len(p) > 2 else 0.0) + z


def read_mesh(file):
    """Vertices and triangles of the PLY that `adit simulate` writes."""
    header, body = file.read_bytes().split(b"end_header\n", 1)
    count = {word[1]: int(word[2]) for word in map(str.split, header.decode().splitlines()) if word[0] == "element"}
    vertices = [struct.unpack_from("<3f", body, 12 * i) for i in range(count["vertex"])]
    begin = 12 * count["vertex"]
    return vertices, [struct.unpack_from("<3I", body, begin + 16 * i + 1) for i in range(count["face"])]


def surfaces_at(mesh, height):
    """Where triangles cross a level."""
    vertices, triangles = mesh
    lines = []
    for triangle in triangles:
        p = [vertices[i] for i in triangle]
        ends = []
        for a, b in ((0, 1), (1, 2), (2, 0)):
            if (p[a][2] > height) != (p[b][2] > height):
                share = (height - p[a][2]) / (p[b][2] - p[a][2])
                ends.append(tuple(p[a][i] + share * (p[b][i] - p[a][i]) for i in range(2)))
        if len(ends) == 2 and math.dist(*ends) > 1e-6:
            lines.append(tuple(ends))
    return lines


def read_plan(file):
    """The lines and points of a drawing."""
    lines = file.read_text().splitlines()
    walls, points, kind, values = [], [], "", {}
    for code, value in zip(lines[0::2], lines[1::2]):
        if code == "0":
            place = [tuple(float(values.get(c, 0)) for c in codes) for codes in (("10", "20"), ("11", "21"))]
            walls += [tuple(place)] if kind == "LINE" else []
            points += [place[0]] if kind == "POINT" else []
            kind, values = value, {}
        else:
            values[code] = value
    return walls, points


def samples(line):
    """Places every 5 cm along a line, each with the length that it stands for."""
    length = math.dist(*line)
    count = max(1, round(length / STEP))
    for i in range(count):
        share = (i + 0.5) / count
        yield tuple(line[0][a] + share * (line[1][a] - line[0][a]) for a in range(2)), length / count


def distance(line, p):
    (x0, y0), (x1, y1) = line
    dx, dy = x1 - x0, y1 - y0
    share = min(1.0, max(0.0, ((p[0] - x0) * dx + (p[1] - y0) * dy) / (dx * dx + dy * dy)))
    return math.hypot(x0 + share * dx - p[0], y0 + share * dy - p[1])


class Index:
    """Lines by the squares of 0.5 m that they are in."""

    def __init__(self, lines):
        self.squares = collections.defaultdict(set)
        for line in lines:
            for p, _ in samples(line):
                for dx in (-1, 0, 1):
                    for dy in (-1, 0, 1):
                        self.squares[math.floor(2 * p[0]) + dx, math.floor(2 * p[1]) + dy].add(line)

    def nearest(self, p):
        return min((distance(line, p) for line in self.squares[math.floor(2 * p[0]), math.floor(2 * p[1])]),
                   default=math.inf)


def measure(adit, folder, seed):
    recording, out = folder / f"office{seed}.mcap", folder / f"office{seed}"
    if not recording.exists():
        run(adit, "simulate", "office", "--seed", seed, "--duration", 60, "--quiet", "-o", recording)
    if not (out / "summary.json").exists():
        run(adit, "run", recording, "-o", out, "--overwrite")
    floors = [float(z) for z in re.findall(r"floor at (\S+) m", run(adit, "export", out, "--plan", "-o", out / "plan.dxf"))]
    place = placement(read_poses(out / "trajectory.tum"), read_poses(recording.with_suffix(".truth.tum")))
    mesh = read_mesh(recording.with_suffix(".scene.ply"))
    totals = collections.Counter(storeys=len(floors))
    errors, of_walls = [], []
    for storey, floor in enumerate(floors):
        level = STOREY * round((floor + place[4]) / STOREY) + HEIGHT
        surfaces = surfaces_at(mesh, level)
        walls, points = read_plan(out / f"plan_{storey}.dxf")
        walls = [tuple(placed(place, end)[:2] for end in wall) for wall in walls]
        index, found = Index(surfaces), Index(walls)
        seen = {(math.floor(x / NEAR), math.floor(y / NEAR)) for x, y, _ in (placed(place, p) for p in points)}
        for wall in walls:
            off = [(index.nearest(p), length) for p, length in samples(wall)]
            errors += [error for error, _ in off if error <= FALSE]
            of_walls += [statistics.mean(good)] if (good := [e for e, _ in off if e <= FALSE]) else []
            totals["walls"] += 1
            totals["drawn"] += sum(length for _, length in off)
            totals["false"] += sum(length for error, length in off if error > FALSE)
        for surface in surfaces:
            for p, length in samples(surface):
                x, y = math.floor(p[0] / NEAR), math.floor(p[1] / NEAR)
                is_found = found.nearest(p) <= FALSE
                if is_found or any((x + dx, y + dy) in seen for dx in (-1, 0, 1) for dy in (-1, 0, 1)):
                    totals["seen"] += length
                    totals["found"] += length if is_found else 0.0
    errors.sort()
    print(f"| {seed} | {totals['storeys']} | {totals['walls']} | {totals['drawn']:.0f} | {1e3 * errors[len(errors) // 2]:.1f} | "
          f"{1e3 * errors[int(0.95 * len(errors))]:.1f} | {1e3 * max(of_walls):.0f} | "
          f"{100 * totals['found'] / totals['seen']:.1f} | {100 * totals['false'] / totals['drawn']:.1f} |", flush=True)


def main():
    adit, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    print("| seed | storeys | lines | drawn, m | error, median, mm | 95 %, mm | worst line, mm | found, % | false, % |")
    print("|---|---|---|---|---|---|---|---|---|")
    for seed in sys.argv[3:] or ["6601", "6602", "6603", "6604", "6605"]:
        measure(adit, folder, int(seed))


if __name__ == "__main__":
    main()
